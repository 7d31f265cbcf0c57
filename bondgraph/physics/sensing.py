"""Sensors that do not read what is there: scale, offset, curvature, limits."""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from bondgraph.physics.gains import in_proportion, is_far_from_zero
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.in_time import may_come_back
from bondgraph.physics.moments import begun_at
from bondgraph.physics.places.base import Coefficient, Place, Q
from bondgraph.physics.places.channels import OutputPlace
from bondgraph.physics.powers import raised
from bondgraph.physics.slips import FACTORS, SLIPS, own_values
from bondgraph.structure.elements import Compliance
from bondgraph.structure.nodes import written_laws
from bondgraph.structure.signals import Signal, parameters_in, signals_in, t

TOUCHES = 0.1
"""A reading that comes this near to zero, in its largest values, may turn there."""


class SensorScale(AbstractPhysics):
    """A reading in another proportion than the model says."""

    word = "sensor_scale"
    reference = "gain error of a sensor"
    passivity = Passivity.SIGNAL
    signature = (
        "everything it reads in proportion, a temperature in degrees Celsius; other "
        "sensors do not see it"
    )

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for outputs without a fitted factor of their own."""
        if not isinstance(place, OutputPlace) or _has_free(place, factor=True):
            return
        scale = place.shape("sensor_scale", "1", FACTORS)
        law, own = in_proportion(place, scale)
        words = f"{place.name} reads in another proportion than what is there"
        yield self.hypothesis(place, place.become(law, *own), law, own, words)
        law = scale.symbol * place.signal
        slip = place.become(law, scale, nested=False)
        slipped = self.hypothesis(place, slip, law, (scale,), words)
        rest = own_values(place)
        yield replace(slipped, starts=tuple({scale.name: x, **rest} for x in SLIPS))


class SensorBias(AbstractPhysics):
    """A reading with an offset, or one that drifts or jumps."""

    word = "sensor_bias"
    reference = "zero error and zero drift of a sensor"
    passivity = Passivity.SIGNAL
    signature = (
        "an error of one reading that is constant, or grows with time whatever is "
        "done; other sensors do not see it"
    )

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for outputs without a fitted offset of their own.

        An integral that nothing else reads has a free origin, which is an offset: that
        may drift alone, as it does where what is integrated is off. Rows of a steady
        table have no time to drift in.
        """
        if not isinstance(place, OutputPlace) or _has_free(place, factor=False):
            return
        offset = place.strength("sensor_bias", place.channel_unit)
        drift = place.strength("sensor_drift", f"({place.channel_unit})/s")
        drifting = drift.symbol * (t - place.scales.begin)
        drifts = f"{place.name} drifts: what it reads is off by more and more"
        if _origin_is_free(place):
            yield self._reads(place, drifting, drifts, drift)
            yield from self._jumping(place)
            return
        words = f"{place.name} reads with a constant offset"
        yield self._reads(place, offset.symbol, words, offset)
        if place.scales.interval:
            yield self._reads(place, drifting, drifts, drift)
            words = f"{place.name} reads with an offset that changes evenly with time"
            yield self._reads(place, offset.symbol + drifting, words, offset, drift)
            yield from self._jumping(place)

    def _jumping(self, place: OutputPlace) -> Iterator[Hypothesis]:
        if may_come_back(place, place.name):
            step = begun_at(place)
            jump = place.strength("sensor_jump", place.channel_unit)
            words = f"{place.name} jumps at one moment: it is off from then on"
            off = jump.symbol * step.height
            yield self._reads(place, off, words, jump, *step.own)

    def _reads(
        self, place: OutputPlace, off: sympy.Expr, words: str, *own: Coefficient
    ) -> Hypothesis:
        """Return the sensor that reads what is there and what it is off by."""
        law = place.signal + off
        return self.hypothesis(place, place.become(law, *own), law, own, words)


class SensorNonlinearity(AbstractPhysics):
    """A reading that is bent, cut off, folded over, or a power of what is there."""

    word = "sensor_nonlinearity"
    reference = "static calibration curve; rectifying and saturating sensors"
    passivity = Passivity.SIGNAL
    signature = "an error that depends on the reading alone; what follows is untouched"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield a bent curve, limits, a rectified reading, a power of what is there.

        A meter that takes a flow from a pressure reads its square. That is proposed of
        what is worked out from something else, in proportion as the model has it.
        """
        if not isinstance(place, OutputPlace):
            return
        yield self._bent(place)
        low, high = place.range
        yield self._cut(place, low, high, "upper")
        yield self._cut(place, high, low, "lower")
        if high > 0.0 and low < TOUCHES * high:
            yield self._rectified(place)
        if not isinstance(place.signal, Signal):
            yield self._raised(place)
        about_zero = _middle(place)[0] == 0.0
        if about_zero and not _has_free(place, factor=True):
            yield self._bent(place, sloped=True)

    def _bent(self, place: OutputPlace, *, sloped: bool = False) -> Hypothesis:
        """Bend it about zero, or about the middle of a range that is far from zero.

        With another slope at zero, where it was calibrated at the ends of its range;
        about the middle of a range it is nearly right there as it is.
        """
        middle, half = _middle(place)
        # At an end it reads at most so much more again, for each of the two bends.
        low, high = -1.0, 1.0
        square = place.strength("sensor_square", "1", (0.0, 0.05), low=low, high=high)
        cube = place.strength("sensor_cube", "1", (0.0, 0.05), low=low, high=high)
        size = place.constant("sensor_size", place.channel_unit, half)
        right = place.constant("sensor_right_at", place.channel_unit, middle)
        x = (place.signal - (right.symbol if middle else 0)) / size.symbol
        law = place.signal + size.symbol * (square.symbol * x**2 + cube.symbol * x**3)
        words = f"{place.name} reads what is there along a bent curve"
        coefficients = (square, cube, size, *((right,) if middle else ()))
        extends: tuple[str, ...] = ()
        if sloped:
            slope = place.strength("sensor_slope", "1", (0.0, 0.05), low=-0.9)
            law += size.symbol * slope.symbol * x
            words += ", steeper or flatter in all"
            coefficients, extends = (slope, *coefficients), (self.word,)
        edit = place.become(law, *coefficients)
        return self.hypothesis(place, edit, law, coefficients, words, extends=extends)

    def _cut(
        self, place: OutputPlace, begin: float, end: float, side: str
    ) -> Hypothesis:
        at = tuple(begin + share * (end - begin) for share in (0.97, 0.85, 0.7, 0.5))
        limit = place.shape(f"sensor_{side}_limit", place.channel_unit, at)
        cut = sympy.Min if side == "upper" else sympy.Max
        law = cut(place.signal, limit.symbol)
        words = f"{place.name} does not read beyond its {side} limit"
        edit = place.become(law, limit, nested=False)
        return self.hypothesis(place, edit, law, (limit,), words)

    def _rectified(self, place: OutputPlace) -> Hypothesis:
        share = place.strength("rectified", "1", (0.0, 0.9), low=0.0, high=1.0)
        folded = share.symbol * sympy.Abs(place.signal)
        law = (1 - share.symbol) * place.signal + folded
        words = f"{place.name} reads the size and not the sign (rectified)"
        return self.hypothesis(place, place.become(law, share), law, (share,), words)

    def _raised(self, place: OutputPlace) -> Hypothesis:
        power = place.strength("sensor_power", "1", (0.0, 0.2), low=-0.8, high=3.0)
        size = place.constant("sensor_size", place.channel_unit, place.peak)
        law = raised(place.signal, size.symbol, power.symbol)
        words = f"{place.name} reads a power of what is there, one higher than told"
        edit = place.become(law, power, size)
        return self.hypothesis(place, edit, law, (power, size), words)


def _middle(place: OutputPlace) -> tuple[float, float]:
    """Return where a bent sensor is right, and how far its range goes from there."""
    low, high = place.range
    if is_far_from_zero(low, high):
        return (low + high) / 2.0, (high - low) / 2.0
    return 0.0, place.peak


def _has_free(place: OutputPlace, *, factor: bool) -> bool:
    """Return whether the reading has a fitted factor (or offset) already."""
    for name in parameters_in(place.signal):
        if place.graph.parameters[name].std is not None:
            continue
        symbol = sympy.Symbol(name, real=True)
        slope = place.signal.diff(symbol)
        rest = place.signal - symbol * slope
        if symbol in slope.free_symbols:
            continue
        if (sympy.expand(rest) == 0) if factor else slope.is_number:
            return True
    return False


def _origin_is_free(place: OutputPlace) -> bool:
    """Return whether it reads an integral whose zero is free in every recording."""
    own = place.signal
    if not isinstance(own, Signal) or own.quantity is not Q:
        return False
    graph = place.graph
    laws = (law for node in graph.nodes for law in written_laws(node))
    if any(own in signals_in(law) for law in laws):
        return False
    ends = (graph.node(bond.other(own.place)) for bond in graph.bonds_at(own.place))
    here = (graph.by_name.get(own.place), *ends)
    return not any(isinstance(node, Compliance) for node in here)
