"""Units are checked and converted to SI where a number enters, and nowhere else.

The arithmetic is pint's. A unit that pint does not know (``raw``, ``tick``) is a
dimension of its own: it fits only the same word.
"""

import re
from functools import cache
from typing import TYPE_CHECKING, Any

from bondgraph.errors import UnitError

if TYPE_CHECKING:
    import pint

DIMENSIONLESS = ("", "1", "-")


@cache
def _registry() -> "pint.UnitRegistry[Any]":
    import pint  # noqa: PLC0415  (0.3 s; most models never convert)

    return pint.UnitRegistry()


def _parse(unit: str) -> "pint.Unit | None":
    """Return pint's unit, or None for a word it does not know."""
    import pint  # noqa: PLC0415

    text = {"%": "percent", "°C": "degC", "Ω": "ohm"}.get(unit.strip(), unit.strip())
    if text in DIMENSIONLESS:
        return _registry().Unit("dimensionless")
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
def si_unit(unit: str) -> str:
    """Return `unit` itself if it is written in coherent SI units, else its SI form.

    A unit that pint does not know is returned as it is.
    """
    words = set(re.findall(r"[A-Za-z%Ω°]+", unit))
    if words <= _SI_WORDS or unit.strip() in DIMENSIONLESS:
        return unit
    parsed = _parse(unit)
    if parsed is None:
        return unit
    base = _registry().Quantity(1.0, parsed).to_base_units().units
    return "1" if base.dimensionless else f"{base:~C}".replace("**", "^")
