"""Events of a simulation, found from its solution: friction and contact."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Modes = NDArray[np.int64]


class EventKind(StrEnum):
    """What happens."""

    STICKS = "sticks"
    SLIPS = "slips"
    TURNS = "turns round"
    CONTACT = "contact"
    RELEASE = "release"
    IMPACT = "impact"
    RESTS = "comes to rest"


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """One event.

    Parameters
    ----------
    time
        In s. A friction's stop, and what a hard contact does, are located within their
        step; a start of slip, and the contact and release of a law in pieces, are
        those of the first sample that shows them.
    place
        The element or elements.
    """

    time: float
    place: str
    kind: EventKind


def friction_events(
    places: tuple[str, ...], modes: Modes, since: Array
) -> tuple[Event, ...]:
    """Return the changes of modes of set-valued frictions, in order of time.

    Parameters
    ----------
    modes, since
        ``[sample, friction]``: 1 and -1 while it slips, 0 while it sticks, and the time
        in s at which it took that mode.
    """
    found = []
    for k, place in enumerate(places):
        slips = np.abs(modes[:, k]) == 1
        for row in np.flatnonzero(np.diff(modes[:, k]) != 0) + 1:
            kind = EventKind.STICKS
            if slips[row]:
                kind = EventKind.TURNS if slips[row - 1] else EventKind.SLIPS
            elif not slips[row - 1]:
                continue
            found.append(Event(time=float(since[row, k]), place=place, kind=kind))
    return tuple(sorted(found, key=lambda event: event.time))


def contact_events(
    places: tuple[str, ...], time: Array, efforts: Array
) -> tuple[Event, ...]:
    """Return where laws with a dead range take hold and let go.

    Parameters
    ----------
    efforts
        ``[sample, place]``; exactly zero where nothing touches.
    """
    found = []
    for k, place in enumerate(places):
        touches = efforts[:, k] != 0.0
        if touches.all() or (~touches).sum() < 2:
            continue
        for row in np.flatnonzero(touches[1:] != touches[:-1]) + 1:
            kind = EventKind.CONTACT if touches[row] else EventKind.RELEASE
            found.append(Event(time=float(time[row]), place=place, kind=kind))
    return tuple(sorted(found, key=lambda event: event.time))
