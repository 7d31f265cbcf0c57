"""A pair of which one law cannot be there is no answer, however well it fits."""

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from bondgraph.diagnosis.search.pairs import together


@dataclass(frozen=True)
class Law:
    """As little of a candidate as a pair is made of."""

    hypothesis: str
    fitted: str = ""

    def reduction(self, base: str) -> float:
        return 0.9


def pair_of(first, second):
    both = Law(second, fitted="both")
    return SimpleNamespace(first=Law(first), second=Law(second), both=both)


@pytest.mark.parametrize(
    ("pair", "worth"),
    [
        (pair_of("drag", "friction"), True),
        (pair_of("stop", "friction"), False),
        (pair_of("friction", "stop"), False),
    ],
    ids=["both", "not the first", "not the second"],
)
def test_both_laws_of_a_pair_may_be_there(monkeypatch, pair, worth):
    def impossible(one):
        assert one.fitted == "both"  # Alone it may be another.
        return "it stops nothing" if one.hypothesis == "stop" else None

    monkeypatch.setattr(together, "impossible", impossible)
    monkeypatch.setattr(together, "worth_judging", lambda _, added, __: (added, ()))
    setting = SimpleNamespace(base="base", recordings=[])
    assert together._is_worth(setting, pair) is worth
