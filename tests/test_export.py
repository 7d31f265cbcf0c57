"""Exported programs, each run in its own language against our own numbers."""

import ctypes
import json
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy
from catalogue import CASES, Case, somewhere
from click.testing import CliRunner, Result
from numpy.typing import NDArray

from bondgraph import TF, BondGraph, C, FinishedGraph, I, R, Se, Sf
from bondgraph.cli.program import program
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import EquationError
from bondgraph.numeric.model import NumericModel, compile_model, evaluate
from bondgraph.numeric.state_space import state_space
from bondgraph.reporting.export.c99 import to_c99
from bondgraph.reporting.export.calculation import calculation
from bondgraph.reporting.export.exporting import (
    C99,
    Json,
    Latex,
    Matlab,
    Modelica,
    PythonControl,
    PythonFunctions,
    PythonModel,
    Target,
    export,
)
from bondgraph.reporting.export.identifiers import Identifiers, identifier
from bondgraph.reporting.export.matlab import to_matlab
from bondgraph.reporting.export.modelica import modelica_unit, to_modelica
from bondgraph.reporting.export.python_control import is_linear, to_python_control
from bondgraph.reporting.export.python_functions import to_python_functions
from bondgraph.simulation.shooting import Shots, shoot
from bondgraph.simulation.solvers import Hold, Sdirk3
from bondgraph.structure.signals import displacement, e, f, flow, q

Array = NDArray[np.float64]
STRICT = "-std=c99 -Wall -Wextra -Werror -pedantic".split()

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not here")
needs_octave = pytest.mark.skipif(
    shutil.which("octave-cli") is None, reason="octave-cli is not here"
)


# Our own numbers


@dataclass(frozen=True)
class Point:
    """Where a model is evaluated: state, input, input rate, time."""

    t: float
    x: Array
    u: Array
    du: Array


def with_numbers(case: Case) -> FinishedGraph:
    """Return a graph with a value for every parameter that suits it."""
    graph = case.graph()
    symbols = {sympy.Symbol(name) for name in graph.parameters}
    values = {str(s): v for s, v in somewhere(symbols).items()}
    values |= {k: v for k, v in case.where.items() if k in graph.parameters}
    return graph.with_parameters(values)


def points(case: Case, model: NumericModel, count: int = 3) -> list[Point]:
    """Return places to evaluate at; the last with negative states where they may be."""
    draw = np.random.default_rng(7)
    found = []
    signs = -1 if "log" not in str(case.graph().nodes) else 1
    for k in range(count):
        x = draw.uniform(0.5, 1.0, model.n_states)
        for i, name in enumerate(model.state_names):
            x[i] = case.where.get(name, x[i] * signs ** (k * i // 2))
        u, du = (draw.uniform(0.2, 1.0, len(model.input_names)) for _ in range(2))
        for i, name in enumerate(model.input_names):
            u[i] = case.where.get(name, u[i])
        found.append(Point(k * 0.3, x, u, du))
    return found


def own_answer(
    model: NumericModel, graph: FinishedGraph, at: Point
) -> tuple[Array, Array]:
    """Return rates and outputs from the tape, by Newton on (rates, unknowns)."""
    nx, nz = model.n_states, model.n_unknowns
    values = [graph.parameters[name].value for name in model.parameter_names]
    w = np.zeros(nx + nz)
    tail = [*at.u, *at.du, *values, at.t]
    directions = np.zeros((2 * nx + nz + len(tail), nx + nz))
    directions[nx : 2 * nx + nz] = np.eye(nx + nz)
    for _ in range(60):
        variables = np.array([*at.x, *w, *tail])
        found, slopes = evaluate(model.dynamics, variables, directions)
        residual = np.concatenate([w[:nx] - found[:nx], found[nx:]])
        slope = np.vstack([np.eye(nx, nx + nz) - slopes[:nx], slopes[nx:]])
        w = w - np.linalg.solve(slope, residual)
    outputs, _ = evaluate(model.output, np.array([*at.x, *w, *tail]), directions)
    return w[:nx], outputs


@dataclass(frozen=True)
class Answered:
    """A graph with numbers and what we say of it at some points."""

    graph: FinishedGraph
    equations: StateEquations
    model: NumericModel
    points: list[Point]
    answers: list[tuple[Array, Array]]


@cache
def answered(name: str) -> Answered:
    case = BY_NAME[name]
    graph = with_numbers(case)
    equations = derive(graph)
    model = compile_model(equations)
    places = points(case, model)
    answers = [own_answer(model, graph, at) for at in places]
    given = [with_needed_rates(equations, at) for at in places]
    return Answered(graph, equations, model, given, answers)


def own_simulation(
    graph: FinishedGraph, time: Array, inputs: Array, initial: Array
) -> Array:
    """Return the outputs of our own kernel, inputs joined by straight lines."""
    model = compile_model(derive(graph))
    ran = shoot(
        model,
        Shots(
            time, inputs, np.zeros((len(time), len(model.output_names))), (0, len(time))
        ),
        parameters=np.array(list(graph.parameters.values_by_name().values())),
        initial=initial[None, :],
        directions=None,
        solver=Sdirk3(substeps=20),
        hold=Hold.FIRST,
    )
    assert ran.completed.all()
    return ran.outputs


# C99


class Compiled:
    """An exported model as a shared library."""

    def __init__(self, graph: FinishedGraph, folder: Path) -> None:
        header, source = to_c99(graph, name="model")
        (folder / "model.h").write_text(header, encoding="utf-8")
        (folder / "model.c").write_text(source, encoding="utf-8")
        target = folder / "model.so"
        gcc("-O0", "-shared", "-fPIC", "-o", target, folder / "model.c", "-lm")
        self._library = ctypes.CDLL(str(target))

    def status(self, what: str, at: Point, answer: Array) -> int:
        """Call a function of the library, which fills `answer`."""
        vectors = [np.array([*v, 0.0]) for v in (at.x, at.u)]
        addresses = [ctypes.c_void_p(v.ctypes.data) for v in (*vectors, answer)]
        defaults = ctypes.byref(ctypes.c_double.in_dll(self._library, "model_defaults"))
        call = getattr(self._library, f"model_{what}")
        time = ctypes.c_double(at.t)
        status = call(time, *addresses[:2], defaults, None, addresses[2])
        return int(status)

    def __call__(self, what: str, at: Point, n: int) -> Array:
        """Return rates or outputs."""
        answer = np.full(max(n, 1), np.nan)
        assert self.status(what, at, answer) == 0
        return answer[:n]


def gcc(*words: object) -> None:
    command = ["gcc", *STRICT, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def with_needed_rates(equations: StateEquations, at: Point) -> Point:
    """Return the point with the input rates that a program needs behind its inputs."""
    needed = calculation(equations).inputs[len(equations.inputs) :]
    rates = [at.du[equations.input_rates.index(rate)] for rate in needed]
    return Point(at.t, at.x, np.array([*at.u, *rates]), at.du)


def _maker(write: Callable[[BondGraph], None]) -> Callable[[], BondGraph]:
    def make() -> BondGraph:
        graph = BondGraph(write.__name__)
        write(graph)
        return graph

    return make


def close(expected: Array) -> object:
    return pytest.approx(expected, rel=1e-9, abs=1e-12)


# What the catalogue does not have: every function, kinks inside algebraic loops


def branches(g: BondGraph) -> None:
    """A nonlinear loop whose laws have cases, kinks and every comparison."""
    a, b, w = sympy.symbols("a b w")
    cases = sympy.Piecewise(
        (a * f, sympy.And(f > -1, f <= 1)),
        (a * f + (f - 1) ** 3, sympy.Or(f >= 1, sympy.Not(f < 5))),
        (a * f + (f + 1) ** 3, True),
    )
    g.one("left", Se("u"), R("broken", law=cases))
    g.zero(
        "middle", R("soft", law=e / b + sympy.Max(0, e - b / 9) + e * sympy.Abs(e * w))
    )
    g.one("right", C("c"), R("hard", law=sympy.tanh(f) + b * f))
    g.join("left", "middle")
    g.join("middle", "right")
    g.measure("v", effort="middle")


def functions(g: BondGraph) -> None:
    """An explicit model that calls every function there is a text for."""
    a, b = sympy.symbols("a b")
    x = q / 3
    law = (
        sympy.sin(x) + sympy.cos(a * x) + sympy.tan(x) + sympy.asin(x) + sympy.acos(x)
        + sympy.atan(x) + sympy.sinh(x) + sympy.cosh(x) + sympy.tanh(x) + sympy.exp(-x)
        + sympy.log(2 + x) + sympy.sqrt(2 + x) + sympy.atan2(x, a) + sympy.Abs(x)
        + sympy.sign(x) + sympy.Min(x, a, b) - sympy.Max(x, a - 1) + sympy.Heaviside(x)
        + (2 + x) ** a + x**5 + (2 + x) ** -2 + (2 + x) ** sympy.Rational(-3, 2)
        - sympy.Rational(2, 7) * x / (a * b) + sympy.pi * sympy.E + 1e-30 * x
        - (x - 1) * (-x - a) / (x + 3) + 2 ** (-x) + sympy.Heaviside(0 * x)
    )  # fmt: skip
    g.one("mass", Se("u"), I("m"), C("spring", law=law), R("r"))
    g.measure("v", flow="mass")
    g.measure("ratio", flow("mass") / (1 + displacement("mass") ** 2))


def moved_transformer(g: BondGraph) -> None:
    """Two dependent storages behind moduli that read each other's motion."""
    length = sympy.Symbol("length")
    g.one("joint", Se("torque"), I("j"))
    for name, law in (
        ("x", length * sympy.cos(displacement("joint"))),
        ("y", -length * sympy.sin(displacement("joint")) - displacement("joint") ** 2),
    ):
        g.one(f"along_{name}", I(f"m_{name}"))
        g.join(f"along_{name}", TF(f"arm_{name}", law=law), "joint")
    g.measure("force", effort="m_y")
    g.measure("speed", flow="along_x")


def hostile_names(g: BondGraph) -> None:
    """Words that languages keep for themselves, and texts that end their comments."""
    g.one("while", Se("double"), R("function"), I("j"))
    g.put(C("q_ω", law=sympy.Symbol("int") * q), on="while")
    g.put(R("Real", law=sympy.Symbol("θ") * f + sympy.Symbol("x") * f), on="while")
    g.put(R("sin", law=sympy.Symbol("p[0]") * f + sympy.Symbol("z") * f), on="while")
    g.measure("y */ int main(\"\\??/ 'quoted'\n% {", flow="while")
    g.measure("time", displacement="while")


def nothing_moves(g: BondGraph) -> None:
    """Neither states nor inputs nor parameters."""
    g.zero("node", Sf("i", value=2), R("r", law=e / 4))
    g.measure("v", effort="node")


EXTRA = [
    Case(write.__name__, make=_maker(write), states=(), source="made here")
    for write in (branches, functions, moved_transformer, hostile_names, nothing_moves)
]
EVERY = [*CASES, *EXTRA]
BY_NAME = {case.name: case for case in EVERY}
on_every_graph = pytest.mark.parametrize("case", EVERY, ids=lambda case: case.name)


@needs_gcc
@on_every_graph
def test_c_gives_our_rates_and_outputs(case: Case, tmp_path: Path) -> None:
    known = answered(case.name)
    compiled = Compiled(known.graph, tmp_path)
    for at, (rates, outputs) in zip(known.points, known.answers, strict=True):
        assert compiled("rates", at, len(rates)) == close(rates)
        assert compiled("outputs", at, len(outputs)) == close(outputs)


RUN = [
    *("rlc_series", "crank_and_slider", "resistive_loop_with_c"),
    *("diode_and_resistance", "modulated_sources", "branches", "moved_transformer"),
]


@needs_gcc
@pytest.mark.parametrize("name", RUN)
def test_c_runs_as_our_simulation(name: str, tmp_path: Path) -> None:
    graph = with_numbers(BY_NAME[name])
    time, inputs, initial = experiment(graph)
    expected = own_simulation(graph, time, inputs, initial)
    header, source = to_c99(graph, name="model")
    for file, text in (
        ("model.h", header),
        ("model.c", source),
        ("main.c", RUNGE_KUTTA),
    ):
        (tmp_path / file).write_text(text, encoding="utf-8")
    gcc(tmp_path / "model.c", tmp_path / "main.c", "-o", tmp_path / "run", "-lm")
    words = [len(time), time[1] - time[0], *initial, *inputs.ravel()]
    done = subprocess.run(
        [tmp_path / "run"], input=" ".join(map(repr, map(float, words))),
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    found = np.array(
        [[float(x) for x in row.split()] for row in done.stdout.splitlines()]
    )
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-7)


def experiment(graph: FinishedGraph) -> tuple[Array, Array, Array]:
    """Return times, inputs and initial states of a simulation."""
    equations = derive(graph)
    time = np.linspace(0.0, 1.0, 201)
    inputs = np.array([driven(k, time) for k in range(len(equations.inputs))])
    initial = np.linspace(0.1, 0.3, len(equations.states))
    return time, inputs.reshape(-1, len(time)).T, initial


def driven(k: int, time: Array) -> Array:
    return (0.5 + 0.1 * k) * np.sin((3.0 + k) * time)


RUNGE_KUTTA = """
#include "model.h"
#include <stdio.h>

enum { NX = model_n_states, NU = model_n_inputs, NY = model_n_outputs, STEPS = 50 };
static double z[model_n_unknowns + 1];

static int slope(double t, const double x[], const double a[], const double b[],
    double share, double dx[])
{
    double u[NU + 1];
    int i;
    for (i = 0; i < NU; ++i)
        u[i] = a[i] + share * (b[i] - a[i]);
    return model_rates(t, x, u, &model_defaults, z, dx);
}

int main(void)
{
    double count, dt, x[NX], a[NU + 1], b[NU + 1], y[NY], k[4][NX], w[NX];
    int i, n, m, s;
    const double nodes[4] = {0.0, 0.5, 0.5, 1.0}, weights[4] = {1.0, 2.0, 2.0, 1.0};
    if (scanf("%lf %lf", &count, &dt) != 2)
        return 10;
    for (i = 0; i < NX; ++i)
        if (scanf("%lf", &x[i]) != 1)
            return 11;
    for (n = 0; n < (int)count; ++n) {
        for (i = 0; i < NU; ++i)
            if (scanf("%lf", &b[i]) != 1)
                return 12;
        for (m = 0; n > 0 && m < STEPS; ++m) {
            const double h = dt / STEPS, t = (n - 1) * dt + m * h;
            for (s = 0; s < 4; ++s) {
                for (i = 0; i < NX; ++i)
                    w[i] = x[i] + (s > 0 ? nodes[s] * h * k[s - 1][i] : 0.0);
                if (slope(t + nodes[s] * h, w, a, b, (m + nodes[s]) / STEPS, k[s]))
                    return 13;
            }
            for (i = 0; i < NX; ++i)
                for (s = 0; s < 4; ++s)
                    x[i] += h / 6.0 * weights[s] * k[s][i];
        }
        for (i = 0; i < NU; ++i)
            a[i] = b[i];
        if (model_outputs(n * dt, x, a, &model_defaults, z, y))
            return 14;
        for (i = 0; i < NY; ++i)
            printf("%.17g ", y[i]);
        printf("\\n");
    }
    return 0;
}
"""


@needs_gcc
def test_c_says_that_unknowns_are_not_determined(tmp_path: Path) -> None:
    graph = with_numbers(BY_NAME["divider"])
    graph = graph.with_parameters({"r1": 0.0, "r2": 0.0})
    compiled = Compiled(graph, tmp_path)
    at = Point(0.0, np.zeros(0), np.ones(1), np.zeros(1))
    assert compiled.status("outputs", at, np.zeros(2)) == 1


@needs_gcc
def test_c_says_that_newton_found_nothing(tmp_path: Path) -> None:
    g = BondGraph("no answer")
    g.one("loop", Se("u"), R("a", law=sympy.exp(f)), R("b", law=sympy.tanh(f)))
    g.measure("i", flow="loop")
    compiled = Compiled(g.finish(), tmp_path)
    at = Point(0.0, np.zeros(0), np.array([-5.0]), np.zeros(1))
    assert compiled.status("outputs", at, np.zeros(1)) in (1, 2, 3)


def test_a_missing_value_is_not_a_number() -> None:
    header, source = to_c99(BY_NAME["rc"].graph())
    assert "    NAN, /* r */" in source
    assert "double r; /* [" in header
    assert "model.parameters.r = NaN;" in to_matlab(BY_NAME["rc"].graph())
    assert "parameter Real r(unit=" in to_modelica(BY_NAME["rc"].graph())


def test_numbers_read_back_exactly() -> None:
    graph = with_numbers(BY_NAME["rc"]).with_parameters({"r": 0.1 + 0.2})
    for text in (to_c99(graph)[1], to_matlab(graph), to_modelica(graph)):
        assert "0.30000000000000004" in text


# MATLAB, run by Octave


@pytest.fixture(scope="module")
def octave_answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Array]]:
    """Run every model in one Octave; return the rates and outputs at each point."""
    folder = tmp_path_factory.mktemp("octave")
    script = []
    for case in EVERY:
        known = answered(case.name)
        name = f"model_{case.name}"
        text = to_matlab(known.graph, name=name)
        (folder / f"{name}.m").write_text(text, encoding="utf-8")
        script.append(f"m = {name}();")
        for at in known.points:
            x, u = (f"[{'; '.join(map(repr, map(float, v)))}]" for v in (at.x, at.u))
            for what in ("rates", "outputs"):
                script.append(f"v = m.{what}({at.t!r}, {x}, {u}, m.parameters);")
                script.append(
                    f"printf('{case.name}'); printf(' %.17g', v); printf('\\n');"
                )
    (folder / "every_model.m").write_text("\n".join(script), encoding="utf-8")
    answers: dict[str, list[Array]] = {case.name: [] for case in EVERY}
    for line in octave("every_model.m", folder).splitlines():
        name, *numbers = line.split()
        answers[name].append(np.array([float(x) for x in numbers]))
    return answers


def octave(file: str, folder: Path) -> str:
    command = ["octave-cli", "--no-gui", "--norc", file]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=False
    )
    # Octave without its graphics says this when it ends, whatever it ran.
    said = [s for s in done.stderr.splitlines() if "preparing to exit" not in s]
    assert (done.returncode, said) == (0, [])
    return done.stdout


@needs_octave
@on_every_graph
def test_octave_gives_our_rates_and_outputs(
    case: Case, octave_answers: dict[str, list[Array]]
) -> None:
    expected = [v for pair in answered(case.name).answers for v in pair]
    found = octave_answers[case.name]
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        assert one == close(other)


@needs_octave
def test_octave_integrates_with_ode45(tmp_path: Path) -> None:
    graph = with_numbers(BY_NAME["crank_and_slider"])
    (tmp_path / "crank.m").write_text(to_matlab(graph, name="crank"), encoding="utf-8")
    time, inputs, initial = experiment(graph)
    expected = own_simulation(graph, time, inputs, initial)
    script = """
    m = crank();
    u = @(t) 0.5*sin(3*t);
    f = @(t, x) m.rates(t, x, u(t), m.parameters);
    [t, x] = ode45(f, [0 1], [0.1; 0.3], odeset('RelTol', 1e-9, 'AbsTol', 1e-10));
    printf('%.17g\\n', m.outputs(1, x(end, :).', u(1), m.parameters));
    """
    (tmp_path / "drive.m").write_text(script, encoding="utf-8")
    found = [float(line) for line in octave("drive.m", tmp_path).split()]
    assert found == pytest.approx(expected[-1], rel=1e-4)


@needs_octave
def test_octave_has_the_linear_model(tmp_path: Path) -> None:
    graph = with_numbers(BY_NAME["dc_motor"])
    (tmp_path / "motor.m").write_text(to_matlab(graph, name="motor"), encoding="utf-8")
    (tmp_path / "drive.m").write_text(
        "m = motor(); printf('%.17g\\n', m.A.', m.B, m.C, m.D);"
    )
    found = [float(line) for line in octave("drive.m", tmp_path).split()]
    system = state_space(graph)
    matrices = (system.A, system.B.T, system.C.T, system.D)
    assert found == [float(x) for m in matrices for x in m.ravel()]


# Modelica, compiled and simulated by rumoca


@on_every_graph
def test_modelica_runs_as_our_simulation(case: Case, tmp_path: Path) -> None:
    rumoca = pytest.importorskip("rumoca", reason="rumoca compiles Modelica")
    if case.name in NO_OWN_RUN:
        pytest.skip(NO_OWN_RUN[case.name])
    known = answered(case.name)
    graph, model = known.graph, known.model
    time = np.linspace(0.0, 1.0, 1001)
    inputs = np.array([driven(k, time) for k in range(len(model.input_names))])
    inputs = inputs.reshape(-1, len(time)).T
    initial = np.linspace(0.1, 0.3, model.n_states)
    expected = own_simulation(graph, time, inputs, initial)[::100]
    text = to_modelica(graph, name="Plant")
    ports = re.findall(r"^  (input|output) Real (\w+)", text, re.MULTILINE)
    reads = [name for kind, name in ports if kind == "input"]
    shows = [name for kind, name in ports if kind == "output"]
    drive = [
        f"  plant.{name} = {0.5 + 0.1 * k}*sin({3.0 + k}*time);"
        for k, name in enumerate(reads)
    ]
    states = re.findall(r"^  Real (\w+)\(.*start=", text, re.MULTILINE)
    starts = [f"{s}(start={v})" for s, v in zip(states, initial, strict=True)]
    plant = f"  Plant plant({', '.join(starts)});" if starts else "  Plant plant;"
    lines = ["model Driven", plant, "equation", *drive, "end Driven;"]
    (tmp_path / "Driven.mo").write_text(text + "\n".join(lines), encoding="utf-8")
    compiled = rumoca.Session().load(str(tmp_path / "Driven.mo"), model="Driven")
    assert compiled.structure().is_balanced
    ran = compiled.simulate(t=(0.0, 1.0), dt=0.1)
    found = np.array([ran[f"plant.{name}"] for name in shows]).T
    # Our kernel takes the rate of an input from its samples, half a step late.
    late = 3e-3 if model.needs_input_rates else 3e-4
    size = np.abs(expected).max(axis=0)
    assert np.all(np.abs(found - expected) <= late * size + 1e-9)


NO_OWN_RUN = {
    "lifted_mass_with_friction": "our fixed steps do not hold a mass that sticks",
    "load_dependent_friction": "our fixed steps do not hold a mass that sticks",
    "functions": "its law jumps where the spring starts, and the mass rests there",
}


# Python, run here


def module(text: str) -> dict[str, Any]:
    namespace: dict[str, Any] = {}
    exec(compile(text, "model.py", "exec"), namespace)
    return namespace


@on_every_graph
def test_python_gives_our_rates_and_outputs(case: Case) -> None:
    known = answered(case.name)
    text = to_python_functions(known.graph)
    assert re.search(r"^(import|from) (?!math$|numpy as np$)", text, re.M) is None
    python = module(text)
    for at, answers in zip(known.points, known.answers, strict=True):
        for what, expected in zip(("rates", "outputs"), answers, strict=True):
            found, z = python[what](at.t, at.x, at.u)
            assert found == close(expected)
            assert len(z) == known.model.n_unknowns


def test_a_nonlinear_model_becomes_a_control_system_with_free_parameters() -> None:
    control = pytest.importorskip("control")
    graph = with_numbers(BY_NAME["crank_and_slider"])
    system = module(to_python_control(graph, name="crank"))["system"]
    assert isinstance(system, control.NonlinearIOSystem)
    assert (system.name, system.input_labels) == ("crank", ["torque"])
    assert (system.state_labels, system.output_labels) == (
        ["p_j", "q_crank"],
        ["theta", "push"],
    )
    time, inputs, initial = experiment(graph)
    ran = control.input_output_response(
        system, time, inputs.T, initial, solve_ivp_kwargs={"rtol": 1e-9, "atol": 1e-10}
    )
    expected = own_simulation(graph, time, inputs, initial)
    assert pytest.approx(expected, rel=1e-5, abs=1e-6) == ran.outputs.T
    heavier = graph.with_parameters({"m": 3.0})
    at = Point(0.0, initial, np.array([0.4]), np.zeros(1))
    rates, _ = own_answer(compile_model(derive(heavier)), heavier, at)
    assert system.dynamics(0.0, at.x, at.u, params={"m": 3.0}) == close(rates)


@pytest.mark.parametrize(
    "case", [c for c in CASES if c.linear], ids=lambda case: case.name
)
def test_linear_is_what_its_matrices_repeat(case: Case) -> None:
    known = answered(case.name)
    assert is_linear(known.equations)
    if known.model.needs_input_rates:
        pytest.skip("its states are shifted by the input")
    system = state_space(known.graph)
    for at, (rates, outputs) in zip(known.points, known.answers, strict=True):
        assert system.A @ at.x + system.B @ at.u == close(rates)
        assert system.C @ at.x + system.D @ at.u == close(outputs)


def test_what_is_linear() -> None:
    linear = {case.name for case in EVERY if is_linear(answered(case.name).equations)}
    assert {"rc", "two_masses_on_one_shaft", "lowerleg", "divider"} <= linear
    assert linear.isdisjoint({"quadratic_drag", "modulated_sources", "nothing_moves"})


def test_a_linear_model_becomes_matrices_for_control() -> None:
    control = pytest.importorskip("control")
    graph = with_numbers(BY_NAME["dc_motor"])
    found = module(to_python_control(graph))["system"]
    assert isinstance(found, control.StateSpace)
    assert found.state_labels == ["p_la", "p_j"]
    assert np.array_equal(found.A, state_space(graph).A)
    static = module(to_python_control(with_numbers(BY_NAME["divider"])))["system"]
    assert static.nstates == 0


# One call for all of them


@pytest.mark.parametrize(
    ("target", "files"),
    [
        (C99("pump"), ["pump.c", "pump.h"]),
        (C99(), ["rc.c", "rc.h"]),
        (C99("double"), ["double_2.c", "double_2.h"]),
        (Matlab("end"), ["end_2.m"]),
        (Modelica("Pump 1"), ["Pump_1.mo"]),
        (Latex(), ["rc.tex"]),
        (PythonControl(), ["rc.py"]),
        (PythonFunctions(), ["rc.py"]),
        (PythonModel(), ["rc.py"]),
        (Json(), ["rc.json"]),
    ],
    ids=str,
)
def test_every_target_gives_its_files(target: Target, files: list[str]) -> None:
    exported = export(with_numbers(BY_NAME["rc"]), target)
    assert [file.name for file in exported] == files
    assert all(file.text.endswith("\n") for file in exported)
    stem = files[0].partition(".")[0]
    if isinstance(target, C99):
        assert f'#include "{stem}.h"' in exported[0].text
        assert f"int {stem}_rates(" in exported[1].text
    if isinstance(target, Matlab):
        assert exported[0].text.startswith(f"function model = {stem}()")
    if isinstance(target, Modelica):
        assert exported[0].text.startswith(f"model {stem} ")


@pytest.mark.parametrize("case", EXTRA, ids=lambda case: case.name)
def test_texts_name_the_model_and_no_date(case: Case) -> None:
    graph = with_numbers(case)
    for target in (C99(), Matlab(), Modelica(), PythonControl(), Latex()):
        for file in export(graph, target):
            assert graph.name in file.text[:200]
            assert re.search(r"20\d\d-\d\d", file.text) is None
            assert export(graph, target)[0] == export(graph, target)[0]


# Units and names


@pytest.mark.parametrize(
    ("unit", "written"),
    [
        ("1", "1"), ("N*m", "N.m"), ("kg*m^2", "kg.m2"), ("m/s", "m/s"), ("", "1"),
        ("N*m*s/rad", "N.m.s/rad"), ("(N*m)/(A)", "N.m/A"), ("1/s", "1/s"),
        ("(Pa*s)/(m^3/s)", "Pa.s2/m3"), ("kg*m^2/s^2/A", "kg.m2/(s2.A)"),
        ("m*s^-1", "m/s"), ("m**3", "m3"), ("ohm", "Ohm"), ("°C", "degC"),
        ("V^0.5", ""), ("m + s", ""), ("(m", ""),
    ],
)  # fmt: skip
def test_units_as_modelica_writes_them(unit: str, written: str) -> None:
    assert modelica_unit(unit) == written


# Names, and what cannot be written


def test_names_become_words_of_ascii() -> None:
    assert identifier("θ_motor") == "theta_motor"
    assert identifier("Ω") == "Omega"
    assert identifier("Länge in µm") == "Lange_in_mum"
    assert identifier("2nd") == "x2nd"
    assert identifier("_a") == "a"
    assert identifier("***") == "x"
    assert identifier("a" * 100) == "a" * 60
    assert identifier("q_c_") == "q_c_"


def test_equal_words_are_told_apart() -> None:
    names = Identifiers({"int"})
    assert [names.new(n) for n in ("int", "θ", "theta", "int_2", "int")] == [
        "int_2", "theta", "theta_2", "int_2_2", "int_3",
    ]  # fmt: skip


@pytest.mark.parametrize("write", [to_c99, to_matlab, to_modelica, to_python_functions])
def test_a_law_without_a_number_form_is_refused(write: Callable[..., object]) -> None:
    g = BondGraph("zeta")
    g.one("at", Se("u"), I("m"), R("r", law=sympy.gamma(f + 2)))
    with pytest.raises(EquationError, match="gamma has no number form"):
        write(g.finish())


def test_many_unknowns_are_refused_in_c() -> None:
    g = BondGraph("many")
    g.one("shaft", Se("u"), *(I(f"m{i}") for i in range(103)))
    g.measure("inner", effort="m7")
    with pytest.raises(EquationError, match="algebraic unknowns"):
        to_c99(g.finish())


# On the command line


def exported(form: str, *words: object) -> Result:
    command = ["export", "flegx_models.demo:drive", "--to", form, *map(str, words)]
    return CliRunner().invoke(program, command)


def test_the_file_named_on_the_command_line_names_the_program(tmp_path: Path) -> None:
    result = exported("c", "-o", tmp_path / "drive.c", "--json", tmp_path / "j.json")
    assert (result.exit_code, result.output) == (0, "")
    assert "int drive_rates(" in (tmp_path / "drive.h").read_text()
    files = json.loads((tmp_path / "j.json").read_text())["files"]
    assert files["drive.c"] == (tmp_path / "drive.c").read_text()


@needs_gcc
def test_one_text_on_stdout_compiles_alone(tmp_path: Path) -> None:
    (tmp_path / "all.c").write_text(exported("c").output, encoding="utf-8")
    gcc("-c", tmp_path / "all.c", "-o", tmp_path / "all.o")


def test_a_folder_that_is_not_there_is_one_line() -> None:
    result = exported("modelica", "-o", "/nowhere/drive.mo")
    assert result.exit_code == 2
    assert "'/nowhere/drive.mo' cannot be written" in result.output
    assert result.output.count("\n") == 1


def test_python_control_is_still_a_word() -> None:
    assert exported("python-control").output == exported("control").output
