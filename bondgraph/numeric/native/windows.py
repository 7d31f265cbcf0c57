"""Many windows in native code, one after another, each from its own initial state."""

from bondgraph.numeric.compiled.loops import Array, Integers, compiled
from bondgraph.numeric.native.explicit import integrate_explicit
from bondgraph.numeric.native.implicit import integrate_implicit
from bondgraph.numeric.native.implicit_step import Tableau
from bondgraph.numeric.native.model import NativeSystem


@compiled
def explicit_windows(
    system: NativeSystem, substeps: int, zero_hold: bool, parameters: Array,
    directions: Integers, time: Array, u: Array, x0: Array, outputs: Array,
    sensitivities: Array, states: Array, edges: Integers, first: int, last: int,
    done: Integers,
) -> None:  # fmt: skip
    """Simulate the windows ``first … last - 1`` with `integrate_explicit`."""
    for window in range(first, last):
        a, b = edges[window], edges[window + 1]
        some = b if len(sensitivities) else 0
        done[window] = integrate_explicit(
            system, substeps, zero_hold, parameters, directions, time[a:b], u[a:b],
            x0[window], outputs[a:b], sensitivities[min(a, some) : some], states[a:b],
        )  # fmt: skip


@compiled
def implicit_windows(
    system: NativeSystem, method: Tableau, parameters: Array, directions: Integers,
    time: Array, u: Array, x0: Array, outputs: Array, sensitivities: Array,
    states: Array, edges: Integers, first: int, last: int, done: Integers,
) -> None:  # fmt: skip
    """Simulate the windows ``first … last - 1`` with `integrate_implicit`."""
    for window in range(first, last):
        a, b = edges[window], edges[window + 1]
        some = b if len(sensitivities) else 0
        done[window] = integrate_implicit(
            system, method, parameters, directions, time[a:b], u[a:b],
            x0[window], outputs[a:b], sensitivities[min(a, some) : some], states[a:b],
        )  # fmt: skip
