"""What is measured of a loop: stability, all margins, peaks and step figures.

One record holds everything, and says first whether the loop is stable, because margins
of an unstable loop are distances to stability and not from it. Every frequency is a
root of the exact response (see `crossings` and `distance`), with delays, integrators,
several crossovers, unstable plants and sampled loops alike.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from bondgraph.loopshaping.crossings import Search, gain_crossovers, phase_crossovers
from bondgraph.loopshaping.curve import Curve, curve
from bondgraph.loopshaping.distance import Peak, encirclements, sensitivity_peak
from bondgraph.loopshaping.loop import Loop, zero_pole_gain
from bondgraph.loopshaping.realisation import closed_loop_poles
from bondgraph.loopshaping.step_response import (
    StepFigures,
    step_figures,
    step_response,
    value_at_rest,
)
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain

_POLE = 1e6  # a gain above this at the far end is that of a pole there


class Stability(StrEnum):
    """Whether the closed loop is stable; the value is the sentence to show."""

    STABLE = "The closed loop is stable."
    UNSTABLE = "The closed loop is unstable."
    MARGINAL = "The closed loop is at the limit of stability."


@dataclass(frozen=True, slots=True)
class GainCrossover:
    """A frequency (rad/s) at which the loop gain is one.

    ``phase_margin`` in degrees, between -180 and 180; ``delay_margin`` the seconds of
    further delay that bring the response to -1 there.
    """

    omega: float
    phase_margin: float
    delay_margin: float


@dataclass(frozen=True, slots=True)
class PhaseCrossover:
    """A frequency (rad/s) of phase -180°; ``gain_margin`` is the factor to -1."""

    omega: float
    gain_margin: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopMeasures:
    """Everything measured of one loop.

    Parameters
    ----------
    unstable_poles
        Number of unstable closed-loop poles by Nyquist's criterion, those hidden by a
        cancellation included; None at the limit of stability, or where a delay makes
        them hundreds or infinitely many.
    closed_loop_poles
        In rad/s (of z if sampled); empty with a continuous delay.
    gain_crossovers, phase_crossovers
        All of them, ascending. Behind a delay, phase crossovers are listed to one turn
        after the last loop gain of 1/1000 (at most 30 times the largest zero or pole).
    gain_margin, gain_reduction_margin
        The least factor above one, and the greatest below one, by which the loop gain
        must change to bring the response to -1; infinite and zero where none does.
    phase_margin
        Degrees, the smallest in size; infinite without gain crossover.
    delay_margin
        Seconds, the smallest; infinite without gain crossover.
    sensitivity, complementary
        Peaks of ``1/|1 + L|`` and ``|L|/|1 + L|``.
    bandwidth
        rad/s: where the response from reference to output first falls 3 dB below its
        value at rest; None where it never does.
    step
        None for a loop that is not stable, or that tends to zero.
    """

    stability: Stability
    unstable_poles: int | None
    closed_loop_poles: tuple[complex, ...]
    gain_crossovers: tuple[GainCrossover, ...]
    phase_crossovers: tuple[PhaseCrossover, ...]
    gain_margin: float
    gain_reduction_margin: float
    phase_margin: float
    delay_margin: float
    sensitivity: Peak
    complementary: Peak
    bandwidth: float | None
    step: StepFigures | None

    @property
    def stable(self) -> bool:
        """Whether the closed loop is stable."""
        return self.stability is Stability.STABLE

    @property
    def crossover(self) -> float:
        """The highest gain crossover in rad/s; 0 without one."""
        return self.gain_crossovers[-1].omega if self.gain_crossovers else 0.0

    @property
    def modulus_margin(self) -> float:
        """The least distance of the Nyquist curve from -1."""
        return 1 / self.sensitivity.value


def measure(
    loop: Any, values: Mapping[str, float] | None = None, *, step: bool = True
) -> LoopMeasures:
    """Return everything measured of a loop.

    Parameters
    ----------
    loop
        A `Loop`; or the open loop alone as anything that `zero_pole_gain` takes, with
        unity feedback around it.
    values
        Parameter values, where the loop is a symbolic transfer function.
    step
        Whether to simulate the step response; the slowest of all.

    Raises
    ------
    LoopShapingError
        If the open loop is zero or has more zeros than poles.
    """
    whole = loop if isinstance(loop, Loop) else Loop(plant=zero_pole_gain(loop, values))
    around = curve(whole.open_loop)
    count = encirclements(around)
    stability = (
        Stability.MARGINAL
        if count.marginal
        else Stability.STABLE
        if count.unstable == 0
        else Stability.UNSTABLE
    )
    gains = gain_crossovers_of(around)
    phases = phase_crossovers_of(whole.open_loop, around)
    factors = [p.gain_margin for p in phases]
    delayed = whole.open_loop.delay and whole.period is None
    poles = () if delayed or count.marginal else closed_loop_poles(whole.open_loop)
    return LoopMeasures(
        stability=stability,
        unstable_poles=count.unstable,
        closed_loop_poles=poles,
        gain_crossovers=gains,
        phase_crossovers=phases,
        gain_margin=min((f for f in factors if f > 1), default=math.inf),
        gain_reduction_margin=max((f for f in factors if f < 1), default=0.0),
        phase_margin=min((g.phase_margin for g in gains), key=abs, default=math.inf),
        delay_margin=min((g.delay_margin for g in gains), default=math.inf),
        sensitivity=sensitivity_peak(around),
        complementary=sensitivity_peak(around.reciprocal()),
        bandwidth=_bandwidth(whole, around),
        step=_step(whole, gains) if step and stability is Stability.STABLE else None,
    )


def gain_crossovers_of(loop: Curve) -> tuple[GainCrossover, ...]:
    """Return all gain crossovers with their margins, ascending."""
    return tuple(_gain_crossover(loop, nu) for nu in gain_crossovers(loop))


def _gain_crossover(loop: Curve, nu: float) -> GainCrossover:
    phase = float(loop.logarithm(np.array([nu]))[0].imag)
    omega = loop.omega(nu)
    until = math.fmod(phase + math.pi, 2 * math.pi)
    until = until + 2 * math.pi if until < 0 else until
    margin = until if until <= math.pi else until - 2 * math.pi
    return GainCrossover(omega, math.degrees(margin), until / omega)


def phase_crossovers_of(
    system: ZeroPoleGain, loop: Curve
) -> tuple[PhaseCrossover, ...]:
    """Return the crossovers, with those at rest and at the far end of the response."""
    found = []
    rest = system.dc_gain
    if -math.inf < rest < 0:
        found.append(PhaseCrossover(0.0, -1 / rest))
    for nu in phase_crossovers(loop):
        size = float(loop.logarithm(np.array([nu]))[0].real)
        found.append(PhaseCrossover(loop.omega(nu), math.exp(-size)))
    end = math.inf if system.period is None else math.pi / system.period
    last = loop.gain if not (loop.orders.sum() or loop.delay) else 0.0
    if -_POLE < last < 0:  # sampled, the far end is z = -1
        found.append(PhaseCrossover(end, -1 / last))
    return tuple(found)


def _bandwidth(loop: Loop, around: Curve) -> float | None:
    """Return where |y/r| first falls to 1/√2 of its value at rest."""
    rest = abs(value_at_rest(loop))
    if not (rest > 0 and math.isfinite(rest)):
        return None
    ahead = curve(loop.forward)
    level = math.log(rest) - 0.5 * math.log(2)

    def drop(nu: FloatArray) -> FloatArray:
        closed = ahead.logarithm(nu).real - np.log(np.abs(1 + around.value(nu)))
        return np.asarray(closed - level)

    def bounds(low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
        forward = ahead.slopes(low, high).magnitude
        middle = np.sqrt(low * high)
        value = around.value(middle)
        reach = np.log(high / middle)
        steep, turn = around.slopes(low, high).steepest()
        largest = np.abs(value) * np.exp(np.minimum(steep * reach, 50.0))
        rate = np.hypot(steep, turn)
        strays = np.abs(value) * np.expm1(np.minimum(rate * reach, 50.0))
        clear = np.maximum(np.abs(1 + value) - strays, 0.0)
        with np.errstate(divide="ignore"):
            slope = np.where(clear > 0, largest * rate / clear, np.inf)
        return forward[0] - slope, forward[1] + slope

    low, high = around.span()
    if around.delay:
        corner = float(np.abs(around.roots).max(initial=0.0))
        high = 30 * max(corner, low) + 4 * math.pi / abs(around.delay)
    found = Search(function=drop, bounds=bounds).crossings(*around.pieces(low, high))
    return around.omega(found[0]) if found else None


def _step(loop: Loop, gains: tuple[GainCrossover, ...]) -> StepFigures | None:
    """Return the step figures; None where a branch has no step response."""
    parts = (loop.forward, loop.feedback)
    if any(part.relative_degree < 0 for part in parts):
        return None
    if value_at_rest(loop) in (0.0, math.inf):
        return None
    if gains:
        scale = gains[-1].omega
    else:
        sizes = [abs(r) for r in loop.open_loop.poles if r != 0]
        scale = min(sizes, default=1.0)
    return step_figures(step_response(loop, scale=scale))
