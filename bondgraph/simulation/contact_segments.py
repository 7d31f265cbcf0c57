"""Pieces of a window with hard contacts, each run with its gaps held open or shut."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.numeric.model import ContactForm
from bondgraph.simulation.engines import Engine
from bondgraph.simulation.impact import Instant, Watched, watched
from bondgraph.simulation.shots import Shooting, Shots
from bondgraph.simulation.solvers import Hold, Implicit

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Position:
    """Where a window is.

    Parameters
    ----------
    slopes
        Of the states along the directions wanted, ``[state, direction]``.
    shut
        Which gaps are held shut.
    """

    time: float
    x: Array
    slopes: Array
    shut: Flags

    def opened(self, contact: int) -> "Position":
        """Return it with one gap held open."""
        shut = self.shut.copy()
        shut[contact] = False
        return replace(self, shut=shut)

    def jumped(self, x: Array, shut: Flags) -> "Position":
        """Return it with other states and gaps."""
        return replace(self, x=x, shut=shut)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Segments:
    """Runs the pieces of one window.

    Parameters
    ----------
    route
        How windows without events are simulated: `shoot`.
    """

    form: ContactForm
    parameters: Array
    directions: Integers | None
    solver: Implicit
    hold: Hold
    engine: Engine
    route: Callable[..., Shooting]
    time: Array
    inputs: Array

    def run(self, start: Position, time: Array, inputs: Array) -> Shooting:
        """Run from `start` over samples, the first of which is its time."""
        hold = start.shut.astype(float)
        return self.route(
            self.form.held,
            Shots(time, inputs, np.zeros((len(time), 0)), (0, len(time))),
            parameters=np.concatenate([self.parameters, hold, 0.0 * hold]),
            initial=start.x[None, :],
            directions=self.directions,
            solver=self.solver,
            hold=self.hold,
            engine=self.engine,
        )

    def within(self, start: Position, row: int, end: float) -> Shooting:
        """Run from `start` to `end`, both between samples `row` and the next."""
        if row + 1 >= len(self.time):
            return self.run(start, self.time[row:], self.inputs[row:])
        time = np.array([start.time, end])
        return self.run(start, time, np.stack([self.at(row, t) for t in time]))

    def at(self, row: int, time: float) -> Array:
        """Return the inputs at a time after sample `row` until just before the next."""
        found: Array = self.inputs[row] + self.rates(row) * (time - self.time[row])
        return found

    def rates(self, row: int) -> Array:
        """Return the rates of the inputs from sample `row` up to the next."""
        if self.hold is Hold.ZERO or row + 1 >= len(self.time):
            return np.zeros(self.inputs.shape[1])
        rise: Array = self.inputs[row + 1] - self.inputs[row]
        return rise / self.step(row)

    def step(self, row: int) -> float:
        """Return the time from sample `row` to the next; 1 where there is none."""
        last = min(row + 1, len(self.time) - 1)
        return float(self.time[last] - self.time[row]) or 1.0

    def instant(self, row: int, time: float) -> Instant:
        """Return the inputs just after a time between sample `row` and the next."""
        rates = self.rates(row)
        here = self.inputs[row] + rates * (time - self.time[row])
        return Instant(time, here, rates)

    def seen(self, shot: Shooting) -> Watched:
        """Return what is told of the contacts at each sample, ``[contact, sample]``."""
        return watched(self.form, shot.outputs.T)

    def reading(self, start: Position, row: int) -> Watched:
        """Return what is told of the contacts just after `start`."""
        last = min(row + 1, len(self.time) - 1)
        shot = self.within(start, row, float(self.time[last]))
        return watched(self.form, shot.outputs[0])

    def sloped(self, start: Position, shot: Shooting) -> Array:
        """Return the slopes of all outputs, ``[sample, output, direction]``."""
        if self.directions is None:
            return np.zeros((0, shot.outputs.shape[1], 0))
        count = len(self.directions)
        found: Array = shot.sensitivities[:, :, count:] @ start.slopes
        found[:, :, :count] += shot.sensitivities[:, :, :count]
        return found

    def moved(
        self, start: Position, shot: Shooting, sample: int, time: float
    ) -> Position:
        """Return where a piece is at one of its samples."""
        slopes = start.slopes
        if self.directions is not None:
            slopes = watched(self.form, self.sloped(start, shot)[sample]).states
        return Position(float(time), shot.states[sample], slopes, start.shut)

    def gap_slopes(self, start: Position, shot: Shooting, contact: int) -> Array:
        """Return the slopes of a penetration at the end of a piece."""
        if self.directions is None:
            return np.zeros(0)
        sloped = watched(self.form, self.sloped(start, shot)[-1])
        found: Array = sloped.penetrations[contact]
        return found
