"""Bad input of every kind to public functions: refused by name, never a raw exception.

Each row is what one would type by mistake, and a part of what is said about it.
"""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from bondgraph import (
    GY,
    PI,
    TF,
    BondGraph,
    Encoder,
    GainMargin,
    I,
    Lead,
    LeadLag,
    Matched,
    NoiseGain,
    Notch,
    Options,
    R,
    Recording,
    RField,
    RollOff,
    Se,
    Tustin,
    bind_to,
    clock_offset,
    derive,
    diagnose,
    digital_controller,
    estimate_noise,
    export,
    fit,
    fit_innovations,
    identifiability,
    linearise,
    resample,
)
from bondgraph.errors import BondGraphError
from bondgraph.loopshaping.controllers import Gain
from bondgraph.recordings.channel import Channel
from bondgraph.structure.signals import e, f

TIME = np.arange(0.0, 5.0, 0.05)


def written(law=None):
    g = BondGraph("lag")
    g.one("a", Se("u"), I("m"), R("r", law=law))
    g.measure("y", flow="a")
    return g


def graph():
    return written().finish().with_parameters({"m": 2.0, "r": 3.0})


def recorded(values, unit="1"):
    run = Recording.from_arrays("run", TIME, {"u": (np.zeros(TIME.size), unit)})
    return replace(run, channels=(Channel("u", unit, values, gaps=True),))


def bound():
    channels = {"u": (np.sin(TIME), "1"), "y": (np.cos(TIME), "1")}
    return bind_to(graph(), Recording.from_arrays("run", TIME, channels))


def through(two_port):
    g = BondGraph("geared")
    g.one("a", Se("u"), I("m"))
    g.one("b", R("r"))
    g.join("a", two_port, "b")
    return derive(g.finish())


def included_in_itself():
    g = written()
    return g.include(g, "again")


def offset(one, other, **choices):
    return clock_offset(one, other, "u", **{"most": 1.0, **choices})


MOVING = np.sin(TIME**2)
HARDLY = np.where(TIME < 0.3, MOVING, np.nan)
LEAD = Lead(gain=1.0, zero=1.0, pole=5.0)

ROWS = {
    "no recording to fit": (lambda: fit(graph(), []), "no recording of 'lag'"),
    "none to filter": (lambda: fit_innovations(graph(), []), "no recording"),
    "none to know of": (lambda: identifiability(graph(), []), "no recording"),
    "none to diagnose": (
        lambda: diagnose(graph(), [], held_out=[bound()]),
        "no recording of 'lag' to diagnose from",
    ),
    "none held out": (
        lambda: diagnose(graph(), [bound()], held_out=[]),
        "no recording of 'lag' to show the answer on",
    ),
    "a word for options": (
        lambda: diagnose(graph(), [bound()], held_out=[bound()], options="fast"),
        "'fast'",
    ),
    "a word for a place": (lambda: Options(where="processes"), r"Processes\(\)"),
    "a word for settings": (lambda: Options(settings="huber"), r"FitSettings\(\)"),
    "a word for a target": (lambda: export(graph(), "c"), r"'c'.*C99\(\)"),
    "a word for a method": (
        lambda: digital_controller(LEAD.transfer, 0.01, method="tustin"),
        r"method of 'controller' is 'tustin'.*Tustin\(\), Matched\(\) or ExactHold",
    ),
    "a word for an arithmetic": (
        lambda: digital_controller(LEAD.transfer, 0.01, arithmetic="single"),
        r"Single\(\)",
    ),
    "a graph in itself": (included_in_itself, "'lag' cannot be a part of itself"),
    "a ragged matrix": (
        lambda: RField.from_matrix("field", [[1, 2], [1]]),
        "matrix of 'field' is 2 x 1 or 2",
    ),
    "a row for a matrix": (lambda: RField.from_matrix("field", [1, 2]), "no matrix"),
    "text in a matrix": (lambda: RField.from_matrix("field", [["1"]]), "expression"),
    "no modulus": (lambda: through(TF("k", law=sympy.Integer(0))), "TF 'k' is zero"),
    "no gyration": (lambda: through(GY("k", law=sympy.Integer(0))), "GY 'k' is zero"),
    "a complex law": (lambda: written(sympy.I * f).finish(), "R 'r' is I[*]f"),
    "a law of nan": (lambda: written(sympy.nan * f).finish(), "R 'r' is nan"),
    "a value in words": (
        lambda: written().parameter("m", "3"),
        "'m' has the value '3'",
    ),
    "a complex value": (lambda: written().parameter("m", 1j), "'m' has the value 1j"),
    "a std in words": (lambda: written().parameter("m", 1, std="low"), "'low'"),
    "bounds in words": (lambda: written().parameter("m", 1, bounds="ab"), "bound 'a'"),
    "one bound": (lambda: written().parameter("m", 1, bounds=5), "bounds 5"),
    "another value": (lambda: graph().with_parameters({"m": "a"}), "value 'a'"),
    "a clock that shows nothing": (
        lambda: offset(recorded(np.ones(TIME.size)), recorded(np.ones(TIME.size))),
        "do not show the same motion",
    ),
    "clocks in two units": (
        lambda: offset(recorded(MOVING, "m"), recorded(MOVING, "V")),
        "'u' is in 'm' in 'run' and in 'V'",
    ),
    "a clock that was not read": (
        lambda: offset(recorded(MOVING), recorded(HARDLY)),
        "fewer than 8 samples",
    ),
    "no largest offset": (
        lambda: offset(recorded(MOVING), recorded(MOVING), most=np.nan),
        "at most nan s",
    ),
    "noise of nothing": (
        lambda: estimate_noise(TIME, np.full(TIME.size, np.nan)),
        "nothing was measured",
    ),
    "noise of another length": (
        lambda: estimate_noise(TIME[:30], TIME),
        r"shape \(30,\) and values of shape \(100,\)",
    ),
    "noise backwards": (lambda: estimate_noise(-TIME, TIME), "do not increase"),
    "noise in words": (lambda: estimate_noise(["a"], ["b"]), "real numbers"),
    "a step beyond the end": (
        lambda: resample(recorded(MOVING), 100.0),
        "'run' is too short to be resampled at 100 s",
    ),
    "an endless step": (lambda: resample(recorded(MOVING), np.inf), "step of inf"),
    "a gain of nan": (lambda: Gain(np.nan), "gain of a gain controller is nan"),
    "a lead of nan": (lambda: Lead(gain=np.nan), "gain of a lead controller is nan"),
    "a lead that lags": (lambda: Lead(zero=-1.0), "zero of a lead controller is -1"),
    "a lag that grows": (lambda: LeadLag(lag_pole=-1.0), "lag_pole"),
    "an integrator too much": (lambda: PI(zero=-1.0), "zero of a pi controller"),
    "a deep notch": (lambda: Notch(1.0, depth=-0.1), "depth of a notch controller"),
    "half a pole": (lambda: RollOff(1.0, order=1.5), "order of a roll_off"),
    "a prewarp backwards": (lambda: Tustin(prewarp=-1.0), "prewarped at -1.0 rad/s"),
    "a match at no frequency": (lambda: Matched(at=np.nan), "matched at nan rad/s"),
    "no gain margin": (lambda: GainMargin(0.5), "limit of 0.5 for the gain margin"),
    "a margin in words": (lambda: GainMargin("2"), "limit of 2 for the gain margin"),
    "noise backwards in time": (lambda: NoiseGain(1.0, omega=-1.0), "-1.0 rad/s"),
    "an encoder without steps": (lambda: Encoder(step=np.nan), "step of an encoder"),
}


@pytest.mark.parametrize("name", ROWS)
def test_bad_input_is_refused_by_name(name):
    call, words = ROWS[name]
    with pytest.raises(BondGraphError, match=words) as refused:
        call()
    assert refused.value.remedy


def test_a_finished_copy_may_be_a_part():
    assert written().include(graph(), "again")["a"] == "again_a"


def test_clocks_in_units_that_convert_are_compared():
    later = Recording.from_arrays("later", TIME + 0.3, {"u": (1e3 * MOVING, "mm")})
    found = clock_offset(recorded(MOVING, "m"), later, "u", most=1.0)
    assert found.seconds == pytest.approx(0.3, abs=1e-6)


def test_a_law_that_is_real_only_somewhere_is_derived():
    """Where a rank is looked at, symbols have values that no machine has."""
    g = BondGraph("valves")
    g.one("a", Se("u"), R("r", law=sympy.sqrt(f - 10)))
    g.zero("n", R("leak", law=sympy.Symbol("k") * sympy.sqrt(e - 10)))
    g.join("a", "n")
    assert len(derive(g.finish()).residuals) == 1


def test_beside_a_parameter_s_transfer_functions_are_written_in_p():
    g = BondGraph("lag")
    g.one("a", Se("u"), I("m"), R("s"))
    g.measure("y", flow="a")
    linear = linearise(derive(g.finish()))
    found = linear.transfer_function()
    words = "p for Laplace's variable, as s is a parameter"
    assert str(found) == f"y/u = 1/(m*p + s), {words}"
    assert str(found.pole_zero_gain) == "y/u = gain*1/(p + s/m), gain = 1/m"
    assert found.poles({"m": 2.0, "s": 3.0}) == (-1.5,)
    assert str(linearise(derive(written().finish())).transfer_function()) == (
        "y/u = 1/(m*s + r)"
    )
