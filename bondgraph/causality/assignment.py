"""Sequential causality assignment: sources, storages, resistances, the rest.

After Karnopp and Rosenberg: each choice is followed by everything it forces before the
next choice is made. Storages are offered integral causality one by one; one that was
forced otherwise is dependent, which is a normal result. A choice that leads to a
conflict is taken back, because in rings of junctions a local rule does not see it.
"""

from bondgraph.causality.choices import Choice, choices
from bondgraph.causality.propagation import FREE, Rule, StrokeBoard
from bondgraph.causality.records import CausalAssignment, CausalStep, CausalStroke
from bondgraph.causality.wording import reason, refusal
from bondgraph.errors import CausalConflictError
from bondgraph.structure.elements import EffortSource, FlowSource, Junction
from bondgraph.structure.graph import CausalPreference, FinishedGraph


def assign_causality(
    graph: FinishedGraph, *, prefer: tuple[CausalPreference, ...] = ()
) -> CausalAssignment:
    """Return the causality of `graph`, integral where possible.

    The stroke of a bond sits at the end that receives effort. The cost is linear in
    the number of bonds.

    Parameters
    ----------
    prefer
        Wishes for single elements, before those that the graph itself carries. A wish
        that the rest of the graph does not allow is listed in the answer's ``unmet``.

    Raises
    ------
    CausalConflictError
        If no causality satisfies every element; the message gives the chain of
        reasons.
    """
    board = StrokeBoard(graph)
    for node, kind in enumerate(graph.nodes):
        # A junction with a single bond also knows its stroke from the start.
        if isinstance(kind, EffortSource | FlowSource) or (
            isinstance(kind, Junction) and len(board.at[node]) == 1
        ):
            board.start(node)
    conflict = board.propagate()
    if conflict:
        raise refusal(board, conflict)
    wishes = {p.element: p for p in (*graph.preferences, *prefer)}
    offered = choices(board, tuple(wishes.values()))
    _decide(board, offered)
    return _answer(board, offered)


def _decide(board: StrokeBoard, offered: list[Choice]) -> None:
    """Make the choices in turn; on a conflict take the latest one back."""
    made: list[tuple[int, int]] = []  # (index of the choice, trail before it)
    first: CausalConflictError | None = None
    budget = 2 * len(board.bonds) + 20
    i = 0
    while i < len(offered):
        choice = offered[i]
        if board.stroke[choice.bond] != FREE:
            i += 1
            continue
        made.append((i, len(board.trail)))
        board.set(choice.bond, choice.at, choice.rule, choice.node)
        conflict = board.propagate()
        while conflict:
            first = first or refusal(board, conflict)
            budget -= 1
            if not made or budget < 0:
                raise first
            i, length = made.pop()
            board.undo(length)
            choice = offered[i]
            at = board.other(choice.bond, choice.at)
            board.set(choice.bond, at, choice.otherwise, choice.node)
            conflict = board.propagate()
        i += 1


def _answer(board: StrokeBoard, offered: list[Choice]) -> CausalAssignment:
    strokes = tuple(
        CausalStroke(bond, board.nodes[at].name)
        for bond, at in zip(board.bonds, board.stroke, strict=True)
    )
    integral: dict[int, str] = {}
    derivative: dict[int, str] = {}
    ports: dict[int, str] = {}
    unmet: list[str] = []
    for choice in offered:
        ports.setdefault(choice.bond, choice.port)
        if choice.integral is not None:
            met = board.stroke[choice.bond] == choice.integral
            (integral if met else derivative)[choice.bond] = choice.port
        if choice.rule is Rule.WISH and board.stroke[choice.bond] != choice.at:
            unmet.append(choice.port)
    return CausalAssignment(
        strokes=strokes,
        integral=_in_order(board, integral),
        derivative=_in_order(board, derivative),
        arbitrary=tuple(
            ports[bond] for bond in board.trail if board.why[bond][0] is Rule.CHOICE
        ),
        unmet=tuple(unmet),
        steps=tuple(CausalStep(strokes[b], reason(board, b)) for b in board.trail),
    )


def _in_order(board: StrokeBoard, ports: dict[int, str]) -> tuple[str, ...]:
    """Return the ports in the order of the graph's nodes, not of the choices."""
    place = {
        bond: node
        for node, bonds in enumerate(board.at)
        for bond in bonds
        if bond in ports and not isinstance(board.nodes[node], Junction)
    }
    return tuple(ports[bond] for bond in sorted(ports, key=lambda b: (place[b], b)))
