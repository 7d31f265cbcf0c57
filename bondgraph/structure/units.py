"""Units are checked and converted to SI where a number enters, and nowhere else.

The arithmetic is pint's. A unit that pint does not know (``raw``, ``tick``) is a
dimension of its own: it fits only the same word. So do counts and pixels, which pint
would turn into 1 and into the metres of a printed page. Cycles (Hz) and angles (rad/s)
do not convert into one another, since one of them lacks the 2 pi.
"""

import re
from functools import cache
from typing import TYPE_CHECKING, Any

from bondgraph.errors import UnitError

if TYPE_CHECKING:
    import pint

DIMENSIONLESS = ("", "1", "-")
_OWN_WORDS = frozenset(
    "bit bits byte bytes count counts dot dots pixel pixels px".split(" ")
)
_CYCLES = frozenset("Hz kHz MHz GHz hertz".split(" "))
_ANGLES = frozenset(
    "rad radian deg degree rpm rev revolution turn mrad revolutions_per_minute".split(
        " "
    )
)


@cache
def _registry() -> "pint.UnitRegistry[Any]":
    import pint  # noqa: PLC0415  (0.3 s; most models never convert)

    return pint.UnitRegistry()


def _words(unit: str) -> set[str]:
    return set(re.findall(r"[A-Za-z%Ω°]+", unit))


def _parse(unit: str) -> "pint.Unit | None":
    """Return pint's unit, or None for a word it does not know."""
    import pint  # noqa: PLC0415

    text = {"%": "percent", "°C": "degC", "Ω": "ohm"}.get(unit.strip(), unit.strip())
    if text in DIMENSIONLESS:
        return _registry().Unit("dimensionless")
    if _words(text) & _OWN_WORDS:
        return None
    try:
        return _registry().Unit(text.replace("·", "*").replace("^", "**"))
    except (pint.errors.UndefinedUnitError, pint.errors.DefinitionSyntaxError):
        return None
    except Exception as error:  # pint raises tokenizer errors of many types
        raise UnitError(
            f"The unit {unit!r} cannot be read ({type(error).__name__}).",
            (unit,),
            "Write products as N*m, quotients as m/s, powers as kg*m^2.",
        ) from error


@cache
def conversion(source: str, target: str) -> tuple[float, float]:
    """Return ``(scale, offset)`` with ``target = scale * source + offset``.

    Raises
    ------
    UnitError
        If the two units measure different things.
    """
    if source.strip() == target.strip():
        return 1.0, 0.0
    a, b = _parse(source), _parse(target)
    for frequency, speed in ((source, target), (target, source)):
        if _words(frequency) & _CYCLES and _words(speed) & _ANGLES:
            raise UnitError(
                f"{source!r} does not convert to {target!r} without a 2 pi.",
                (source, target),
                "Write turn/s for a speed in cycles per second.",
            )
    if a is None or b is None or not a.is_compatible_with(b):
        raise UnitError(
            f"{source!r} is not a unit of {target!r}.",
            (source, target),
            f"Give the quantity in {target} or a unit that converts to it.",
        )
    registry = _registry()
    zero = float(registry.Quantity(0.0, a).to(b).magnitude)
    one = float(registry.Quantity(1.0, a).to(b).magnitude)
    return one - zero, zero


def compatible(source: str, target: str) -> bool:
    """Return whether `source` converts to `target`."""
    try:
        conversion(source, target)
    except UnitError:
        return False
    return True


_SI_WORDS = frozenset(
    "m kg s A K mol N Pa J W V C F H Ohm ohm rad Hz Wb T 1 degC".split(" ")
)


@cache
def plain_unit(unit: str) -> str:
    """Return a unit without brackets around what needs none: ``(J)/(K)`` as ``J/K``."""
    return re.sub(r"\((\w+)\)", r"\1", unit)


def si_unit(unit: str) -> str:
    """Return `unit` itself if it is written in coherent SI units, else its SI form.

    A unit that pint does not know is returned as it is.
    """
    if _words(unit) <= _SI_WORDS or unit.strip() in DIMENSIONLESS:
        return unit
    parsed = _parse(unit)
    if parsed is None:
        return unit
    base = _registry().Quantity(1.0, parsed).to_base_units().units
    return "1" if base.dimensionless else f"{base:~C}".replace("**", "^")


def is_coherent(unit: str) -> bool:
    """Return whether SI would write the same number; also of a unit nobody knows."""
    try:
        return conversion(unit, si_unit(unit)) == (1.0, 0.0)
    except UnitError:
        return True
