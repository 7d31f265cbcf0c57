"""No causality can be right: which elements disagree, and the chain of reasons."""

from bondgraph.causality.propagation import Conflict, StrokeBoard
from bondgraph.causality.records import Rule, described
from bondgraph.errors import CausalConflictError
from bondgraph.structure.elements import (
    EffortSource,
    Gyrator,
    Node,
    OneJunction,
    Transformer,
    ZeroJunction,
)

SHOWN_REASONS = 12


def refusal(board: StrokeBoard, conflict: Conflict) -> CausalConflictError:
    """Return the error that names the node, the elements and the chain of reasons."""
    node = board.nodes[conflict.node]
    givers = [
        board.bonds[b].other(node.name)
        for b in conflict.bonds
        if not isinstance(node, ZeroJunction | OneJunction)
        or board.supplies(b, conflict.node)
    ]
    problem, remedy = _problem(node, givers, board, conflict)
    chain = board.chain(conflict)
    reasons = list(dict.fromkeys(board.step(bond).reason for bond in chain))
    if len(reasons) > SHOWN_REASONS:
        half = SHOWN_REASONS // 2
        reasons = [*reasons[:half], "…", *reasons[-half:]]
    trace = f" This follows from: {'; '.join(reasons)}." if reasons else ""
    roots = [
        board.nodes[because].name
        for rule, because in (board.why[bond] for bond in chain)
        if rule not in (Rule.SUPPLIED, Rule.LAST, Rule.TWO_PORT)
    ]
    about = tuple(dict.fromkeys([node.name, *givers, *roots]))
    return CausalConflictError(problem + trace, about, remedy)


def _problem(
    node: Node, givers: list[str], board: StrokeBoard, conflict: Conflict
) -> tuple[str, str]:
    """Return what is wrong at `node`, and the way out."""
    names = " and ".join(repr(name) for name in givers)
    who = described(node)
    match node:
        case ZeroJunction() | OneJunction():
            zero = isinstance(node, ZeroJunction)
            common = "effort" if zero else "flow"
            if not givers:
                return (
                    f"Nothing gives {who} its {common}.",
                    f"Put a source, a storage or an R on {node.name!r}.",
                )
            part = (
                "a 1-junction with an I or R" if zero else "a 0-junction with a C or R"
            )
            return (
                f"{who} gets its {common} {len(givers)} times, from {names}.",
                f"Remove all but one of them, or part them by {part}.",
            )
        case Transformer():
            gets = "effort" if board.received[conflict.node] else "flow"
            return (
                f"{who} gets {gets} from both sides, {names}.",
                "Change or free one of the elements named here.",
            )
        case Gyrator():
            return (
                f"{who} gets effort from one side and flow from the other, {names}.",
                "Change or free one of the elements named here.",
            )
        case _:
            imposes = "effort" if isinstance(node, EffortSource) else "flow"
            return (
                f"{who} imposes {imposes} where {names} imposes it already.",
                "Remove one of them, or part them by a junction with a storage or R.",
            )
