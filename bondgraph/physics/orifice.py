"""Flows with the root of a pressure, and over an edge: orifices and overflows."""

from collections.abc import Iterator

import sympy

from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import FLUID, Coefficient, E, F, Place
from bondgraph.physics.places.junction import (
    JunctionPlace,
    OneJunctionPlace,
    ZeroJunctionPlace,
)
from bondgraph.physics.places.pair import StockPair
from bondgraph.structure.domains import ELECTRICAL
from bondgraph.structure.edits import InsertElement, ReplaceRelation, SeveralEdits
from bondgraph.structure.elements import FlowSource, Resistance, ZeroJunction
from bondgraph.structure.signals import e, f, flow, parameter_symbol, signals_in


class SquareRootOrifice(AbstractPhysics):
    """A flow out of a junction, or to another one, with the root of the effort."""

    word = "square_root_orifice"
    reference = "Torricelli 1643"
    passivity = Passivity.DISSIPATIVE
    signature = "a stock that empties in a parabola and to the end in finite time"
    domains = FLUID

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions and for pairs; smooth within 0.1 % of the effort."""
        if isinstance(place, StockPair) and self.suits(place):
            yield self._between(place)
        if not isinstance(place, ZeroJunctionPlace) or not self.suits(place):
            return
        k = place.strength("orifice", place.unit(F), (0.0, 0.3 * place.flow), low=0.0)
        at = place.constant("orifice_effort", place.unit(E), place.effort)
        law = k.symbol * _smooth_root(e / at.symbol)
        element = Resistance(place.name_of(self.word), law=law)
        words = f"{place.a(F)} lost with the root of {place.domain.effort}"
        edit = place.insert(element, k, at)
        yield self.hypothesis(place, edit, law, (k, at), words)

    def _between(self, place: StockPair) -> Hypothesis:
        stem = f"orifice_to_{place.second}_from"
        k = place.strength(stem, place.unit(F), (0.0, 0.3 * place.flow), low=0.0)
        at = place.constant(f"{stem}_effort", place.unit(E), place.effort)
        law = k.symbol * _smooth_root(e / at.symbol)
        name = place.name_of(f"orifice_path_to_{place.second}_from")
        edit = place.connect(Resistance(name, law=law), k, at)
        words = (
            f"{place.a(F)} from {place.name} to {place.second} with the root of the "
            f"difference of {place.domain.effort}"
        )
        return self.hypothesis(place, edit, law, (k, at), words)


class SquareLaw(AbstractPhysics):
    """A linear resistance that is a square law: effort grows with the flow squared.

    The outlet of a tank, a turbulent pipe, a fan: the linear law is replaced, since the
    two do not act side by side; between two stocks another way may lead past it.
    """

    word = "square_root_orifice"
    reference = "Torricelli 1643; turbulent pressure loss"
    passivity = Passivity.DISSIPATIVE
    signature = "a resistance that seems smaller the less flows"
    domains = FLUID

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every fitted linear R of a hydraulic or analogue junction."""
        if not isinstance(place, JunctionPlace) or not self.suits(place):
            return
        graph = place.graph
        for bond in graph.bonds_at(place.name):
            node = graph.node(bond.other(place.name))
            linear = isinstance(node, Resistance) and node.law is None
            if linear and not graph.parameters[node.name].exact:
                yield self._replaced(place, node.name)
                if isinstance(place, OneJunctionPlace):
                    yield self._beside(place, node.name)

    def _replaced(self, place: JunctionPlace, resistance: str) -> Hypothesis:
        """Write the law in the variable that the junction gives."""
        stated = place.graph.parameters[resistance].value or 1.0
        linear = place.scales.fitted.get(resistance) or stated
        if isinstance(place, OneJunctionPlace):
            start = (linear / place.flow,)
            unit = place.unit(E, F, 2)
            k = place.shape(f"{resistance}_square", unit, start, low=0.0)
            law = k.symbol * f * sympy.Abs(f)
            coefficients: tuple[Coefficient, ...] = (k,)
        else:
            start = (place.effort / linear,)
            k = place.shape(f"{resistance}_flow", place.unit(F), start, low=0.0)
            at = place.constant(f"{resistance}_effort", place.unit(E), place.effort)
            law = k.symbol * _smooth_root(e / at.symbol)
            coefficients = (k, at)
        parameters = tuple(c.parameter for c in coefficients)
        words = (
            f"{resistance} passes {place.a(F)} that grows with the root of "
            f"{place.domain.effort}, not in proportion to it"
        )
        edit = ReplaceRelation(resistance, law, parameters)
        also = (resistance,)
        return self.hypothesis(place, edit, law, coefficients, words, also=also)

    def _beside(self, place: OneJunctionPlace, resistance: str) -> Hypothesis:
        """Let part of the flow pass beside the linear law, under the same effort."""
        most = (0.0, 0.3 * place.flow)
        k = place.strength(f"{resistance}_past", place.unit(F), most, low=0.0)
        at = place.constant(f"{resistance}_effort", place.unit(E), place.effort)
        linear = e / parameter_symbol(resistance)
        law = linear + k.symbol * _smooth_root(e / at.symbol)
        words = (
            f"{place.a(F)} that grows with the root of {place.domain.effort} passes "
            f"beside that of {resistance}"
        )
        own = (k.parameter, at.parameter)
        edit = ReplaceRelation(resistance, law, own, nested=True)
        return self.hypothesis(place, edit, law, (k, at), words, also=(resistance,))


class Overflow(AbstractPhysics):
    """A flow over an edge: nothing below a level, steeply more above it.

    What flows over is lost, or part of it falls into the next stock.
    """

    word = "overflow"
    reference = "Poleni 1717 (weir); Schoukens et al. 2016 (cascaded tanks)"
    passivity = Passivity.DISSIPATIVE
    signature = (
        "a level that stays at a ceiling while the inflow goes on; taken for a "
        "saturated sensor, which leaves what follows untouched"
    )
    domains = FLUID
    shares = (0.5, 0.65, 0.8, 0.9)
    steepest = 100.0
    """Typical flows over an edge, where the effort is twice as high as it usually is.

    What is steeper is a step, and which step nothing tells: its slope would run away.
    """

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions: proportional, as a weir, and into the next."""
        if not isinstance(place, ZeroJunctionPlace) or not self.suits(place):
            return
        yield self._over(place, power=sympy.S.One, below=None)
        yield self._over(place, power=sympy.Rational(3, 2), below=None)
        for below in _next_stocks(place):
            yield self._over(place, power=sympy.S.One, below=below)

    def _over(
        self, place: ZeroJunctionPlace, *, power: sympy.Expr, below: str | None
    ) -> Hypothesis:
        low, high = place.effort_range
        bottom = max(low, 0.0) if high > 0.0 else low
        levels = tuple(bottom + share * (high - bottom) for share in self.shares)
        none = (0.0,) * len(levels)
        some = (2.0 * place.flow,) * len(levels)
        # An edge below all that was ever there is none: what flows over it all the
        # time is a leak, or a bias.
        edge = place.shape("overflow_level", place.unit(E), levels * 2, low=bottom)
        k = place.strength(
            "overflow",
            place.unit(F),
            none + some,
            low=0.0,
            high=self.steepest * place.flow,
        )
        size = place.constant("overflow_effort", place.unit(E), place.effort)
        law = k.symbol * sympy.Max((e - edge.symbol) / size.symbol, 0) ** power
        name = place.name_of("overflow")
        edit = place.insert(Resistance(name, law=law), edge, k, size)
        over = f"{place.a(F)} over an edge, once {place.domain.effort} has reached it"
        if below is None:
            form = " (weir)" if power != 1 else ""
            return self.hypothesis(place, edit, law, (edge, k, size), f"{over}{form}")
        share = place.shape("overflow_share", "1", (0.5,), low=0.0, high=1.0)
        into = FlowSource(f"{name}_to_{below}", value=share.symbol * flow(name))
        fall = InsertElement(below, into, (share.parameter,))
        return self.hypothesis(
            place,
            SeveralEdits((edit, fall)),
            law,
            (edge, k, share, size),
            f"{over}; part of it falls into {below}",
            extends=("overflow",),
        )


class Clamp(Overflow):
    """A current that begins above a voltage: a diode, a suppressor, an insulation."""

    word = "saturation"
    reference = "clamping diode, piecewise linear"
    signature = "a voltage that stays at a ceiling; taken for a saturated sensor"
    domains = frozenset({ELECTRICAL})
    steepest = 1e4

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it at 0-junctions."""
        if isinstance(place, ZeroJunctionPlace) and self.suits(place):
            yield self._over(place, power=sympy.S.One, below=None)


def _next_stocks(place: ZeroJunctionPlace) -> tuple[str, ...]:
    """Return the 0-junctions that what flows out of here flows into.

    Through a resistance between the two, or a source that reads the flow of one here.
    """
    graph = place.graph
    found: dict[str, None] = {}
    for bond in graph.bonds_at(place.name):
        beyond = bond.other(place.name)
        if bond.tail == place.name and place.is_one_junction(beyond):
            for following in graph.bonds_at(beyond):
                if isinstance(graph.node(following.head), ZeroJunction):
                    found[following.head] = None
    outlets = {n.name for n in place.neighbours if isinstance(n, Resistance)}
    for node in graph.elements:
        if not isinstance(node, FlowSource) or node.value is None:
            continue
        if outlets & {signal.place for signal in signals_in(node.value)}:
            found[graph.bonds_at(node.name)[0].head] = None
    return tuple(name for name in found if name != place.name)


def _smooth_root(x: sympy.Expr) -> sympy.Expr:
    """Return the signed square root of x, smooth within 0.1 % of its range."""
    return x / (x**2 + sympy.Float(1e-6)) ** sympy.Rational(1, 4)
