"""The kinds of a bond graph: a kind is a type.

A one-port's law is a sympy expression in its port variables. Written in the usual
variable it gives the other: for R, an expression in ``f`` is the effort and one in
``e`` the flow; for C, one in ``q`` is the effort and one in ``e`` the displacement;
for I, one in ``p`` is the flow and one in ``f`` the momentum. Without a law the
element is linear with one parameter that has the element's name:
``e = R f``, ``q = C e``, ``p = I f``.
"""

from dataclasses import dataclass

import sympy

from bondgraph.errors import EquationError, StructureError
from bondgraph.structure import signals
from bondgraph.structure.signals import PORT_VARIABLES, canonical, parameter_symbol


def _check_name(name: object, kind: str) -> None:
    if not isinstance(name, str) or not name.isidentifier():
        raise StructureError(
            f"{name!r} cannot name {kind}.",
            (str(name),),
            "Use a Python identifier such as motor_shaft.",
        )
    if name in {"e", "f", "p", "q", "t"}:
        raise StructureError(
            f"The name {name!r} is taken by a port variable.",
            (name,),
            "Choose a longer name.",
        )


@dataclass(frozen=True, slots=True)
class Relation:
    """A constitutive relation ``output = expression(argument, …)`` of one port."""

    output: sympy.Symbol
    argument: sympy.Symbol
    expression: sympy.Expr

    def solved_for(self, output: sympy.Symbol) -> sympy.Expr:
        """Return `output` as an expression of the other port variable.

        Raises
        ------
        EquationError
            If the relation is not uniquely invertible in closed form.
        """
        if output == self.output:
            return self.expression
        if output != self.argument:
            raise EquationError(f"The relation does not contain {output}.")
        slope = self.expression.diff(self.argument)
        if not slope.has(self.argument) and slope != 0:
            rest = self.expression.xreplace({self.argument: sympy.S.Zero})
            return (self.output - rest) / slope
        raise EquationError(
            f"The law {self.output} = {self.expression} cannot be inverted uniquely.",
            (str(self.output), str(self.argument)),
            f"Write the law as an expression in {self.output}.",
        )


def _relation(
    name: str, law: sympy.Expr | None, pair: tuple[sympy.Symbol, sympy.Symbol]
) -> Relation:
    """Return the relation of an element whose law uses one of the `pair`.

    ``pair`` is (variable the law is usually written in, variable it then gives).
    """
    argument, output = pair
    if law is None:
        return Relation(argument, output, parameter_symbol(name) * output)
    used = law.free_symbols & PORT_VARIABLES
    if used <= {argument}:
        return Relation(output, argument, law)
    if used == {output}:
        return Relation(argument, output, law)
    raise StructureError(
        f"The law of {name!r} uses {', '.join(sorted(map(str, used)))}.",
        (name,),
        f"Write it in {argument} (giving {output}) or in {output} (giving {argument}).",
    )


@dataclass(frozen=True, slots=True)
class EffortSource:
    """Se: imposes an effort; an input named like it, or an expression."""

    name: str
    value: sympy.Expr | None = None

    def __post_init__(self) -> None:
        _check_name(self.name, "a source")
        if self.value is not None:
            object.__setattr__(self, "value", canonical(self.value))


@dataclass(frozen=True, slots=True)
class FlowSource:
    """Sf: imposes a flow; an input named like it, or an expression."""

    name: str
    value: sympy.Expr | None = None

    def __post_init__(self) -> None:
        _check_name(self.name, "a source")
        if self.value is not None:
            object.__setattr__(self, "value", canonical(self.value))


@dataclass(frozen=True, slots=True)
class Inertance:
    """I: stores momentum; linear ``p = I f`` or a law."""

    name: str
    law: sympy.Expr | None = None

    def __post_init__(self) -> None:
        _check_name(self.name, "an I")
        if self.law is not None:
            object.__setattr__(self, "law", canonical(self.law))
        assert self.relation is not None

    @property
    def relation(self) -> Relation:
        """The relation between flow and momentum."""
        return _relation(self.name, self.law, (signals.p, signals.f))


@dataclass(frozen=True, slots=True)
class Compliance:
    """C: stores displacement; linear ``q = C e`` or a law."""

    name: str
    law: sympy.Expr | None = None

    def __post_init__(self) -> None:
        _check_name(self.name, "a C")
        if self.law is not None:
            object.__setattr__(self, "law", canonical(self.law))
        assert self.relation is not None

    @property
    def relation(self) -> Relation:
        """The relation between effort and displacement."""
        return _relation(self.name, self.law, (signals.q, signals.e))


@dataclass(frozen=True, slots=True)
class Resistance:
    """R: dissipates; linear ``e = R f`` or a law."""

    name: str
    law: sympy.Expr | None = None

    def __post_init__(self) -> None:
        _check_name(self.name, "an R")
        if self.law is not None:
            object.__setattr__(self, "law", canonical(self.law))
        assert self.relation is not None

    @property
    def relation(self) -> Relation:
        """The relation between effort and flow."""
        if self.law is None:
            return Relation(
                signals.e, signals.f, parameter_symbol(self.name) * signals.f
            )
        return _relation(self.name, self.law, (signals.f, signals.e))


def _modulus(name: str, modulus: sympy.Expr | None) -> sympy.Expr:
    return parameter_symbol(name) if modulus is None else modulus


@dataclass(frozen=True, slots=True)
class Transformer:
    """TF from a to b with modulus K: ``e_b = K e_a`` and ``f_a = K f_b``."""

    name: str
    law: sympy.Expr | None = None

    def __post_init__(self) -> None:
        _check_name(self.name, "a TF")
        if self.law is not None:
            object.__setattr__(self, "law", canonical(self.law))

    @property
    def modulus(self) -> sympy.Expr:
        """The modulus K, an expression of parameters and signals."""
        return _modulus(self.name, self.law)


@dataclass(frozen=True, slots=True)
class Gyrator:
    """GY from a to b with modulus r: ``e_b = r f_a`` and ``e_a = r f_b``."""

    name: str
    law: sympy.Expr | None = None

    def __post_init__(self) -> None:
        _check_name(self.name, "a GY")
        if self.law is not None:
            object.__setattr__(self, "law", canonical(self.law))

    @property
    def modulus(self) -> sympy.Expr:
        """The modulus r, an expression of parameters and signals."""
        return _modulus(self.name, self.law)


@dataclass(frozen=True, slots=True)
class ZeroJunction:
    """0: one effort common to its bonds; the flows balance."""

    name: str

    def __post_init__(self) -> None:
        _check_name(self.name, "a junction")


@dataclass(frozen=True, slots=True)
class OneJunction:
    """1: one flow common to its bonds; the efforts balance."""

    name: str

    def __post_init__(self) -> None:
        _check_name(self.name, "a junction")


Source = EffortSource | FlowSource
Storage = Inertance | Compliance
OnePort = EffortSource | FlowSource | Inertance | Compliance | Resistance
TwoPort = Transformer | Gyrator
Element = OnePort | TwoPort
Junction = ZeroJunction | OneJunction
Node = Element | Junction

LETTERS: dict[type, str] = {
    EffortSource: "Se",
    FlowSource: "Sf",
    Inertance: "I",
    Compliance: "C",
    Resistance: "R",
    Transformer: "TF",
    Gyrator: "GY",
    ZeroJunction: "0",
    OneJunction: "1",
}


def letter(node: Node) -> str:
    """Return the field's letter for the kind of `node` (``Se``, ``1``, …)."""
    return LETTERS[type(node)]


# The field's letters, for authors.
Se, Sf = EffortSource, FlowSource
I, C, R = Inertance, Compliance, Resistance
TF, GY = Transformer, Gyrator
