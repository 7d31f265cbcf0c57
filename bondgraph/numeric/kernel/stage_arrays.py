"""What one implicit stage works on: the model as the kernel sees it, and scratch."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bondgraph.numeric.compiled.loops import Array, Integers, compiled

Flags = NDArray[np.bool_]

# Modes of a dry friction; slipping forward and backward are 1 and -1.
STICKS = 0
IDLE = 2  # λ = 0: the friction acts on nothing, and its argument is zero
UNKNOWN = 3


class System(NamedTuple):
    """The model as the kernel sees it.

    ``rate``, ``residual`` and ``read`` are result slots; the variables of both tapes
    are x, ẋ, z, u, u̇, p, t. ``nd``: that many of the last unknowns z are λ of dry
    friction, and the last residuals are their arguments. ``linear``: r is affine in
    (x, w). ``instantaneous``: an output depends on w, so w is solved for at every
    sample.
    """

    dynamics: Integers
    first: int
    rate: Integers
    residual: Integers
    output: Integers
    first_output: int
    read: Integers
    nx: int
    nz: int
    nd: int
    nu: int
    n_parameters: int
    linear: bool
    instantaneous: bool


class Work(NamedTuple):
    """Scratch arrays of one simulation.

    ``v``, ``vo`` values on the two tapes; ``d`` tangents along w; ``dq``, ``dqo``
    tangents along parameters and initial states; ``lu``, ``pivot`` the factored dr/dw;
    ``sensitivity`` dw along parameters and initial states; ``weight`` sizes of w.

    Of dry friction: ``mode`` (see `bondgraph.numeric.kernel.friction_modes`), whether
    modes are ``held``, ``argument`` g at the solution, ``compliance`` -dg/dλ per second
    of step. ``trouble`` says why the last stage failed and which unknown changed most.
    """

    v: Array
    vo: Array
    d: Array
    dq: Array
    dqo: Array
    lu: Array
    pivot: Integers
    rhs: Array
    sensitivity: Array
    weight: Array
    w: Array
    step: Array
    mode: Integers
    held: Flags
    argument: Array
    compliance: Array
    trouble: Integers


@compiled
def make_work(system: System, n: int) -> Work:
    """Return zeroed scratch for `n` tangent directions."""
    slots = system.first + system.dynamics.shape[0]
    slots_output = system.first_output + system.output.shape[0]
    nw = system.nx + system.nz
    some, columns = max(nw, 1), max(n, 1)
    weight = np.full(nw, 1e-12)
    weight[nw - system.nd :] = 1.0
    return Work(
        v=np.zeros(slots),
        vo=np.zeros(slots_output),
        d=np.zeros((slots, some)),
        dq=np.zeros((slots, columns)),
        dqo=np.zeros((slots_output, columns)),
        lu=np.zeros((nw, nw)),
        pivot=np.zeros(nw, dtype=np.int64),
        rhs=np.zeros((nw, 1)),
        sensitivity=np.zeros((nw, columns)),
        weight=weight,
        w=np.zeros(nw),
        step=np.zeros(nw),
        mode=np.full(system.nd, UNKNOWN, dtype=np.int64),
        held=np.zeros(1, dtype=np.bool_),
        argument=np.zeros(system.nd),
        compliance=np.zeros(system.nd),
        trouble=np.zeros(2, dtype=np.int64),
    )
