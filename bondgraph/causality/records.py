"""The answer of causality assignment: a stroke per bond, each with its reason."""

from dataclasses import dataclass

from bondgraph.structure.graph import Bond


@dataclass(frozen=True, slots=True)
class CausalStroke:
    """The stroke of one bond: the node `at` receives effort and returns flow."""

    bond: Bond
    at: str

    @property
    def away(self) -> str:
        """The node at the other end: it gives effort and receives flow."""
        return self.bond.other(self.at)


@dataclass(frozen=True, slots=True)
class CausalStep:
    """One stroke in the order in which it was set, and why, in words."""

    stroke: CausalStroke
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class CausalAssignment:
    """The causality of a whole graph.

    Parameters
    ----------
    strokes
        One per bond, in the order of the graph's bonds.
    integral, derivative
        Names of the storages that are states, and of those that depend on others; a
        field's port is called ``name[1]``.
    arbitrary
        Names of resistances (or bonds) whose causality was a free choice; each
        usually closes an algebraic loop.
    unmet
        Names of the elements whose preferred causality the rest does not allow.
    steps
        The same strokes in the order in which they were set, with reasons.
    """

    strokes: tuple[CausalStroke, ...]
    integral: tuple[str, ...]
    derivative: tuple[str, ...]
    arbitrary: tuple[str, ...]
    steps: tuple[CausalStep, ...]
    unmet: tuple[str, ...] = ()

    def stroke_of(self, bond: str) -> CausalStroke:
        """Return the stroke of the bond called `bond` (the first of that name)."""
        return next(s for s in self.strokes if s.bond.name == bond)
