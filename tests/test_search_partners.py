"""Partners are looked for beside the narrowest of the laws that do the same."""

from types import SimpleNamespace

import pytest

from bondgraph.diagnosis.search.pairs import partners
from bondgraph.diagnosis.search.pairs.partners import couples

WIDER = {"stribeck": "coulomb"}


class Law(SimpleNamespace):
    def contains(self, other):
        return WIDER.get(self.name) == other.name


def single(name, cost):
    return SimpleNamespace(hypothesis=Law(name=name), cost=cost)


@pytest.mark.parametrize(
    ("cost", "screened"),
    [
        # A wider law that does about as much has the partners of the narrower one.
        (0.95, ["coulomb", "drag"]),
        (0.5, ["coulomb", "stribeck", "drag"]),
    ],
)
def test_what_does_no_more_than_a_part_of_it_is_not_screened(
    cost, screened, monkeypatch
):
    seen = []

    def beside(bench, law, others):
        seen.append(law.hypothesis.name)
        return []

    monkeypatch.setattr(partners, "promising_beside", beside)
    monkeypatch.setattr(partners, "fitted_alone", lambda bench, laws: {})
    singles = [single("coulomb", 1.0), single("stribeck", cost), single("drag", 2.0)]
    benches = {id(one): None for one in singles}
    assert couples(None, benches, singles, []) == []
    assert seen == screened
