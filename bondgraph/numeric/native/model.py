"""A whole model in native code, as the compiled time loops see it."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bondgraph.numeric.model import NumericModel
from bondgraph.numeric.native.compiling import (
    NativeCode,
    compiled_text,
    module_text,
    slopes_of,
    values_of,
)
from bondgraph.numeric.native.step import Sizes, step
from bondgraph.numeric.native.step_tangents import step_tangents
from bondgraph.numeric.tape import Tape

FEW = 8
"""Along so few parameters slopes are written whichever are asked for: a fit asks for
some, all and none in turn, and to compile for each takes longer than they do.
"""


class NativeSystem(NamedTuple):
    """Addresses and sizes; variables are x, ẋ, z, u, u̇, p, t, then results.

    Slopes have the columns x, ẋ, z and, where sensitivities are wanted, all p.
    """

    values: int
    slopes: int
    read: int
    read_slopes: int
    step: int
    step_tangents: int
    n_columns: int
    nx: int
    nz: int
    nu: int
    ny: int
    n_parameters: int
    n_variables: int
    linear: bool
    instantaneous: bool


@dataclass(frozen=True, slots=True, eq=False)
class NativeModel:
    """A `NativeSystem` with the owner of its code."""

    system: NativeSystem
    code: NativeCode


@dataclass(frozen=True, slots=True)
class _Written:
    """A tape as a value that can be compared: equal ones are compiled once."""

    n_variables: int
    constants: bytes
    code: bytes
    outputs: bytes

    @classmethod
    def of(cls, tape: Tape) -> "_Written":
        parts = (tape.constants, tape.code, tape.outputs)
        return cls(tape.n_variables, *(part.tobytes() for part in parts))

    def tape(self) -> Tape:
        """Return the tape again, without the degrees, which no code needs."""
        return Tape(
            n_variables=self.n_variables,
            constants=np.frombuffer(self.constants),
            code=np.frombuffer(self.code, dtype=np.int64).reshape(-1, 4),
            outputs=np.frombuffer(self.outputs, dtype=np.int64),
            degree=np.zeros(0, dtype=np.int64),
        )


def native_model(
    model: NumericModel,
    *,
    along: Collection[int] | None,
    explicit: bool = False,
    lanes: int = 1,
    optimised: bool = False,
) -> NativeModel:
    """Return the native code of a model.

    Parameters
    ----------
    along
        Parameters along which slopes are wanted, too; None for no sensitivities.
    explicit
        Whether it is for steps of the classical Runge-Kutta method, or for Newton's.
    lanes
        How many parameter sets are stepped at once (explicit, not sensitive).
    optimised
        Whether code that is a little faster is worth waiting for.
    """
    wanted = None if along is None else frozenset(int(k) for k in along)
    everything = range(len(model.parameter_names))
    if len(everything) <= FEW and not (explicit and wanted is None):
        wanted = frozenset(everything)
    return _native(model, wanted, explicit, lanes, optimised)


@lru_cache(maxsize=256)
def _native(
    model: NumericModel,
    along: frozenset[int] | None,
    explicit: bool,
    lanes: int,
    optimised: bool,
) -> NativeModel:
    """Return the code of this very model: a fit asks thousands of times."""
    nx, nu, ny = model.n_states, len(model.input_names), len(model.output_names)
    nz, n_parameters = model.n_unknowns, len(model.parameter_names)
    sizes = Sizes(states=nx, inputs=nu, parameters=n_parameters)
    columns = list(range(2 * nx + nz))
    if along is not None:
        shift = 2 * nx + nz + 2 * nu
        columns += [shift + k if k in along else -1 for k in range(n_parameters)]
    code = _compiled(
        _Written.of(model.dynamics),
        _Written.of(model.output),
        sizes if explicit else None,
        tuple(columns),
        along,
        lanes,
        optimised,
        model.instantaneous,
    )
    system = NativeSystem(
        values=code["values"],
        slopes=code["slopes"],
        read=code["read"],
        read_slopes=code["read_slopes"],
        step=code["step"],
        step_tangents=code["step_tangents"],
        n_columns=len(columns),
        nx=nx,
        nz=nz,
        nu=nu,
        ny=ny,
        n_parameters=n_parameters,
        n_variables=model.dynamics.n_variables,
        linear=model.linear,
        instantaneous=model.instantaneous,
    )
    return NativeModel(system, code)


@lru_cache(maxsize=256)
def _compiled(
    dynamics: _Written,
    output: _Written,
    sizes: Sizes | None,
    columns: tuple[int, ...],
    along: frozenset[int] | None,
    lanes: int,
    optimised: bool,
    instantaneous: bool,
) -> NativeCode:
    rates, read = dynamics.tape(), output.tape()
    functions = []
    if sizes is None or along is None:
        functions.append(values_of(rates, "values", lanes))
        functions.append(values_of(read, "read", lanes))
    if sizes is None or (along is not None and instantaneous):
        functions.append(slopes_of(rates, "slopes", columns))
    if along is not None:
        functions.append(slopes_of(read, "read_slopes", columns))
    if sizes is not None:
        moved = None if along is None else step_tangents(rates, sizes, along)
        functions.append(moved or step(rates, sizes, lanes))
    return compiled_text(module_text(functions, lanes), optimised=optimised)
