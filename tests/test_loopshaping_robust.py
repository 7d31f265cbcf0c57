"""Robust shaping: margins that hold for a family, and what the bounds mean."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.signal import lsim
from scipy.stats import binom

from bondgraph import BondGraph, I, R, Recording, Se, bind_to, fit
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.transfer.linear import linearise
from bondgraph.errors import LoopShapingError, ParameterError
from bondgraph.loopshaping.loop import Loop, zero_pole_gain
from bondgraph.loopshaping.requirements import PeakSensitivity, PhaseMargin
from bondgraph.loopshaping.synthesis.family import (
    PlantFamily,
    PlantHypothesis,
    Posterior,
    Ranges,
)
from bondgraph.loopshaping.synthesis.optimise import optimise_controller
from bondgraph.loopshaping.synthesis.robust import (
    robust_controller,
    robustness,
    violated_at_most,
)
from bondgraph.loopshaping.synthesis.structure import ControllerStructure
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain
from bondgraph.structure.parameters import Parameter, ParameterSet
from flegx_models.models import lowerleg_flight

CORNER = 2 * math.pi * 25
FILTER = ZeroPoleGain(
    poles=tuple(np.roots([1, 1.414 * CORNER, CORNER**2])) * 2, gain=CORNER**4
)
SAMPLING = ZeroPoleGain(delay=1.5 / 400)
LEAD = ControllerStructure(zeros=1, poles=1, slowest=0.5, fastest=200.0)


@cache
def lowerleg():
    """Return the transfer function of the lower leg's graph, and its values."""
    graph = lowerleg_flight().finish()
    transfer = linearise(derive(graph)).transfer_function("theta", "T_motor")
    return transfer, graph.parameters.values_by_name()


def loop_at(values):
    transfer, known = lowerleg()
    plant = zero_pole_gain(transfer, {**known, **values})
    return Loop(plant=plant * SAMPLING, feedback=FILTER)


def spring_loop(values):
    """The other hypothesis: a flexible shaft, by a resonance near 60 rad/s."""
    w = values["resonance"]
    mode = ZeroPoleGain(poles=tuple(np.roots([1, 0.6 * w, w * w])), gain=w * w)
    return Loop(
        plant=loop_at({"c_friction_lowerleg": 3.0}).plant * mode, feedback=FILTER
    )


def friction(factor):
    """From 0.36 N·m·s up: the audit's estimate of the worm gear is 3.6."""
    ranges = Ranges({"c_friction_lowerleg": (0.36, 0.36 * factor)})
    return PlantHypothesis(name="friction", build=loop_at, uncertainty=(ranges,))


@cache
def designed():
    family = PlantFamily((friction(10.0),))
    return family, robust_controller(
        family,
        LEAD,
        (PhaseMargin(45.0), PeakSensitivity(1.7)),
        crossover=(3.0, 60.0),
        samples=100,
    )


def test_robust_design_keeps_45_degrees_over_ten_fold_friction():
    _, found = designed()
    assert found.design.met
    assert found.report.violations == 0
    assert found.report.unstable == 0
    for c in np.geomspace(0.36, 3.6, 25):
        loop = loop_at({"c_friction_lowerleg": c})
        loop = Loop(plant=loop.plant, feedback=FILTER, controller=found.controller)
        omega = np.geomspace(1e-3, 1e4, 40_001)
        size = loop.open_loop.response(omega)
        k = np.flatnonzero(np.diff(np.sign(np.abs(size) - 1)))
        assert len(k) == 1
        assert 180 + np.degrees(np.angle(size[k[0]])) >= 45 - 0.1


def test_design_for_one_plant_alone_does_not_keep_them():
    family, found = designed()
    alone = optimise_controller(
        loop_at({"c_friction_lowerleg": 3.6}),
        LEAD,
        (PhaseMargin(45.0), PeakSensitivity(1.7)),
        crossover=(3.0, 60.0),
    )
    assert alone.met
    report = robustness(
        alone.controller, family, (PhaseMargin(45.0), PeakSensitivity(1.7)), samples=60
    )
    assert report.violations > 0
    assert alone.value > found.design.value  # what robustness costs


def test_bound_of_the_violated_share_is_the_binomial_one():
    for violations in (0, 1, 7):
        bound = violated_at_most(violations, 200, 0.95)
        assert binom.cdf(violations, 200, bound) == pytest.approx(0.05)
    assert violated_at_most(0, 200, 0.95) == pytest.approx(1 - 0.05 ** (1 / 200))
    assert violated_at_most(200, 200, 0.95) == 1.0


def test_bound_covers_the_true_share():
    """Of 400 repetitions at least 95 % (less three sigma) must cover the truth."""
    generator = np.random.default_rng(5)
    truth, covered = 0.06, 0
    for _ in range(400):
        bad = int(generator.binomial(100, truth))
        covered += violated_at_most(bad, 100, 0.95) >= truth
    assert covered / 400 >= 0.95 - 3 * math.sqrt(0.95 * 0.05 / 400)


def test_other_hypotheses_join_the_family():
    flexible = PlantHypothesis(
        name="flexible shaft",
        build=spring_loop,
        uncertainty=(Ranges({"resonance": (50.0, 80.0)}),),
        weight=0.5,
    )
    family = PlantFamily((friction(2.0), flexible))
    drawn = family.draw(300, 1)
    share = sum(m.hypothesis == "flexible shaft" for m in drawn) / 300
    assert abs(share - 1 / 3) < 0.1
    found = robust_controller(
        family, LEAD, (PhaseMargin(45.0),), crossover=(2.0, 40.0), samples=40, starts=2
    )
    assert found.report.violations == 0
    assert {m.hypothesis for m in found.scenarios} == {"friction", "flexible shaft"}
    rigid = robust_controller(
        PlantFamily((friction(2.0),)),
        LEAD,
        (PhaseMargin(45.0),),
        crossover=(2.0, 40.0),
        samples=40,
        starts=2,
    )
    assert rigid.design.value > found.design.value


def test_posterior_has_the_mean_and_covariance_it_was_given():
    covariance = np.array([[0.04, 0.018], [0.018, 0.01]])
    parameters = ParameterSet(
        (
            Parameter(name="a", value=2.0, std=0.2, unit="1"),
            Parameter(name="b", value=1.0, std=0.1, unit="1"),
            Parameter(name="c", value=7.0, std=0.0, unit="1"),
        )
    )
    posterior = Posterior.of(parameters, covariance=covariance)
    assert posterior.names == ("a", "b")
    generator = np.random.default_rng(0)
    drawn = np.array([list(posterior.draw(generator).values()) for _ in range(4000)])
    assert drawn.mean(axis=0) == pytest.approx([2.0, 1.0], abs=0.02)
    assert np.cov(drawn.T) == pytest.approx(covariance, rel=0.1)
    alone = Posterior.of(parameters)
    assert alone.covariance == pytest.approx(np.diag([0.04, 0.01]))


def test_margins_hold_over_a_posterior():
    _, known = lowerleg()
    names = ("c_friction_lowerleg", "I_lowerleg")
    parameters = ParameterSet(
        (
            Parameter(
                name=names[0], value=2.0, std=0.4, unit="N*m*s/rad", bounds=(0.1, 9.0)
            ),
            Parameter(
                name=names[1],
                value=known[names[1]],
                std=0.004,
                unit="kg*m^2",
                bounds=(1e-4, 1.0),
            ),
        )
    )
    hypothesis = PlantHypothesis(
        name="fit", build=loop_at, uncertainty=(Posterior.of(parameters),)
    )
    family = PlantFamily((hypothesis,))
    found = robust_controller(
        family, LEAD, (PhaseMargin(60.0),), crossover=(3.0, 60.0), samples=60, starts=2
    )
    assert found.report.violations <= 2
    assert found.report.violated_at_most < 0.11
    assert "c_friction_lowerleg" in str(found.report)
    again = robustness(
        found.controller,
        family,
        (PhaseMargin(60.0),),
        samples=60,
        seed=found.report.seed,
    )
    assert again == found.report


def test_unknown_uncertainty_is_refused_by_name():
    parameters = ParameterSet((Parameter(name="k", value=1.0, std=None, unit="1"),))
    with pytest.raises(ParameterError, match="'k'"):
        Posterior.of(parameters, names=("k",))
    with pytest.raises(LoopShapingError, match="covariance"):
        Posterior.of(
            ParameterSet((Parameter(name="k", value=1.0, std=1.0, unit="1"),)),
            covariance=np.eye(2),
        )
    with pytest.raises(LoopShapingError, match="'k'"):
        Ranges({"k": (2.0, 1.0)})
    with pytest.raises(LoopShapingError, match="hypotheses"):
        PlantFamily(())


def test_the_posterior_of_a_fit_keeps_what_is_known_only_together():
    # A spinning inertia with friction: from torque and speed a fit knows both.
    graph = BondGraph("wheel", domain="rotation")
    graph.one("wheel", Se("torque"), I("inertia"), R("drag"))
    graph.measure("speed", flow="wheel")
    graph.parameter("inertia", 0.8, "kg*m^2")
    graph.parameter("drag", 0.5, "N*m*s/rad")
    time = np.linspace(0.0, 20.0, 2001)
    torque = np.sign(np.sin(1.3 * time))
    _, speed, _ = lsim(([1.0], [0.6, 0.3]), torque, time, interp=False)
    noisy = speed + np.random.default_rng(3).normal(0.0, 0.02, len(time))
    channels = {"torque": (torque, "N*m"), "speed": (noisy, "rad/s")}
    finished = graph.finish()
    recording = bind_to(finished, Recording.from_arrays("bench", time, channels))
    result = fit(finished, [recording])
    names = [estimate.name for estimate in result.estimates]
    posterior = Posterior.of(
        result.model.parameters, covariance=np.array(result.covariance), names=names
    )

    def servo(values):
        poles = (0.0, -values["drag"] / values["inertia"])
        return Loop(plant=ZeroPoleGain(poles=poles, gain=1 / values["inertia"]))

    hypothesis = PlantHypothesis(name="fit", build=servo, uncertainty=(posterior,))
    family = PlantFamily((hypothesis,))
    lead = ZeroPoleGain(zeros=(-1.0,), gain=2.0)
    report = robustness(lead, family, (PhaseMargin(45.0),), samples=100)
    assert report.violations == 0
    assert report.violated_at_most == pytest.approx(violated_at_most(0, 100, 0.95))
    tight = robustness(lead, family, (PhaseMargin(89.9),), samples=20)
    assert tight.violations == 20
