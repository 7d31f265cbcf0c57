"""Linear systems: right transfer functions, and agreement with an independent solve.

The independent route knows nothing of causality: one effort and one flow per bond, the
raw equation of every node, and one dense solve per frequency.
"""

from operator import attrgetter

import numpy as np
import pytest
import sympy
from catalogue import CASES, Case, agree, expression, random_graph, somewhere

from bondgraph import (
    BondGraph,
    C,
    FinishedGraph,
    I,
    R,
    Se,
    Sf,
    derive,
    displacement,
    effort,
    f,
    flow,
    linearise,
    q,
)
from bondgraph.equations.transfer.transfer_function import s
from bondgraph.errors import (
    CausalConflictError,
    EquationError,
    ParameterError,
    StructureError,
)
from bondgraph.numeric.state_space import (
    from_equations,
    state_space,
    to_control,
    transfer_function_to_control,
)
from bondgraph.structure import elements as kinds
from bondgraph.structure.signals import Signal

linear_cases = pytest.mark.parametrize(
    "case", [c for c in CASES if c.linear], ids=attrgetter("name")
)


def with_numbers(graph: FinishedGraph) -> FinishedGraph:
    symbols = {sympy.Symbol(name, real=True) for name in graph.parameters}
    values = {x.name: v for x, v in somewhere(symbols).items()}
    return graph.with_parameters(values)


@linear_cases
def test_transfer_functions_are_those_derived_by_hand(case: Case) -> None:
    system = linearise(derive(case.graph()))
    for (output, source), text in case.transfers.items():
        found = system.transfer_function(output, source)
        assert agree(found.expression, expression(text)), found
        assert agree(found.textbook, expression(text)), found


# The independent route ------------------------------------------------------------


Terms = dict[int, complex]


def raw_response(graph: FinishedGraph, frequency: complex) -> np.ndarray:
    """Return outputs over inputs at s = `frequency` from the raw equations."""
    size = len(graph.bonds)
    inputs = [source.name for source in graph.inputs]
    equations: list[tuple[Terms, str | None]] = []
    for node in graph.nodes:
        at = [i for i, b in enumerate(graph.bonds) if node.name in (b.tail, b.head)]
        if isinstance(node, kinds.EffortSource | kinds.FlowSource):
            offset = size if isinstance(node, kinds.FlowSource) else 0
            equations.append(({offset + at[0]: 1.0}, node.name))
        elif isinstance(node, kinds.OneJunction | kinds.ZeroJunction):
            equations += [(row, None) for row in junction_rows(graph, node, at)]
        else:
            equations += [(row, None) for row in law_rows(graph, node, at, frequency)]
    matrix = np.zeros((2 * size, 2 * size), complex)
    right = np.zeros((2 * size, len(inputs)))
    for i, (terms, source) in enumerate(equations):
        for column, value in terms.items():
            matrix[i, column] += value
        right[i] = [name == source for name in inputs]
    if np.linalg.cond(matrix) > 1e12:
        raise np.linalg.LinAlgError("the raw equations are singular")
    solution = np.linalg.solve(matrix, right)
    reads = [read(graph, m.expression, frequency) for m in graph.measurements]
    return np.array([solution[column] / power for column, power in reads])


def junction_rows(
    graph: FinishedGraph, node: kinds.Junction, at: list[int]
) -> list[Terms]:
    size = len(graph.bonds)
    common = size if isinstance(node, kinds.OneJunction) else 0
    rows: list[Terms] = [{common + at[0]: 1.0, common + i: -1.0} for i in at[1:]]
    signs = {i: 1.0 if graph.bonds[i].head == node.name else -1.0 for i in at}
    return [*rows, {size - common + i: sign for i, sign in signs.items()}]


def law_rows(
    graph: FinishedGraph, node: kinds.Node, at: list[int], frequency: complex
) -> list[Terms]:
    size = len(graph.bonds)
    values = graph.parameters.values_by_name()
    put = {sympy.Symbol(n, real=True): v for n, v in values.items()}
    effort_a, flow_a = at[0], size + at[0]
    effort_b, flow_b = at[-1], size + at[-1]
    if isinstance(node, kinds.Transformer):
        modulus = float(node.modulus.xreplace(put))
        return [{effort_b: 1.0, effort_a: -modulus}, {flow_a: 1.0, flow_b: -modulus}]
    if isinstance(node, kinds.Gyrator):
        modulus = float(node.modulus.xreplace(put))
        return [{effort_b: 1.0, flow_a: -modulus}, {effort_a: 1.0, flow_b: -modulus}]
    assert isinstance(node, kinds.Inertance | kinds.Compliance | kinds.Resistance)
    relation = node.relation
    slope = float(relation.expression.diff(relation.argument).xreplace(put))
    # p is e/s and q is f/s, so every law is a ratio of effort and flow.
    columns = {
        "e": (effort_a, 1.0),
        "f": (flow_a, 1.0),
        "p": (effort_a, 1 / frequency),
        "q": (flow_a, 1 / frequency),
    }
    (out, left), (argument, right) = (
        columns[str(x)] for x in (relation.output, relation.argument)
    )
    return [{out: left, argument: -slope * right}]


def read(
    graph: FinishedGraph, signal: sympy.Expr, frequency: complex
) -> tuple[int, complex]:
    assert isinstance(signal, Signal)
    bond = next(
        i for i, b in enumerate(graph.bonds) if signal.place in (b.tail, b.head)
    )
    effort = signal.quantity in ("effort", "momentum")
    power = frequency if signal.quantity in ("momentum", "displacement") else 1.0
    return (bond if effort else len(graph.bonds) + bond), power


@linear_cases
def test_matrices_agree_with_the_raw_equations(case: Case) -> None:
    graph = with_numbers(case.graph())
    values = graph.parameters.values_by_name()
    system = linearise(derive(graph))
    for frequency in (0.7 + 0.3j, 0.2 + 2.1j):
        expected = raw_response(graph, frequency)
        for i, output in enumerate(system.outputs):
            for j, source in enumerate(system.inputs):
                transfer = system.transfer_function(output, source)
                top, bottom = transfer.coefficients(values)
                found = np.polyval(top, frequency) / np.polyval(bottom, frequency)
                assert found == pytest.approx(expected[i, j], rel=1e-9)


@linear_cases
def test_numeric_and_symbolic_routes_agree(case: Case) -> None:
    graph = with_numbers(case.graph())
    symbolic = linearise(derive(graph))
    if symbolic.D_rate.todok():
        with pytest.raises(EquationError, match="follows the rate of the input"):
            state_space(graph)
        return
    omega = np.array([0.3, 1.1])
    response = state_space(graph).response(omega)
    for k, w in enumerate(omega):
        assert response[k] == pytest.approx(raw_response(graph, 1j * w), rel=1e-9)


def ladder(stages: int, rungs: tuple[str, ...] = ("b", "mass", "spring")) -> BondGraph:
    b, mass, spring = rungs
    graph = BondGraph("ladder")
    graph.one("m0", Se("force"), I(f"{mass}0"), R(f"{b}0"))
    for k in range(1, stages):
        graph.one(f"m{k}", I(f"{mass}{k}"), R(f"{b}{k}"))
        graph.zero(f"s{k}", C(f"{spring}{k}"))
        graph.join(f"m{k - 1}", f"s{k}")
        graph.join(f"s{k}", f"m{k}")
    graph.measure("v", flow=f"m{stages - 1}")
    return graph


def test_a_long_ladder_agrees_with_the_raw_equations() -> None:
    graph = with_numbers(ladder(20).finish())
    response = state_space(graph).response(np.array([0.4]))
    assert response[0] == pytest.approx(raw_response(graph, 0.4j), rel=1e-8)


def resistive_mesh(stages: int) -> BondGraph:
    graph = BondGraph("mesh")
    graph.one("r0", Se("u"), R("series0"))
    for k in range(stages):
        graph.zero(f"n{k}", R(f"shunt{k}"))
        graph.join(f"r{k}", f"n{k}")
        graph.one(f"r{k + 1}", R(f"series{k + 1}"))
        graph.join(f"n{k}", f"r{k + 1}")
    graph.measure("i", flow=f"r{stages}")
    return graph


def test_many_algebraic_loops_agree_with_the_raw_equations() -> None:
    graph = with_numbers(resistive_mesh(8).finish())
    equations = derive(graph)
    assert equations.unknowns
    found = state_space(graph).response(np.array([1.0]))
    assert found[0] == pytest.approx(raw_response(graph, 1j), rel=1e-8)


def raw_or_none(graph: FinishedGraph, frequency: complex) -> np.ndarray | None:
    try:
        return raw_response(graph, frequency)
    except np.linalg.LinAlgError:
        return None


@pytest.mark.parametrize("seed", range(60))
def test_random_graphs_agree_with_the_raw_equations_or_are_refused(seed: int) -> None:
    try:
        graph = with_numbers(random_graph(seed).finish())
    except StructureError:
        return  # a junction without a bond
    frequency = 0.83j
    expected = raw_or_none(graph, frequency)
    try:
        system = linearise(derive(graph))
    except (CausalConflictError, EquationError):
        assert expected is None, "a graph with a solution was refused"
        return
    assert expected is not None, "a graph without a solution was accepted"
    values = graph.parameters.values_by_name()
    for i, output in enumerate(system.outputs):
        for j, source in enumerate(system.inputs):
            transfer = system.transfer_function(output, source)
            top, bottom = transfer.coefficients(values)
            found = np.polyval(top, frequency) / np.polyval(bottom, frequency)
            assert found == pytest.approx(expected[i, j], rel=1e-7, abs=1e-9)


# Transfer functions as records ----------------------------------------------------


def lowerleg() -> FinishedGraph:
    return next(c for c in CASES if c.name == "lowerleg").graph()


def test_gain_and_pole_of_the_lower_leg() -> None:
    transfer = linearise(derive(lowerleg())).transfer_function()
    inertia = expression("jl + jt + jw*kw**2 + (jm + jg)*(kg*kw)**2")
    n, c = expression("kg*kw"), expression("c")
    assert agree(transfer.gain, n / inertia)
    assert transfer.dc_gain == sympy.oo
    values = {"jl": 2.0, "jt": 1.0, "jw": 0.5, "jm": 0.25, "jg": 0.125, "c": 3.0}
    values |= {"kg": 2.0, "kw": 4.0}
    total = 2 + 1 + 0.5 * 16 + 0.375 * 64
    assert transfer.gain_at(values) == pytest.approx(8 / total)
    assert transfer.poles(values) == pytest.approx((0.0, -3 / total))
    assert transfer.zeros(values) == ()
    assert agree(transfer.textbook, n / (s * (inertia * s + c)))
    assert sympy.latex(transfer.textbook) in transfer._repr_latex_()


def test_a_hidden_state_leaves_no_common_factor() -> None:
    # Two equal tanks filled by one source: their difference is never moved.
    graph = BondGraph("twins")
    graph.zero("inlet", Sf("inflow"))
    graph.one("left")
    graph.one("right")
    r = sympy.Symbol("r")
    for side in ("left", "right"):
        graph.join("inlet", side)
        graph.put(R(f"pipe_{side}", law=r * f), on=side)
        graph.put(C(f"tank_{side}", law=sympy.Symbol("k") * q), on=side)
    graph.measure("level", -3 * effort("tank_left"))
    transfer = linearise(derive(graph.finish())).transfer_function()
    assert agree(transfer.expression, expression("-3*k/(2*s)"))
    assert len(transfer.denominator_coefficients) == 2


def test_zeros_and_a_static_transfer_function() -> None:
    drive = next(c for c in CASES if c.name == "two_mass_drive").graph()
    transfer = linearise(derive(drive)).transfer_function()
    values = {"j1": 1.0, "j2": 2.0, "c": 0.5, "d": 4.0}
    assert transfer.zeros(values) == pytest.approx((-0.5,))
    static = next(c for c in CASES if c.name == "divider").graph()
    ratio = linearise(derive(static)).transfer_function("v", "u")
    assert agree(ratio.gain, expression("r2/(r1 + r2)"))
    assert agree(ratio.dc_gain, ratio.gain)


def test_unknown_names_and_missing_numbers_are_refused() -> None:
    system = linearise(derive(lowerleg()))
    with pytest.raises(EquationError, match=r"no output 'thetta'.*Did you mean theta"):
        system.transfer_function("thetta")
    divider = next(c for c in CASES if c.name == "divider").graph()
    with pytest.raises(EquationError, match="has 2 outputs; say which one"):
        linearise(derive(divider)).transfer_function()
    with pytest.raises(ParameterError, match="needs a value of"):
        system.transfer_function().poles({"c": 1.0})


def test_too_many_states_for_a_closed_form_are_refused() -> None:
    system = linearise(derive(ladder(12).finish()))
    with pytest.raises(EquationError, match="23 states; its closed form has more"):
        system.transfer_function()


# Operating points -----------------------------------------------------------------


def test_a_pendulum_is_linearised_where_it_hangs_and_where_it_stands() -> None:
    graph = BondGraph("pendulum")
    w = sympy.Symbol("w")
    weight = Se("weight", value=-w * sympy.sin(displacement("joint")))
    graph.one("joint", Se("torque"), I("j"), weight)
    graph.measure("theta", displacement="joint")
    equations = derive(graph.finish())
    hanging = linearise(equations).transfer_function()
    standing = linearise(equations, {"q_joint": sympy.pi}).transfer_function()
    assert agree(hanging.expression, expression("1/(j*s**2 + w)"))
    assert agree(standing.expression, expression("1/(j*s**2 - w)"))


def test_coulomb_friction_has_no_linear_form_at_rest() -> None:
    graph = next(c for c in CASES if c.name == "lifted_mass_with_friction").graph()
    equations = derive(graph)
    with pytest.raises(EquationError, match="away from the kink"):
        linearise(equations)
    moving = linearise(equations, {"p_m": 2.0}).transfer_function()
    assert agree(moving.expression, expression("1/(m*s**2)"))


def test_an_input_that_is_divided_by_is_named_where_it_is_zero() -> None:
    graph = BondGraph("wheel", domain="rotation")
    tyre = R("tyre", law=sympy.Symbol("c") * f / flow("road"))
    graph.one("wheel", Se("torque"), I("j"), tyre)
    graph.one("road", Sf("drum"), R("bearing"))
    graph.measure("speed", flow="wheel")
    equations = derive(graph.finish())
    with pytest.raises(EquationError, match="it divides by drum, which is 0"):
        linearise(equations)
    rolling = linearise(equations, {"drum": 2}).transfer_function("speed", "torque")
    assert agree(rolling.expression, expression("1/(j*s + c/2)"))


def test_drag_is_linearised_at_speed_through_assigned_symbols() -> None:
    graph = next(c for c in CASES if c.name == "quadratic_drag").graph()
    momentum = sympy.Symbol("p0", positive=True)
    system = linearise(derive(graph), {"p_m": momentum})
    expected = 1 / expression("m*s + 2*b*p0/m").xreplace(
        {sympy.Symbol("p0", real=True): momentum}
    )
    put = {sympy.Symbol(n, real=True): v for n, v in (("m", 1.3), ("b", 0.7))}
    found = system.transfer_function().expression.subs({momentum: 2.0, s: 1.1, **put})
    assert float(found) == pytest.approx(
        float(expected.subs({momentum: 2.0, s: 1.1, **put}))
    )


# python-control -------------------------------------------------------------------


def test_python_control_objects_keep_the_names() -> None:
    graph = lowerleg()
    graph = with_numbers(graph)
    values = graph.parameters.values_by_name()
    model = state_space(graph)
    assert model.states == ("p_jm", "q_joint")
    twin = to_control(model)
    assert twin.input_labels == ["torque"]
    assert twin.output_labels == ["theta"]
    assert twin.state_labels == ["p_jm", "q_joint"]
    transfer = linearise(derive(graph)).transfer_function()
    other = transfer_function_to_control(transfer, values)
    assert other.input_labels == ["torque"]
    assert other(0.3j) == pytest.approx(twin(0.3j))
    poles = sorted(abs(p) for p in model.poles())
    assert poles == pytest.approx([abs(p) for p in transfer.poles(values)], abs=1e-12)


def test_from_equations_names_units() -> None:
    graph = BondGraph("cart", domain="translation")
    graph.one("cart", Se("force"), I("m"), R("b"))
    graph.measure("v", flow="cart")
    model = from_equations(derive(graph.finish()), {"m": 2.0, "b": 3.0})
    assert (model.state_units, model.input_units) == (("N*s",), ("N",))
    assert model.output_units == ("m/s",)
    assert pytest.approx(np.array([[-1.5]])) == model.A


def test_a_graph_with_no_states_and_no_inputs_has_an_empty_system() -> None:
    graph = BondGraph("still")
    graph.one("loop", R("one"), R("two"))
    graph.measure("i", flow="loop")
    graph.parameter("one", 1.0)
    graph.parameter("two", 2.0)
    system = state_space(graph.finish())
    assert (system.A.shape, system.D.shape) == ((0, 0), (1, 0))
