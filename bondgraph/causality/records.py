"""The answer of causality assignment: a stroke per bond, each with its reason.

Strokes and steps are named tuples, because there are hundreds of thousands of them.
"""

from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple

from bondgraph.structure.elements import Junction, Node, ZeroJunction, letter
from bondgraph.structure.graph import Bond


class CausalStroke(NamedTuple):
    """The stroke of one bond: the node `at` receives effort and returns flow."""

    bond: Bond
    at: str

    @property
    def away(self) -> str:
        """The node at the other end: it gives effort and receives flow."""
        return self.bond.other(self.at)


class Rule(Enum):
    """Why a stroke was set."""

    SOURCE = auto()
    INTEGRAL = auto()
    DERIVATIVE = auto()
    CHOICE = auto()
    TURNED = auto()  # the other one, because what was chosen led to a conflict
    WISH = auto()  # what the author prefers
    UNMET = auto()  # the other one, because the wish led to a conflict
    SUPPLIED = auto()  # the junction has its effort (flow) already
    LAST = auto()  # the last bond that can supply the junction
    TWO_PORT = auto()


_AGAINST = {
    Rule.UNMET: " against the author's wish, which led to a conflict",
    Rule.TURNED: ", because otherwise there was a conflict",
}


class CausalStep(NamedTuple):
    """One stroke in the order in which it was set, and the rule that set it.

    ``node`` is where the rule applied; ``giver`` is the node at the other end of the
    bond, or, where a junction is supplied, the one that supplies it.
    """

    stroke: CausalStroke
    rule: Rule
    node: Node
    giver: str

    @property
    def reason(self) -> str:
        """Why the stroke is where it is, in words."""
        node = self.node
        who = described(node)
        common = "effort" if isinstance(node, ZeroJunction) else "flow"
        gives = "flow" if self.stroke.at == node.name else "effort"
        match self.rule:
            case Rule.SOURCE:
                return f"{who} imposes its {gives}"
            case Rule.INTEGRAL:
                return f"{who} is integral, as preferred"
            case Rule.DERIVATIVE:
                return f"{who} is derivative, because integral led to a conflict"
            case Rule.WISH:
                return f"{who} gives {gives}, as its author prefers"
            case Rule.UNMET | Rule.TURNED:
                return f"{who} gives {gives}{_AGAINST[self.rule]}"
            case Rule.CHOICE:
                chosen = f"was chosen to give {gives}"
                return f"{who} may give effort or flow, and {chosen}"
            case Rule.SUPPLIED:
                return f"{who} has its {common} from {self.giver!r}"
            case Rule.LAST:
                return f"only {self.giver!r} is left to give {who} its {common}"
            case Rule.TWO_PORT:
                return f"{who} passes causality on"


def described(node: Node) -> str:
    """Return the kind and name of a node: ``1-junction 'shaft'``."""
    junction = "-junction" if isinstance(node, Junction) else ""
    return f"{letter(node)}{junction} {node.name!r}"


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
