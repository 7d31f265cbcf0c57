"""A pendulum with dry friction, driven by a sampled noisy torque: kernel and scipy.

Ten seconds at 1 kHz. scipy gets the best that Python has to offer: the right-hand side
is a plain lambdified function and the input is looked up by index. Its adaptive step
control sees the samples' noise as dynamics; the kernel steps from sample to sample. The
reference is the classical Runge-Kutta method at 20 steps per sample, written out here.
"""

from collections.abc import Callable, Sequence

import numpy as np
import sympy
from numpy.typing import NDArray
from scipy.integrate import odeint, solve_ivp

from benchmarks.measuring import print_machine, print_table, seconds, stopwatch
from bondgraph import BondGraph, C, I, R, Sdirk2, Sdirk3, Se, derive, f, q
from bondgraph.numeric.model import compile_model
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, Solver

Array = NDArray[np.float64]
STEP, SAMPLES, FINE = 1e-3, 10_000, 20
VALUES = {"J": 0.1, "weight": 4.0, "coulomb": 0.3, "viscous": 0.02, "slip": 0.01}
START = {"p_J": 0.0, "q_mass": 0.3}


def pendulum() -> BondGraph:
    weight, coulomb, viscous, slip = sympy.symbols("weight coulomb viscous slip")
    graph = BondGraph("pendulum", domain="rotation")
    friction = coulomb * sympy.tanh(f / slip) + viscous * f
    graph.one(
        "axle",
        Se("torque"),
        I("J"),
        R("friction", law=friction),
        C("mass", law=weight * sympy.sin(q)),
    )
    graph.measure("angle", displacement="axle")
    return graph


def torque() -> Array:
    """Return what a torque sensor would: a slow motion, and noise on every sample."""
    time = STEP * np.arange(SAMPLES)
    noise = np.random.default_rng(0).normal(size=SAMPLES)
    return 1.5 * np.sin(2 * np.pi * 0.5 * time) + 0.3 * noise


def right_hand_side(u: Array) -> Callable[[float, Sequence[float]], list[float]]:
    """Return (t, x) -> rates as plain Python, x = momentum, angle."""
    momentum, angle, drive = sympy.symbols("momentum angle drive")
    v = {name: sympy.Float(value) for name, value in VALUES.items()}
    speed = momentum / v["J"]
    friction = v["coulomb"] * sympy.tanh(speed / v["slip"]) + v["viscous"] * speed
    rates = [drive - friction - v["weight"] * sympy.sin(angle), speed]
    compiled = sympy.lambdify([momentum, angle, drive], rates, modules="math", cse=True)
    samples = [*u.tolist(), float(u[-1])]

    def rate(t: float, x: Sequence[float]) -> list[float]:
        at = t / STEP
        k = min(int(at), SAMPLES - 1)
        share = at - k
        now = samples[k] + share * (samples[k + 1] - samples[k])
        result: list[float] = compiled(x[0], x[1], now)
        return result

    return rate


def reference(u: Array) -> Array:
    """Return the angle by the classical Runge-Kutta method in small steps."""
    rate = right_hand_side(u)
    h = STEP / FINE
    x, y = START["p_J"], START["q_mass"]
    angles = [y]
    for k in range((SAMPLES - 1) * FINE):
        t = k * h
        a = rate(t, (x, y))
        b = rate(t + h / 2, (x + h / 2 * a[0], y + h / 2 * a[1]))
        c = rate(t + h / 2, (x + h / 2 * b[0], y + h / 2 * b[1]))
        d = rate(t + h * (1 - 1e-9), (x + h * c[0], y + h * c[1]))
        x += h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
        y += h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
        if (k + 1) % FINE == 0:
            angles.append(y)
    return np.array(angles)


def kernel(u: Array, solver: Solver, *, sensitivities: bool) -> Callable[[], Array]:
    model = compile_model(derive(pendulum().finish()))
    time = STEP * np.arange(SAMPLES)
    shots = Shots(time, u[:, None], np.zeros((SAMPLES, 1)), (0, SAMPLES))
    parameters = np.array([VALUES[name] for name in model.parameter_names])
    initial = np.array([[START[name] for name in model.state_names]])
    about = np.arange(len(parameters)) if sensitivities else None

    def simulate() -> Array:
        shot = shoot(
            model,
            shots,
            parameters=parameters,
            initial=initial,
            directions=about,
            solver=solver,
            hold=Hold.FIRST,
        )
        assert shot.completed.all()
        return shot.outputs[:, 0]

    return simulate


def scipy_runs(u: Array) -> dict[str, Callable[[], Array]]:
    rate = right_hand_side(u)
    time = STEP * np.arange(SAMPLES)
    x0 = [START["p_J"], START["q_mass"]]

    def ivp(method: str, rtol: float) -> Callable[[], Array]:
        def solve() -> Array:
            found = solve_ivp(
                rate, (0, time[-1]), x0, method, time, rtol=rtol, atol=1e-3 * rtol
            )
            return found.y[1]

        return solve

    def ode(rtol: float) -> Callable[[], Array]:
        return lambda: odeint(rate, x0, time, tfirst=True, rtol=rtol, atol=1e-3 * rtol)[
            :, 1
        ]

    runs = {
        f"scipy solve_ivp {method}, rtol {rtol:.0e}": ivp(method, rtol)
        for method in ("RK45", "LSODA")
        for rtol in (1e-3, 1e-6)
    }
    return {**runs, "scipy odeint, rtol 1e-06": ode(1e-6)}


def main() -> None:
    print_machine()
    u = torque()
    true = reference(u)
    ours = {
        "kernel, Sdirk2": kernel(u, Sdirk2(), sensitivities=False),
        "kernel, Sdirk3": kernel(u, Sdirk3(), sensitivities=False),
        "kernel, Sdirk2, 7 sensitivities": kernel(u, Sdirk2(), sensitivities=True),
    }
    rows, base = [], 0.0
    for name, run in ours.items():
        run()  # loads the compiled kernel
        duration, angle = stopwatch(run, times=5)
        base = base or duration
        rows.append(_row(name, duration, base, angle, true))
    for name, run in scipy_runs(u).items():
        duration, angle = stopwatch(run, times=1)
        rows.append(_row(name, duration, base, angle, true))
    columns = ("method", "time", "times the kernel", "largest error of the angle")
    print_table("Friction pendulum, 10 s at 1 kHz, noisy torque", columns, rows)


def _row(
    name: str, duration: float, base: float, angle: Array, true: Array
) -> tuple[str, ...]:
    error = float(np.abs(angle - true).max())
    return name, seconds(duration), f"{duration / base:.3g}", f"{error:.1e} rad"


if __name__ == "__main__":
    main()
