"""Sequential causality assignment: sources, storages, resistances, the rest.

After Karnopp and Rosenberg: each choice is followed by everything it forces before the
next choice is made. Storages are offered integral causality one by one; one that was
forced otherwise is dependent, which is a normal result. A choice that leads to a
conflict is taken back, because in rings of junctions a local rule does not see it.
"""

from bondgraph.causality.propagation import FREE, Rule, StrokeBoard
from bondgraph.causality.records import CausalAssignment, CausalStep, CausalStroke
from bondgraph.causality.wording import reason, refusal
from bondgraph.errors import CausalConflictError, EquationError
from bondgraph.structure import signals
from bondgraph.structure.elements import (
    Compliance,
    EffortSource,
    FlowSource,
    Inertance,
    OneJunction,
    Resistance,
    Storage,
    ZeroJunction,
)
from bondgraph.structure.graph import FinishedGraph

# (bond, preferred node for the stroke, rule if preferred, rule otherwise, decided at)
_Choice = tuple[int, int, Rule, Rule, int]


def assign_causality(graph: FinishedGraph) -> CausalAssignment:
    """Return the causality of `graph`, integral where possible.

    The stroke of a bond sits at the end that receives effort. The cost is linear in
    the number of bonds.

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
            isinstance(kind, ZeroJunction | OneJunction) and len(board.at[node]) == 1
        ):
            board.start(node)
    conflict = board.propagate()
    if conflict:
        raise refusal(board, conflict)
    _decide(board, _choices(board))
    return _answer(board)


def _choices(board: StrokeBoard) -> list[_Choice]:
    """Return the choices to make, in order of preference."""
    storages: list[tuple[bool, _Choice]] = []
    resistances: list[tuple[int, _Choice]] = []
    for node, kind in enumerate(board.nodes):
        if isinstance(kind, Inertance | Compliance):
            bond = board.at[node][0]
            at = node if isinstance(kind, Inertance) else board.other(bond, node)
            choice = (bond, at, Rule.INTEGRAL, Rule.DERIVATIVE, node)
            storages.append((_derivative_is_easy(kind), choice))
        elif isinstance(kind, Resistance):
            bond = board.at[node][0]
            written = gives_effort(kind)
            at = board.other(bond, node) if written else node
            choice = (bond, at, Rule.CHOICE, Rule.CHOICE, node)
            resistances.append((_flexibility(kind), choice))
    # Laws that work one way only choose first (the sort is stable).
    ordered = [choice for _, choice in sorted(storages, key=lambda item: item[0])]
    ordered += [choice for _, choice in sorted(resistances, key=lambda item: item[0])]
    inner = [
        (bond, head, Rule.CHOICE, Rule.CHOICE, tail)
        for bond, (tail, head) in enumerate(board.ends)
    ]
    return ordered + inner


def _derivative_is_easy(storage: Storage) -> bool:
    """Return whether momentum (displacement) is explicit in flow (effort)."""
    if storage.law is None:
        return True
    stored = signals.p if isinstance(storage, Inertance) else signals.q
    try:
        storage.relation.solved_for(stored)
    except EquationError:
        return False
    return True


def gives_effort(resistance: Resistance) -> bool:
    """Return whether the law is written as an effort."""
    return bool(resistance.law is None or resistance.relation.output == signals.e)


def is_invertible(resistance: Resistance) -> bool:
    """Return whether the law gives effort and flow in closed form."""
    if resistance.law is None:
        return True
    try:
        resistance.relation.solved_for(resistance.relation.argument)
    except EquationError:
        return False
    return True


def _flexibility(resistance: Resistance) -> int:
    """Return how gladly a resistance works either way.

    A law that is written keeps the direction it is written in, where it can: solved for
    the other variable, a friction that happens to be zero would be divided by.
    """
    if not is_invertible(resistance):
        return 0
    return 1 if resistance.law is not None else 2


def _decide(board: StrokeBoard, choices: list[_Choice]) -> None:
    """Make the choices in turn; on a conflict take the latest one back."""
    made: list[tuple[int, int]] = []  # (index of the choice, trail before it)
    first: CausalConflictError | None = None
    budget = 2 * len(board.bonds) + 20
    i = 0
    while i < len(choices):
        bond, at, preferred, _, node = choices[i]
        if board.stroke[bond] != FREE:
            i += 1
            continue
        made.append((i, len(board.trail)))
        board.set(bond, at, preferred, node)
        conflict = board.propagate()
        while conflict:
            first = first or refusal(board, conflict)
            budget -= 1
            if not made or budget < 0:
                raise first
            i, length = made.pop()
            board.undo(length)
            bond, at, _, otherwise, node = choices[i]
            board.set(bond, board.other(bond, at), otherwise, node)
            conflict = board.propagate()
        i += 1


def _answer(board: StrokeBoard) -> CausalAssignment:
    strokes = tuple(
        CausalStroke(bond, board.nodes[at].name)
        for bond, at in zip(board.bonds, board.stroke, strict=True)
    )
    integral: list[str] = []
    derivative: list[str] = []
    for node, kind in enumerate(board.nodes):
        if isinstance(kind, Inertance | Compliance):
            receives_effort = board.stroke[board.at[node][0]] == node
            is_integral = receives_effort == isinstance(kind, Inertance)
            (integral if is_integral else derivative).append(kind.name)
    return CausalAssignment(
        strokes=strokes,
        integral=tuple(integral),
        derivative=tuple(derivative),
        arbitrary=tuple(_chosen(board, bond) for bond in _free_choices(board)),
        steps=tuple(CausalStep(strokes[b], reason(board, b)) for b in board.trail),
    )


def _free_choices(board: StrokeBoard) -> list[int]:
    return [bond for bond in board.trail if board.why[bond][0] is Rule.CHOICE]


def _chosen(board: StrokeBoard, bond: int) -> str:
    node = board.nodes[board.why[bond][1]]
    return node.name if isinstance(node, Resistance) else board.bonds[bond].name
