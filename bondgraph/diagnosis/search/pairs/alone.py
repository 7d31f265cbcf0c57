"""Laws as fitted alone: those that help most, and any that are to be paired."""

from collections.abc import Sequence
from dataclasses import dataclass

from bondgraph.diagnosis.candidates import Candidate, Promised, is_named
from bondgraph.diagnosis.search.laws.fits import fit_best
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.judging import first_twin
from bondgraph.diagnosis.search.trials.trying import Trial, fit_fully
from bondgraph.physics.hypothesis import Hypothesis

MOST = 6
"""So many laws are paired: those that help most alone."""

HELPS = 0.1
"""A law with less than this share of the best reduction is not paired."""


@dataclass(frozen=True, slots=True)
class Singles:
    """Laws as fitted alone.

    Parameters
    ----------
    leading
        Those that help most, the best first; of those that say the same, the first.
    fitted
        All that were fitted to the end, these among them.
    """

    leading: tuple[Candidate, ...]
    fitted: tuple[Candidate, ...]

    @classmethod
    def of(cls, bench: Bench, promising: Sequence[Promised]) -> "Singles":
        """Return those of the laws that promise most."""
        named = [one for one in promising if is_named(one.hypothesis)]
        fitted = fit_best(bench, named, HELPS, 2 * MOST)
        fitted.sort(key=lambda candidate: candidate.cost)
        kinds: dict[tuple[str, str], Candidate] = {}
        for i, one in enumerate(fitted):
            if first_twin(i, fitted) == i and one.cost < bench.base.optimum.cost:
                kinds.setdefault((one.hypothesis.physics, one.hypothesis.place), one)
        return cls(tuple(kinds.values())[:MOST], tuple(fitted))

    def like(self, one: Candidate) -> list[Candidate]:
        """Return what says the same as a law alone, and what it contains."""
        return [
            other
            for other in self.fitted
            if other is not one
            and (
                first_twin(1, (one, other)) == 0
                or one.hypothesis.contains(other.hypothesis)
            )
        ]


def fitted_alone(bench: Bench, laws: Sequence[Hypothesis]) -> dict[int, Candidate]:
    """Return each law as fitted alone, by the id of its hypothesis.

    Also one of which a fit alone can make nothing, a limit that is never reached.
    """
    once = {id(law): law for law in laws}
    promised = [Promised(law, 1.0) for law in once.values()]
    fitted = fit_best(bench, promised, 0.0, len(once))
    helping = {id(one.hypothesis) for one in fitted}
    trials = [Trial(law) for law in once.values() if id(law) not in helping]
    idle = bench.candidates(trials, bench.run(fit_fully, trials, "fits"))
    return {id(one.hypothesis): one for one in (*fitted, *idle)}


def one_law(a: Hypothesis, b: Hypothesis) -> bool:
    """Return whether both are forms of one law at one place."""
    same = a.physics == b.physics or a.contains(b) or b.contains(a)
    return a.place == b.place and same
