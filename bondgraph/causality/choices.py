"""What causality assignment may choose, and in which order it is best chosen.

First the storages that the author has a wish for; then the others, integral, those
whose law has no inverse before those that can easily be dependent; then resistances,
those with a wish first, then those that work one way only; last the bonds between
junctions.
"""

from collections.abc import Iterator
from functools import cache, lru_cache
from typing import NamedTuple

import sympy

from bondgraph.causality.propagation import FREE, StrokeBoard
from bondgraph.causality.records import Rule
from bondgraph.structure import signals
from bondgraph.structure.elements import Inertance, Resistance, Storage
from bondgraph.structure.fields import MultiPort, ResistanceField
from bondgraph.structure.graph import CausalPreference, Wanted
from bondgraph.structure.relations import inverse, slope_of_line
from bondgraph.structure.signals import parameter_symbol, parameters_in


class Choice(NamedTuple):
    """A bond whose stroke may be put at the node `at`, or else at the other end.

    ``port`` is the name of the element (``name[i]`` of a field) or of the bond;
    ``integral`` is where the stroke is in integral causality, for storages.
    """

    bond: int
    at: int
    rule: Rule
    otherwise: Rule
    node: int
    port: str
    integral: int | None = None


def choices(
    board: StrokeBoard, preferences: tuple[CausalPreference, ...]
) -> list[Choice]:
    """Return the storages and resistances in order of preference."""
    wishes = {p.element: p.wanted for p in preferences}
    ranked: list[tuple[int, Choice]] = []
    for rank, choice in _ports(board):
        wanted = wishes.get(choice.port)
        if wanted is None:
            ranked.append((rank, choice))
        else:
            # A resistance's wish must not take a storage's state away.
            first = -1 if choice.integral is not None else 9
            ranked.append((first, _wished(board, choice, wanted)))
    ranked.sort(key=lambda item: item[0])  # stable: the author's order within a rank
    return [choice for _, choice in ranked]


def offer_bonds(board: StrokeBoard, offered: list[Choice]) -> bool:
    """Append the bonds between junctions that are still free; False if none is."""
    free = [
        Choice(bond, head, Rule.CHOICE, Rule.TURNED, tail, board.bonds[bond].name)
        for bond, (tail, head) in enumerate(board.ends)
        if board.stroke[bond] == FREE
    ]
    offered += free
    return bool(free)


def _wished(board: StrokeBoard, choice: Choice, wanted: Wanted) -> Choice:
    other = board.other(choice.bond, choice.node)
    match wanted:
        case Wanted.GIVES_EFFORT:
            at = other
        case Wanted.GIVES_FLOW:
            at = choice.node
        case Wanted.INTEGRAL:
            at = choice.at if choice.integral is None else choice.integral
        case Wanted.DERIVATIVE:
            at = board.other(choice.bond, choice.at)
    rule = Rule.WISH
    return Choice(
        choice.bond, at, rule, Rule.UNMET, choice.node, choice.port, choice.integral
    )


def _ports(board: StrokeBoard) -> Iterator[tuple[int, Choice]]:
    """Yield every port that stores or resists, with its rank (lower is earlier)."""
    for node, kind in enumerate(board.nodes):
        if isinstance(kind, Storage):
            bond = board.at[node][0]
            momentum = isinstance(kind, Inertance)
            rank = _ease_of_derivative(kind)
            yield rank, _storage(board, bond, node, kind.name, momentum)
        elif isinstance(kind, Resistance):
            bond = board.at[node][0]
            given = kind.law is None or kind.relation.output == signals.e
            rank = 10 + _flexibility(kind)
            yield rank, _resistance(board, bond, node, kind.name, given)
        elif isinstance(kind, MultiPort):
            yield from _field_ports(board, node, kind)


def _field_ports(
    board: StrokeBoard, node: int, field: MultiPort
) -> Iterator[tuple[int, Choice]]:
    relations = field.relations
    linear = not any(
        law.diff(r.argument).free_symbols & {s.argument for s in relations}
        for law in field.laws
        for r in relations
    )
    for i, bond in enumerate(board.at[node]):
        port = field.port(i + 1)
        if isinstance(field, ResistanceField):
            gives_effort = relations[i].output.letter == "e"
            rank = 10 + int(linear)
            yield rank, _resistance(board, bond, node, port, gives_effort)
        else:
            momentum = field.stored[i].letter == "p"
            yield 2 * int(linear), _storage(board, bond, node, port, momentum)


def _storage(
    board: StrokeBoard, bond: int, node: int, port: str, momentum: bool
) -> Choice:
    at = node if momentum else board.other(bond, node)
    return Choice(bond, at, Rule.INTEGRAL, Rule.DERIVATIVE, node, port, integral=at)


def _resistance(
    board: StrokeBoard, bond: int, node: int, port: str, gives_effort: bool
) -> Choice:
    at = board.other(bond, node) if gives_effort else node
    return Choice(bond, at, Rule.CHOICE, Rule.TURNED, node, port)


def _ease_of_derivative(storage: Storage) -> int:
    """Return 2 if the law gives what is stored, 1 after some algebra, 0 if never."""
    if storage.law is None:
        return 2
    stored = signals.p if isinstance(storage, Inertance) else signals.q
    return _ease(storage, stored)


def _ease(element: Storage | Resistance, wanted: sympy.Symbol) -> int:
    relation = element.relation
    if relation.output == wanted:
        return 2
    return _ease_of_law(relation.expression, relation.argument, relation.output)


@lru_cache(maxsize=1024)
def _ease_of_law(law: sympy.Expr, argument: sympy.Symbol, output: sympy.Symbol) -> int:
    """Return how easily a law is inverted, whatever its parameters are called."""
    constants = sorted(map(parameter_symbol, parameters_in(law)), key=str)
    form = law.xreplace(dict(zip(constants, _places(len(constants)), strict=True)))
    return _ease_of_form(form, argument, output)


@cache
def _places(count: int) -> tuple[sympy.Symbol, ...]:
    return tuple(sympy.Dummy(f"k{i}", real=True) for i in range(count))


@lru_cache(maxsize=1024)
def _ease_of_form(law: sympy.Expr, argument: sympy.Symbol, output: sympy.Symbol) -> int:
    """Return how easily a law is inverted; large machines repeat few forms of law."""
    if slope_of_line(law, argument) is not None:
        return 2
    return 0 if inverse(law, argument, output) is None else 1


_LEVEL = (sympy.Max, sympy.Min, sympy.Piecewise, sympy.sign, sympy.tanh)
"""A law of these is level somewhere, or nearly: no value of it tells its argument."""


def _flexibility(resistance: Resistance) -> int:
    """Return how gladly a resistance works either way.

    A law that is written keeps the direction it is written in, where it can: solved for
    the other variable, a friction that happens to be zero would be divided by. Least
    gladly one that is level somewhere: beside one that only rises, that is solved.
    """
    if resistance.law is None:
        return 4
    if resistance.law.has(*_LEVEL):
        return 0
    return 1 + _ease(resistance, resistance.relation.argument)
