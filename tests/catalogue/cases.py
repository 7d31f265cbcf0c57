"""What a case of the catalogue is, and how its answers are written and compared."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import sympy

from bondgraph import BondGraph, FinishedGraph


@dataclass(frozen=True)
class Case:
    """One graph and what is known of it.

    ``source`` says where the machine and its equations are from. ``rates`` are ẋ by
    state, ``transfers`` transfer functions by (output, input), both as text in terms
    of parameter names. ``relations`` are texts that must vanish, for answers that have
    no closed form: in states, rates (``dq_c`` for the rate of ``q_c``), inputs, their
    rates (``du``), outputs and parameters. An ``active`` case has a source that reads
    a signal, so that it is more than a graph of power. ``where`` gives numbers for
    symbols that cannot have any.
    """

    name: str
    make: Callable[[], BondGraph]
    states: tuple[str, ...]
    source: str
    derivative: tuple[str, ...] = ()
    loops: int = 0
    rates: Mapping[str, str] = field(default_factory=dict)
    transfers: Mapping[tuple[str, str], str] = field(default_factory=dict)
    relations: tuple[str, ...] = ()
    active: bool = False
    where: Mapping[str, float] = field(default_factory=dict)

    @property
    def linear(self) -> bool:
        return bool(self.transfers) and not self.active

    def graph(self) -> FinishedGraph:
        return self.make().finish()


CASES: list[Case] = []


def case(**known: object) -> Callable[[Callable[[BondGraph], None]], None]:
    """Add the decorated writer of a graph to the catalogue."""
    return adder(CASES, **known)


def adder(
    to: list[Case], **known: object
) -> Callable[[Callable[[BondGraph], None]], None]:
    """Return a decorator that adds the writer of a graph to the list `to`."""

    def add(write: Callable[[BondGraph], None]) -> None:
        def make() -> BondGraph:
            graph = BondGraph(write.__name__)
            write(graph)
            return graph

        to.append(Case(name=write.__name__, make=make, **known))  # type: ignore[arg-type]

    return add


FUNCTIONS = frozenset(
    "sin cos tan exp log tanh sign sqrt Abs Max Min Heaviside pi".split()
)


def expression(text: str) -> sympy.Expr:
    """Return a catalogue answer with the symbols the library uses."""
    names = {str(x): sympy.Symbol(str(x), real=True) for x in _names(text)}
    return sympy.sympify(text, locals={**names, "s": sympy.Symbol("s")})


def _names(text: str) -> set[str]:
    return set(re.findall(r"[A-Za-z_]\w*", text)) - FUNCTIONS


def somewhere(symbols: set[sympy.Symbol], seed: int = 0) -> dict[sympy.Symbol, float]:
    """Return arbitrary values between 0.5 and 1.5, the same for the same names."""
    ordered = sorted(symbols, key=str)
    values = {}
    for x in ordered:
        code = sum((i + 1) * ord(c) for i, c in enumerate(str(x))) + 37 * seed
        values[x] = 0.5 + (code * 0.6180339887498949) % 1.0
    return values


def agree(one: sympy.Expr, other: sympy.Expr) -> bool:
    """Return whether two expressions have the same value at arbitrary numbers."""
    symbols = one.free_symbols | other.free_symbols
    for seed in range(3):
        put = somewhere(symbols, seed)
        a, b = (complex(sympy.sympify(x.xreplace(put))) for x in (one, other))
        if abs(a - b) > 1e-9 * max(1.0, abs(a), abs(b)):
            return False
    return True
