"""The implicit route against the causal one, against hand-made numbers, and at size."""

from collections.abc import Mapping
from dataclasses import replace
from operator import attrgetter

import numpy as np
import pytest
import sympy
from catalogue import CASES, FIELDS, Case, random_graph, somewhere
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from bondgraph import (
    TF,
    BondGraph,
    C,
    FinishedGraph,
    Hold,
    I,
    R,
    Sdirk2,
    Sdirk3,
    Se,
    Sf,
    derive,
    e,
    f,
    q,
    state_space,
)
from bondgraph.errors import (
    BondGraphError,
    CausalConflictError,
    EquationError,
    StructureError,
)
from bondgraph.numeric.implicit.matrices import (
    ImplicitStateSpace,
    implicit_state_space,
)
from bondgraph.numeric.implicit.points import solve_at
from bondgraph.numeric.implicit.system import implicit_system
from bondgraph.numeric.jacobian import point, settled
from bondgraph.numeric.model import compile_model, evaluate
from bondgraph.simulation.sparse import SparseStatus, simulate_sparse

every_case = pytest.mark.parametrize("case", CASES + FIELDS, ids=attrgetter("name"))
TIME = 0.37


def with_numbers(graph: FinishedGraph) -> FinishedGraph:
    values = somewhere({sympy.Symbol(name) for name in graph.parameters})
    return graph.with_parameters({str(x): value for x, value in values.items()})


def generic(names: list[str]) -> dict[str, float]:
    found = somewhere({sympy.Symbol(name) for name in names})
    return {str(x): value for x, value in found.items()}


def four(system: ImplicitStateSpace) -> list[np.ndarray]:
    """Return A, B, C, D with the states x - B_rate u, as `StateSpace` has them."""
    A, rate, read = (m.toarray() for m in (system.A, system.B_rate, system.C))
    return [A, system.B.toarray() + A @ rate, read, system.D.toarray() + read @ rate]


def assert_close(found: np.ndarray, expected: np.ndarray) -> None:
    scale = 1.0 + np.max(np.abs(expected), initial=0.0)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * scale)


# Agreement with the causal route --------------------------------------------------


@every_case
def test_rates_and_outputs_are_those_of_the_causal_route(case: Case) -> None:
    graph = with_numbers(case.graph())
    equations = derive(graph)
    states = [s.symbol.name for s in equations.states]
    inputs = [u.name for u in equations.inputs]
    at = generic(states + inputs)
    moving = {name: 0.3 + 0.1 * j for j, name in enumerate(inputs)}
    model = compile_model(equations)
    values = graph.parameters.values_by_name()
    x, u, p = (
        np.array([source[name] for name in names])
        for source, names in (
            (at, states),
            (at, inputs),
            (values, model.parameter_names),
        )
    )
    start = point(model, x, u, p, t=TIME)
    start = replace(start, input_rates=np.array([moving[name] for name in inputs]))
    causal = settled(model, start)
    empty = np.zeros((len(causal.variables), 0))
    outputs = evaluate(model.output, causal.variables, empty)[0]
    for merged in (True, False):
        system = implicit_system(graph, merged=merged)
        here = solve_at(system, {**at, "t": TIME}, input_rates=moving)
        independent = here.reduction.independent
        assert [system.state_names[i] for i in independent] == states
        assert_close(here.rates[independent], causal.rates)
        assert_close(system.outputs(here.z, TIME), outputs)


@every_case
def test_linear_forms_are_those_of_the_causal_route(case: Case) -> None:
    graph = with_numbers(case.graph())
    equations = derive(graph)
    names = [s.symbol.name for s in equations.states]
    names += [u.name for u in equations.inputs]
    at = {**generic(names), "t": TIME}
    found = implicit_state_space(graph, at=at)
    if found.D_rate.nnz:
        with pytest.raises(EquationError, match="improper"):
            state_space(graph, at=at)
        return
    expected = state_space(graph, at=at)
    assert found.states == expected.states
    assert found.state_units == expected.state_units
    assert (found.inputs, found.outputs) == (expected.inputs, expected.outputs)
    for mine, theirs in zip(
        four(found), (expected.A, expected.B, expected.C, expected.D), strict=True
    ):
        assert_close(mine, theirs)


@pytest.mark.parametrize("start", range(140, 300, 20))
def test_random_graphs_agree_or_are_refused_by_both(start: int) -> None:
    compared = 0
    for seed in range(start, start + 20):
        try:
            graph = with_numbers(random_graph(seed).finish())
        except StructureError:
            continue  # a junction without a bond
        compared += compare_or_refuse(graph)
    assert compared > 3


HIGHER_INDEX = "random 212"
"""An inertance that follows another dependent one: only the implicit route goes on."""


def compare_or_refuse(graph: FinishedGraph) -> bool:
    """Compare the two routes; return whether both answered."""
    try:
        equations = derive(graph)
    except (CausalConflictError, EquationError):
        if graph.name != HIGHER_INDEX:
            with pytest.raises(EquationError):
                implicit_state_space(graph)
        return False
    found = implicit_state_space(graph)
    if not (equations.states or equations.inputs):
        assert found.states == ()
        return False
    if found.D_rate.nnz:
        with pytest.raises(EquationError, match="improper"):
            state_space(graph)
        return False
    expected = state_space(graph)
    assert found.states == expected.states
    for mine, theirs in zip(
        four(found), (expected.A, expected.B, expected.C, expected.D), strict=True
    ):
        assert_close(mine, theirs)
    return True


def test_the_full_system_has_an_effort_and_a_flow_per_bond() -> None:
    graph = with_numbers(CASES[0].graph())
    system = implicit_system(graph, merged=False)
    bonds, storages = len(graph.bonds), 1
    assert system.constant.shape == (2 * bonds, 2 * bonds + storages)


# Refusals -------------------------------------------------------------------------


def refused(graph: BondGraph, values: Mapping[str, float] | None = None) -> str:
    with pytest.raises(EquationError) as caught:
        implicit_state_space(graph.finish().with_parameters(values or {}))
    return str(caught.value)


def test_conflicting_sources_are_named() -> None:
    graph = BondGraph("two supplies")
    graph.zero("rail", Se("battery"), Se("mains"), R("lamp"))
    said = refused(graph, {"lamp": 2.0})
    assert "Se 'battery', Se 'mains'" in said
    assert "contradict" in said


def test_what_a_ring_of_junctions_leaves_open_is_named() -> None:
    graph = BondGraph("ring")
    graph.zero("left", Se("u"), R("r"))
    graph.zero("right", C("c"))
    graph.join("left", "right")
    graph.join("left", "right")
    with pytest.raises(BondGraphError, match="right"):
        implicit_state_space(graph.finish().with_parameters({"r": 1.0, "c": 1.0}))


def twin_gears(second: float) -> FinishedGraph:
    graph = BondGraph("twin gears")
    graph.one("left", Se("torque"), I("j1"), R("b1"))
    graph.one("right", I("j2"), R("b2"))
    graph.join("left", TF("k1"), "right")
    graph.join("left", TF("k2"), "right")
    graph.measure("w", flow="left")
    values = {"j1": 1.0, "j2": 2.0, "b1": 0.5, "b2": 0.25, "k1": 3.0, "k2": second}
    return graph.finish().with_parameters(values)


def test_two_gears_of_one_ratio_are_singular_only_at_these_numbers() -> None:
    with pytest.raises(EquationError, match="does not determine"):
        implicit_state_space(twin_gears(3.0))
    # Of different ratios they hold each other still.
    locked = implicit_state_space(twin_gears(4.0))
    assert locked.states == ()
    assert locked.dependent == ("p_j1", "p_j2")
    assert locked.D.toarray() == pytest.approx(0.0)


def test_a_kink_at_the_operating_point_is_refused_and_a_bend_is_not() -> None:
    graph = BondGraph("rubbing")
    rub = R("rub", law=sympy.Symbol("fc") * sympy.sign(f) + sympy.Symbol("c") * f**2)
    graph.one("mass", Se("force"), I("m"), rub)
    finished = graph.finish().with_parameters({"fc": 1.0, "c": 2.0, "m": 1.0})
    with pytest.raises(EquationError, match="law of rub"):
        implicit_state_space(finished)
    moving = implicit_state_space(finished, at={"p_m": 0.5})
    assert moving.A.toarray() == pytest.approx(np.array([[-2.0]]))
    smooth = finished.with_parameters({"fc": 0.0})
    assert implicit_state_space(smooth).A.toarray() == pytest.approx(np.zeros((1, 1)))


def test_unknown_names_and_missing_values_are_refused() -> None:
    graph = spring_chain(2)
    with pytest.raises(EquationError, match="no state or input 'p_m9'"):
        implicit_state_space(graph, at={"p_m9": 1.0})
    with pytest.raises(EquationError, match="no input 'puII'"):
        simulate_sparse(graph, [0.0, 1.0], inputs={"puII": 1.0})
    with pytest.raises(EquationError, match="3 samples"):
        simulate_sparse(graph, [0.0, 1.0, 2.0], inputs={"pull": [1.0, 2.0]})
    with pytest.raises(EquationError, match="do not increase"):
        simulate_sparse(graph, [0.0, 1.0, 1.0])


# Size -----------------------------------------------------------------------------


def spring_chain(masses: int, *, nonlinear: bool = False) -> FinishedGraph:
    """Return masses in a row, each joined to the next by a spring and a damper."""
    graph = BondGraph("chain")
    for i in range(masses):
        graph.one(f"mass{i}", I(f"m{i}"))
        graph.zero(f"link{i}")
        spring, damper = C(f"c{i}"), R(f"b{i}")
        if nonlinear:
            k, k3, fc = sympy.symbols(f"k{i} k3_{i} fc{i}")
            spring = C(f"c{i}", law=k * q + k3 * q**3)
            damper = R(f"b{i}", law=fc * sympy.tanh(f / 0.1))
        graph.one(f"spring{i}", spring, damper)
        graph.join(f"link{i}", f"spring{i}")
        graph.join(f"mass{i}", f"link{i}")
        if i:
            graph.join(f"link{i - 1}", f"mass{i}")
    graph.put(Se("pull"), on="mass0")
    graph.one("wall", R("anchor"))
    graph.join(f"link{masses - 1}", "wall")
    graph.measure("speed", flow="mass0")
    finished = graph.finish()
    names = sorted(finished.parameters)
    return finished.with_parameters(
        {name: 0.5 + (0.37 * i) % 1.0 for i, name in enumerate(names)}
    )


def chain_matrix(graph: FinishedGraph, masses: int) -> np.ndarray:
    """Return A of the chain from Newton's law, states p0 q0 p1 q1 …"""
    v = graph.parameters.values_by_name()
    A = np.zeros((2 * masses, 2 * masses))

    def push(row: int, spring: int, sign: float) -> None:
        A[row, 2 * spring + 1] += sign / v[f"c{spring}"]
        A[row, 2 * spring] += sign * v[f"b{spring}"] / v[f"m{spring}"]
        if spring + 1 < masses:
            next_speed = v[f"b{spring}"] / v[f"m{spring + 1}"]
            A[row, 2 * spring + 2] -= sign * next_speed

    for i in range(masses):
        push(2 * i, i, -1.0)
        if i:
            push(2 * i, i - 1, 1.0)
        A[2 * i + 1, 2 * i] = 1.0 / v[f"m{i}"]
        if i + 1 < masses:
            A[2 * i + 1, 2 * i + 2] = -1.0 / v[f"m{i + 1}"]
    return A


def test_a_chain_has_the_matrix_that_newton_gives() -> None:
    graph = spring_chain(6)
    graph = graph.with_parameters({"anchor": 1e9})
    found = implicit_state_space(graph)
    assert found.states == tuple(f"{x}{i}" for i in range(6) for x in ("p_m", "q_c"))
    A = found.A.toarray()
    expected = chain_matrix(graph, 6)
    np.testing.assert_allclose(A, expected, rtol=1e-7, atol=1e-7)


def test_a_thousand_stages_have_a_few_numbers_in_each_row() -> None:
    system = implicit_state_space(spring_chain(1000))
    assert system.A.shape == (2000, 2000)
    assert system.A.nnz < 8 * 2000


def test_a_large_algebraic_loop_is_factorised_sparsely() -> None:
    stages = 60
    graph = BondGraph("mesh")
    graph.one("r0", Se("u"), R("series0"))
    for k in range(stages):
        graph.zero(f"n{k}", R(f"shunt{k}"))
        graph.join(f"r{k}", f"n{k}")
        graph.one(f"r{k + 1}", R(f"series{k + 1}"))
        graph.join(f"n{k}", f"r{k + 1}")
    graph.measure("i", flow="r0")
    finished = with_numbers(graph.finish())
    v = finished.parameters.values_by_name()
    resistance = v[f"series{stages}"]
    for k in reversed(range(stages)):
        beside = 1.0 / (1.0 / v[f"shunt{k}"] + 1.0 / resistance)
        resistance = v[f"series{k}"] + beside
    found = implicit_state_space(finished)
    assert found.D.toarray() == pytest.approx(1.0 / resistance, rel=1e-12)


def test_equal_laws_are_one_group_with_exact_partials() -> None:
    system = implicit_system(spring_chain(50, nonlinear=True))
    assert sorted(len(group.rows) for group in system.laws) == [50, 50]
    z = np.random.default_rng(1).normal(size=system.constant.shape[1])
    way = np.random.default_rng(2).normal(size=len(z))
    u, h = np.array([0.4]), 1e-6
    slope = (system.residual(z + h * way, u) - system.residual(z - h * way, u)) / (
        2.0 * h
    )
    assert system.jacobian(z) @ way == pytest.approx(slope, rel=1e-6, abs=1e-6)


# Simulation -----------------------------------------------------------------------


def test_a_linear_run_converges_to_the_exact_one_with_the_methods_order() -> None:
    graph = spring_chain(4)
    model = state_space(graph)
    # A constant input from rest: x(t) = A⁻¹ (exp(A t) - 1) B u.
    n, end = len(model.states), 3.0
    large = np.zeros((n + 1, n + 1))
    large[:n, :n], large[:n, n:] = model.A * end, model.B * end
    exact = float((model.C @ expm(large)[:n, n:])[0, 0])
    errors = []
    for solver, order in ((Sdirk2(), 2), (Sdirk3(), 3)):
        for steps in (200, 400):
            times = np.linspace(0.0, end, steps + 1)
            run = simulate_sparse(graph, times, inputs={"pull": 1.0}, solver=solver)
            assert run.status is SparseStatus.SUCCESSFUL
            assert run.factorisations == 1
            errors.append(abs(run.output("speed")[-1] - exact))
        assert errors[-2] / errors[-1] == pytest.approx(2.0**order, rel=0.15)


def test_substeps_and_a_held_input_do_what_they_say() -> None:
    graph = spring_chain(3)
    times = np.linspace(0.0, 2.0, 41)
    wave = np.sin(3.0 * times)
    fine = np.linspace(0.0, 2.0, 81)
    between = np.interp(fine, times, wave)
    coarse = simulate_sparse(
        graph, times, inputs={"pull": wave}, solver=Sdirk2(substeps=2)
    )
    same = simulate_sparse(graph, fine, inputs={"pull": between})
    assert coarse.output("speed") == pytest.approx(same.output("speed")[::2], abs=1e-12)
    held = simulate_sparse(graph, times, inputs={"pull": wave}, hold=Hold.ZERO)
    steps = np.repeat(wave, 100)[: 40 * 100 + 1]
    finer = simulate_sparse(
        graph,
        np.linspace(0.0, 2.0, 40 * 100 + 1),
        inputs={"pull": steps},
        hold=Hold.ZERO,
    )
    assert held.output("speed") == pytest.approx(finer.output("speed")[::100], abs=2e-3)


def test_a_nonlinear_run_agrees_with_newton_and_scipy() -> None:
    graph = spring_chain(3, nonlinear=True)
    v = graph.parameters.values_by_name()

    def newton(t: float, x: np.ndarray) -> np.ndarray:
        p, stretch = x[:3], x[3:]
        speed = p / [v["m0"], v["m1"], v["m2"]]

        def force(i: int, rate: float) -> float:
            law = v[f"k{i}"] * stretch[i] + v[f"k3_{i}"] * stretch[i] ** 3
            return law + v[f"fc{i}"] * np.tanh(rate / 0.1)

        # At the far end the spring and the wall's damper carry one force.
        low, high = -100.0, 100.0
        for _ in range(80):
            wall = 0.5 * (low + high)
            rest = force(2, speed[2] - wall) - v["anchor"] * wall
            low, high = (wall, high) if rest > 0 else (low, wall)
        rates = np.array([speed[0] - speed[1], speed[1] - speed[2], speed[2] - wall])
        forces = [force(i, rates[i]) for i in range(3)]
        push = np.array(
            [np.sin(2.0 * t) - forces[0], forces[0] - forces[1], forces[1] - forces[2]]
        )
        return np.concatenate([push, rates])

    times = np.linspace(0.0, 3.0, 1501)
    expected = solve_ivp(
        newton, (0.0, 3.0), np.zeros(6), method="LSODA", rtol=1e-9, atol=1e-11
    )
    run = simulate_sparse(
        graph, times, inputs={"pull": np.sin(2.0 * times)}, keep_states=True
    )
    assert run.state_names == ("p_m0", "q_c0", "p_m1", "q_c1", "p_m2", "q_c2")
    assert run.states[-1][[0, 2, 4, 1, 3, 5]] == pytest.approx(
        expected.y[:, -1], rel=2e-4, abs=1e-5
    )
    assert run.factorisations < run.iterations


@pytest.mark.parametrize("nonlinear", [False, True])
def test_the_energy_audit_closes_with_the_square_of_the_step(nonlinear: bool) -> None:
    graph = spring_chain(5, nonlinear=nonlinear)
    left = []
    for steps in (400, 800):
        times = np.linspace(0.0, 4.0, steps + 1)
        run = simulate_sparse(graph, times, inputs={"pull": np.sin(2.0 * times)})
        audit = run.audit
        assert audit.dissipated > 0.0
        assert audit.supplied == pytest.approx(
            audit.stored + audit.dissipated, rel=1e-3
        )
        left.append(audit.relative)
    assert left[0] > left[1] > 0.0
    assert left[0] / left[1] > 3.0


def test_dependent_storages_and_algebraic_loops_need_nothing_special() -> None:
    graph = BondGraph("drive")
    graph.one("fast", Se("torque"), I("j1"), R("b1"))
    graph.one("slow", I("j2"), R("b2"))
    graph.join("fast", TF("n"), "slow")
    graph.measure("w", flow="fast")
    values = {"j1": 1.0, "j2": 6.0, "b1": 0.5, "b2": 1.0, "n": 2.0}
    finished = graph.finish().with_parameters(values)
    model = state_space(finished)
    times = np.linspace(0.0, 4.0, 801)
    run = simulate_sparse(finished, times, inputs={"torque": 1.0})
    pole, gain = model.A[0, 0], (model.C @ model.B)[0, 0]
    exact = gain * (np.exp(pole * times) - 1.0) / pole
    assert run.output("w") == pytest.approx(exact, abs=1e-5)


def test_an_implicit_nonlinear_loop_is_solved_at_every_step() -> None:
    i0, vt = sympy.symbols("i0 vt")
    graph = BondGraph("rectifier")
    diode = R("diode", law=i0 * (sympy.exp(e / vt) - 1))
    graph.one("loop", Se("u"), diode, R("r"), C("c"))
    graph.measure("v", effort="c")
    graph.measure("i", flow="loop")
    values = {"i0": 1e-3, "vt": 0.05, "r": 2.0, "c": 0.5}
    finished = graph.finish().with_parameters(values)
    times = np.linspace(0.0, 5.0, 1001)
    run = simulate_sparse(finished, times, inputs={"u": np.sin(2.0 * times)})
    current, voltage = run.output("i"), run.output("v")
    drop = np.sin(2.0 * times) - voltage - 2.0 * current
    assert current == pytest.approx(1e-3 * (np.exp(drop / 0.05) - 1.0), abs=1e-7)
    assert np.diff(voltage) == pytest.approx(
        np.diff(times) * 0.5 * (current[1:] + current[:-1]) / 0.5, abs=2e-5
    )


def test_a_run_without_solution_says_how_far_it_came() -> None:
    graph = BondGraph("breaking")
    graph.one("loop", Sf("i"), R("limited", law=sympy.sqrt(1 - f**2)))
    graph.measure("v", effort="limited")
    times = np.linspace(0.0, 1.0, 11)
    run = simulate_sparse(graph.finish(), times, inputs={"i": 2.1 * times})
    assert run.status is SparseStatus.NOT_CONVERGED
    assert run.reached == pytest.approx(0.4)
    assert np.isfinite(run.outputs[:5]).all()
    assert np.isnan(run.outputs[5:]).all()
