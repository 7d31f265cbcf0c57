"""Sequential causality assignment: sources, storages, resistances, the rest.

After Karnopp and Rosenberg: each choice is followed by everything it forces before the
next choice is made. Storages are offered integral causality one by one; one that was
forced otherwise is dependent, which is a normal result. A choice that leads to a
conflict is taken back, because in rings of junctions a local rule does not see it.
"""

from bondgraph.causality.choices import Choice, choices, offer_bonds
from bondgraph.causality.propagation import FREE, StrokeBoard
from bondgraph.causality.records import CausalAssignment, Rule
from bondgraph.causality.wording import refusal
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
    while i < len(offered) or offer_bonds(board, offered):
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
    strokes = [board.stroke_of(bond) for bond in range(len(board.bonds))]
    integral: list[Choice] = []
    derivative: list[Choice] = []
    unmet: list[Choice] = []
    for choice in offered:
        at = board.stroke[choice.bond]
        if choice.integral is not None:
            (integral if at == choice.integral else derivative).append(choice)
        if choice.rule is Rule.WISH and at != choice.at:
            unmet.append(choice)
    ports = {choice.bond: choice.port for choice in reversed(offered)}
    return CausalAssignment(
        strokes=tuple(strokes),
        integral=_named(integral),
        derivative=_named(derivative),
        arbitrary=tuple(
            ports[bond] for bond in board.trail if board.why[bond][0] is Rule.CHOICE
        ),
        unmet=_named(unmet),
        steps=tuple(board.step(bond, strokes[bond]) for bond in board.trail),
    )


def _named(found: list[Choice]) -> tuple[str, ...]:
    """Return the ports in the order of the graph's nodes, not of the choices."""
    return tuple(c.port for c in sorted(found, key=lambda c: (c.node, c.bond)))
