"""Sensitivities against finite differences, hand-derived ones, and honest refusals."""

import numpy as np
import pytest
import sympy
from catalogue import CASES, agree, expression

from bondgraph import BondGraph, C, I, ParameterSet, R, Se, derive, linearise
from bondgraph.equations.transfer.sensitivities import (
    PoleStatus,
    Sensitivity,
    _lines,
    sensitivities,
)
from bondgraph.errors import ParameterError
from bondgraph.structure.parameters import Parameter

VALUES = {"jl": 2.0, "jt": 1.0, "jw": 0.5, "jm": 0.25, "jg": 0.125, "c": 3.0}
VALUES |= {"kg": 2.0, "kw": 4.0}


def transfer(name: str):
    graph = next(case for case in CASES if case.name == name).graph()
    return linearise(derive(graph)).transfer_function()


def test_gain_of_the_leg_by_hand() -> None:
    found = sensitivities(transfer("lowerleg"), VALUES)
    inertia = expression("jl + jt + jw*kw**2 + (jm + jg)*(kg*kw)**2")
    n = expression("kg*kw")
    for name, text in {"jm": "-(kg*kw)**2", "jl": "-1", "jw": "-kw**2"}.items():
        assert agree(found.gain_slopes[name], n * expression(text) / inertia**2)
    # kg: N/J with J = J0 + J1 kg², so (J0 - J1 kg²)/J.
    reflected = expression("(jm + jg)*(kg*kw)**2")
    assert agree(found.elasticity("kg"), 1 - 2 * reflected / inertia)
    total = 2 + 1 + 0.5 * 16 + 0.375 * 64
    assert found.gain.elasticities["kg"] == pytest.approx(1 - 2 * 24 / total)
    assert found.dc_gain is None
    assert "c" not in found.gain.slopes
    zero, slow = found.poles
    assert zero.status is PoleStatus.FIXED
    assert slow.status is PoleStatus.SIMPLE
    assert slow.value == pytest.approx(-3 / total)
    assert slow.elasticities["c"] == pytest.approx(1.0)
    assert slow.elasticities["jl"] == pytest.approx(-2 / total)


@pytest.mark.parametrize(
    "case", [c for c in CASES if c.linear and len(c.states) > 1], ids=lambda c: c.name
)
def test_every_slope_is_that_of_finite_differences(case) -> None:
    system = linearise(derive(case.graph()))
    found = system.transfer_function(system.outputs[0], system.inputs[0])
    if not found.numerator_coefficients[0]:
        return
    symbols = found.expression.free_symbols - {sympy.Symbol("s")}
    values = {str(x): 0.7 + 0.13 * i for i, x in enumerate(sorted(symbols, key=str))}
    answer = sensitivities(found, values)
    step = 1e-6
    for name, value in values.items():
        ends = [{**values, name: value * (1 + sign * step)} for sign in (1, -1)]
        change = 2 * step * value
        gains = [found.gain_at(end) for end in ends]
        slope = answer.gain.slopes.get(name, 0.0)
        assert slope == pytest.approx(
            (gains[0] - gains[1]) / change, rel=1e-5, abs=1e-7
        )
        for pole in answer.poles:
            if pole.status is not PoleStatus.SIMPLE:
                continue
            near = [nearest(found.poles(end), pole.value) for end in ends]
            slope = pole.slopes.get(name, 0.0)
            difference = (near[0] - near[1]) / change
            assert slope == pytest.approx(difference, rel=1e-4, abs=1e-6)


def nearest(poles, to):
    return min(poles, key=lambda pole: abs(pole - to))


def oscillator(damping: float) -> tuple:
    graph = BondGraph("oscillator")
    graph.one("mass", Se("force"), I("m"), C("c"), R("b"))
    graph.measure("x", displacement="mass")
    return (
        linearise(derive(graph.finish())).transfer_function(),
        {"m": 1.0, "c": 1.0, "b": damping},
    )


def test_a_multiple_pole_is_called_one() -> None:
    found = sensitivities(*oscillator(2.0))
    assert [pole.status for pole in found.poles] == [PoleStatus.MULTIPLE] * 2
    assert all(not pole.slopes and pole.std is None for pole in found.poles)
    assert "splits" in str(found)
    complex_pair = sensitivities(*oscillator(0.5)).poles
    assert {pole.status for pole in complex_pair} == {PoleStatus.SIMPLE}
    # d(-b/2m)/db = -1/2 for the real part.
    assert complex_pair[0].slopes["b"].real == pytest.approx(-0.5)


def test_standard_deviations_are_those_of_many_draws() -> None:
    transfer_function, values = oscillator(0.4)
    std = {"m": 0.01, "c": 0.02, "b": 0.004}
    parameters = ParameterSet(
        tuple(Parameter(name=n, value=v, std=std[n]) for n, v in values.items())
    )
    found = sensitivities(transfer_function, parameters)
    draw = np.random.default_rng(8)
    samples = [
        {n: v + std[n] * draw.normal() for n, v in values.items()} for _ in range(400)
    ]
    gains = [transfer_function.gain_at(sample) for sample in samples]
    assert found.gain.std == pytest.approx(np.std(gains), rel=0.15)
    pole = found.poles[0]
    near = np.array([nearest(transfer_function.poles(x), pole.value) for x in samples])
    spread = np.cov(near.real, near.imag)
    assert pole.std == pytest.approx(np.sqrt(np.linalg.eigvalsh(spread)[-1]), rel=0.15)


def test_an_unknown_std_is_no_std() -> None:
    transfer_function, _ = oscillator(0.4)
    parameters = ParameterSet(
        (
            Parameter(name="m", value=1.0, std=0.1),
            Parameter(name="c", value=1.0, std=0.0),
            Parameter(name="b", value=0.4),
        )
    )
    found = sensitivities(transfer_function, parameters)
    assert found.gain.std == pytest.approx(0.1)  # the gain is 1/m
    assert found.poles[0].std is None
    assert found.poles[0].unknown == ("b",)
    assert found.dc_gain is not None
    assert found.dc_gain.std == 0.0  # c, which is exact


def test_the_table_reads_in_percent() -> None:
    text = str(
        sensitivities(
            transfer("dc_motor"), dict.fromkeys(("la", "ra", "k", "j", "b"), 1.0)
        )
    )
    assert text.startswith("w/u\n  gain = 1\n")
    assert "gain: +1.00 % per % of k" in text
    assert "dc gain: +0.00 % per % of k" in text
    assert "pole 1" in text


def test_missing_values_and_wrong_names_are_refused() -> None:
    with pytest.raises(ParameterError, match="needs a value of"):
        sensitivities(transfer("lowerleg"), {"c": 1.0})
    found = sensitivities(transfer("lowerleg"), VALUES)
    with pytest.raises(ParameterError, match="does not depend on a parameter 'c'"):
        found.elasticity("c")


def test_the_largest_effects_are_told_first() -> None:
    row = Sensitivity(
        name="gain",
        value=2.0,
        slopes={"a": 1.0, "b": -4.0, "c": 0.0, "d": 0.5},
        elasticities={"a": 0.5, "b": -2.0, "c": 0.0, "d": 0.01},
        std=None,
        status=PoleStatus.SIMPLE,
    )
    told = [line.split()[-1] for line in _lines(row)[1:]]
    assert told == ["b", "a", "d", "c"]


def test_a_pair_of_poles_is_told_with_either_sign() -> None:
    graph = BondGraph("sprung mass")
    graph.one("mass", Se("push"), I("m"), C("c"), R("b"))
    graph.measure("v", flow="mass")
    values = {"m": 1.0, "c": 0.2, "b": 2.0}
    system = linearise(derive(graph.finish()))
    text = str(sensitivities(system.transfer_function(), values))
    # s² + 2 s + 5 has its roots at -1 ± 2 i.
    assert "(-1 - 2i)" in text
    assert "(-1 + 2i)" in text


def test_every_pole_at_zero_stays_there() -> None:
    free = BondGraph("free mass")
    free.one("mass", Se("push"), I("m"))
    free.measure("x", displacement="mass")
    system = linearise(derive(free.finish()))
    found = sensitivities(system.transfer_function(), {"m": 2.0})
    assert [pole.status for pole in found.poles] == [PoleStatus.FIXED] * 2
    assert [pole.value for pole in found.poles] == [0, 0]
