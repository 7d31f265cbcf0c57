"""Laws whose fit has let go of them: states of their own explain, and not the law.

A state that a hypothesis adds begins anew in every window. With next to no strength
and an enormous state to begin with, a law lends its form to whatever disturbs the
machine: a mass of nothing on a spring swings as one likes. No fit finds the way back
from there, for all that it has learnt is in those states; it is begun again with an
effect, and set aside where it ends there again.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from bondgraph.diagnosis.candidates import Candidate, Rejected
from bondgraph.diagnosis.search.trials.trying import Start, Trial
from bondgraph.physics.hypothesis import Hypothesis

REASON = (
    "nothing is left of it where it fits best: only states that are set anew in every "
    "window explain"
)

NOTHING = 1e-6
"""A strength of less than this share of where it would begin with an effect is none."""

ENORMOUS = 30.0
"""A memory so many times larger than its law lets it become belongs to another law."""


def begun_again(candidates: Sequence[Candidate]) -> list[Trial]:
    """Return fits that begin with an effect, of the laws that have lost theirs.

    All else that the fit has found is kept, but for the states.
    """
    trials = []
    for candidate in candidates:
        if has_vanished(candidate):
            found = candidate.fitted.values
            starts = _with_effect(candidate.hypothesis)
            values = {**found, **starts}
            trials.append(Trial(candidate.hypothesis, (Start(values),)))
    return trials


def without_vanished(
    candidates: Sequence[Candidate],
) -> tuple[list[Candidate], tuple[Rejected, ...]]:
    """Return the candidates of which something is left, and the others."""
    kept = [one for one in candidates if not has_vanished(one)]
    gone = (one.hypothesis for one in candidates if has_vanished(one))
    return kept, tuple(Rejected(hypothesis, REASON) for hypothesis in gone)


def has_vanished(candidate: Candidate) -> bool:
    """Return whether no strength is above a start that is as good as none.

    Or whether its memory is enormous, which makes up for next to no strength.
    """
    nothing = is_nothing(candidate.hypothesis, candidate.fitted.values)
    return nothing or _is_enormous(candidate)


def _is_enormous(candidate: Candidate) -> bool:
    """Return whether a memory begins windows far beyond what its law lets it become."""
    memory = candidate.hypothesis.memory
    if memory is None:
        return False
    fitted = candidate.fitted
    which = fitted.problem.model.state_names.index(f"q_{memory.state}")
    along = fitted.optimum.linearisation.states[:, which]
    return bool(np.max(np.abs(along)) > ENORMOUS * memory.most)


def is_nothing(hypothesis: Hypothesis, values: Mapping[str, float]) -> bool:
    """Return whether no strength of a law is above what is as good as none."""
    if not hypothesis.strengths or not hypothesis.silent_starts:
        return False
    none, some = hypothesis.silent_starts[0], _with_effect(hypothesis)
    return all(
        0.0 < abs(values[n]) <= max(abs(none[n]), NOTHING * abs(some[n]))
        for n in hypothesis.strengths
    )


def _with_effect(hypothesis: Hypothesis) -> dict[str, float]:
    """Return the largest start value of each strength."""
    return {
        name: max((start[name] for start in hypothesis.starts), key=abs)
        for name in hypothesis.strengths
    }
