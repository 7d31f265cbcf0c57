"""A feedback loop: controller, plant and what sits in the feedback branch.

::

    r ──►(+)── e ──► controller ── u ──► plant ──┬──► y
          ▲ -                                    │
          └───────────── feedback ◄──────────────┘

The open loop L = controller · plant · feedback decides stability, margins and
sensitivities; the response that a user sees, from r to y, is
controller · plant / (1 + L), because a filter in the feedback branch does not filter
the reference.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.errors import LoopShapingError, did_you_mean
from bondgraph.loopshaping.zero_pole_gain import (
    ComplexArray,
    FloatArray,
    ZeroPoleGain,
)
from bondgraph.numeric.state_space import StateSpace

if TYPE_CHECKING:
    import control


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """The parts of a single loop with negative feedback; see the module's head."""

    plant: ZeroPoleGain
    controller: ZeroPoleGain = field(default_factory=ZeroPoleGain)
    feedback: ZeroPoleGain = field(default_factory=ZeroPoleGain)

    @property
    def forward(self) -> ZeroPoleGain:
        """Controller times plant, from the error to the output."""
        return self.controller * self.plant

    @property
    def open_loop(self) -> ZeroPoleGain:
        """L, once around the loop without the minus sign."""
        return self.forward * self.feedback

    @property
    def period(self) -> float | None:
        """Sampling period in seconds; None in continuous time."""
        return self.open_loop.period

    def closed(self, omega: FloatArray) -> ComplexArray:
        """Return the response from reference to output at `omega` in rad/s."""
        ratio = self.forward.response(omega)
        return np.asarray(ratio / (1 + self.open_loop.response(omega)))

    def sensitivity(self, omega: FloatArray) -> ComplexArray:
        """Return S = 1 / (1 + L) at `omega` in rad/s."""
        return np.asarray(1 / (1 + self.open_loop.response(omega)))

    def complementary(self, omega: FloatArray) -> ComplexArray:
        """Return T = L / (1 + L) at `omega` in rad/s."""
        ratio = self.open_loop.response(omega)
        return np.asarray(ratio / (1 + ratio))

    def control_of_noise(self, omega: FloatArray) -> ComplexArray:
        """Return the controller's output per measurement noise, sign left out."""
        acting = (self.controller * self.feedback).response(omega)
        return np.asarray(acting / (1 + self.open_loop.response(omega)))


def zero_pole_gain(
    system: Any,
    values: Mapping[str, float] | None = None,
    *,
    output: str | None = None,
    input: str | None = None,  # noqa: A002
    delay: float = 0.0,
) -> ZeroPoleGain:
    """Return any linear system with one input and one output in factored form.

    Parameters
    ----------
    system
        A `ZeroPoleGain`, a symbolic `TransferFunction` (with `values`), a `StateSpace`,
        a python-control system, or a plain number.
    values
        Parameter values by name, for a symbolic transfer function.
    output, input
        Which ones, where a state space has several.
    delay
        Seconds added to the system's own.

    Raises
    ------
    LoopShapingError
        If it is none of these, or has more than one input or output.
    ParameterError
        If a parameter has no value.
    """
    found = _without_delay(system, values or {}, output, input)
    return replace(found, delay=found.delay + delay)


def _without_delay(
    system: Any, values: Mapping[str, float], output: str | None, source: str | None
) -> ZeroPoleGain:
    if isinstance(system, ZeroPoleGain):
        return system
    if isinstance(system, int | float):
        return ZeroPoleGain(gain=float(system))
    if isinstance(system, TransferFunction):
        return ZeroPoleGain(
            zeros=system.zeros(values),
            poles=system.poles(values),
            gain=system.gain_at(values),
        )
    if isinstance(system, StateSpace):
        row = _chosen(output, system.outputs, "output", system.name)
        column = _chosen(source, system.inputs, "input", system.name)
        B, C = system.B[:, [column]], system.C[[row]]
        return _factored(system.A, B, C, float(system.D[row, column]), None)
    return _from_control(system, output, source)


def _factored(
    A: FloatArray, B: FloatArray, C: FloatArray, through: float, period: float | None
) -> ZeroPoleGain:
    """Return the factored form of the part between one input and one output."""
    import control  # noqa: PLC0415  (1 s; only its users wait for it)

    whole = control.StateSpace(A, B, C, [[through]])
    zeros = _exact_at_rest(np.atleast_1d(whole.zeros()), A)
    poles = _exact_at_rest(np.atleast_1d(whole.poles()), A)
    # The gain from one point that is far from every root.
    reach = 2 * float(np.abs(np.concatenate([zeros, poles, [0.5]])).max())
    here = complex(reach, reach)
    solved = np.linalg.solve(here * np.eye(len(A)) - A, B) if len(A) else B
    value = complex((C @ solved)[0, 0] + through)
    gain = value * np.prod(here - poles) / np.prod(here - zeros)
    return ZeroPoleGain(
        zeros=tuple(map(complex, zeros)),
        poles=tuple(map(complex, poles)),
        gain=float(gain.real),
        period=period,
    )


def _exact_at_rest(roots: ComplexArray, A: FloatArray) -> ComplexArray:
    """Return finite roots, those that vanish within rounding as exact zeros."""
    finite = roots[np.isfinite(roots)].astype(complex)
    size = float(np.abs(A).max(initial=0.0)) * max(len(A), 1)
    return np.where(np.abs(finite) < 1e-14 * size, 0j, finite)


def _from_control(system: Any, output: str | None, source: str | None) -> ZeroPoleGain:
    import control  # noqa: PLC0415

    if not isinstance(system, control.lti.LTI) or isinstance(system, control.FRD):
        raise LoopShapingError(
            f"{type(system).__name__} is no linear system.",
            remedy="Give a ZeroPoleGain, TransferFunction, StateSpace or a "
            "python-control system.",
        )
    if output is not None or source is not None or not system.issiso():
        row = _chosen(output, tuple(system.output_labels), "output", "the system")
        column = _chosen(source, tuple(system.input_labels), "input", "the system")
        system = system[row, column]
    period = None if system.dt in (None, 0) else float(system.dt)
    if isinstance(system, control.StateSpace):
        through = float(system.D[0, 0])
        return _factored(system.A, system.B, system.C, through, period)
    top, bottom = (np.trim_zeros(c[0][0], "f") for c in (system.num, system.den))
    if not len(top):
        raise LoopShapingError(
            "The transfer function is zero.", remedy="Give one that is not."
        )
    return ZeroPoleGain(
        zeros=tuple(map(complex, np.roots(top))),
        poles=tuple(map(complex, np.roots(bottom))),
        gain=float(top[0] / bottom[0]),
        period=period,
    )


def _chosen(name: str | None, names: tuple[str, ...], kind: str, model: str) -> int:
    if name is None and len(names) == 1:
        return 0
    if name in names:
        return names.index(name)
    problem = (
        f"{model} has {len(names)} {kind}s; a loop is closed around one."
        if name is None
        else f"{model} has no {kind} {name!r}."
    )
    raise LoopShapingError(problem, (name or model,), did_you_mean(name or "", names))


def to_python_control(
    system: ZeroPoleGain, *, delay_order: int | None = None
) -> "control.StateSpace":
    """Return the system for python-control.

    Parameters
    ----------
    delay_order
        Order of the Padé fraction that stands for a continuous delay there.

    Raises
    ------
    LoopShapingError
        If there is a delay and no order is given: python-control knows no delays.
    """
    import control  # noqa: PLC0415

    from bondgraph.loopshaping.realisation import realise  # noqa: PLC0415

    A, B, C, D = realise(system)
    if system.period is not None:
        return control.StateSpace(A, B, C, D, system.period)
    whole = control.StateSpace(A, B, C, D)
    if not system.delay:
        return whole
    if delay_order is None:
        raise LoopShapingError(
            f"python-control has no delays; this one is {system.delay:g} s.",
            remedy="Say delay_order=4 for a Padé fraction, or measure(...) it here.",
        )
    top, bottom = control.pade(system.delay, delay_order)
    return control.tf2ss(control.TransferFunction(top, bottom)) * whole
