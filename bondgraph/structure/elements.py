"""The kinds of a bond graph: a kind is a type.

A one-port's law is a sympy expression in its port variables. Written in the usual
variable it gives the other: for R, an expression in ``f`` is the effort and one in
``e`` the flow; for C, one in ``q`` is the effort and one in ``e`` the displacement;
for I, one in ``p`` is the flow and one in ``f`` the momentum. Without a law the
element is linear with one parameter that has the element's name:
``e = R f``, ``q = C e``, ``p = I f``. Multiports are in `bondgraph.structure.fields`.
"""

from dataclasses import dataclass
from typing import ClassVar, TypeGuard

import sympy

from bondgraph.errors import StructureError
from bondgraph.structure import signals
from bondgraph.structure.domains import Quantity
from bondgraph.structure.relations import Relation
from bondgraph.structure.signals import (
    PORT_VARIABLES,
    canonical,
    parameter_symbol,
    signals_in,
)

_PORT_VARIABLE = {
    Quantity.EFFORT: signals.e,
    Quantity.FLOW: signals.f,
    Quantity.MOMENTUM: signals.p,
    Quantity.DISPLACEMENT: signals.q,
}
_TAKEN = frozenset({"e", "f", "p", "q", "t"})


@dataclass(frozen=True, slots=True)
class Named:
    """Anything in a graph that has a name."""

    name: str

    letter: ClassVar[str] = "?"
    _kind: ClassVar[str] = "a node"

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.isidentifier():
            raise StructureError(
                f"{self.name!r} cannot name {self._kind}.",
                (str(self.name),),
                "Use a Python identifier such as motor_shaft.",
            )
        if self.name in _TAKEN:
            raise StructureError(
                f"The name {self.name!r} is taken by a port variable.",
                (self.name,),
                "Choose a longer name.",
            )


@dataclass(frozen=True, slots=True)
class _Source(Named):
    value: sympy.Expr | None = None

    _kind: ClassVar[str] = "a source"

    def __post_init__(self) -> None:
        Named.__post_init__(self)
        if self.value is not None:
            object.__setattr__(self, "value", canonical(self.value))


@dataclass(frozen=True, slots=True)
class EffortSource(_Source):
    """Se: imposes an effort; an input named like it, or an expression."""

    letter: ClassVar[str] = "Se"


@dataclass(frozen=True, slots=True)
class FlowSource(_Source):
    """Sf: imposes a flow; an input named like it, or an expression."""

    letter: ClassVar[str] = "Sf"


@dataclass(frozen=True, slots=True)
class _WithRelation(Named):
    """A one-port with a law between `_big` and `_small`; linear: big = name small."""

    law: sympy.Expr | None = None

    _big: ClassVar[sympy.Symbol]
    _small: ClassVar[sympy.Symbol]

    def __post_init__(self) -> None:
        Named.__post_init__(self)
        if self.law is not None:
            object.__setattr__(self, "law", self._in_own_variables(self.law))
            assert self.relation is not None  # refuses a law in the wrong variables

    def _in_own_variables(self, law: sympy.Expr) -> sympy.Expr:
        """Return the law with what it reads of this very element by port variables.

        ``displacement("spring")`` in the law of the C ``spring``, written in q, is q.
        """
        law = canonical(law)
        own = {
            signal: _PORT_VARIABLE[signal.quantity]
            for signal in signals_in(law)
            if signal.place == self.name
        }
        written = {s for s in law.free_symbols if signals.is_port_variable(s)}
        usual = {self._small if isinstance(self, Resistance) else self._big}
        same = {s: v for s, v in own.items() if v in (written or usual)}
        return law.xreplace(same) if same else law

    @property
    def relation(self) -> Relation:
        """The relation between the two port variables, as written."""
        big, small = self._big, self._small
        if self.law is None:
            return Relation(big, small, parameter_symbol(self.name) * small)
        used = {s for s in self.law.free_symbols if signals.is_port_variable(s)}
        for output, argument in ((small, big), (big, small)):
            usual = argument == (small if isinstance(self, Resistance) else big)
            if used == {argument} or (usual and not used):
                return Relation(output, argument, self.law)
        raise StructureError(
            f"The law of {self.name!r} uses {', '.join(sorted(map(str, used)))}.",
            (self.name,),
            f"Write it in {small} (giving {big}) or in {big} (giving {small}).",
        )


@dataclass(frozen=True, slots=True)
class Inertance(_WithRelation):
    """I: stores momentum; linear ``p = I f`` or a law."""

    letter: ClassVar[str] = "I"
    _kind: ClassVar[str] = "an I"
    _big: ClassVar[sympy.Symbol] = signals.p
    _small: ClassVar[sympy.Symbol] = signals.f


@dataclass(frozen=True, slots=True)
class Compliance(_WithRelation):
    """C: stores displacement; linear ``q = C e`` or a law."""

    letter: ClassVar[str] = "C"
    _kind: ClassVar[str] = "a C"
    _big: ClassVar[sympy.Symbol] = signals.q
    _small: ClassVar[sympy.Symbol] = signals.e


@dataclass(frozen=True, slots=True)
class Resistance(_WithRelation):
    """R: dissipates; linear ``e = R f`` or a law."""

    letter: ClassVar[str] = "R"
    _kind: ClassVar[str] = "an R"
    _big: ClassVar[sympy.Symbol] = signals.e
    _small: ClassVar[sympy.Symbol] = signals.f


@dataclass(frozen=True, slots=True)
class _WithModulus(Named):
    law: sympy.Expr | None = None

    def __post_init__(self) -> None:
        Named.__post_init__(self)
        if self.law is None:
            return
        object.__setattr__(self, "law", canonical(self.law))
        used = self.modulus.free_symbols & PORT_VARIABLES
        if used:
            raise StructureError(
                f"The modulus of {self.name!r} uses {', '.join(map(str, used))}, and "
                f"it has two ports.",
                (self.name,),
                'Say which variable is meant: displacement("joint").',
            )

    @property
    def modulus(self) -> sympy.Expr:
        """The modulus, an expression of parameters and signals."""
        return parameter_symbol(self.name) if self.law is None else self.law


@dataclass(frozen=True, slots=True)
class Transformer(_WithModulus):
    """TF from a to b with modulus K: ``e_b = K e_a`` and ``f_a = K f_b``."""

    letter: ClassVar[str] = "TF"
    _kind: ClassVar[str] = "a TF"


@dataclass(frozen=True, slots=True)
class Gyrator(_WithModulus):
    """GY from a to b with modulus r: ``e_b = r f_a`` and ``e_a = r f_b``."""

    letter: ClassVar[str] = "GY"
    _kind: ClassVar[str] = "a GY"


@dataclass(frozen=True, slots=True)
class ZeroJunction(Named):
    """0: one effort common to its bonds; the flows balance."""

    letter: ClassVar[str] = "0"
    _kind: ClassVar[str] = "a junction"


@dataclass(frozen=True, slots=True)
class OneJunction(Named):
    """1: one flow common to its bonds; the efforts balance."""

    letter: ClassVar[str] = "1"
    _kind: ClassVar[str] = "a junction"


Source = EffortSource | FlowSource
Storage = Inertance | Compliance
OnePort = EffortSource | FlowSource | Inertance | Compliance | Resistance
TwoPort = Transformer | Gyrator
Junction = ZeroJunction | OneJunction
Node = Named


def letter(node: Node) -> str:
    """Return the field's letter for the kind of `node` (``Se``, ``1``, …)."""
    return node.letter


def is_one_port(node: object) -> TypeGuard[OnePort]:
    """Return whether `node` has exactly one port."""
    return isinstance(node, OnePort)


def is_modulated(law: sympy.Expr | None) -> bool:
    """Return whether a law reads a signal from elsewhere in the graph."""
    return law is not None and bool(signals_in(law))


# The field's letters, for authors. What makes a source, transformer or gyrator
# modulated is its law; MTF("k", law) only says so to the reader.
Se, Sf = EffortSource, FlowSource
I, C, R = Inertance, Compliance, Resistance
TF, GY = Transformer, Gyrator
MSe, MSf, MTF, MGY, MR = EffortSource, FlowSource, Transformer, Gyrator, Resistance
