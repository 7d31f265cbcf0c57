"""Windows simulated by the tape's kernel, in native code while friction modes last."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bondgraph.numeric.held_modes import with_modes_given
from bondgraph.numeric.model import NumericModel
from bondgraph.simulation.engines import Engine
from bondgraph.simulation.shots import Shots
from bondgraph.simulation.solvers import Implicit
from bondgraph.simulation.threads import in_parallel

if TYPE_CHECKING:
    from bondgraph.numeric.kernel.native_steps import Fast
    from bondgraph.numeric.kernel.stage_arrays import System

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class TapeRun:
    """Outputs, states, sensitivities, modes and times of modes as in `Shooting`.

    ``done``: samples done per window; ``trouble``: the kernel's codes of failures.
    """

    outputs: Array
    states: Array
    sensitivities: Array
    modes: Integers
    since: Array
    done: Integers
    trouble: Integers


def run_tape(
    model: NumericModel,
    shots: Shots,
    parameters: Array,
    initial: Array,
    directions: Integers | None,
    solver: Implicit,
    engine: Engine,
    *,
    zero_hold: bool,
    of_initial: bool,
) -> TapeRun:
    """Simulate every window; arguments as for `shoot`."""
    from bondgraph.numeric.kernel.method import Method  # noqa: PLC0415
    from bondgraph.numeric.kernel.windows import (  # noqa: PLC0415  (loads numba)
        Results,
        integrate_windows,
    )

    n, nx, ny = len(shots.time), model.n_states, len(model.output_names)
    wanted = np.zeros(0, np.int64) if directions is None else directions
    nd = 0 if directions is None else len(wanted) + (nx if of_initial else 0)
    outputs = np.full((n, ny), np.nan)
    states = np.full((n, nx), np.nan)
    sensitivities = np.zeros((n if directions is not None else 0, ny, nd))
    form = model if model.set_valued is None else model.set_valued
    system = _system(model)
    dry = system.nd
    method = Method(*solver.tableau, solver.substeps, zero_hold)
    values = np.concatenate([parameters, np.zeros(2 * dry)])
    fast, code = _fast(model, engine, n, sensitive=nd > 0)

    edges = shots.edge_array
    done = np.zeros(shots.n_windows, dtype=np.int64)
    trouble = np.zeros((shots.n_windows, 2), dtype=np.int64)
    modes, since = np.zeros((n, dry), np.int64), np.full((n, dry), -np.inf)
    results = Results(outputs, sensitivities, states, modes, since)
    initial = np.ascontiguousarray(initial, dtype=np.float64)
    constants, output_constants = form.dynamics.constants, form.output.constants

    def some(first: int, last: int) -> None:
        integrate_windows(
            system, fast, method, constants, output_constants, values, wanted,
            shots.time, shots.inputs, initial, results, edges, first, last, done,
            trouble,
        )  # fmt: skip

    in_parallel(some, shots.n_windows)
    del code  # it was needed until here
    return TapeRun(outputs, states, sensitivities, modes, since, done, trouble)


def _system(model: NumericModel) -> "System":
    """Return the model as the kernel sees it; dry friction's λ are at the end of z."""
    from bondgraph.numeric.kernel.stage_arrays import System  # noqa: PLC0415

    form = model if model.set_valued is None else model.set_valued
    dry = 0 if model.set_valued is None else len(model.set_valued.places)
    dynamics, output, nx = form.dynamics, form.output, model.n_states
    return System(
        dynamics=dynamics.code,
        first=dynamics.n_variables + len(dynamics.constants),
        rate=np.ascontiguousarray(dynamics.outputs[:nx]),
        residual=np.ascontiguousarray(dynamics.outputs[nx:]),
        output=output.code,
        first_output=output.n_variables + len(output.constants),
        read=output.outputs,
        nx=nx,
        nz=model.n_unknowns + dry,
        nd=dry,
        nu=len(model.input_names),
        n_parameters=len(model.parameter_names) + 2 * dry,
        linear=form.linear,
        instantaneous=form.instantaneous,
    )


def _fast(
    model: NumericModel, engine: Engine, samples: int, *, sensitive: bool
) -> tuple["Fast", object]:
    """Return native code of a model with held modes, and what keeps it alive."""
    from bondgraph.numeric.kernel.native_steps import Fast  # noqa: PLC0415
    from bondgraph.numeric.native.compiling import (  # noqa: PLC0415  (LLVM)
        compiled_text,
        module_text,
        values_of,
    )
    from bondgraph.numeric.native.model import (  # noqa: PLC0415
        NativeSystem,
        native_model,
    )

    form, held = model.set_valued, with_modes_given(model)
    if form is None or held is None or not engine.compiles(held, samples):
        return Fast(NativeSystem(*(0,) * 13, False, False), 0, False), None
    native = native_model(
        held,
        along=range(len(held.parameter_names)) if sensitive else None,
        optimised=engine.optimises(samples),
    )
    arguments = compiled_text(module_text([values_of(form.arguments, "arguments")]))
    fast = Fast(native.system, arguments["arguments"], True)
    return fast, (native, arguments)
