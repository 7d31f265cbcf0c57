"""The delivered controller around its plant: measured exactly, and simulated.

Between samples the command is held and a linear plant moves by matrix exponentials, so
that the simulation is exact; a plant with dry friction or a stop is any object that can
move on under a constant command. Computing takes time: the command of a sample acts
that much later. The encoder sees whole steps, and the actuator has limits.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bondgraph.choices import is_finite
from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.delivery.digital import DigitalController
from bondgraph.loopshaping.delivery.discretise import ExactHold, propagated
from bondgraph.loopshaping.loop import Loop, zero_pole_gain
from bondgraph.loopshaping.realisation import Matrices, realise
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain


class AbstractPlant(ABC):
    """A machine that moves on under a command that is held."""

    @abstractmethod
    def output(self) -> float:
        """Return what the sensor would measure now, in SI units."""

    @abstractmethod
    def advance(self, command: float, duration: float) -> None:
        """Move on for `duration` seconds under a constant command."""


class LinearPlant(AbstractPlant):
    """A linear system without delay, from rest; exact under a held command."""

    def __init__(self, system: ZeroPoleGain) -> None:
        if system.delay or system.period is not None or system.relative_degree < 1:
            raise LoopShapingError(
                "A plant to simulate is continuous, without delay and with more poles "
                "than zeros.",
                remedy="Say computing_time for a delay.",
            )
        self._A, self._B, self._C, _ = realise(system)
        self._x = np.zeros((len(self._A), 1))
        self._moves: dict[float, tuple[FloatArray, FloatArray]] = {}

    def output(self) -> float:
        """Return the output."""
        return float((self._C @ self._x)[0, 0])

    def advance(self, command: float, duration: float) -> None:
        """Move on for `duration` seconds under a constant command."""
        if duration not in self._moves:
            self._moves[duration] = propagated(self._A, self._B, duration)
        move, drive = self._moves[duration]
        self._x = move @ self._x + drive * command


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder:
    """A sensor that tells whole steps.

    Parameters
    ----------
    step
        In the output's unit; zero for none.
    noise
        Standard deviation of white noise before the steps are counted.
    """

    step: float = 0.0
    noise: float = 0.0

    def __post_init__(self) -> None:
        for what, value in (("step", self.step), ("noise", self.noise)):
            if not (is_finite(value) and value >= 0):
                raise LoopShapingError(
                    f"The {what} of an encoder is {value!r}.",
                    (what,),
                    "Give a finite number that is not negative.",
                )

    def read(self, output: float, generator: np.random.Generator) -> float:
        """Return what the controller is told."""
        if self.noise:
            output += self.noise * float(generator.standard_normal())
        if not self.step:
            return output
        return self.step * math.floor(output / self.step + 0.5)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampledRun:
    """A simulated run, one value per sample; `output` is true, `measured` was told."""

    time: FloatArray
    reference: FloatArray
    output: FloatArray
    measured: FloatArray
    command: FloatArray

    @property
    def rms_error(self) -> float:
        """Root mean square of reference minus true output."""
        return float(np.sqrt(np.mean((self.reference - self.output) ** 2)))


def simulate_sampled(
    plant: AbstractPlant,
    controller: DigitalController,
    reference: Callable[[float], float],
    duration: float,
    *,
    computing_time: float = 0.0,
    encoder: Encoder | None = None,
    feedforward: Callable[[float], float] | None = None,
    actuator_limits: tuple[float, float] = (-math.inf, math.inf),
    seed: int = 0,
) -> SampledRun:
    """Return how the controller drives a plant.

    Parameters
    ----------
    plant
        Moves on as the simulation runs; make a fresh one for each.
    reference
        Of time in seconds.
    computing_time
        Seconds from a sample until its command acts.
    feedforward
        Added to the command, of the measured output.
    actuator_limits
        Of what acts, whatever the controller's own limits are.
    """
    if not computing_time >= 0:
        raise LoopShapingError(
            f"A computing time of {computing_time} s is no time.",
            remedy="Give a number of seconds that is not negative.",
        )
    run, period = controller.run(), controller.period
    sensor, generator = encoder or Encoder(), np.random.default_rng(seed)
    whole = math.floor(computing_time / period + 1e-9)
    late = max(computing_time - whole * period, 0.0)
    late = late if late > 1e-9 * period else 0.0
    acting = [0.0] * (whole + 1)  # commands on their way, the oldest first
    count = math.ceil(duration / period - 1e-9)
    rows = np.empty((count, 4))
    low, high = actuator_limits
    for k in range(count):
        wanted, true = reference(k * period), plant.output()
        told = sensor.read(true, generator)
        command = run.step(wanted, told, feedforward(told) if feedforward else 0.0)
        rows[k] = wanted, true, told, command
        acting.append(min(max(command, low), high))
        if late:
            plant.advance(acting[0], late)
        acting.pop(0)
        plant.advance(acting[0], period - late)
    columns = rows.T.copy()
    return SampledRun(
        time=np.arange(count) * np.float64(period),
        reference=columns[0],
        output=columns[1],
        measured=columns[2],
        command=columns[3],
    )


def sampled_loop(
    plant: ZeroPoleGain, controller: DigitalController, *, computing_time: float = 0.0
) -> Loop:
    """Return the loop from sample to sample, exactly, for `measure`.

    The controller has its rounded coefficients; steps of signals are left out.

    Parameters
    ----------
    plant
        Continuous, with any delay of its own.
    """
    late = replace(plant, delay=plant.delay + computing_time)
    ahead, behind = controller.rounded()
    period = controller.period
    return Loop(
        plant=ExactHold()(late, period),
        controller=_factored(ahead, controller.controller, period),
        feedback=_factored(behind, controller.filter, period),
    )


def _factored(matrices: Matrices, made: ZeroPoleGain, period: float) -> ZeroPoleGain:
    """Return the factored form of rounded matrices; as designed where none changed."""
    same = zip(matrices, realise(made), strict=True)
    if all(np.array_equal(one, other) for one, other in same):
        return made
    import control  # noqa: PLC0415

    return zero_pole_gain(control.StateSpace(*matrices, period))
