"""Alternatives against each other: what would part them, an input or a sensor."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.experiment.divergence import (
    Behaviour,
    behaviour,
    information,
    least_distance,
    unexplained,
    with_sensors,
)
from bondgraph.diagnosis.experiment.records import SensorAddition
from bondgraph.fitting.estimate import FittedModel
from bondgraph.numeric.model import NumericModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import OneJunction
from bondgraph.structure.signals import Signal

Array = NDArray[np.float64]
USUAL_NOISE = 1e-3
"""Of a signal's spread: noise of a sensor that is not there, at least."""
BEYOND = 3.0
"""An output may leave the range seen so far by this factor."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contest:
    """Fitted alternatives, with what is known of them and what hides a difference.

    Parameters
    ----------
    noise
        Per output, what none of them would explain anyway.
    known
        Of each, the information on its free parameters.
    nested
        Whether the others are the first with something added.
    """

    alternatives: tuple[FittedModel, ...]
    recordings: tuple[BoundRecording, ...]
    noise: Array
    known: tuple[Array, ...]
    nested: bool = False

    @classmethod
    def between(
        cls,
        alternatives: Sequence[FittedModel],
        recordings: Sequence[BoundRecording],
        *,
        nested: bool = False,
    ) -> "Contest":
        """Return the contest between alternatives fitted to the same recordings."""
        noise = unexplained(alternatives, recordings)
        return cls(
            alternatives=tuple(alternatives),
            recordings=tuple(recordings),
            noise=noise,
            known=tuple(information(one, noise) for one in alternatives),
            nested=nested,
        )

    def played(
        self, time: Array, inputs: Array, models: Sequence[NumericModel] | None = None
    ) -> list[Behaviour] | None:
        """Return what each alternative does under inputs; None where one of them fails.

        Parameters
        ----------
        models
            The alternatives with further sensors; as they are when None.
        """
        chosen = [one.problem.model for one in self.alternatives]
        chosen = chosen if models is None else list(models)
        found = []
        for one, known, model in zip(
            self.alternatives, self.known, chosen, strict=True
        ):
            done = behaviour(one, time, inputs, known, model)
            if done is None:
                return None
            found.append(done)
        return found

    def stay_near(self, done: Sequence[Behaviour]) -> bool:
        """Return whether no alternative takes an output far beyond the range seen."""
        seen = np.max([np.ptp(r.outputs, axis=0) for r in self.recordings], axis=0)
        return all((np.ptp(one.outputs, axis=0) <= BEYOND * seen).all() for one in done)

    def distance(self, done: Sequence[Behaviour]) -> float:
        """Return the sigmas between the two that differ least."""
        return least_distance(done, self.noise, nested=self.nested)

    def as_recorded(self, samples: int) -> tuple[float, tuple[SensorAddition, ...]]:
        """Return the sigmas under the first recorded inputs, and those with a sensor.

        One further sensor at a time, at each junction that all alternatives have, the
        best first; nothing where an alternative fails.
        """
        first, ny = self.recordings[0], len(self.noise)
        signals = self._unread()
        models = [with_sensors(one, signals) for one in self.alternatives]
        done = self.played(first.time[:samples], first.inputs[:samples], models)
        if done is None:
            return 0.0, ()
        recorded = self.distance([one.of(range(ny)) for one in done])
        found = []
        for k, noise in enumerate(self._assumed(done[0])):
            if not noise > 0.0:
                continue
            seen = [one.of((*range(ny), ny + k)) for one in done]
            total = np.append(self.noise, noise)
            sigmas = least_distance(seen, total, nested=self.nested)
            found.append(self._addition(signals[k], sigmas))
        worth = (addition for addition in found if addition.sigmas > 0.0)
        return recorded, tuple(sorted(worth, key=lambda addition: -addition.sigmas))

    def _assumed(self, done: Behaviour) -> Array:
        """Return the noise of further sensors, in proportion as of those there are."""
        ny, spread = len(self.noise), np.std(done.outputs, axis=0)
        share = np.median(self.noise / np.where(spread > 0.0, spread, np.inf)[:ny])
        assumed: Array = max(float(share), USUAL_NOISE) * spread[ny:]
        return assumed

    def _unread(self) -> tuple[Signal, ...]:
        """Return the common variables of junctions of all that no sensor reads."""
        first, *rest = (one.graph for one in self.alternatives)
        read = {measurement.expression for measurement in first.measurements}
        signals = (
            Signal(
                Quantity.FLOW if isinstance(j, OneJunction) else Quantity.EFFORT, j.name
            )
            for j in first.junctions
            if all(other.has_place(j.name) for other in rest)
        )
        return tuple(signal for signal in signals if signal not in read)

    def _addition(self, signal: Signal, sigmas: float) -> SensorAddition:
        domain = self.alternatives[0].graph.domain_at(signal.place)
        return SensorAddition(
            quantity=domain.word(signal.quantity), place=signal.place, sigmas=sigmas
        )
