"""What is simulated, windows laid end to end, and what that gives."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondgraph.simulation.events import Event
from bondgraph.simulation.trouble import Trouble

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Shots:
    """Windows of recordings laid end to end.

    Parameters
    ----------
    time, inputs, outputs
        Samples of all windows: (n,), (n, nu), (n, ny); a missing output is NaN. Time
        and inputs are kept as compiled loops take them, see `as_loops_take`.
    edges
        Window k holds the samples ``edges[k]:edges[k + 1]``.
    """

    time: Array
    inputs: Array
    outputs: Array
    edges: tuple[int, ...]

    def __post_init__(self) -> None:
        for name in ("time", "inputs"):
            object.__setattr__(self, name, as_loops_take(getattr(self, name)))

    def __reduce__(self) -> tuple[type["Shots"], tuple[object, ...]]:
        # Made anew in another process: pickled arrays are no longer read-only, and all
        # loops would be compiled there once more, for arrays that may be written.
        return Shots, (self.time, self.inputs, self.outputs, self.edges)

    @property
    def n_windows(self) -> int:
        """Number of windows."""
        return len(self.edges) - 1

    @property
    def timeless(self) -> bool:
        """Whether every sample is a window of its own, as in a steady table."""
        return self.n_windows == len(self.time)

    @cached_property
    def edge_array(self) -> NDArray[np.int64]:
        """The edges as loops take them, (n_windows + 1,)."""
        return np.array(self.edges, dtype=np.int64)

    @cached_property
    def lengths(self) -> NDArray[np.int64]:
        """How many samples each window holds."""
        return np.diff(self.edge_array)

    @cached_property
    def known(self) -> NDArray[np.bool_]:
        """Which readings there are, (n, ny)."""
        return np.isfinite(self.outputs)

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """The windows as slices."""
        return tuple(slice(a, b) for a, b in pairwise(self.edges))

    @cached_property
    def interval(self) -> float:
        """Median time between samples; 0 where every window has only one."""
        steps = np.concatenate([np.diff(self.time[part]) for part in self.slices])
        return float(np.median(steps)) if steps.size else 0.0

    def subset(self, windows: NDArray[np.int64], most: int | None = None) -> "Shots":
        """Return the windows numbered `windows`, each cut after `most` samples."""
        parts = [self.slices[w] for w in windows]
        stops = [s.stop if most is None else min(s.stop, s.start + most) for s in parts]
        lengths = [b - s.start for s, b in zip(parts, stops, strict=True)]
        ends = zip(parts, stops, strict=True)
        index = np.concatenate([np.arange(s.start, b) for s, b in ends])
        edges = np.cumsum([0, *lengths])
        return Shots(
            self.time[index],
            self.inputs[index],
            self.outputs[index],
            tuple(int(e) for e in edges),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Shooting:
    """What simulating all windows gave.

    Parameters
    ----------
    outputs, states
        (n, ny) and (n, nx).
    sensitivities
        (n, ny, nq + nx): to the chosen parameters, then to the initial state.
    completed
        Per window, whether it was simulated to its end with finite outputs.
    trouble
        Per window, why it was not; None where it was.
    modes, since
        (n, frictions): whether each set-valued friction slips (1, -1) or sticks (0),
        and the time at which it took that mode; None without such frictions.
    impacts
        Per window, the events of hard contacts.
    """

    outputs: Array
    states: Array
    sensitivities: Array
    completed: NDArray[np.bool_]
    trouble: tuple[Trouble | None, ...] = ()
    modes: NDArray[np.int64] | None = None
    since: Array | None = None
    impacts: tuple[tuple[Event, ...], ...] = ()


def as_loops_take(values: Array) -> Array:
    """Return samples laid out as compiled loops take them: row by row, read only.

    For every other layout numba would compile the whole loop anew, for most of a
    minute.
    """
    rows = np.ascontiguousarray(values, dtype=np.float64).view()
    rows.flags.writeable = False
    return rows
