"""Sparse Jacobians: exact, sparse, cheap at any size, and refused at a kink."""

import numpy as np
import pytest
import sympy
from catalogue import CASES

from bondgraph import BondGraph, C, FinishedGraph, I, R, Se, derive, f, linearise, q
from bondgraph.errors import EquationError
from bondgraph.numeric.jacobian import jacobian, point, settled, slopes
from bondgraph.numeric.model import compile_model, evaluate
from bondgraph.numeric.state_space import (
    sparse_from_equations,
    sparse_state_space,
    state_space,
)

STIFF, CUBIC, SLIP, DRAG = sympy.symbols("stiff cubic slip drag")


def chain(stages: int, *, nonlinear: bool = False) -> FinishedGraph:
    graph = BondGraph("chain")
    for k in range(stages):
        law = DRAG * sympy.tanh(f / SLIP) if nonlinear else None
        graph.one(f"m{k}", I(f"mass{k}"), R(f"b{k}", law=law))
        if k:
            law = STIFF * q + CUBIC * q**3 if nonlinear else None
            graph.zero(f"s{k}", C(f"c{k}", law=law))
            graph.join(f"m{k - 1}", f"s{k}")
            graph.join(f"s{k}", f"m{k}")
    graph.put(Se("force"), on="m0")
    graph.measure("v", flow=f"m{stages - 1}")
    graph.measure("sum", sympy.Add(*(sympy.Symbol(f"mass{k}") for k in range(2))))
    finished = graph.finish()
    draw = np.random.default_rng(3)
    return finished.with_parameters(
        {name: draw.uniform(0.5, 2.0) for name in finished.parameters}
    )


def values_in_order(graph: FinishedGraph) -> np.ndarray:
    return np.array(list(graph.parameters.values_by_name().values()))


def test_the_sparse_jacobian_is_that_of_the_dense_tangents() -> None:
    graph = chain(12, nonlinear=True)
    model = compile_model(derive(graph))
    x = np.random.default_rng(1).normal(size=model.n_states)
    p, u = values_in_order(graph), np.array([0.4])
    found = jacobian(model, x, u, p)
    directions = np.zeros((model.dynamics.n_variables, model.n_states))
    directions[: model.n_states] = np.eye(model.n_states)
    variables = point(model, x, u, p).variables
    _, tangents = evaluate(model.dynamics, variables, directions)
    assert found.toarray() == pytest.approx(tangents, rel=1e-14, abs=1e-14)
    assert found.nnz < 5 * model.n_states


@pytest.mark.parametrize("case", CASES, ids=lambda c: c.name)
def test_partial_derivatives_are_those_of_finite_differences(case) -> None:
    graph = case.graph()
    names = list(graph.parameters)
    graph = graph.with_parameters({n: 1.0 + 0.1 * i for i, n in enumerate(names)})
    equations = derive(graph)
    model = compile_model(equations)
    draw = np.random.default_rng(5)
    x, u = draw.uniform(0.2, 0.9, model.n_states), draw.uniform(0.2, 0.9, 3)
    here = point(model, x, u[: len(model.input_names)], values_in_order(graph), t=0.3)
    here = settled(model, here)
    found = slopes(model, here).eliminated()[0].toarray()
    step = 1e-6
    for j in range(model.n_states):
        ends = []
        for sign in (1, -1):
            moved = x.copy()
            moved[j] += sign * step
            at = point(model, moved, here.u, here.p, t=0.3)
            ends.append(settled(model, at).rates)
        slope = (ends[0] - ends[1]) / (2 * step)
        assert found[:, j] == pytest.approx(slope, rel=2e-5, abs=1e-6)


def test_sparse_and_dense_systems_and_the_symbolic_one_agree() -> None:
    graph = chain(5)
    values = graph.parameters.values_by_name()
    thin, dense = sparse_state_space(graph), state_space(graph)
    put = {sympy.Symbol(n, real=True): v for n, v in values.items()}
    symbolic = linearise(derive(graph))
    for letter in "ABCD":
        known = np.array(getattr(symbolic, letter).xreplace(put), dtype=float)
        assert getattr(dense, letter) == pytest.approx(known, rel=1e-13)
        assert getattr(thin, letter).toarray().tolist() == (
            getattr(dense, letter).tolist()
        )
    omega = np.array([0.2, 1.7])
    assert thin.response(omega) == pytest.approx(dense.response(omega), rel=1e-11)


def star(arms: int) -> FinishedGraph:
    graph = BondGraph("star")
    graph.one("hub", Se("force"), I("hub_mass"))
    for k in range(arms):
        graph.put(C(f"c{k}", law=STIFF * q), on="hub")
    graph.measure("v", flow="hub")
    finished = graph.finish()
    return finished.with_parameters(dict.fromkeys(finished.parameters, 2.0))


def test_one_full_row_makes_nothing_else_full() -> None:
    # All columns meet in the hub's row, so no two of them could share a tangent.
    graph = star(150)
    A = sparse_state_space(graph).A
    assert A.nnz == 2 * 150
    row = A[[graph_state(graph, "p_hub_mass")], :].toarray()
    assert row.sum() == pytest.approx(-300.0)


def graph_state(graph: FinishedGraph, name: str) -> int:
    return [s.symbol.name for s in derive(graph).states].index(name)


@pytest.mark.parametrize("nonlinear", [False, True], ids=["linear", "nonlinear"])
def test_a_long_chain_has_a_few_numbers_in_each_row(nonlinear: bool) -> None:
    graph = chain(300, nonlinear=nonlinear)
    values = graph.parameters.values_by_name()
    system = sparse_from_equations(derive(graph), values)
    assert len(system.states) == 599
    assert system.A.nnz < 5 * 599


def test_too_many_states_for_dense_matrices_are_refused() -> None:
    system = sparse_state_space(chain(3))
    many = type(system)(
        **{
            name: getattr(system, name) for name in system.__slots__ if name != "states"
        },
        states=tuple(map(str, range(10**4))),
    )
    with pytest.raises(EquationError, match=r"would not fit.*sparse_state_space"):
        many.dense()


SMOOTH = {
    "drag": (f * sympy.Abs(f), 0.0),
    "square with a sign": (f**2 * sympy.sign(f), 0.0),
    "two branches, one slope": (
        sympy.Piecewise((DRAG * f, f < 0), (DRAG * f + f**2, True)),
        2.0,
    ),
    "larger of two that touch": (sympy.Max(DRAG * f, DRAG * f + f**3), 2.0),
}
KINKED = {
    "absolute value": DRAG * sympy.Abs(f),
    "Coulomb": DRAG * sympy.sign(f),
    "absolute value in disguise": DRAG * f * sympy.sign(f),
    "larger of two": sympy.Max(DRAG * f, 2 * DRAG * f),
    "two slopes": sympy.Piecewise((DRAG * f, f < 0), (2 * DRAG * f, True)),
    "a jump": sympy.Piecewise((-DRAG, f < 0), (DRAG, True)),
    "a vertical start": sympy.sign(f) * sympy.sqrt(sympy.Abs(f)),
}


def cart(law: sympy.Expr) -> FinishedGraph:
    graph = BondGraph("cart")
    graph.one("cart", Se("force"), I("m"), R("guide", law=law))
    graph.measure("v", flow="cart")
    finished = graph.finish()
    values = {"m": 1.0, "drag": 2.0}
    return finished.with_parameters({n: values[n] for n in finished.parameters})


@pytest.mark.parametrize("name", SMOOTH)
def test_a_law_with_one_slope_at_its_switch_is_linearised(name: str) -> None:
    law, slope = SMOOTH[name]
    graph = cart(law)
    assert state_space(graph).A[0, 0] == pytest.approx(-slope)
    symbolic = linearise(derive(graph)).A[0, 0]
    put = {sympy.Symbol("m", real=True): 1.0, sympy.Symbol("drag", real=True): 2.0}
    assert float(symbolic.xreplace(put)) == pytest.approx(-slope)


@pytest.mark.parametrize("name", KINKED)
def test_a_law_with_two_slopes_at_its_switch_is_refused(name: str) -> None:
    graph = cart(KINKED[name])
    with pytest.raises(EquationError, match="no linear form at this operating point"):
        state_space(graph)
    with pytest.raises(EquationError, match="no linear form at this operating point"):
        linearise(derive(graph))
    # Away from the switch there is nothing to refuse.
    assert np.isfinite(state_space(graph, at={"p_m": 0.5}).A).all()
    assert linearise(derive(graph), {"p_m": 0.5}).A is not None


def test_kinks_that_only_some_directions_see_are_refused() -> None:
    # |x| sign(y) is linear along x = y: both rays of one line agree.
    graph = BondGraph("two carts")
    for k in (1, 2):
        graph.one(f"cart{k}", Se(f"force{k}"), I(f"m{k}"))
    from bondgraph import flow  # noqa: PLC0415

    law = sympy.Abs(f) * sympy.sign(flow("cart2"))
    graph.put(R("odd", law=law), on="cart1")
    graph.measure("v", flow="cart1")
    finished = graph.finish().with_parameters({"m1": 1.0, "m2": 1.0})
    with pytest.raises(EquationError, match="no linear form"):
        state_space(finished)
    with pytest.raises(EquationError, match="no linear form"):
        linearise(derive(finished))
