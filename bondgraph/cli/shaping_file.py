"""What ``bondgraph shape`` is asked for: a TOML file, read strictly.

::

    input = "T_motor"                 # of the model; where it has one, leave it out
    output = "theta"
    delay = 0.0025                    # s, in the plant
    at = {theta = 0.3}                # operating point of a nonlinear model

    [[series]]                        # between controller and model
    gain = 1.3e4                      # ratio of the leading coefficients
    zeros = [-4403]
    poles = [-4201, -1.61e6]          # complex ones as [real, imaginary]

    [[feedback]]                      # in the feedback branch
    low_pass = 157.08                 # rad/s; second order
    damping = 0.707
    times = 2

    [[controller]]                    # several are in series
    kind = "lead"                     # gain, lead, lead_lag, pi, notch, roll_off
    zero = "cancel"                   # the plant's slowest pole; or rad/s
    pole = 50

    [free]                            # numbers that the design chooses
    "lead.pole" = [10, 500]

    [require]
    prototype_damping = 0.6
    phase_margin = 45                 # deg
    noise_gain = {limit = 0.1, omega = 838}

A key that is not understood is an error, never ignored.
"""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields
from pathlib import Path
from typing import Any

from bondgraph.checking.written import NotTomlError, finite, shown, toml
from bondgraph.errors import LoopShapingError, did_you_mean
from bondgraph.loopshaping.controllers import (
    PI,
    AbstractController,
    Gain,
    Lead,
    LeadLag,
    Notch,
    Product,
    RollOff,
)
from bondgraph.loopshaping.prototype import SecondOrderPrototype
from bondgraph.loopshaping.requirements import (
    AbstractRequirement,
    Crossover,
    DelayMargin,
    GainMargin,
    NoiseGain,
    Overshoot,
    PeakComplementary,
    PeakSensitivity,
    PhaseMargin,
    SettlingTime,
    Specification,
)
from bondgraph.loopshaping.shaping import cancelling_zero
from bondgraph.loopshaping.sizing import Free
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain

CANCEL = "cancel"
MOST_POLES = 20
"""Of one filter; more are a slip of the pen."""

_KINDS: Mapping[str, Callable[..., AbstractController]] = {
    "gain": Gain,
    "lead": Lead,
    "lead_lag": LeadLag,
    "pi": PI,
    "notch": Notch,
    "roll_off": RollOff,
}
_REQUIREMENTS: Mapping[str, Callable[[float], AbstractRequirement]] = {
    "phase_margin": PhaseMargin,
    "gain_margin": GainMargin,
    "delay_margin": DelayMargin,
    "peak_sensitivity": PeakSensitivity,
    "peak_complementary": PeakComplementary,
    "crossover": Crossover,
    "overshoot": Overshoot,
    "settling_time": SettlingTime,
}
_TOP = ("input", "output", "at", "delay", "series", "feedback", "controller")
_BLOCK = ("gain", "zeros", "poles", "delay", "low_pass", "damping", "times")


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapingRequest:
    """A shaping file as read; `controller` needs the plant for its cancelling zero."""

    input: str | None
    output: str | None
    at: Mapping[str, float]
    delay: float
    series: ZeroPoleGain
    feedback: ZeroPoleGain
    factors: tuple[Mapping[str, Any], ...]
    free: tuple[Free, ...]
    specification: Specification

    def controller(self, plant: ZeroPoleGain) -> AbstractController:
        """Return the controller to size, its ``"cancel"`` filled in."""
        built = [_controller(table, plant) for table in self.factors]
        return built[0] if len(built) == 1 else Product(tuple(built))


def read_request(path: Path) -> ShapingRequest:
    """Return what the file at `path` asks for.

    Raises
    ------
    LoopShapingError
        If it is missing, no TOML, or not understood.
    """
    try:
        table = toml(path)
    except OSError as error:
        raise LoopShapingError(
            f"{str(path)!r} cannot be read ({error.strerror}).",
            (str(path),),
            "Name the file with --spec FILE.",
        ) from error
    except NotTomlError as error:
        raise LoopShapingError(
            f"{str(path)!r} is no TOML: {error}.", (str(path),), "Correct it."
        ) from error
    _known(table, (*_TOP, "free", "require"), "the file")
    factors = _tables(table, "controller")
    if not factors:
        raise LoopShapingError(
            "The file names no controller.",
            ("controller",),
            'Add [[controller]] with kind = "lead".',
        )
    return ShapingRequest(
        input=_text(table, "input"),
        output=_text(table, "output"),
        at={name: _number(v, name) for name, v in _table(table, "at").items()},
        delay=_number(table.get("delay", 0.0), "delay"),
        series=_chain(_tables(table, "series")),
        feedback=_chain(_tables(table, "feedback")),
        factors=factors,
        free=tuple(_free(p, ends) for p, ends in _table(table, "free").items()),
        specification=_specification(_table(table, "require")),
    )


def _known(table: Mapping[str, Any], names: tuple[str, ...], where: str) -> None:
    for name in table:
        if name not in names:
            raise LoopShapingError(
                f"{name!r} is not understood in {where}.",
                (name,),
                did_you_mean(name, names),
            )


def _tables(table: Mapping[str, Any], name: str) -> tuple[Mapping[str, Any], ...]:
    found = table.get(name, [])
    if isinstance(found, dict):
        return (found,)
    if not (isinstance(found, list) and all(isinstance(x, dict) for x in found)):
        raise _wrong(name, "a table", f"[[{name}]]")
    return tuple(found)


def _table(table: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    found = table.get(name, {})
    if not isinstance(found, dict):
        raise _wrong(name, "a table", f"[{name}]")
    return found


def _number(value: object, name: str) -> float:
    number = finite(value)
    if number is None:
        kind = "a finite number" if isinstance(value, int | float) else "a number"
        raise _wrong(name, kind, f"{name} = 1.0")
    return number


def _count(value: object, name: str) -> int:
    number = _number(value, name)
    if number not in range(1, MOST_POLES + 1):
        raise _wrong(name, f"a number of 1 to {MOST_POLES}", f"{name} = 2")
    return int(number)


def _text(table: Mapping[str, Any], name: str) -> str | None:
    value = table.get(name)
    if value is not None and not isinstance(value, str):
        raise _wrong(name, "a name", f'{name} = "theta"')
    return value


def _wrong(name: str, kind: str, example: str) -> LoopShapingError:
    return LoopShapingError(f"{name!r} is not {kind}.", (name,), f"Write {example}.")


def _chain(tables: tuple[Mapping[str, Any], ...]) -> ZeroPoleGain:
    whole = ZeroPoleGain()
    for table in tables:
        whole = whole * _block(table)
    return whole


def _block(table: Mapping[str, Any]) -> ZeroPoleGain:
    _known(table, _BLOCK, "a block")
    block = ZeroPoleGain(
        zeros=_roots(table.get("zeros", []), "zeros"),
        poles=_roots(table.get("poles", []), "poles"),
        gain=_number(table.get("gain", 1.0), "gain"),
        delay=_number(table.get("delay", 0.0), "delay"),
    )
    if "low_pass" in table:
        corner = _number(table["low_pass"], "low_pass")
        damping = _number(table.get("damping", 0.5**0.5), "damping")
        # a notch without zeros: ω² / (s² + 2 ζ ω s + ω²)
        poles = Notch(corner, width=damping).transfer.poles
        for _ in range(_count(table.get("times", 1), "times")):
            block = block * ZeroPoleGain(poles=poles, gain=corner**2)
    return block


def _roots(values: object, name: str) -> tuple[complex, ...]:
    if not isinstance(values, list):
        raise _wrong(name, "a list", f"{name} = [-1.0, [-2.0, 3.0], [-2.0, -3.0]]")
    roots = []
    for value in values:
        if isinstance(value, list) and len(value) == 2:
            roots.append(complex(*(_number(part, name) for part in value)))
        else:
            roots.append(complex(_number(value, name)))
    return tuple(roots)


def _controller(table: Mapping[str, Any], plant: ZeroPoleGain) -> AbstractController:
    kind = table.get("kind")
    if not isinstance(kind, str) or kind not in _KINDS:
        raise LoopShapingError(
            f"{shown(kind)} is no kind of controller.",
            (shown(kind),),
            did_you_mean(shown(kind), _KINDS),
        )
    make = _KINDS[kind]
    names = tuple(field.name for field in fields(make))  # type: ignore[arg-type]
    _known(table, ("kind", *names), f"a {kind} controller")
    numbers = {
        name: cancelling_zero(plant)
        if (name, value) == ("zero", CANCEL)
        else _number(value, name)
        for name, value in table.items()
        if name != "kind"
    }
    if kind in ("notch", "roll_off") and "omega" not in numbers:
        raise LoopShapingError(
            f"A {kind} controller needs its omega.", ("omega",), "Give it in rad/s."
        )
    if "order" in numbers:
        numbers["order"] = _count(numbers["order"], "order")
    for field in fields(make):  # type: ignore[arg-type]
        if field.name not in numbers and field.default is MISSING:
            raise LoopShapingError(
                f"A {kind} controller needs its {field.name}.",
                (field.name,),
                f"Write {field.name} = 1.0.",
            )
    return make(**numbers)


def _free(path: str, ends: object) -> Free:
    if not (isinstance(ends, list) and len(ends) == 2):
        raise _wrong(path, "a pair of limits", f'"{path}" = [10, 500]')
    low, high = (_number(end, path) for end in ends)
    return Free(path, low, high)


def _specification(table: Mapping[str, Any]) -> Specification:
    _known(
        table, ("prototype_damping", "noise_gain", *_REQUIREMENTS), "the requirements"
    )
    prototype = None
    requirements: list[AbstractRequirement] = []
    for name, value in table.items():
        if name == "prototype_damping":
            prototype = SecondOrderPrototype(_number(value, name))
        elif name == "noise_gain":
            if not isinstance(value, dict) or set(value) != {"limit", "omega"}:
                raise _wrong(name, "a limit at a frequency", _NOISE)
            limit, omega = (_number(value[key], key) for key in ("limit", "omega"))
            requirements.append(NoiseGain(limit, omega=omega))
        else:
            requirements.append(_REQUIREMENTS[name](_number(value, name)))
    return Specification(prototype=prototype, requirements=tuple(requirements))


_NOISE = "noise_gain = {limit = 0.1, omega = 838}"
