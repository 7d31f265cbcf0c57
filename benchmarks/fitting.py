"""Five parameters of the friction pendulum from 10 s at 1 kHz: ours, lmfit, CasADi.

The angle is recorded with noise of 1e-3 rad; every tool starts from the same values, 25
to 100 % off, and simulates from the true initial state, so that all fit the same thing
(ours estimates the initial state too). lmfit calls scipy's odeint and differentiates by
differences; CasADi steps as we do and differentiates exactly.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import odeint
from scipy.optimize import least_squares

from benchmarks.measuring import print_machine, print_table, seconds, write_results
from benchmarks.simulation import (
    SAMPLES,
    START,
    STEP,
    VALUES,
    pendulum,
    reference,
    torque,
)
from bondgraph import FitSettings, WholeRecordings, fit
from bondgraph.recordings.binding import BoundRecording
from bondgraph.simulation.solvers import RungeKutta4, Sdirk2, Solver
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Parameter

Array = NDArray[np.float64]
NAMES = ("J", "weight", "coulomb", "viscous", "slip")
OFF = {"J": 1.5, "weight": 1.25, "coulomb": 0.6, "viscous": 2.0, "slip": 1.7}
FIRST = np.array([VALUES[name] * OFF[name] for name in NAMES])
Found = tuple[float, dict[str, float], int]


def ours(u: Array, measured: Array, solver: Solver) -> Found:
    units = {"J": "kg*m^2", "weight": "N*m", "coulomb": "N*m",
             "viscous": "N*m*s/rad", "slip": "rad/s"}  # fmt: skip
    graph: FinishedGraph = (
        pendulum()
        .finish()
        .with_parameters(
            [
                Parameter(name=name, value=v, unit=units[name], bounds=(0.0, np.inf))
                for name, v in zip(NAMES, FIRST.tolist(), strict=True)
            ]
        )
    )
    recording = BoundRecording(
        name="noisy torque", time=STEP * np.arange(SAMPLES), inputs=u[:, None],
        outputs=measured[:, None], input_names=("torque",), output_names=("angle",),
        input_units=("N*m",), output_units=("rad",),
    )  # fmt: skip
    settings = FitSettings(horizon=WholeRecordings(), solver=solver)
    fit(graph, [recording.part(0, 300)], settings=settings)  # loads the kernels
    begin = time.process_time()
    found = fit(graph, [recording], settings=settings)
    used = time.process_time() - begin
    return used, {e.name: e.value for e in found.estimates}, found.iterations


def lmfit_odeint(u: Array, measured: Array) -> Found:
    import lmfit  # noqa: PLC0415

    instants, samples = STEP * np.arange(SAMPLES), [*u.tolist(), float(u[-1])]
    start = [START["p_J"], START["q_mass"]]

    def residual(given: Any) -> Array:
        J, weight, coulomb, viscous, slip = (given[name].value for name in NAMES)

        def rate(x: Array, t: float) -> tuple[float, float]:
            at = t / STEP
            k = min(int(at), SAMPLES - 1)
            drive = samples[k] + (at - k) * (samples[k + 1] - samples[k])
            speed = x[0] / J
            friction = coulomb * np.tanh(speed / slip) + viscous * speed
            return drive - friction - weight * np.sin(x[1]), speed

        angle: Array = odeint(rate, start, instants)[:, 1]
        return (angle - measured) / 1e-3

    parameters = lmfit.Parameters()
    for name, value in zip(NAMES, FIRST, strict=True):
        parameters.add(name, value=value, min=1e-9)
    begin = time.process_time()
    found = lmfit.minimize(residual, parameters, method="leastsq", max_nfev=60)
    used = time.process_time() - begin
    return used, dict(found.params.valuesdict()), found.nfev


def casadi_least_squares(u: Array, measured: Array) -> Found:
    import casadi  # noqa: PLC0415

    begin = time.process_time()
    x, w, p = (casadi.SX.sym(name, n) for name, n in (("x", 2), ("w", 2), ("p", 5)))
    J, weight, coulomb, viscous, slip = casadi.vertsplit(p)

    def rate(state: Any, drive: Any) -> Any:
        speed = state[0] / J
        friction = coulomb * casadi.tanh(speed / slip) + viscous * speed
        return casadi.vertcat(drive - friction - weight * casadi.sin(state[1]), speed)

    h, middle = STEP, 0.5 * (w[0] + w[1])
    a = rate(x, w[0])
    b = rate(x + h / 2 * a, middle)
    c = rate(x + h / 2 * b, middle)
    d = rate(x + h * c, w[1])
    new = x + h / 6 * (a + 2 * b + 2 * c + d)
    step = casadi.Function("step", [x, w, p], [new])
    # The parameters' tangents are states of an extended system: exact, and forward.
    s = casadi.SX.sym("s", 2, 5)
    moved = casadi.jacobian(new, x) @ s + casadi.jacobian(new, p)
    both = casadi.Function("both", [casadi.horzcat(x, s), w, p],
                           [casadi.horzcat(step(x, w, p), moved)])  # fmt: skip
    runs = both.mapaccum(SAMPLES - 1)
    pairs = np.stack([u[:-1], u[1:]])
    start = np.zeros((2, 6))
    start[:, 0] = START["p_J"], START["q_mass"]
    known: dict[bytes, Array] = {}

    def simulated(theta: Array) -> Array:
        key = theta.tobytes()
        if key not in known:
            known.clear()
            tiled = casadi.repmat(casadi.DM(theta), 1, SAMPLES - 1)
            whole = np.array(runs(start, pairs, tiled))[1].reshape(-1, 6)
            known[key] = np.vstack([start[1], whole])
        return known[key]

    found = least_squares(
        lambda theta: (simulated(theta)[:, 0] - measured) / 1e-3,
        FIRST,
        jac=lambda theta: simulated(theta)[:, 1:] / 1e-3,
        bounds=(1e-9, np.inf),
        x_scale=FIRST,
    )
    used = time.process_time() - begin
    return used, dict(zip(NAMES, found.x.tolist(), strict=True)), found.nfev


def main() -> None:
    print_machine()
    u = torque()
    noise = 1e-3 * np.random.default_rng(7).normal(size=SAMPLES)
    measured = reference(u) + noise
    tools: dict[str, Callable[[], Found]] = {
        "ours, RungeKutta4": lambda: ours(u, measured, RungeKutta4()),
        "ours, Sdirk2": lambda: ours(u, measured, Sdirk2()),
        "CasADi, least_squares": lambda: casadi_least_squares(u, measured),
        "lmfit, odeint": lambda: lmfit_odeint(u, measured),
    }
    rows, record, base = [], [], 0.0
    for name, run in tools.items():
        try:
            used, values, calls = min(
                (run() for _ in range(1 if "lmfit" in name else 3)), key=lambda f: f[0]
            )
        except ImportError as error:
            print(f"{name} is not run: {error}")
            continue
        base = base or used
        worst = max(abs(values[n] / VALUES[n] - 1) for n in NAMES)
        rows.append((name, seconds(used), f"{used / base:.3g}", str(calls),
                     f"{100 * worst:.2g} %"))  # fmt: skip
        record.append({"tool": name, "seconds": used, "iterations": calls,
                       "worst": worst, "values": values})  # fmt: skip
    columns = ("tool", "processor time", "ratio", "iterations or calls",
               "largest parameter error")  # fmt: skip
    print_table("Fit of five parameters, 10 000 samples", columns, rows)
    write_results("fitting", record)


if __name__ == "__main__":
    main()
