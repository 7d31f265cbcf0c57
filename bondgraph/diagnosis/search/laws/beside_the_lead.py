"""Laws fitted from where the leading one has ended: those that come as far are kept."""

from collections.abc import Sequence

from bondgraph.diagnosis.candidates import Candidate, best_of_each
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Trial, fit_fully
from bondgraph.diagnosis.search.trials.vanished import has_vanished


def with_fitted(
    bench: Bench,
    candidates: Sequence[Candidate],
    trials: Sequence[Trial],
    what: str,
    keep: float,
) -> list[Candidate]:
    """Return the candidates, and what fits of `trials` have ended in.

    Of a law that is among them the better fit.

    Parameters
    ----------
    what
        Is done, for progress.
    keep
        Share of the leading reduction that a fit must reach to be kept.
    """
    if not trials:
        return list(candidates)
    least = keep * max(one.reduction(bench.base) for one in candidates)
    fitted = bench.candidates(trials, bench.run(fit_fully, trials, what))
    near = [
        one
        for one in fitted
        if one.reduction(bench.base) >= least and not has_vanished(one)
    ]
    return best_of_each([*candidates, *near])
