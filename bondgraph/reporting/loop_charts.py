"""The charts of loop shaping, each drawn into axes that are handed in.

Phase is the continuous phase of the factored loop, so that no curve is torn and nothing
is unwrapped. Charts take several loops by name, because shaping is comparing.
"""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from bondgraph.loopshaping.curve import curve
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.measures import LoopMeasures
from bondgraph.loopshaping.prototype import SecondOrderPrototype
from bondgraph.loopshaping.step_response import step_response
from bondgraph.loopshaping.zero_pole_gain import ComplexArray, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Loops = Mapping[str, Loop]
Measured = Mapping[str, LoopMeasures]

# Okabe and Ito's colours, told apart by everybody; styles do it again in print.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
STYLES = ("-", "--", "-.", ":", "-", "--")
GREY, PALE = "#555555", "#BBBBBB"
M_LEVELS = (12.0, 6.0, 3.0, 1.0, -1.0, -3.0, -6.0, -12.0)  # dB
_POINTS = 1500


def frequencies(measured: Measured) -> FloatArray:
    """Return frequencies around everything that happens in the loops, in rad/s."""
    places = [
        place
        for m in measured.values()
        for place in (
            *(g.omega for g in m.gain_crossovers),
            *(p.omega for p in m.phase_crossovers if 0.01 < 1 / p.gain_margin < 100),
            m.sensitivity.omega,
        )
        if 0 < place < math.inf
    ]
    low, high = min(places, default=1.0), max(places, default=1.0)
    return np.geomspace(low / 100, high * 10, _POINTS)


def logarithm(loop: Loop, omega: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the open loop's gain in dB and its continuous phase in degrees."""
    around = curve(loop.open_loop)
    if loop.period is not None:
        omega = omega[omega < math.pi / loop.period * (1 - 1e-9)]
    ln = around.logarithm(around.nu(omega))
    phase = np.degrees(ln.imag)
    middle = phase[np.argmin(np.abs(ln.real))]
    turns = math.ceil(middle / 360)  # -360 to 0 where the gain is one
    return 20 / math.log(10) * ln.real, phase - 360 * turns


def draw_bode(gain: "Axes", phase: "Axes", loops: Loops, measured: Measured) -> None:
    """Draw gain and phase of the open loops, crossovers and margins marked."""
    omega = frequencies(measured)
    for (name, loop), colour, style in zip(
        loops.items(), COLOURS, STYLES, strict=False
    ):
        decibels, degrees = logarithm(loop, omega)
        shown = omega[: len(decibels)]
        gain.semilogx(shown, decibels, style, color=colour, label=name)
        phase.semilogx(shown, degrees, style, color=colour)
        for crossover in measured[name].gain_crossovers:
            at = float(np.interp(crossover.omega, shown, degrees))
            gain.plot(crossover.omega, 0, "o", color=colour, markersize=4)
            phase.plot(crossover.omega, at, "o", color=colour, markersize=4)
            below = -180 + 360 * round((at + 180 - crossover.phase_margin) / 360)
            phase.plot([crossover.omega] * 2, [below, at], color=colour, linewidth=0.8)
        for turn in measured[name].phase_crossovers[:1]:
            if 0 < turn.omega < shown[-1]:
                high = -20 * math.log10(turn.gain_margin)
                gain.plot([turn.omega] * 2, [high, 0], color=colour, linewidth=0.8)
    gain.axhline(0, color=GREY, linewidth=0.6)
    phase.axhline(-180, color=GREY, linewidth=0.6)
    gain.set_ylim(-80, 60)
    phase.set_ylim(-400, -60)
    phase.set_yticks(range(-360, -89, 90))
    gain.set_ylabel("|L| in dB")
    phase.set_ylabel("arg L in °")
    phase.set_xlabel("ω in rad/s")
    for axes in (gain, phase):
        axes.grid(visible=True, which="both", color="#EEEEEE")
        axes.set_xlim(omega[0], omega[-1])


def draw_nichols(
    axes: "Axes",
    loops: Loops,
    measured: Measured,
    prototype: SecondOrderPrototype | None = None,
) -> None:
    """Draw the loops on the Nichols chart with M-circles and the prototype."""
    for level in M_LEVELS:
        _m_circle(axes, 10 ** (level / 20), PALE, f"{level:g} dB")
    omega = frequencies(measured)
    for (name, loop), colour, style in zip(
        loops.items(), COLOURS, STYLES, strict=False
    ):
        decibels, degrees = logarithm(loop, omega)
        axes.plot(degrees, decibels, style, color=colour, label=name)
        for crossover in measured[name].gain_crossovers:
            at = float(np.interp(crossover.omega, omega[: len(degrees)], degrees))
            axes.plot(at, 0, "o", color=colour, markersize=4)
    if prototype is not None:
        chart = prototype.curve()
        axes.plot(*_on_chart(chart), color=GREY, linestyle=":", label="prototype")
        _bound(axes, prototype)
    axes.plot(-180, 0, "+", color="black", markersize=9)
    axes.set_xlim(-270, -60)
    axes.set_ylim(-40, 40)
    axes.set_xticks(range(-270, -59, 30))
    axes.set_xlabel("arg L in °")
    axes.set_ylabel("|L| in dB")


def _m_circle(axes: "Axes", size: float, colour: str, label: str) -> None:
    """Draw where |L/(1+L)| has one value."""
    angle = np.linspace(0, 2 * np.pi, 2001)
    closed = size * np.exp(1j * angle)
    degrees, decibels = _on_chart(closed / (1 - closed))
    order = np.argsort(degrees) if size < 1 else slice(None)
    axes.plot(degrees[order], decibels[order], color=colour, linewidth=0.6)
    inside = (degrees > -265) & (degrees < -65) & (np.abs(decibels) < 38)
    if inside.any():
        k = np.flatnonzero(inside)[np.argmax(degrees[inside])]
        axes.annotate(
            label, (degrees[k], decibels[k]), fontsize=6, color=GREY, ha="right"
        )


def _bound(axes: "Axes", prototype: SecondOrderPrototype) -> None:
    """Draw the two curves that the loop must stay outside of."""
    angle = np.linspace(0, 2 * np.pi, 2001)
    allowed = np.exp(1j * angle) / prototype.sensitivity_peak - 1
    axes.plot(*_on_chart(allowed), color="black", linewidth=0.9, label="its |S|, |T|")
    if prototype.complementary_peak > 1:
        closed = prototype.complementary_peak * np.exp(1j * angle)
        axes.plot(*_on_chart(closed / (1 - closed)), color="black", linewidth=0.9)


def _on_chart(values: ComplexArray) -> tuple[FloatArray, FloatArray]:
    """Return phase between -360° and 0 and gain in dB."""
    degrees = np.mod(np.degrees(np.angle(values)), 360.0) - 360.0
    return np.asarray(degrees), np.asarray(20 * np.log10(np.abs(values)))


def draw_nyquist(axes: "Axes", loops: Loops, measured: Measured) -> None:
    """Draw the open loops around -1, with the disc that they leave free."""
    omega = frequencies(measured)
    for (name, loop), colour, style in zip(
        loops.items(), COLOURS, STYLES, strict=False
    ):
        values = loop.open_loop.response(omega)
        axes.plot(values.real, values.imag, style, color=colour, label=name)
        angle = np.linspace(0, 2 * np.pi, 200)
        disc = -1 + measured[name].modulus_margin * np.exp(1j * angle)
        axes.plot(disc.real, disc.imag, ":", color=colour, linewidth=0.8)
    axes.plot(-1, 0, "+", color="black", markersize=9)
    axes.axhline(0, color=PALE, linewidth=0.6)
    axes.axvline(0, color=PALE, linewidth=0.6)
    axes.set_xlim(-2.2, 0.6)
    axes.set_ylim(-1.8, 1.0)
    axes.set_aspect("equal")
    axes.set_xlabel("Re L")
    axes.set_ylabel("Im L")


def draw_sensitivities(
    axes: "Axes",
    loops: Loops,
    measured: Measured,
    prototype: SecondOrderPrototype | None = None,
) -> None:
    """Draw |S| and |T| of the loops, their peaks and those of the prototype."""
    omega = frequencies(measured)
    for (name, loop), colour, style in zip(
        loops.items(), COLOURS, STYLES, strict=False
    ):
        shown = _below_nyquist(omega, loop)
        axes.loglog(
            shown, np.abs(loop.sensitivity(shown)), style, color=colour, label=name
        )
        axes.loglog(
            shown, np.abs(loop.complementary(shown)), style, color=colour, alpha=0.5
        )
        peak = measured[name].sensitivity
        if shown[0] < peak.omega < shown[-1]:
            axes.plot(peak.omega, peak.value, "o", color=colour, markersize=4)
    if prototype is not None:
        axes.axhline(prototype.sensitivity_peak, color="black", linewidth=0.8)
    axes.set_ylim(1e-2, 5)
    axes.set_xlim(omega[0], omega[-1])
    axes.grid(visible=True, which="both", color="#EEEEEE")
    axes.set_ylabel("|S|, and paler |T|")
    axes.set_xlabel("ω in rad/s")


def draw_step(axes: "Axes", loops: Loops, measured: Measured) -> None:
    """Draw the step responses of those loops that are stable."""
    longest = 0.0
    for (name, loop), colour, style in zip(
        loops.items(), COLOURS, STYLES, strict=False
    ):
        m = measured[name]
        if m.step is None or not m.gain_crossovers:
            continue
        response = step_response(loop, scale=m.crossover)
        axes.plot(response.time, response.output, style, color=colour, label=name)
        quick = min(m.step.settling_time, 30 / m.crossover)
        longest = max(longest, 1.6 * quick, 8 / m.crossover)
    axes.axhline(1, color=GREY, linewidth=0.6)
    axes.set_xlim(0, longest or 1.0)
    axes.set_ylim(bottom=0)
    axes.grid(visible=True, color="#EEEEEE")
    axes.set_xlabel("time in s")
    axes.set_ylabel("y after a step of r")


def draw_noise(axes: "Axes", loops: Loops, measured: Measured) -> None:
    """Draw command per measurement noise."""
    omega = frequencies(measured)
    omega = np.geomspace(omega[0], omega[-1] * 10, _POINTS)
    for (name, loop), colour, style in zip(
        loops.items(), COLOURS, STYLES, strict=False
    ):
        shown = _below_nyquist(omega, loop)
        values = np.abs(loop.control_of_noise(shown))
        axes.loglog(shown, values, style, color=colour, label=name)
    low, high = axes.get_ylim()
    axes.set_ylim(max(low, high * 1e-6), high)
    axes.set_xlim(omega[0], omega[-1])
    axes.grid(visible=True, which="both", color="#EEEEEE")
    axes.set_xlabel("ω in rad/s")
    axes.set_ylabel("|command / noise|")


def _below_nyquist(omega: FloatArray, loop: Loop) -> FloatArray:
    if loop.period is None:
        return omega
    return omega[omega < math.pi / loop.period]
