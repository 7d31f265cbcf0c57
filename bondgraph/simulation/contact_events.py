"""Events of hard contacts: where within a step they lie, and what holds after them."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bondgraph.simulation.contact_segments import Position, Segments
from bondgraph.simulation.contact_slopes import slopes_after
from bondgraph.simulation.events import Event, EventKind
from bondgraph.simulation.impact import ImpactLaw, Instant, Watched
from bondgraph.simulation.shots import Shooting
from bondgraph.simulation.trouble import RunStatus, Trouble

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

GLANCE = 1e-6  # of a step, the time within which last bounces are no longer followed
NEAR = 1e-9  # of the largest depth, rate or force seen, what counts as none
LOCATED = 1e-14  # of the rest of a step, to which an event is located
MOST_EVENTS = 10_000  # within one step
STARTS = 40  # halvings of a step, to find open a gap that has just opened


class Stopped(Exception):  # noqa: N818  (no error: it ends one window)
    """A window that goes no further."""

    def __init__(self, trouble: Trouble) -> None:
        super().__init__(trouble)
        self.trouble = trouble


def check(shot: Shooting, samples: int) -> None:
    """Stop where a piece failed before that many samples.

    Raises
    ------
    Stopped
    """
    if shot.trouble[0] is not None:
        done = int(np.isfinite(shot.states[:samples]).all(axis=1).sum())
        if done < samples:
            raise Stopped(shot.trouble[0])


class ContactEvents:
    """Finds and resolves the events of one window.

    ``found`` holds what happened; ``depth``, ``speed`` and ``force`` are the largest
    that were seen, against which rounding is judged.
    """

    def __init__(self, segments: Segments) -> None:
        self.segments = segments
        self.law = ImpactLaw(segments.form, segments.parameters)
        self.found: list[Event] = []
        self.depth = self.speed = self.force = 0.0

    def begin(self, here: Position) -> Position:
        """Return the start, after the impact of what begins at or inside a stop.

        Raises
        ------
        EquationError
            If the law of a contact pulls instead of holding.
        """
        self.law.refuse_pulling(self.segments.instant(0, here.time), here.x)
        seen = self.segments.reading(here, 0)
        inside = (seen.penetrations >= 0.0) & (seen.rates >= 0.0)
        for k in np.flatnonzero(inside).tolist():
            if not here.shut[k]:
                here = self._impact(here, 0, k, np.zeros(here.slopes.shape[1]))
        return here

    def wrong(self, seen: Watched, shut: Flags) -> Flags:
        """Return where a gap held open closes, or one held shut pulls.

        Parameters
        ----------
        seen
            ``[contact, sample]``.
        """
        held = shut[:, None]
        self._look(seen, held)
        closes = ~held & (seen.penetrations > 0.0) & (seen.rates > 0.0)
        return closes | (held & (seen.forces < -NEAR * self.force))

    def cross(self, here: Position, row: int) -> Position:
        """Return where the window is at the sample after `row`, events included.

        Raises
        ------
        Stopped
            If a piece fails or the events do not end.
        """
        segments = self.segments
        end = float(segments.time[row + 1])
        for _ in range(MOST_EVENTS):
            shot = segments.within(here, row, end)
            check(shot, 2)
            seen = segments.seen(shot)
            wrong = np.flatnonzero(self.wrong(seen, here.shut)[:, 1]).tolist()
            if not wrong:
                return segments.moved(here, shot, 1, end)
            time, k = min((self._locate(here, row, end, k, seen), k) for k in wrong)
            gap_slopes = np.zeros(here.slopes.shape[1])
            if time > here.time:
                shot = segments.within(here, row, time)
                check(shot, 2)
                gap_slopes = segments.gap_slopes(here, shot, k)
                here = segments.moved(here, shot, 1, time)
            if here.shut[k]:
                here = self.let_go(here, k)
            else:
                here = self._impact(here, row, k, gap_slopes)
        raise Stopped(
            Trouble(
                status=RunStatus.NOT_CONVERGED,
                time=here.time,
                unknown=f"more than {MOST_EVENTS} events of hard contacts in a step",
            )
        )

    def let_go(self, here: Position, k: int) -> Position:
        """Return where the window is after contact `k` has let go."""
        self._note(here.time, k, EventKind.RELEASE)
        return here.opened(k)

    def _look(self, seen: Watched, shut: Flags) -> None:
        """Note how large depths, rates and forces are."""

        def most(values: Array) -> float:
            return float(np.nanmax(np.abs(values), initial=0.0))

        self.depth = max(self.depth, most(seen.penetrations))
        self.speed = max(self.speed, most(seen.rates))
        self.force = max(self.force, most(np.where(shut, seen.forces, 0.0)))

    def _locate(
        self, here: Position, row: int, end: float, k: int, seen: Watched
    ) -> float:
        """Return the time at which contact `k` shuts or lets go."""
        from scipy.optimize import brentq  # noqa: PLC0415  (0.2 s)

        span = end - here.time
        begun = float(seen.penetrations[k, 0])
        touching = not here.shut[k] and begun > -NEAR * self.depth

        def margin(share: float) -> float:
            shot = self.segments.within(here, row, here.time + share * span)
            check(shot, 2)
            now = self.segments.seen(shot)
            if here.shut[k]:
                return float(now.forces[k, 1])
            depth = float(now.penetrations[k, 1])
            # Of a gap that has just opened, the first root is the start itself.
            return (depth - begun) / share if touching else depth

        low, low_margin = 0.0, float(seen.forces[k, 0]) if here.shut[k] else begun
        if touching:
            low_margin = float(seen.rates[k, 0]) * span
            if low_margin >= -NEAR * self.speed * span:
                low, low_margin = _first_open(margin)
        high_margin = margin(1.0)
        begins = low_margin <= 0.0 if here.shut[k] else touching and low_margin >= 0.0
        if begins:
            return here.time
        if low_margin * high_margin >= 0.0:
            return end

        ends = {low: low_margin, 1.0: high_margin}
        share = brentq(
            lambda share: ends[share] if share in ends else margin(share),
            low, 1.0, xtol=LOCATED, rtol=1e-15,
        )  # fmt: skip
        return float(here.time + share * span)

    def _impact(self, here: Position, row: int, k: int, gap_slopes: Array) -> Position:
        """Return where the window is after contact `k` has shut."""
        segments = self.segments
        at = segments.instant(row, here.time)
        before = segments.reading(here, row)
        self._look(before, here.shut)
        touching = here.shut | (before.penetrations >= -NEAR * self.depth)
        touching[k] = True
        after = self.law.after(at, here.x, touching, plastic=np.zeros_like(touching))
        closing = self.law.response(at, after).approach
        still = here.shut & (closing > -NEAR * self.speed)
        resting = touching & ~still & self._rests(here.jumped(after, still), row)
        if resting.any():
            after = self.law.after(at, here.x, touching, plastic=resting)
        there = self._holding(here.jumped(after, still | resting), row)
        self._tell(here, there, touching, before)
        if segments.directions is None:
            return there

        def jump(law: ImpactLaw, at: Instant, x: Array) -> Array:
            return law.after(at, x, touching, plastic=resting)

        slopes = slopes_after(
            segments, jump, here, at, segments.step(row), before,
            segments.reading(there, row), gap_slopes, float(before.rates[k]),
        )  # fmt: skip
        return Position(there.time, there.x, slopes, there.shut)

    def _rests(self, here: Position, row: int) -> Flags:
        """Return which gaps would shut again so soon that they stay shut."""
        seen = self.segments.reading(here, row)
        left = GLANCE * self.segments.step(row) * (1.0 - seen.restitution)
        soon = -2.0 * seen.rates <= left * seen.bends
        still = np.abs(seen.rates) <= NEAR * self.speed
        return (soon & (seen.bends > 0.0)) | (still & (seen.bends >= 0.0))

    def _holding(self, here: Position, row: int) -> Position:
        """Return a position whose shut gaps all push."""
        while here.shut.any():
            seen = self.segments.reading(here, row)
            self._look(seen, here.shut)
            forces = np.where(here.shut, seen.forces, 0.0)
            k = int(np.argmin(forces))
            if forces[k] >= -NEAR * self.force:
                break
            here = here.opened(k)
        return here

    def _tell(
        self, here: Position, there: Position, touching: Flags, before: Watched
    ) -> None:
        for k in np.flatnonzero(touching).tolist():
            if not here.shut[k] and before.rates[k] > NEAR * self.speed:
                self._note(here.time, k, EventKind.IMPACT)
            if there.shut[k] != here.shut[k]:
                now = EventKind.RESTS if there.shut[k] else EventKind.RELEASE
                self._note(here.time, k, now)

    def _note(self, time: float, k: int, kind: EventKind) -> None:
        place = self.segments.form.places[k]
        self.found.append(Event(time=float(time), place=place, kind=kind))


def _first_open(margin: Callable[[float], float]) -> tuple[float, float]:
    """Return a share of a step after which a gap that was touching is open."""
    share, found = 1.0, 0.0
    for _ in range(STARTS):
        share *= 0.5
        found = margin(share)
        if found < 0.0:
            break
    return share, found
