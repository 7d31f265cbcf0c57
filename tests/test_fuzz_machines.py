"""Random machines of 3 to 200 elements: right by their raw equations, or refused.

A fixed sample of what ``python -m benchmarks.fuzzing graphs 10000`` draws.
"""

import sys
from pathlib import Path

import pytest

ROOT = str(Path(__file__).parents[1])
if ROOT not in sys.path:
    sys.path.append(ROOT)

from benchmarks.fuzzing.machines import DOMAINS, MANNERS, random_machine  # noqa: E402
from benchmarks.fuzzing.verdicts import FAILURES, End, try_machine  # noqa: E402
from benchmarks.fuzzing.watching import watched  # noqa: E402
from bondgraph.errors import StructureError  # noqa: E402

SMALL = 20
SAMPLE = 20 * len(MANNERS)


@pytest.mark.parametrize("first", range(0, SAMPLE, len(MANNERS)))
def test_small_machines_are_right_or_refused_by_name(first):
    trials = [
        try_machine(seed, largest=SMALL) for seed in range(first, first + len(MANNERS))
    ]
    failed = [trial for trial in trials if trial.end in FAILURES]
    assert not failed
    assert sum(trial.end is End.AGREES for trial in trials) >= len(MANNERS) // 2


@pytest.mark.parametrize("seed", [1000, 1001, 1004, 1005])
def test_machines_of_a_hundred_elements_are_right_or_refused_by_name(seed):
    trial = try_machine(seed)
    assert trial.end not in FAILURES, trial


def test_machines_have_every_domain_kind_and_trouble():
    graphs = []
    for seed in range(20 * len(MANNERS)):
        try:
            graphs.append(random_machine(seed, largest=60).finish())
        except StructureError:
            continue
    domains = {domain.name for graph in graphs for domain in graph.domains}
    assert domains == set(DOMAINS)
    kinds = {type(node).__name__ for graph in graphs for node in graph.nodes}
    assert {"Transformer", "Gyrator", "InertanceField", "ResistanceField"} <= kinds
    assert any(len(graph.bonds) > len(graph.nodes) for graph in graphs)  # rings


def test_a_wrong_derivation_is_told_from_a_right_one(monkeypatch):
    # The judge itself: with one sign turned it must say no.
    from benchmarks.fuzzing import verdicts  # noqa: PLC0415

    right = verdicts.Seen.at

    def turned(self, *point):
        rates, outputs = right(self, *point)
        outputs[0] = -outputs[0]
        return rates, outputs

    monkeypatch.setattr(verdicts.Seen, "at", turned)
    ends = {try_machine(seed, largest=SMALL).end for seed in (0, 7, 14, 5, 12)}
    assert ends == {End.DISAGREES}


def test_a_worker_that_hangs_or_dies_costs_one_trial():
    lines = list(watched("graphs", 0, 3, limit=1e-3))
    assert [line["seed"] for line in lines] == [0, 1, 2]
    assert {line["end"] for line in lines} == {"HUNG"}
