"""The controller as text and as a python-control system."""

from typing import TYPE_CHECKING

import numpy as np

from bondgraph.loopshaping.delivery.digital import DigitalController
from bondgraph.loopshaping.loop import to_python_control
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain

if TYPE_CHECKING:
    import control


def difference_equation(
    system: ZeroPoleGain, *, source: str = "e", result: str = "u"
) -> str:
    """Return a sampled system as one line, ``u[k] = … u[k-1] … + … e[k] …``.

    Coefficients are written so that they read back exactly.
    """
    bottom = np.real(np.poly(system.poles)) if system.poles else np.ones(1)
    top = system.gain * (np.real(np.poly(system.zeros)) if system.zeros else np.ones(1))
    late = len(bottom) - len(top)
    late += round(system.delay / system.period) if system.period else 0
    terms = [(-c, result, k) for k, c in enumerate(bottom) if k]
    terms += [(c, source, k + late) for k, c in enumerate(top)]
    text = ""
    for value, name, back in terms:
        number = float(value)
        if number == 0:
            continue
        where = f"{name}[k]" if back == 0 else f"{name}[k-{back}]"
        sign = "-" if number < 0 else "+" if text else ""
        text += f" {sign} {abs(number)!r} {where}" if sign else f" {number!r} {where}"
    return f"{result}[k] ={text or ' 0'}"


def difference_equations(controller: DigitalController) -> str:
    """Return a controller's difference equations, limits and period."""
    lines = [f"{controller.name}: every {controller.period!r} s"]
    filtered = "y"
    if not controller.filter.static or controller.filter.gain != 1:
        filtered = "f"
        lines.append(difference_equation(controller.filter, source="y", result="f"))
    lines.append(f"e[k] = r[k] - {filtered}[k]")
    lines.append(difference_equation(controller.controller, source="e", result="v"))
    limits = controller.limits
    command = "v[k] + w[k]"
    if limits:
        command = f"min(max({command}, {limits[0]!r}), {limits[1]!r})"
    lines.append(f"u[k] = {command}")
    return "\n".join(lines)


def controller_to_control(controller: DigitalController) -> "control.StateSpace":
    """Return the controller from reference and measurement to command.

    Inputs ``r``, ``y``, output ``u``; linear, so without limits and rounding.
    """
    import control  # noqa: PLC0415  (1 s; only its users wait for it)

    period = controller.period
    parts = []
    for part in (controller.controller, controller.filter):
        found = to_python_control(part)
        parts.append(control.StateSpace(found.A, found.B, found.C, found.D, period))
    ahead, behind = parts
    both = control.append(control.StateSpace([], [], [], [[1.0]], period), behind)
    error = control.StateSpace([], [], [], [[1.0, -1.0]], period)
    whole = ahead * error * both
    return control.StateSpace(
        whole.A,
        whole.B,
        whole.C,
        whole.D,
        period,
        inputs=["r", "y"],
        outputs=["u"],
        name=controller.name,
    )
