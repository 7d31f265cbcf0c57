"""A pendulum with dry friction, driven by a sampled noisy torque: ours and others.

Ten seconds at 1 kHz, against the same method written by hand in numba and C, against
CasADi and scipy. scipy gets the best that Python has to offer: the right-hand side
is a plain lambdified function and the input is looked up by index. Its adaptive step
control sees the samples' noise as dynamics; ours steps from sample to sample. The
reference is the classical Runge-Kutta method at 20 steps per sample, written out here.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray
from scipy.integrate import odeint, solve_ivp

from benchmarks.handwritten import c_loop, numba_loop
from benchmarks.measuring import (
    interleaved,
    print_machine,
    print_table,
    seconds,
    write_results,
)
from bondgraph import BondGraph, C, I, R, Sdirk2, Sdirk3, Se, derive, f, q
from bondgraph.numeric.model import compile_model
from bondgraph.simulation.engines import Engine, Interpreted, Native
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, RungeKutta4, Solver

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


def ours(
    u: Array,
    solver: Solver,
    engine: Engine,
    *,
    sensitivities: bool = False,
) -> Callable[[], Array]:
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
            engine=engine,
        )
        assert shot.completed.all()
        return shot.outputs[:, 0]

    return simulate


def by_hand(u: Array, loop: Callable[..., None]) -> Callable[[], Array]:
    names = ("J", "weight", "coulomb", "viscous", "slip")
    values = np.array([VALUES[name] for name in names])

    def simulate() -> Array:
        y = np.empty(SAMPLES)
        loop(values, u, STEP, START["p_J"], START["q_mass"], y)
        return y

    return simulate


def casadi_run(u: Array) -> Callable[[], Array] | None:
    """Return CasADi's mapped Runge-Kutta steps, or None where it is not installed."""
    try:
        import casadi  # noqa: PLC0415
    except ImportError:
        return None
    x, w = casadi.SX.sym("x", 2), casadi.SX.sym("w", 2)
    v = VALUES

    def rate(state: Any, drive: Any) -> Any:
        speed = state[0] / v["J"]
        friction = v["coulomb"] * casadi.tanh(speed / v["slip"]) + v["viscous"] * speed
        pull = v["weight"] * casadi.sin(state[1])
        return casadi.vertcat(drive - friction - pull, speed)

    h, middle = STEP, 0.5 * (w[0] + w[1])
    a = rate(x, w[0])
    b = rate(x + h / 2 * a, middle)
    c = rate(x + h / 2 * b, middle)
    d = rate(x + h * c, w[1])
    new = x + h / 6 * (a + 2 * b + 2 * c + d)
    steps = casadi.Function("step", [x, w], [new]).mapaccum(SAMPLES - 1)
    pairs = np.stack([u[:-1], u[1:]])
    start = [START["p_J"], START["q_mass"]]

    def simulate() -> Array:
        angles = np.array(steps(start, pairs))[1]
        return np.concatenate([[START["q_mass"]], angles])

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


def quick_runs(u: Array) -> dict[str, Callable[[], Array]]:
    """Return what is fast enough to be repeated, the measure of all first."""
    in_c, in_casadi = c_loop(), casadi_run(u)
    native = Native()
    runs = {
        "numba loop by hand": by_hand(u, numba_loop),
        **({"C loop by hand, gcc -O3": by_hand(u, in_c)} if in_c else {}),
        "RungeKutta4": ours(u, RungeKutta4(), native),
        "RungeKutta4, 7 sensitivities": ours(
            u, RungeKutta4(), native, sensitivities=True
        ),
        "Sdirk2": ours(u, Sdirk2(), native),
        "Sdirk2, 7 sensitivities": ours(u, Sdirk2(), native, sensitivities=True),
        "Sdirk3": ours(u, Sdirk3(), native),
        "Sdirk2 on the tape": ours(u, Sdirk2(), Interpreted()),
        "Sdirk2 on the tape, 7 sensitivities": ours(
            u, Sdirk2(), Interpreted(), sensitivities=True
        ),
    }
    return {**runs, **({"CasADi, the same steps": in_casadi} if in_casadi else {})}


def main() -> None:
    print_machine()
    u = torque()
    true = reference(u)
    quick, slow = quick_runs(u), scipy_runs(u)
    times = interleaved(quick, rounds=40) | interleaved(slow, rounds=2)
    measure, record, rows = times["numba loop by hand"], [], []
    for name, run in {**quick, **slow}.items():
        error = float(np.abs(run() - true).max())
        ratio, middle = (t / m for t, m in zip(times[name], measure, strict=True))
        record.append({"method": name, "seconds": times[name][0], "ratio": ratio,
                       "ratio_of_medians": middle, "error": error})  # fmt: skip
        rows.append(
            (name, seconds(times[name][0]), f"{ratio:.3g}", f"{middle:.3g}",
             f"{error:.1e} rad")
        )  # fmt: skip
    columns = ("method", "processor time", "ratio", "ratio of medians", "largest error")
    print_table("Friction pendulum, 10 s at 1 kHz, noisy torque", columns, rows)
    write_results("simulation", record)


if __name__ == "__main__":
    main()
