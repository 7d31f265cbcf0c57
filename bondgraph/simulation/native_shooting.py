"""Windows simulated in native code: arrays in, arrays out, on two threads."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bondgraph.equations.hard_contact import refuse_hard_contact
from bondgraph.errors import EquationError
from bondgraph.numeric.explicit_form import explicit_form
from bondgraph.numeric.model import NumericModel
from bondgraph.simulation.solvers import RungeKutta4, Sdirk2, Sdirk3
from bondgraph.simulation.threads import in_parallel

if TYPE_CHECKING:
    from bondgraph.numeric.native.model import NativeSystem

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
SomeWindows = Callable[[int, int], None]
WORTH_A_THREAD = 4000
"""Explicit steps; a shorter simulation ends before another thread has woken."""

IMPLICIT_STEP = 4
"""Explicit steps that take as long as an implicit one."""


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """What is simulated: samples laid end to end, their edges, initial states."""

    time: Array
    inputs: Array
    edges: Integers
    initial: Array


@dataclass(frozen=True, slots=True, eq=False)
class NativeRun:
    """Outputs, states and sensitivities as in `Shooting`; samples done per window."""

    outputs: Array
    states: Array
    sensitivities: Array
    done: Integers


def run_native(
    model: NumericModel,
    windows: Windows,
    parameters: Array,
    directions: Integers | None,
    solver: RungeKutta4 | Sdirk2 | Sdirk3,
    *,
    zero_hold: bool,
    of_initial: bool = True,
    optimised: bool = False,
) -> NativeRun:
    """Simulate every window in native code.

    Parameters
    ----------
    directions
        Parameters whose sensitivities are wanted; None for no sensitivities at all.
    of_initial
        Whether those to the initial states follow.
    optimised
        Whether code that is a little faster is worth waiting for.

    Raises
    ------
    EquationError
        If an explicit method is asked for a model whose rates are only implicit.
    """
    from bondgraph.numeric.native.model import native_model  # noqa: PLC0415  (LLVM)

    n, nx, ny = len(windows.time), model.n_states, len(model.output_names)
    if directions is not None and not len(directions) + (nx if of_initial else 0):
        # Code made to follow derivatives has no plain values to call for none of them.
        run = run_native(
            model, windows, parameters, None, solver,
            zero_hold=zero_hold, optimised=optimised,
        )  # fmt: skip
        return replace(run, sensitivities=np.zeros((n, ny, 0)))
    explicit = isinstance(solver, RungeKutta4)
    if explicit:
        model = stepped_explicitly(model)
    native = native_model(
        model,
        along=None if directions is None else set(directions.tolist()),
        explicit=explicit,
        optimised=optimised,
    )
    wanted = np.zeros(0, np.int64) if directions is None else directions
    rows = 0 if directions is None else n
    run = NativeRun(
        np.empty((n, ny)),
        np.empty((n, nx)),
        np.zeros((rows, ny, len(wanted) + (nx if of_initial else 0))),
        np.zeros(len(windows.edges) - 1, dtype=np.int64),
    )
    given = (parameters, wanted, windows.time, windows.inputs, windows.initial)
    filled = (run.outputs, run.sensitivities, run.states, windows.edges)
    simulate = _stepping(native.system, solver, zero_hold, given, filled, run.done)
    _share(simulate, len(run.done), n if explicit else IMPLICIT_STEP * n)
    for window in np.flatnonzero(run.done < windows.edges[1:] - windows.edges[:-1]):
        left = slice(
            windows.edges[window] + run.done[window], windows.edges[window + 1]
        )
        run.outputs[left] = run.states[left] = np.nan
    return run


def _stepping(
    system: "NativeSystem",
    solver: RungeKutta4 | Sdirk2 | Sdirk3,
    zero_hold: bool,
    given: tuple[Array, Integers, Array, Array, Array],
    filled: tuple[Array, Array, Array, Integers],
    done: Integers,
) -> SomeWindows:
    """Return what simulates the windows from one to before another by that method."""
    if isinstance(solver, RungeKutta4):
        from bondgraph.numeric.native.windows import explicit_windows  # noqa: PLC0415

        def explicitly(first: int, last: int) -> None:
            explicit_windows(
                system, solver.substeps, zero_hold, *given, *filled, first, last, done
            )

        return explicitly
    from bondgraph.numeric.native.implicit_step import Tableau  # noqa: PLC0415
    from bondgraph.numeric.native.windows import implicit_windows  # noqa: PLC0415

    method = Tableau(*solver.tableau, solver.substeps, zero_hold)

    def implicitly(first: int, last: int) -> None:
        implicit_windows(system, method, *given, *filled, first, last, done)

    return implicitly


def _share(simulate: SomeWindows, windows: int, steps: int) -> None:
    """Simulate all windows, on several threads where they are long enough."""
    if steps < WORTH_A_THREAD:
        simulate(0, windows)
    else:
        in_parallel(simulate, windows)


def suits_explicit(model: NumericModel) -> bool:
    """Return whether an explicit method can step a model: nothing in it sticks.

    Says nothing about stiffness.
    """
    held = model.contacts is not None or model.set_valued is not None
    return not held and model.n_states > 0 and explicit_form(model) is not None


def stepped_explicitly(model: NumericModel) -> NumericModel:
    """Return the model solved for its rates; refuse one that cannot be, saying why."""
    if model.contacts is not None:
        refuse_hard_contact(
            model.name, model.contacts.places, "whose force an explicit method lacks"
        )
    if model.set_valued is not None:
        raise EquationError(
            f"{model.name!r} has dry friction that can stick; an explicit method "
            "cannot hold it still.",
            (model.name,),
            "Use Sdirk2() or Sdirk3(), or write tanh(f / slip) instead of sign(f).",
        )
    form = explicit_form(model)
    if form is None:
        raise EquationError(
            f"The rates of {model.name!r} are only given implicitly "
            f"({model.n_unknowns} unknowns besides them).",
            (model.name,),
            "Use Sdirk2() or Sdirk3(), which solve for them.",
        )
    return form
