"""How a simulation ended, and why where it did not end well."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from bondgraph.numeric.model import NumericModel


class RunStatus(StrEnum):
    """How a simulation ended; the value is the sentence to show."""

    SUCCESSFUL = "The simulation ran to the end."
    SINGULAR = "The equations of a step determine no solution."
    NOT_FINITE = "The solution did not stay finite."
    NOT_CONVERGED = (
        "The equations of a step had no solution that Newton's method found."
    )
    OUTPUT_NOT_FINITE = "The states stayed finite, an output did not."
    SOLVER_FAILED = "The solver gave up."
    GROWTH_NOT_FOLLOWED = (
        "The model grows many times over within one step: no step follows that."
    )


REMEDIES = {
    RunStatus.SINGULAR: "Look for a law that is flat there, or start elsewhere.",
    RunStatus.NOT_FINITE: (
        "Check the initial state and the signs of the laws, or take smaller steps."
    ),
    RunStatus.NOT_CONVERGED: "Take smaller steps, or smooth a law that jumps.",
    RunStatus.OUTPUT_NOT_FINITE: "Check where the measurement is defined.",
    RunStatus.GROWTH_NOT_FOLLOWED: (
        "Check the signs of the laws and parameters, or take shorter steps than that."
    ),
    RunStatus.SOLVER_FAILED: "Loosen the tolerances, or take fixed implicit steps.",
}
CODES = {
    0: RunStatus.NOT_FINITE,
    1: RunStatus.SINGULAR,
    2: RunStatus.NOT_FINITE,
    3: RunStatus.NOT_CONVERGED,
}
"""What the kernel's codes mean; 0 where a step itself left the numbers."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trouble:
    """Where and why a simulation stopped.

    Parameters
    ----------
    time
        In s: the last sample that was reached.
    unknown
        The unknown that moved most when the solver gave up, or the output; "" where
        there is none.
    """

    status: RunStatus
    time: float
    unknown: str

    @property
    def reason(self) -> str:
        """What happened, where, and the way out, in a sentence or two."""
        about = f" ({self.unknown})" if self.unknown else ""
        what = self.status.value.rstrip(".")
        return f"{what}: after t = {self.time:.6g} s{about}. {REMEDIES[self.status]}"


def unknown_names(model: NumericModel) -> Sequence[str]:
    """Return what the unknowns of a stage are, in the kernel's order."""
    dry = () if model.set_valued is None else model.set_valued.places
    return (
        *(f"the rate of {name}" for name in model.state_names),
        *(f"the unknown {name}" for name in model.unknown_names),
        *(f"the dry friction of {place}" for place in dry),
    )
