"""Every entry of the library finds its own parameters again, from its own starts.

The machine is simulated with the physics in it and a little noise; the fit knows the
machine, not the physics' parameters, and starts where the entry says.
"""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from physics_machines import (
    MACHINES,
    FinishedGraph,
    inputs,
    outputs,
    scales_of,
    times,
)

from bondgraph import FitSettings, Recording, WholeRecordings, bind_to, fit
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.places.everywhere import all_places

WHOLE = FitSettings(horizon=WholeRecordings())
NOISE = 1e-4
"""Of an output's standard deviation."""


@dataclass(frozen=True)
class Case:
    """One entry at one place, with the parameters to be found, by their stems."""

    machine: str
    entry: str
    place: str
    truth: dict[str, float] = field(hash=False)
    which: int = 0
    steady: bool = False

    @property
    def base(self) -> FinishedGraph:
        """The machine without it, all of its parameters known."""
        graph = MACHINES[self.machine]
        exact = [replace(p, std=0.0) for p in graph.parameters.members]
        return graph.with_parameters(exact)

    @property
    def hypothesis(self) -> Hypothesis:
        """What the entry proposes there."""
        graph = MACHINES[self.machine]
        (physics,) = (p for p in LIBRARY if type(p).__name__ == self.entry)
        scales = scales_of(graph)
        if self.steady:
            scales = replace(scales, least={f"flow({self.place})": 0.03})
        places = [p for p in all_places(graph, scales) if p.name == self.place]
        return [h for place in places for h in physics.propose(place)][self.which]


RUBBING = (0.1, 0.15, 0.12, 0.2, 0.25, 0.15, 0.1, 0.14)
DAMPING = (0.4, 0.6, 0.5, 0.8, 0.7, 0.9, 0.5, 0.3)
RATIO = (0.04, -0.06, 0.05, 0.08, -0.05, 0.06)


def heights(stem: str, values: tuple[float, ...]) -> dict[str, float]:
    """Return the heights of a broken line at its knots."""
    return {f"{stem}_{i}": value for i, value in enumerate(values)}


def stop(end: str, at: float, damping: float) -> dict[str, float]:
    """Return the parameters of a stop at one end of the way."""
    named = {"": at, "_stiffness": 300.0, "_damping": damping}
    return {f"{end}_stop{name}": value for name, value in named.items()}


CASES = [
    Case("wheel", "ViscousFriction", "shaft", {"viscous": 0.05}),
    Case("wheel", "CoulombFriction", "shaft", {"coulomb": 0.2}),
    Case("dc_drive", "VoltageDrop", "winding", {"drop": 0.3}),
    Case("geared_arm", "LoadDependentFriction", "joint", {"mu": 0.15}),
    Case("two_masses", "LoadDependentFriction", "second", {"mu": 0.15}),
    Case(
        "geared_arm",
        "LoadDependentFriction",
        "joint",
        {"mu": -0.15, "coulomb": 0.4},
        2,
    ),
    Case(
        "geared_arm",
        "LoadDependentFriction",
        "joint",
        {
            "mu": 0.15,
            "coulomb": 0.4,
            "slow_rise_ahead": -0.3,
            "slow_rise_back": 0.6,
            "slow_flow": 0.3,
        },
        2,
        steady=True,
    ),
    Case("wheel", "DirectionDependentDamping", "shaft", {"damping_ahead": 0.1}),
    Case("wheel", "DirectionDependentDamping", "shaft", {"damping_back": 0.1}, 1),
    Case(
        "wheel",
        "DirectionDependentFriction",
        "shaft",
        {"coulomb": 0.2, "asymmetry": 0.25},
    ),
    Case(
        "wheel",
        "DirectionDependentFriction",
        "shaft",
        {
            "coulomb": 0.2,
            "asymmetry": 0.25,
            "slow_rise_ahead": -0.4,
            "slow_rise_back": 0.8,
            "slow_flow": 0.5,
        },
        1,
        steady=True,
    ),
    Case(
        "wheel",
        "StribeckFriction",
        "shaft",
        {"coulomb": 0.15, "stribeck_rise": 0.15, "stribeck_flow": 0.4},
    ),
    Case("slider", "QuadraticDrag", "carriage", {"quadratic": 20.0}),
    Case("slider", "ConstantBias", "carriage", {"bias": 0.4}),
    Case("two_tanks", "ConstantBias", "upper", {"bias": 0.2}),
    Case("lamp", "ConstantBias", "mains", {"input_bias": 0.2}),
    Case("wheel", "Gravity", "shaft", {"gravity_sine": 0.5, "gravity_cosine": 0.2}),
    Case("geared_arm", "Gravity", "joint", {"gravity_sine": 0.5}, 1),
    Case("wheel", "Spring", "shaft", {"stiffness": 0.4, "bias": 0.1}),
    Case("slider", "HardeningSpring", "carriage", {"cubic_stiffness": 2e4}),
    Case(
        "wheel",
        "HardeningSpring",
        "shaft",
        {"cubic_stiffness": 0.1, "square_stiffness": -0.08},
        1,
    ),
    Case(
        "wheel",
        "HardeningSpring",
        "shaft",
        {
            "cubic_stiffness": 0.1,
            "square_stiffness": -0.08,
            "stiffness": 0.4,
            "bias": 0.1,
        },
        2,
    ),
    Case("two_masses", "HardeningSpring", "spring", {"cubic_stiffness": 2e4}),
    Case("slider", "AddedInertia", "carriage", {"added_inertia": 0.5}),
    Case("two_tanks", "AddedCompliance", "lower", {"added_compliance": 0.1}),
    Case(
        "two_tanks", "StoreBehind", "lower", {"second_capacity": 0.3, "fill_time": 0.4}
    ),
    Case(
        "dc_drive", "StoreBehind", "winding", {"slow_resistance": 0.5, "fill_time": 0.3}
    ),
    Case("two_tanks", "StoreAmid", "pipe", {"capacity_amid": 0.3}),
    Case(
        "slider",
        "RelaxingSpring",
        "carriage",
        {"relaxing_stiffness": 30.0, "relaxation_time": 0.2},
    ),
    Case(
        "dc_drive",
        "InducedCurrent",
        "winding",
        {"induced_inductance": 0.05, "induced_time": 0.3},
    ),
    Case("two_axes", "Drag", "pan", {"drag": 0.1}),
    Case("two_axes", "Tie", "pan", {"stiffness": 0.6}),
    Case("two_axes", "SharedInertia", "pan", {"inertia_of_sum": 0.02}),
    Case("two_axes", "SharedInertia", "pan", {"inertia_of_difference": 0.02}, 1),
    Case("two_axes", "GyroscopicCoupling", "pan", {"gyration": -0.05}),
    Case("two_tanks", "Leak", "upper", {"leak": 0.1}),
    Case("heaters", "Leak", "block1", {"leak_to_block2_from": 0.01}, 1),
    Case("lamp", "OneWayPassage", "series", {"one_way": 0.6, "opening": 0.1}),
    Case("dc_drive", "OneWayPassage", "winding", {"one_way": 0.7}),
    Case("two_masses", "Slip", "coupling", {"leak": 0.05}),
    Case("geared_arm", "Slip", "gear", {"slip_resistance": 20.0}),
    Case("dc_drive", "Bypass", "inductance", {"bypass_resistance": 10.0}),
    Case("draining_tank", "SquareLaw", "tank", {"outlet_flow": 0.5}),
    Case("piped_tanks", "SquareLaw", "pipe", {"laminar_square": 3.0}),
    Case("piped_tanks", "SquareLaw", "pipe", {"laminar_past": 0.3}, 1),
    Case("two_tanks", "SquareRootOrifice", "upper", {"orifice": 0.3}),
    Case("two_tanks", "Overflow", "upper", {"overflow_level": 1.5, "overflow": 3.0}),
    Case("two_tanks", "Overflow", "upper", {"overflow_level": 1.5, "overflow": 3.0}, 1),
    Case(
        "two_tanks",
        "Overflow",
        "upper",
        {"overflow_level": 1.5, "overflow": 3.0, "overflow_share": 0.4},
        2,
    ),
    Case("heaters", "Radiation", "block1", {"radiation": 1.0, "radiation_room": 300.0}),
    Case("slider", "EndStop", "carriage", stop("upper", 0.03, 400.0)),
    Case("slider", "EndStop", "carriage", stop("lower", -0.03, 400.0), 1),
    Case("slider", "EndStop", "carriage", stop("upper", 0.03, 4.0), 2),
    Case(
        "geared_arm",
        "SeriesCompliance",
        "gear",
        {"compliance": 0.005, "compliance_damping": 2.0},
    ),
    Case(
        "geared_arm",
        "Backlash",
        "gear",
        {"half_gap": 0.02, "contact_stiffness": 200.0, "contact_damping": 200.0},
    ),
    Case("two_masses", "Backlash", "spring", {"half_gap": 0.01}),
    Case("soft_shaft", "Backlash", "spring", {"half_gap": 0.01}, 1),
    Case(
        "wheel",
        "FlexibleMode",
        "shaft",
        {"mode_inertia": 0.06, "mode_frequency": 5.0, "mode_damping": 0.1},
    ),
    Case("lamp", "Clamp", "node", {"overflow_level": 0.3, "overflow": 1.0}),
    Case(
        "heaters",
        "TemperatureDependentResistance",
        "loss1",
        {"temperature_slope": 0.01},
    ),
    Case("dc_drive", "QuadraticDrag", "winding", {"quadratic": 0.3}),
    Case(
        "slider", "DahlHysteresis", "carriage", {"hysteresis": 0.5, "presliding": 0.01}
    ),
    Case(
        "slider",
        "BoucWenHysteresis",
        "carriage",
        {"hysteresis": 0.5, "presliding": 0.01, "hysteresis_skew": 0.4},
    ),
    Case(
        "wheel",
        "Cogging",
        "shaft",
        {"cogging_sine": 0.1, "cogging_cosine": 0.05, "cogging_wave": 4.0},
    ),
    Case(
        "slider",
        "Cogging",
        "carriage",
        {"cogging_sine": 0.3, "cogging_cosine": 0.1, "cogging_wave": 120.0},
    ),
    Case(
        "geared_arm",
        "Eccentricity",
        "gear",
        {"runout_sine_joint": 0.05, "runout_cosine_joint": 0.03},
        1,
    ),
    Case("dc_drive", "SaturatingInertia", "inductance", {"saturation": 2e4}),
    Case(
        "dc_drive",
        "SaturatingInertia",
        "inductance",
        {"saturation": 2e4, "saturation_power": 3.0},
        1,
    ),
    Case(
        "dc_drive",
        "TemperatureDependentResistance",
        "resistance",
        {"warming": 0.5, "warming_time": 0.8},
    ),
    Case(
        "dc_drive",
        "TemperatureDependentGyrator",
        "k_m",
        {"warming": -0.3, "warming_time": 2.5},
    ),
    Case("slider", "ParameterDrift", "mass", {"drift": 0.05}),
    Case("slider", "ParameterDrift", "force", {"drift": 0.05}),
    Case("slider", "ParameterDrift", "position", {"drift": 0.05}),
    Case("slider", "ParameterStep", "position", {"step": 0.3, "moment": 2.2}),
    Case("slider", "ParameterStep", "mass", {"step": 0.3, "moment": 2.2}),
    Case("slider", "ParameterStep", "force", {"step": -0.2, "moment": 3.1}),
    Case("slider", "DisturbanceStep", "carriage", {"step": 2.0, "moment": 2.2}),
    Case(
        "wheel", "SpeedLimit", "shaft", {"flow_limit": 4.0, "flow_limit_steepness": 1.0}
    ),
    Case("slider", "SensorBias", "position", {"sensor_bias": 0.01}),
    Case("wheel", "SensorBias", "angle", {"sensor_drift": 0.002}),
    Case("slider", "SensorBias", "position", {"sensor_drift": 0.002}, 1),
    Case(
        "slider",
        "SensorBias",
        "position",
        {"sensor_bias": 0.01, "sensor_drift": -0.003},
        2,
    ),
    Case("slider", "SensorBias", "position", {"sensor_jump": 0.01, "moment": 2.2}, 3),
    Case("slider", "SensorScale", "position", {"sensor_scale": 1.1}),
    Case("slider", "InputScale", "force", {"input_scale": 0.9}),
    Case("heaters", "InputScale", "heater1", {"share_lost_to_heater2": 0.3}, 4),
    Case("slider", "Lag", "force", {"lag": 0.05}),
    Case("slider", "Lag", "position", {"lag": 0.05}),
    Case("slider", "Lag", "force", {"lag_each": 0.03}, 1),
    Case("slider", "Lag", "position", {"lag_each": 0.03}, 1),
    Case("slider", "Delay", "force", {"delay": 0.04}),
    Case("slider", "Delay", "position", {"delay": 0.04}),
    Case("damper", "Delay", "load", {"delay": 0.04}),
    Case("servo", "Lag", "loop", {"lag": 0.05}),
    Case("servo", "Lag", "loop", {"lag_of_arm": 0.05}, 1),
    Case("servo", "Lag", "loop", {"lag_each": 0.03}, 2),
    Case("servo", "Lag", "loop", {"lag_each_of_arm": 0.03}, 3),
    Case("servo", "Delay", "loop", {"delay": 0.04}),
    Case("servo", "Delay", "loop", {"delay_of_arm": 0.04}, 1),
    Case("slider", "Saturation", "force", {"limit": 1.5}),
    Case("slider", "Saturation", "force", {"rate_limit": 5.0}, 1),
    Case("slider", "Saturation", "force", {"lower_limit": -0.4}, 2),
    Case("slider", "Saturation", "force", {"upper_limit": 0.8}, 3),
    Case("slider", "Saturation", "force", {"lower_limit": -0.2, "upper_limit": 1.1}, 4),
    Case("servo", "Saturation", "loop", {"limit": 1.5}),
    Case("servo", "Saturation", "loop", {"lower_limit": -0.5}, 1),
    Case("servo", "Saturation", "loop", {"upper_limit": 0.5}, 2),
    Case("slider", "DeadZone", "force", {"dead_zone": 0.3}),
    Case("servo", "DeadZone", "loop", {"dead_zone": 0.3}),
    Case("two_tanks", "LostMotion", "pump", {"half_gap": 0.2}),
    Case("slider", "LostMotion", "position", {"half_gap": 0.01}),
    Case("slider", "InputNonlinearity", "force", {"input_power": 0.6}),
    Case(
        "slider",
        "SensorNonlinearity",
        "position",
        {"sensor_square": 0.1, "sensor_cube": -0.05},
    ),
    Case("slider", "SensorNonlinearity", "position", {"sensor_upper_limit": 0.03}, 1),
    Case("slider", "SensorNonlinearity", "position", {"sensor_lower_limit": -0.03}, 2),
    Case("slider", "SensorNonlinearity", "position", {"rectified": 0.9}, 3),
    Case("slider", "UnknownRelation", "carriage", heights("curve", RUBBING), 2),
    Case("slider", "UnknownRelation", "carriage", heights("curve", DAMPING), 3),
    Case("geared_arm", "UnknownRelation", "gear", heights("curve_joint", RATIO), 1),
]


@pytest.mark.parametrize(
    "case", CASES, ids=lambda case: f"{case.entry}-{case.place}-{case.which}"
)
def test_its_parameters_are_found_again(case):
    hypothesis = case.hypothesis
    truth = {f"{stem}_{case.place}": value for stem, value in case.truth.items()}
    assert set(truth) == set(hypothesis.parameters)
    edited = hypothesis.apply(case.base)
    driven = inputs(case.base)
    clean = outputs(edited, truth)
    random = np.random.default_rng(5)
    noise = NOISE * clean.std(axis=0)
    measured = clean + noise * random.standard_normal(clean.shape)
    channels = {
        s.name: (driven[:, i], case.base.input_unit(s.name))
        for i, s in enumerate(case.base.inputs)
    }
    channels |= {
        m.name: (measured[:, i], m.unit) for i, m in enumerate(case.base.measurements)
    }
    recording = bind_to(edited, Recording.from_arrays("made", times(), channels))
    best = None
    for start in hypothesis.starts:
        result = fit(edited.with_parameters(start), [recording], settings=WHOLE)
        if best is None or result.score.nrmse < best.score.nrmse:
            best = result
        if best.score.nrmse < 2.0 * NOISE:
            break
    found = {e.name: e.value for e in best.estimates}
    for name, value in truth.items():
        assert found[name] == pytest.approx(value, rel=0.05), (found, best.score)


def test_every_entry_is_tried_here_or_has_no_parameters():
    tried = {case.entry for case in CASES}
    rest = {type(p).__name__ for p in LIBRARY} - tried
    assert rest == {"SensorSwap", "InputSwap"}
