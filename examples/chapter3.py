"""Chapter 3 of the FlegX thesis: its figures, from data generated with its numbers.

The thesis's recordings are not public. Each figure here is made from data generated
with its printed values and noise, and identified again, so the truth is known.

Run with ``python examples/chapter3.py [FOLDER]``; needs matplotlib.
"""

import math
import sys
from itertools import pairwise
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")  # pictures are written, no window is opened
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.signal import lsim

from bondgraph import state_space
from flegx_models.characterisation.added_mass import EXACT_SHARE, equivalent_mass
from flegx_models.characterisation.beam_modes import UniformBeam
from flegx_models.characterisation.cantilever import Cantilever
from flegx_models.characterisation.encoder_filter import ButterworthPair, PwmEncoder
from flegx_models.characterisation.feasible_lines import feasible_lines
from flegx_models.characterisation.flexible_link import (
    PointMass,
    StaticCorrection,
    flexible_link,
)
from flegx_models.characterisation.free_decay import free_decay, printed_damping_factor
from flegx_models.characterisation.frequency_response import (
    frequency_response,
    pulse_only,
)
from flegx_models.characterisation.hysteresis_fit import identify_hysteresis
from flegx_models.characterisation.impact_modes import Mode, identify_modes
from flegx_models.characterisation.pendulum import swinging_part
from flegx_models.characterisation.sensor_line import Line, least_squares_line
from flegx_models.characterisation.torque_hysteresis import (
    FixedWidth,
    Hysteresis,
    UntilMet,
)
from flegx_models.parameters_chapter3 import CHAPTER_3

Array = NDArray[np.float64]

P = CHAPTER_3.values_by_name()
RANDOM = np.random.default_rng(2018)
STRIP = Cantilever(
    length=P["L_link"],
    width=P["b_link"],
    thickness=P["h_link"],
    youngs_modulus=P["E_tendon"],
)
# The mass for which the strip's own stiffness gives the measured 35 Hz.
BEAM = UniformBeam(
    length=STRIP.length,
    bending_stiffness=STRIP.bending_stiffness,
    mass=equivalent_mass(STRIP.tip_stiffness, frequency=P["f_1"]) / EXACT_SHARE,
    thickness=STRIP.thickness,
)
DAMPING = 0.006  # not printed; a steel strip clamped between profiles


def sensor_line(folder: Path) -> None:
    """Draw figures 3.9 to 3.13: three characteristics and what each leaves possible."""
    true = Line(P["slope_least_squares"], P["offset_least_squares"])
    volts = np.linspace(0.1, 5.3, 14)
    e_out, e_in = 0.6, 0.02
    force = true(volts) + RANDOM.uniform(-e_out, e_out, volts.size)
    read = volts + RANDOM.uniform(-e_in, e_in, volts.size)
    squares = least_squares_line(read, force)
    output_only = feasible_lines(read, force, output_error=e_out)
    if output_only.slack < 0:
        needed = e_out - output_only.slack
        print(f"  with exact voltages: {output_only.status} They need {needed:.2f} N.")
        output_only = feasible_lines(read, force, output_error=1.1 * needed)
    both = feasible_lines(read, force, output_error=e_out, input_error=e_in)

    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
    left.errorbar(
        read, force - true(read), e_out, e_in, fmt="k.", ms=4, label="points, bounds"
    )
    for line, label in (
        (squares.line, "least squares (fig. 3.9)"),
        (output_only.centre, "linear programme (fig. 3.10)"),
        (both.centre, "errors in variables (fig. 3.12)"),
    ):
        text = f"{label}: {line.slope:.2f} u {line.offset:+.2f}"
        left.plot(read, line(read) - true(read), label=text)
        print(f"  {text}")
    left.set(
        xlabel="strain gauge [V]",
        ylabel="force less the true line [N]",
        title="Three characteristics (fig. 3.13)",
        ylim=(-1.7, 2.6),
    )
    left.legend(fontsize=8, loc="upper left")
    for found, label, colour in (
        (output_only, "errors in the force only, bound enlarged", "tab:orange"),
        (both, "errors in force and voltage", "tab:green"),
    ):
        for k, polygon in enumerate(found.polygons):
            corners = np.array([*polygon, polygon[0]])
            right.fill(
                *corners.T, alpha=0.3, color=colour, label=label if not k else ""
            )
        (a0, a1), (b0, b1) = found.slope, found.offset
        right.plot([a0, a1, a1, a0, a0], [b0, b0, b1, b1, b0], ":", color=colour)
        right.plot(found.centre.slope, found.centre.offset, "o", color=colour)
    right.plot(true.slope, true.offset, "k*", ms=11, label="truth")
    right.plot(squares.line.slope, squares.line.offset, "b+", ms=10, label="least sq.")
    right.set(
        xlabel="slope [N/V]", ylabel="offset [N]", title="Lines that are possible"
    )
    right.legend(fontsize=8)
    figure.savefig(folder / "sensor_line.png", dpi=110)


def hits(place: float, rate: int, samples: int, over: int) -> tuple[Array, Array]:
    """Return forces and strains of three hits at a place, each (3, samples)."""
    t = np.arange(samples * over) / (rate * over)
    link = flexible_link(BEAM, modes=5, force_at=place, gauge_at=0.01, damping=DAMPING)
    model = state_space(link.finish())
    system = (model.A, model.B, model.C[:1], model.D[:1])
    forces, strains = [], []
    for _ in range(3):
        width, height = RANDOM.uniform(6e-4, 1e-3), RANDOM.uniform(20, 50)
        during = (t > 0.02) & (t < 0.02 + width)
        force = np.where(during, height * np.sin(np.pi * (t - 0.02) / width), 0)
        strain = lsim(system, force, t)[1][::over]
        forces.append(force[::over] + RANDOM.normal(0, 0.1, samples))
        strains.append(strain + RANDOM.normal(0, 1e-6, samples))
    return np.array(forces), np.array(strains)


def impacts(folder: Path) -> None:
    """Draw figures 3.14 to 3.20: impacts, frequency responses and mode shapes."""
    rate, samples, over = 4000, 4000, 10
    places = np.arange(1, 9) / 8 * BEAM.length
    responses = []
    for place in places:
        forces, strains = hits(place, rate, samples, over)
        quiet = pulse_only(forces, samples=8)
        response = frequency_response(quiet, strains, interval=1 / rate, decay=3.0)
        responses.append(response)
    found = identify_modes(responses, band=(15.0, 800.0), count=3)

    figure, axes = plt.subplots(2, 3, figsize=(12, 6.5), layout="constrained")
    axes[0, 0].plot(np.arange(samples) / rate, strains[-1] * 1e6, lw=0.6)
    axes[0, 0].set(
        xlabel="time [s]", ylabel="strain [1e-6]", title="Hit at the tip (fig. 3.16)"
    )
    for response, place in zip(responses[1::3], places[1::3], strict=True):
        label = f"hit at {place * 1e3:.0f} mm"
        size = np.abs(response.value)
        axes[0, 1].loglog(response.frequency, size, lw=0.8, label=label)
    for mode in found.modes:
        axes[0, 1].axvline(mode.frequency, color="k", lw=0.6, ls=":")
    axes[0, 1].set(
        xlabel="frequency [Hz]",
        ylabel="strain per force [1/N]",
        title="Frequency response (fig. 3.17)",
        xlim=(10, 1000),
    )
    axes[0, 1].legend(fontsize=8)
    axes[0, 2].semilogx(responses[-1].frequency, responses[-1].coherence, lw=0.7)
    axes[0, 2].set(
        xlabel="frequency [Hz]", title="Coherence, hit at the tip", xlim=(10, 1000)
    )
    for order, (mode, axis) in enumerate(zip(found.modes, axes[1], strict=True)):
        draw_shape(axis, order, mode, places)
    figure.savefig(folder / "impacts.png", dpi=110)


def draw_shape(axis: Axes, order: int, mode: Mode, places: Array) -> None:
    """Draw an identified mode shape on the exact one, and print its frequency."""
    fine = np.linspace(0, BEAM.length, 200)
    shape = BEAM.shape(order + 1, fine)
    sign = np.sign(mode.shape[-1] * shape[-1])
    axis.plot(fine * 1e3, sign * shape / 2, "k-", lw=0.8, label="exact")
    error, points = 2 * mode.shape_std, places * 1e3
    axis.errorbar(points, mode.shape, error, fmt="o", ms=4, label="identified")
    axis.set(
        xlabel="place [mm]",
        title=f"{mode.frequency:.3f} ± {mode.frequency_std:.3f} Hz, "
        f"ζ = {mode.damping:.4f} (fig. 3.{18 + order})",
    )
    axis.title.set_fontsize(10)
    axis.legend(fontsize=8)
    print(
        f"  mode {order + 1}: {mode.frequency:.3f} ± {mode.frequency_std:.3f} Hz, true "
        f"{BEAM.frequencies(order + 1)[order] / (2 * math.pi):.3f}"
    )


def accelerometer(folder: Path) -> None:
    """Draw tables 3.1 to 3.3: what the accelerometer's mass does, and from where."""
    free = BEAM.frequencies(3)
    measured = [P[f"f_{k}_accelerometer"] / P[f"f_{k}"] for k in (1, 2, 3)]
    ratios = np.linspace(0, 0.2, 21)

    def shifted(ratio: float, at: float) -> np.ndarray:
        load = PointMass(ratio * BEAM.mass, at=at) if ratio else None
        graph = flexible_link(
            BEAM, modes=5, force_at=0.1, load=load, truncation=StaticCorrection()
        )
        poles = state_space(graph.finish()).poles()
        return np.sort(np.abs(poles))[::2][:3] / free

    figure, axes = plt.subplots(1, 3, figsize=(12, 4), layout="constrained")
    for axis, inside in zip(axes, (0.0, 0.015), strict=False):
        lines = np.array([shifted(mu, BEAM.length - inside) for mu in ratios])
        for k in range(3):
            (curve,) = axis.plot(ratios, lines[:, k], label=f"mode {k + 1}")
            axis.axhline(measured[k], color=curve.get_color(), ls=":")
        where = "at the tip" if not inside else f"{inside * 1e3:.0f} mm from the tip"
        axis.set(
            xlabel="mass over the strip's mass",
            ylabel="frequency over that without mass",
            title=f"Mass {where}; dotted: measured",
        )
        axis.legend(fontsize=8)
    mass = 0.1 * BEAM.mass
    exact = BEAM.frequencies(3, tip_mass=mass)
    counts = np.arange(3, 17)
    for truncation, style in ((None, "o-"), (StaticCorrection(), "s--")):
        errors = []
        for n in counts:
            graph = flexible_link(
                BEAM,
                modes=int(n),
                force_at=0.1,
                load=PointMass(mass),
                truncation=truncation,
            )
            poles = np.sort(np.abs(state_space(graph.finish()).poles()))[::2]
            errors.append(abs(poles[0] / exact[0] - 1))
        label = "with static correction" if truncation else "modes alone"
        axes[2].semilogy(counts, errors, style, ms=4, label=label)
    axes[2].set(
        xlabel="modes in the graph", title="Error of the first frequency, mass 10 %"
    )
    axes[2].legend(fontsize=8)
    figure.savefig(folder / "accelerometer.png", dpi=110)


def torque_sensors(folder: Path) -> None:
    """Draw figures 3.22 to 3.26: the hip's and the knee's torque sensor."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 4.2), layout="constrained")
    corners = (0.0, 1.0, -1.0, 0.7, -0.4, 1.2, -1.2, 0.3, -0.7, 0.0)
    volts = np.concatenate(
        [np.linspace(a, b, int(200 * abs(b - a))) for a, b in pairwise(corners)]
    )
    rising = Line(P["hip_slope_rising"], P["hip_offset_rising"])
    falling = Line(P["hip_slope_falling"], P["hip_offset_falling"])
    for axis, transition in zip(
        axes, (FixedWidth(P["V_transition"]), UntilMet()), strict=False
    ):
        model = Hysteresis(
            rising=rising,
            falling=falling,
            transition_slope=P["hip_slope_transition"],
            transition=transition,
        )
        torque = model.torque(volts) + RANDOM.normal(0, 0.25, volts.size)
        fit = identify_hysteresis(
            volts, torque, width=0.2, voltage_noise=1e-3, transition=transition
        )
        mean = Line(
            (rising.slope + falling.slope) / 2, (rising.offset + falling.offset) / 2
        )
        axis.plot(volts, torque - mean(volts), ".", ms=2, color="0.7", label="data")
        axis.plot(volts, fit.model.torque(volts) - mean(volts), lw=0.9, label="model")
        found = fit.model
        axis.set(
            xlabel="voltage [V]",
            ylabel="torque less the mean line [N·m]",
            title=f"Hip, {type(transition).__name__}: {found.rising.slope:.2f}, "
            f"{found.falling.slope:.2f}, {found.transition_slope:.1f} N·m/V",
        )
        axis.legend(fontsize=8)
        print(
            f"  hip, {transition}: rms {fit.rms:.3f} N·m, "
            f"with one line {fit.single_line_rms:.3f}"
        )
    ways = np.concatenate([np.linspace(0, 0.9, 60), np.linspace(0.9, 0, 60)])
    for name, kind in (("rising", "-"), ("falling", "--")):
        line = Line(P[f"knee_slope_{name}"], P[f"knee_offset_{name}"])
        single = Line(P["knee_slope"], P["knee_offset"])
        axes[2].plot(ways, line(ways) - single(ways), kind, label=f"{name} (eq. 3.23)")
    axes[2].axhline(0, color="k", lw=0.6, label="one line (eq. 3.22)")
    axes[2].set(xlabel="voltage [V]", title="Knee: less the one line [N·m]")
    axes[2].legend(fontsize=8)
    figure.savefig(folder / "torque_sensors.png", dpi=110)


def pendulums(folder: Path) -> None:
    """Draw figures 3.28 to 3.30: free swings, and the damping that is printed."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.8), layout="constrained")
    t = np.arange(0, 9, 0.0025)
    for axis, part, title in zip(
        axes,
        ("upperleg", "lowerleg", "lowerleg_total"),
        ("Upper leg (fig. 3.28)", "Lower leg (fig. 3.29)", "With gear (fig. 3.30)"),
        strict=True,
    ):
        inertia = P[
            "I_lowerleg" if part == "lowerleg" else f"I_{part.split('_')[0]}_total"
        ]
        omega, delta = P[f"omega_{part}"], P[f"delta_{part}"]
        weight = inertia * omega**2
        friction = 2 * delta / math.hypot(2 * math.pi, delta) * omega * inertia

        def rates(_t, x, inertia=inertia, weight=weight, friction=friction):
            return [x[1], -(weight * math.sin(x[0]) + friction * x[1]) / inertia]

        angle = solve_ivp(rates, (0, 9), [0.4, 0], t_eval=t, rtol=1e-8).y[0]
        angle = angle + RANDOM.normal(0, 0.002, t.size)
        decay = free_decay(t, angle, smallest=0.03)
        found = swinging_part(decay, weight_torque=weight)
        printed = printed_damping_factor(decay.decrement)
        axis.plot(t, angle, lw=0.7)
        for zeta, style, label in (
            (decay.damping_factor, "k-", "right"),
            (printed, "r--", "printed"),
        ):
            envelope = 0.4 * np.exp(-zeta * decay.natural_frequency * t)
            axis.plot(t, envelope, style, lw=0.9, label=f"{label}: ζ = {zeta:.4f}")
        axis.set(xlabel="time [s]", ylabel="angle [rad]", title=title)
        axis.legend(fontsize=8)
        print(
            f"  {part}: I = {found.inertia:.4g} kg·m², c = {found.friction:.3g} N·m·s; "
            f"eq. 3.32 would give {2 * printed * omega * inertia:.3g}"
        )
    figure.savefig(folder / "pendulums.png", dpi=110)


def encoder(folder: Path) -> None:
    """Draw figures 3.31 and 3.32: the encoder's filter."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.8), layout="constrained")
    hertz = np.logspace(-0.5, 2.5, 400)
    text = ButterworthPair(cutoff=2 * math.pi * P["f_filter"])
    formula = ButterworthPair(cutoff=P["omega_filter"])
    for pair, label in ((text, "25 Hz (text)"), (formula, "25 rad/s (eq. 3.34)")):
        response = pair.response(2 * math.pi * hertz)
        axes[0].semilogx(hertz, 20 * np.log10(np.abs(response)), label=label)
        axes[1].semilogx(hertz, np.degrees(np.unwrap(np.angle(response))), label=label)
    axes[0].plot(P["f_noise"], -P["filter_attenuation"], "k*", label="asked for")
    axes[0].set(xlabel="frequency [Hz]", ylabel="magnitude [dB]", title="Fig. 3.31")
    axes[1].set(xlabel="frequency [Hz]", ylabel="phase [°]", title="Fig. 3.31")
    chip = PwmEncoder(
        step=P["encoder_step"], clock=P["encoder_clock"], frame=P["encoder_frame"]
    )
    rate = P["f_sampling"]
    t = np.arange(0, 2.5, 1 / rate)
    motion = 0.15 * (1 - np.cos(2 * math.pi * 1.0 * t))
    noise = P["encoder_noise"] / 2 * np.sin(2 * math.pi * rate / 3 * t + 0.3)
    read = chip.read(motion + noise)
    axes[2].plot(t, read, color="0.8", lw=0.6, label="read")
    axes[2].plot(t, text.filtered(read, sampling=rate), label="filtered, 25 Hz")
    axes[2].plot(t, motion, "k:", lw=0.8, label="motion")
    axes[2].set(xlabel="time [s]", ylabel="angle [rad]", title="Fig. 3.32")
    for axis in axes:
        axis.legend(fontsize=8)
    print(
        f"  25 Hz: {text.attenuation(2 * math.pi * P['f_noise']):.1f} dB at 133 Hz, "
        f"bandwidth {text.bandwidth / (2 * math.pi):.1f} Hz, delay "
        f"{1e3 * text.delay:.1f} ms; encoder {1e3 * chip.delay(rate):.1f} ms more"
    )
    figure.savefig(folder / "encoder.png", dpi=110)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/chapter3")
    folder.mkdir(parents=True, exist_ok=True)
    for draw in (
        sensor_line,
        impacts,
        accelerometer,
        torque_sensors,
        pendulums,
        encoder,
    ):
        print(f"{draw.__name__}:")
        draw(folder)
    print(f"Pictures are in {folder}.")


if __name__ == "__main__":
    main()
