"""Refusals: every error says what is wrong, with what, and the way out.

An error keeps its parts as positional arguments, so that it survives pickling on
its way back from a worker process, and renders them in ``__str__``.
"""

from collections.abc import Iterable
from difflib import get_close_matches


class BondGraphError(Exception):
    """A request that cannot be served.

    Parameters
    ----------
    problem
        One sentence: what is wrong, naming the objects.
    about
        Names of the objects concerned, for programs.
    remedy
        One sentence: the way out.
    """

    def __init__(
        self, problem: str, about: tuple[str, ...] = (), remedy: str = ""
    ) -> None:
        super().__init__(problem, about, remedy)
        self.problem = problem
        self.about = about
        self.remedy = remedy

    def __str__(self) -> str:
        return f"{self.problem} {self.remedy}".strip()


class StructureError(BondGraphError):
    """The graph is not well formed (dangling bond, duplicate or unknown name)."""


class UnfinishedGraphError(StructureError, AttributeError):
    """A graph that is still being written was used as a finished one."""


class ParameterError(BondGraphError):
    """A parameter is unknown, missing, unused, out of bounds or in a wrong unit."""


class UnitError(BondGraphError):
    """A unit is unknown or does not fit where it is used."""


class CausalConflictError(BondGraphError):
    """No causality satisfies every element; the trace says why."""


class EquationError(BondGraphError):
    """The equations cannot be formed or solved (law not invertible, singular)."""


class RecordingError(BondGraphError):
    """A recording cannot be read or does not fit the model."""


class FitError(BondGraphError):
    """A fit cannot be set up or did not end in an answer."""


class LoopShapingError(BondGraphError):
    """A loop cannot be measured, or its controller not be sized as asked."""


class CheckError(BondGraphError):
    """A check file cannot be understood."""


class ModelLoadError(BondGraphError):
    """A model file or factory cannot be found or run."""


class MissingExtraError(BondGraphError):
    """An optional package is needed and not installed."""


MOST_NAMES_LISTED = 50
"""A message that lists more names is not one line any more."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a sentence naming the closest known names, or all that one line holds.

    Parameters
    ----------
    name
        The word that was not found.
    known
        The words that would have been.
    """
    candidates = sorted(known)
    close = get_close_matches(name, candidates, n=3, cutoff=0.6)
    if close:
        return f"Did you mean {' or '.join(close)}?"
    if candidates:
        more = len(candidates) - MOST_NAMES_LISTED
        rest = f" and {more} more" if more > 0 else ""
        return f"Known here: {', '.join(candidates[:MOST_NAMES_LISTED])}{rest}."
    return "There are none here."
