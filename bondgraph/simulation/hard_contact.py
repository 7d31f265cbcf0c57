"""Windows of models with hard contacts: run to each event, jump, and run on.

Between events the model is an ordinary one, its gaps held open or shut by parameters.
A sample that shows a penetration, or a force that pulls, sends the run back into the
step before it, where the event is located; what is left of the step is a step of its
own, so the error stays that of a smooth run. A bounce that would last no millionth of
a step, and those after it, are the coming to rest.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import EquationError
from bondgraph.numeric.model import NumericModel
from bondgraph.simulation.contact_events import ContactEvents, Stopped, check
from bondgraph.simulation.contact_segments import Position, Segments
from bondgraph.simulation.engines import Engine, Interpreted, Native
from bondgraph.simulation.shots import Shooting, Shots
from bondgraph.simulation.solvers import Hold, Implicit
from bondgraph.simulation.trouble import RunStatus, Trouble

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

FIRST_LENGTH = 32  # samples tried after an event; twice as many each time none came


def shoot_with_contacts(
    model: NumericModel, shots: Shots, parameters: Array, initial: Array,
    directions: Integers | None, solver: Implicit, hold: Hold, engine: Engine,
    route: Callable[..., Shooting],
) -> Shooting:  # fmt: skip
    """Simulate every window, as `bondgraph.simulation.shooting.shoot` does.

    Parameters
    ----------
    route
        How windows without events are simulated.

    Raises
    ------
    EquationError
        If the law of a contact pulls instead of holding.
    """
    form = model.contacts
    assert form is not None
    native = engine.compiles(form.held, len(shots.time))
    windows = []
    for number, part in enumerate(shots.slices):
        segments = Segments(
            form=form, parameters=parameters, directions=directions, solver=solver,
            hold=hold, engine=Native() if native else Interpreted(), route=route,
            time=shots.time[part], inputs=shots.inputs[part],
        )  # fmt: skip
        window = _Window(segments, len(model.output_names))
        window.run(initial[number])
        windows.append(window)
    dry = model.set_valued is not None
    return Shooting(
        outputs=np.concatenate([w.outputs for w in windows]),
        states=np.concatenate([w.states for w in windows]),
        sensitivities=np.concatenate([w.sensitivities for w in windows]),
        completed=np.array([w.trouble is None for w in windows], dtype=np.bool_),
        trouble=tuple(w.trouble for w in windows),
        modes=np.concatenate([w.modes for w in windows]) if dry else None,
        since=np.concatenate([w.since for w in windows]) if dry else None,
        impacts=tuple(tuple(w.events.found) for w in windows),
    )


class _Window:
    """One window and its results so far."""

    def __init__(self, segments: Segments, n_outputs: int) -> None:
        self.segments = segments
        self.events = ContactEvents(segments)
        self.trouble: Trouble | None = None
        n, nx = len(segments.time), segments.form.held.n_states
        wanted, dry = segments.directions, segments.form.held.set_valued
        rows, columns = (0, 0) if wanted is None else (n, len(wanted) + nx)
        frictions = 0 if dry is None else len(dry.places)
        self.outputs = np.full((n, n_outputs), np.nan)
        self.states = np.full((n, nx), np.nan)
        self.sensitivities = np.zeros((rows, n_outputs, columns))
        self.modes = np.zeros((n, frictions), dtype=np.int64)
        self.since = np.full((n, frictions), -np.inf)

    def run(self, x: Array) -> None:
        """Run from the first sample to the last, or until it fails."""
        nx = len(x)
        slopes = np.zeros((nx, self.sensitivities.shape[2]))
        if self.segments.directions is not None:
            slopes[:, -nx:] = np.eye(nx)
        shut = np.zeros(len(self.segments.form.places), dtype=np.bool_)
        start = Position(float(self.segments.time[0]), x, slopes, shut)
        try:
            self._follow(self.events.begin(start))
        except Stopped as stopped:
            self.trouble = stopped.trouble
        except EquationError as error:
            done = np.isfinite(self.states).all(axis=1)
            if not done.any():
                raise
            last = float(self.segments.time[done][-1])
            self.trouble = Trouble(
                status=RunStatus.NOT_CONVERGED, time=last, unknown=error.problem
            )

    def _follow(self, here: Position) -> None:
        """Run in pieces that grow as long as nothing happens."""
        time, inputs = self.segments.time, self.segments.inputs
        row, length = 0, FIRST_LENGTH
        while True:
            end = min(row + length, len(time))
            shot = self.segments.run(here, time[row:end], inputs[row:end])
            seen = self.events.wrong(self.segments.seen(shot), here.shut)
            pulled = np.flatnonzero(seen[:, 0] & here.shut)
            if len(pulled):  # an input has jumped
                here = self.events.let_go(here, int(pulled[0]))
                continue
            seen[:, 0] = False
            wrong = np.flatnonzero(seen.any(axis=0)).tolist()
            kept = wrong[0] if wrong else end - row
            check(shot, kept)
            self._accept(here, shot, row, kept)
            row += kept - 1
            here = self.segments.moved(here, shot, kept - 1, time[row])
            length *= 2
            if wrong:
                here = self.events.cross(here, row)
                row, length = row + 1, FIRST_LENGTH
            elif row == len(time) - 1:
                return

    def _accept(self, start: Position, shot: Shooting, row: int, count: int) -> None:
        """Write the first samples of a piece to the results."""
        here, ny = slice(row, row + count), self.outputs.shape[1]
        self.outputs[here] = shot.outputs[:count, :ny]
        self.states[here] = shot.states[:count]
        if self.segments.directions is not None:
            sloped = self.segments.sloped(start, shot)
            self.sensitivities[here] = sloped[:count, :ny]
        if shot.modes is not None and shot.since is not None:
            since = shot.since[:count].copy()
            fresh = ~np.isfinite(since)
            since[fresh] = start.time
            if row > 0:
                kept = fresh & (shot.modes[:count] == self.modes[row - 1])
                since = np.where(kept, self.since[row - 1], since)
            self.modes[here], self.since[here] = shot.modes[:count], since
