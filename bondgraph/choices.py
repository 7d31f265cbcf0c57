"""Choices are objects: what is not of the family is refused, never taken for another.

A word such as ``"huber"`` passes through Python unseen and would mean whatever the last
branch of the code means. So what takes a choice asks here first.
"""

import math
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from inspect import isabstract
from numbers import Integral
from typing import Any, get_args

from bondgraph.errors import BondGraphError


def refuse_other(
    value: object, family: Any, what: str, refusal: type[BondGraphError]
) -> None:
    """Raise `refusal` if `value` is not an object of the family.

    Parameters
    ----------
    family
        A class, an enumeration or a union of classes.
    what
        What is chosen, as the subject of the sentence: ``"The loss of a fit"``.
    """
    if isinstance(value, family):
        return
    kinds = get_args(family) or (family,)
    # A class with slots stands beside the one it was made from.
    known = list(dict.fromkeys(name for kind in kinds for name in _names(kind)))
    raise refusal(
        f"{what} is {_shown(value)}, which is none.",
        (_shown(value),),
        f"Give {' or '.join([', '.join(known[:-1])] * (len(known) > 1) + known[-1:])}.",
    )


def refuse_other_count(
    value: object, least: int, what: str, refusal: type[BondGraphError]
) -> None:
    """Raise `refusal` if `value` is not a whole number of at least `least`."""
    whole = isinstance(value, Integral) and not isinstance(value, bool)
    if not whole or value < least:  # type: ignore[operator]
        raise refusal(
            f"{what} is {value!r}.", (), f"Give a whole number, at least {least}."
        )


def refuse_other_size(
    value: object, what: str, refusal: type[BondGraphError], *, above: float = 0.0
) -> None:
    """Raise `refusal` if `value` is not a finite number greater than `above`."""
    if not is_finite(value) or value <= above:  # type: ignore[operator]
        raise refusal(
            f"{what} is {value!r}.", (), f"Give a finite number above {above:g}."
        )


def is_number(value: Any) -> bool:
    """Return whether `value` is one real number, of whatever type; text is none."""
    if isinstance(value, str) or getattr(value, "ndim", 0) != 0:
        return False
    try:
        float(value)
    except (TypeError, ValueError):
        return False
    return True


def is_finite(value: Any) -> bool:
    """Return whether `value` is one finite real number."""
    return is_number(value) and math.isfinite(value)


def _shown(value: object) -> str:
    return f"the class {value.__name__}" if isinstance(value, type) else repr(value)


def _names(kind: type) -> list[str]:
    """Return how the objects of a kind are written: ``Sdirk2()``, ``Hold.ZERO``."""
    if issubclass(kind, Enum):
        return [str(f"{kind.__name__}.{member.name}") for member in kind]
    if isabstract(kind):
        return [name for below in kind.__subclasses__() for name in _names(below)]
    needed = (
        [
            one.name
            for one in fields(kind)
            if one.init and one.default is MISSING and one.default_factory is MISSING
        ]
        if is_dataclass(kind)
        else []
    )
    return [f"{kind.__name__}({', '.join(needed)})"]
