"""What runs and fits are given: numbers that are none, words for objects, functions."""

from decimal import Decimal

import numpy as np
import pytest

from bondgraph import (
    BondGraph,
    Cvode,
    Direct,
    FitSettings,
    Hold,
    Huber,
    I,
    Ida,
    R,
    Radau,
    Recording,
    RungeKutta4,
    Sdirk2,
    Sdirk3,
    Se,
    bind_to,
    fit_innovations,
    simulate_batch,
    simulate_inputs,
    simulate_sparse,
)
from bondgraph.errors import EquationError, FitError, ParameterError

TIME = np.arange(0.0, 2.0, 0.1)


def lag():
    g = BondGraph("lag")
    g.one("a", Se("u"), I("m"), R("r"))
    g.measure("y", flow="a")
    return g.finish().with_parameters({"m": 1.0, "r": 1.0})


def bound(graph):
    channels = {"u": (np.sin(TIME), "1"), "y": (np.cos(TIME), "1")}
    return bind_to(graph, Recording.from_arrays("run", TIME, channels))


def batch(graph, *, sets=({},), **choices):
    return simulate_batch(graph, sets, bound(graph), **choices)


@pytest.mark.parametrize("run", [simulate_inputs, simulate_sparse])
@pytest.mark.parametrize(
    ("time", "words"),
    [
        ([0.0, np.nan, 1.0], "Sample 1 of time is nan"),
        ([0.0, 1.0, np.inf], "Sample 2 of time is inf"),
        ([0.0, 2.0, 1.0], "do not increase"),
        ([], "shape"),
        ([[0.0, 1.0]], "shape"),
        (["0", "1"], "real numbers"),
    ],
)
def test_time_that_is_none_is_refused_before_the_run(run, time, words):
    with pytest.raises(EquationError, match=words):
        run(lag(), time)


@pytest.mark.parametrize("run", [simulate_inputs, simulate_sparse])
@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"inputs": {"u": [0.0, np.nan, 1.0]}}, "'u' is nan at 1 s"),
        ({"inputs": {"u": np.inf}}, "'u' is inf at 0 s"),
        ({"inputs": {"u": 1j}}, "'u' is not made of real numbers"),
        ({"inputs": {"u": "1"}}, "'u' is not made of real numbers"),
        ({"inputs": {"u": [[1.0], [1.0, 2.0]]}}, "'u' is not made of real numbers"),
        ({"initial": {"p_m": np.inf}}, "initial value of 'p_m' is inf"),
        ({"initial": {"p_m": "a"}}, "initial value of 'p_m'"),
    ],
)
def test_inputs_and_states_that_are_no_numbers_are_refused_by_name(run, given, words):
    with pytest.raises(EquationError, match=words):
        run(lag(), [0.0, 1.0, 2.0], **given)


def test_numbers_of_any_kind_are_taken():
    one = simulate_inputs(lag(), [0, 1], inputs={"u": [Decimal(1), Decimal(2)]})
    other = simulate_inputs(lag(), [0, 1], inputs={"u": np.array([1, 2], np.int8)})
    assert np.array_equal(one.outputs, other.outputs)


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda t: [t], r"'u' is \[0.0\] at 0 s"),
        (lambda t: 1 / 0, "'u' raises ZeroDivisionError: division by zero at 0 s"),
        (lambda t: np.nan, "'u' is nan at 0 s"),
        (lambda t: 1j, "'u' is 1j at 0 s"),
        (lambda: 0.0, "'u' raises TypeError"),
    ],
)
def test_a_function_of_time_gives_one_number(function, words):
    with pytest.raises(EquationError, match=words):
        simulate_inputs(lag(), TIME, inputs={"u": function})


@pytest.mark.parametrize("hold", Hold)
def test_what_is_lost_between_the_samples_of_a_function_shows_in_the_error(hold):
    """The response to sin 50 t, of which samples at 0.1 s show nothing."""
    time = np.arange(0.0, 3.0, 0.1)
    given = {"inputs": {"u": lambda t: np.sin(50.0 * t)}, "hold": hold}
    w = 50.0
    exact = (np.sin(w * time) - w * np.cos(w * time) + w * np.exp(-time)) / (1 + w * w)
    for solver in (RungeKutta4(substeps=50), Sdirk3(substeps=50)):
        run = simulate_inputs(lag(), time, solver=solver, estimate_error=True, **given)
        wrong = np.abs(run.output("y") - exact).max()
        assert wrong > 0.02
        assert run.solver_error[0] > 0.3 * wrong
    exactly = simulate_inputs(lag(), time, solver=Radau(), **given)
    assert exactly.output("y") == pytest.approx(exact, abs=1e-8)


@pytest.mark.parametrize("kind", [Sdirk2, Sdirk3, RungeKutta4])
@pytest.mark.parametrize("substeps", [0, -1, 1.5, True, "2", None])
def test_a_fixed_step_is_a_whole_number_of_times_shorter(kind, substeps):
    with pytest.raises(EquationError, match=f"substeps of {kind.__name__}"):
        kind(substeps=substeps)
    assert kind(substeps=np.int64(2)) == kind(substeps=2)


@pytest.mark.parametrize("kind", [Cvode, Ida, Radau])
@pytest.mark.parametrize("name", ["rtol", "atol"])
@pytest.mark.parametrize("value", [-1.0, 0.0, np.nan, np.inf, "small"])
def test_a_tolerance_is_a_positive_number(kind, name, value):
    with pytest.raises(EquationError, match=f"{name} of {kind.__name__}"):
        kind(**{name: value})


@pytest.mark.parametrize(
    ("choice", "words"),
    [
        ({"hold": "zero"}, "hold of a fit is 'zero'.*Hold.ZERO or Hold.FIRST"),
        ({"loss": "huber"}, "loss.*SquaredError.*Huber.* or StudentT"),
        ({"loss": Huber}, "loss of a fit is the class Huber"),
        ({"horizon": 3}, r"horizon of a fit is 3.*Windows\(samples\)"),
        ({"strategy": "direct"}, "strategy"),
        ({"noise": "coloured"}, "noise"),
        ({"starts": 3}, r"starts of a fit is 3.*ManyStarts\(count\)"),
        ({"solver": "rk4"}, "solver of a fit is 'rk4'.*RungeKutta4"),
        ({"solver": Radau()}, "solver of a fit is Radau"),
        ({"iterations": -1}, "iterations"),
        ({"iterations": 2.5}, "iterations"),
    ],
)
def test_a_word_is_no_choice_of_a_fit(choice, words):
    with pytest.raises(FitError, match=words):
        FitSettings(**choice)
    assert FitSettings(strategy=Direct(), loss=Huber()).loss == Huber()


@pytest.mark.parametrize(
    ("run", "choice", "words"),
    [
        (simulate_inputs, {"hold": "zero"}, "hold is 'zero'"),
        (simulate_inputs, {"solver": Sdirk2}, "solver is the class Sdirk2"),
        (simulate_inputs, {"solver": "rk4"}, r"solver is 'rk4'.*Radau\(\)"),
        (simulate_sparse, {"hold": "zero"}, "hold is 'zero'"),
        (simulate_sparse, {"solver": RungeKutta4()}, "solver is RungeKutta4"),
    ],
)
def test_a_word_is_no_choice_of_a_run(run, choice, words):
    with pytest.raises(EquationError, match=words):
        run(lag(), TIME, **choice)


@pytest.mark.parametrize(
    ("choice", "refusal", "words"),
    [
        ({"hold": "zero"}, EquationError, "hold is 'zero'"),
        ({"solver": Radau()}, EquationError, "solver of a batch is Radau"),
        ({"sets": [{"m": "a"}]}, ParameterError, "value of 'm' is 'a'"),
        ({"sets": [{"m": np.inf}]}, ParameterError, "value of 'm' is inf"),
        ({"initial": {"p_m": np.inf}}, ParameterError, "initial value of 'p_m'"),
    ],
)
def test_a_batch_refuses_what_is_no_choice_and_no_number(choice, refusal, words):
    with pytest.raises(refusal, match=words):
        batch(lag(), **choice)


def test_a_word_is_no_kalman_filter():
    graph = lag()
    with pytest.raises(FitError, match="Kalman filter is 'unscented'"):
        fit_innovations(graph, [bound(graph)], kalman="unscented")
