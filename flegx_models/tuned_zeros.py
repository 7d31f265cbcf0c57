"""What the tuned zeros of chapter 6 say about friction (eq. 6.1 to 6.4).

Section 5.2 puts the controller's zero on the train's friction pole, so that the loop
stays what it is: for a viscous friction c the zero belongs at z = c / J, J the inertia
at the joint. Dry friction has no pole, but in a test that repeats the joint's speed is
nearly a sine of amplitude V, and what the loop meets of a dry friction F is, to first
harmonic, a viscous one of 4 F / (π V) (Gelb and Vander Velde 1968, section 2.3). Hence

    z = (c + 4 F / (π V)) / J,    F = (κ_d - κ_b)/2 · |T| + F₀.

T is the torque that the worm passes on (here gravity's in the test posture), κ_d and
κ_b the worm's driving and back-driving factors (`flegx_models.jump.worm`), F₀ friction
without load. So the zero has to rise

- in stance far more than in flight, as T does (6 times at the hip, 49 at the knee);
- at the hip twice as much as at the knee, because its swing and with it V is half.

No number here is adjusted to the tuned zeros; `identified_friction` then reads f and F₀
off them and says how well two numbers explain four zeros.
"""

import math
from dataclasses import dataclass

import numpy as np

from flegx_models.controllers import MODELS, controller
from flegx_models.gravity import printed_feed_forward
from flegx_models.jump.worm import WormGear, irreversible_worm
from flegx_models.parameters import RECONCILED
from flegx_models.parameters_control import CONTROL
from flegx_models.published import PUBLISHED
from flegx_models.splines import Motion, QuinticSpline

_SAMPLES = 2000


@dataclass(frozen=True, slots=True, kw_only=True)
class TuningTest:
    """One of the four tuning tests of section 6.1.

    Parameters
    ----------
    inertia
        J in kg·m².
    speed
        V, amplitude of the first harmonic of the wanted speed, in rad/s.
    load
        |T| in N·m, gravity's torque in the middle of the test.
    viscous
        c of the bearings in N·m·s.
    tuned_zero
        rad/s.
    """

    model: str
    inertia: float
    speed: float
    load: float
    viscous: float
    tuned_zero: float

    def zero(self, worm: WormGear) -> float:
        """Return the zero in rad/s that this worm asks for."""
        dry = friction_per_load(worm) * self.load + worm.constant
        return (self.viscous + 4 * dry / (math.pi * self.speed)) / self.inertia

    @property
    def friction_of_the_zero(self) -> float:
        """The dry friction F in N·m that the tuned zero stands for."""
        whole = self.tuned_zero * self.inertia - self.viscous
        return whole * math.pi * self.speed / 4


def friction_per_load(worm: WormGear) -> float:
    """Return half the width of the worm's hysteresis per torque passed on."""
    return (worm.driving - worm.backdriving) / 2


def tuning_tests() -> tuple[TuningTest, ...]:
    """Return the four tests, in the order of `flegx_models.controllers.MODELS`."""
    return tuple(map(_test, MODELS))


def first_harmonic_of_the_speed(swing: float, period: float) -> float:
    """Return V in rad/s of splines to and fro over `swing` rad, each half a period."""
    there = QuinticSpline(Motion(0.0), Motion(swing), period / 2)
    times = (np.arange(_SAMPLES) + 1 / 2) / _SAMPLES * period / 2
    speeds = np.array([there.at(float(t)).speed for t in times])
    # The way back is the way there with the other sign, so half a period is enough.
    return float(2 * np.mean(speeds * np.sin(2 * np.pi * times / period)))


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentifiedFriction:
    """The worm that explains the four tuned zeros best, by least squares of F.

    Parameters
    ----------
    worm
        With the friction and the constant part found.
    zeros
        rad/s that it asks for, in the order of the tests.
    residual
        Root mean square of the friction left over, in N·m.
    """

    worm: WormGear
    zeros: tuple[float, ...]
    residual: float


def identified_friction() -> IdentifiedFriction:
    """Return friction coefficient and constant part from the four tuned zeros."""
    from scipy.optimize import brentq  # noqa: PLC0415

    tests = tuning_tests()
    columns = np.array([[test.load, 1.0] for test in tests])
    found = np.array([test.friction_of_the_zero for test in tests])
    (per_load, constant), *_ = np.linalg.lstsq(columns, found, rcond=None)
    ideal = irreversible_worm()

    def excess(friction: float) -> float:
        return friction_per_load(ideal.with_friction(friction)) - float(per_load)

    friction = float(brentq(excess, 0.0, 1.0))
    worm = ideal.with_friction(friction, max(float(constant), 0.0))
    left = columns @ np.array([per_load, worm.constant]) - found
    return IdentifiedFriction(
        worm=worm,
        zeros=tuple(test.zero(worm) for test in tests),
        residual=float(np.sqrt(np.mean(left**2))),
    )


def _test(model: str) -> TuningTest:
    link, phase = model.split("_")
    v, mechanical = CONTROL.values_by_name(), RECONCILED.values_by_name()
    carried = printed_feed_forward(phase)
    knee = v["hip_test"] + v["knee_test"]
    at_hip, at_knee = carried.torques(v["hip_test"], knee)
    gain = next(p.gain for p in PUBLISHED if p.model == model)
    return TuningTest(
        model=model,
        inertia=mechanical["K_gearbox"] * mechanical["K_worm_gear"] / gain,
        speed=first_harmonic_of_the_speed(v[f"swing_{link}"], v["period_test"]),
        load=abs(at_hip if link == "upperleg" else at_knee),
        viscous=mechanical[f"c_friction_{link}"],
        tuned_zero=controller(model, "tuned").zero,
    )
