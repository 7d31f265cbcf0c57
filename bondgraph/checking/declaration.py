"""What a check file declares, read strictly: an unknown key is an error, not a comment.

A check file is TOML with one ``[[check]]`` table per check::

    [[check]]
    name = "lowerleg, flight: gain"
    model = "flegx_models.models:lowerleg_flight"
    input = "T_motor"
    output = "theta"
    quantity = "gain"          # or dc_gain, pole, zero
    value = 176.76
    digits = 2                 # or tolerance = 0.005, or relative_tolerance = 1e-4
    parameters = {L = 0.3}     # optional; or the name of a ParameterSet, "file.py:NAME"

In ``pyproject.toml`` the same tables are written ``[[tool.bondgraph.checks.check]]``.
A pole or zero is the one closest to ``value``, unless ``index`` (counted from 0 by
growing magnitude) or ``nearest`` (a point of the s-plane, rad/s) says which one. A
complex value is written ``[real, imaginary]``.
"""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from bondgraph.errors import CheckError, did_you_mean


class CheckedQuantity(StrEnum):
    """What of a transfer function is compared."""

    GAIN = "gain"
    DC_GAIN = "dc_gain"
    POLE = "pole"
    ZERO = "zero"


@dataclass(frozen=True, slots=True)
class Absolute:
    """The derived value may differ by `amount`, in its own unit."""

    amount: float

    def allowed(self, value: complex) -> float:
        """Return the largest difference from `value` that passes."""
        return self.amount

    def __str__(self) -> str:
        return f"± {self.amount:g}"


@dataclass(frozen=True, slots=True)
class Relative:
    """The derived value may differ by `fraction` of the declared one."""

    fraction: float

    def allowed(self, value: complex) -> float:
        """Return the largest difference from `value` that passes."""
        return self.fraction * abs(value)

    def __str__(self) -> str:
        return f"± {100 * self.fraction:g} %"


@dataclass(frozen=True, slots=True)
class Decimals:
    """The derived value must round to the declared one at `digits` decimals."""

    digits: int

    def allowed(self, value: complex) -> float:
        """Return the largest difference from `value` that passes."""
        # A tie rounds either way in print; the last bits of 0.005 must not decide it.
        return 0.5 * 10.0**-self.digits * (1 + 1e-12) + 4 * math.ulp(abs(value))

    def __str__(self) -> str:
        return f"to {self.digits} decimals"


Tolerance = Absolute | Relative | Decimals


@dataclass(frozen=True, slots=True)
class Index:
    """The pole or zero at this place, counted from 0 by growing magnitude."""

    place: int


@dataclass(frozen=True, slots=True)
class Nearest:
    """The pole or zero closest to this point of the s-plane."""

    point: complex


Selection = Index | Nearest


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One declared value of one transfer function.

    Parameters
    ----------
    model
        As `bondgraph.loading.load_model` reads it, relative to the check file.
    value
        The declared value, in SI units; poles and zeros in rad/s.
    selection
        Which pole or zero is meant.
    parameters
        Other values by parameter name, or a reference to a `ParameterSet`.
    """

    name: str
    model: str
    input: str
    output: str
    quantity: CheckedQuantity
    value: complex
    tolerance: Tolerance
    selection: Selection
    parameters: Mapping[str, float] | str


def read_checks(path: Path) -> tuple[Check, ...]:
    """Return the checks that the file at `path` declares.

    Raises
    ------
    CheckError
        If the file is missing, is not TOML, or declares something not understood.
    """
    tables = _tables(_toml(path), path)
    checks = tuple(
        _Table(table, _label(path, table, number)).check()
        for number, table in enumerate(tables, start=1)
    )
    for number, check in enumerate(checks):
        if check.name in (other.name for other in checks[:number]):
            raise CheckError(
                f"{path.name} has two checks called {check.name!r}.",
                (check.name,),
                "Give each check a name of its own.",
            )
    return checks


def _toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise CheckError(
            f"There is no check file {str(path)!r}.",
            (str(path),),
            "Write one with [[check]] tables, or name another file.",
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise CheckError(
            f"The check file {str(path)!r} cannot be read: {reason}.", (str(path),)
        ) from error
    except tomllib.TOMLDecodeError as error:
        raise CheckError(
            f"{path.name} is not TOML: {error}.", (str(path),), "Correct the syntax."
        ) from error


def _tables(document: dict[str, Any], path: Path) -> list[Any]:
    """Return the check tables, of a file of its own or of ``pyproject.toml``."""
    heading = "check"
    if path.name == "pyproject.toml":
        heading = "tool.bondgraph.checks.check"
        for key in ("tool", "bondgraph", "checks"):
            document = document.get(key, {}) if isinstance(document, dict) else {}
    if not isinstance(document, dict):
        raise CheckError(
            f"{path.name} has no [[{heading}]] table.", (), f"Write [[{heading}]]."
        )
    for key in document:
        if key != "check":
            raise CheckError(
                f"{path.name} has {key!r}, which checks do not use.",
                (key,),
                f"Write each check under [[{heading}]].",
            )
    tables = document.get("check")
    if not isinstance(tables, list) or not tables:
        raise CheckError(
            f"{path.name} declares no check.", (), f"Write [[{heading}]] tables."
        )
    return tables


def _label(path: Path, table: Any, number: int) -> str:
    name = table.get("name") if isinstance(table, dict) else None
    return f"{path.name}, check {name if isinstance(name, str) else number!r}"


_REQUIRED = ("name", "model", "input", "output", "quantity", "value")
_TOLERANCES = ("tolerance", "relative_tolerance", "digits")
_SELECTIONS = ("index", "nearest")
_KEYS = (*_REQUIRED, *_TOLERANCES, *_SELECTIONS, "parameters")


class _Table:
    """One ``[[check]]`` table being read; `label` opens every refusal."""

    def __init__(self, table: Any, label: str) -> None:
        self._label = label
        if not isinstance(table, dict):
            raise self._error("is not a table.", "", "Write [[check]] and keys.")
        self._table: dict[str, Any] = table

    def _error(self, problem: str, key: str, remedy: str = "") -> CheckError:
        return CheckError(f"{self._label} {problem}", (key,) if key else (), remedy)

    def check(self) -> Check:
        """Return the check that the table declares."""
        for key in self._table:
            if key not in _KEYS:
                raise self._error(
                    f"has the unknown key {key!r}.", key, did_you_mean(key, _KEYS)
                )
        for key in _REQUIRED:
            if key not in self._table:
                raise self._error(f"lacks {key!r}.", key, f"Add {key} = ….")
        value = self._point("value")
        quantity = self._quantity(value)
        return Check(
            name=self._text("name"),
            model=self._text("model"),
            input=self._text("input"),
            output=self._text("output"),
            quantity=quantity,
            value=value,
            tolerance=self._tolerance(value),
            selection=self._selection(quantity, value),
            parameters=self._parameters(),
        )

    def _text(self, key: str) -> str:
        text = self._table[key]
        if not isinstance(text, str) or not text.strip():
            raise self._error(f"has {key} = {text!r}.", key, "Write a text in quotes.")
        return text

    def _number(self, key: str, number: object) -> float:
        plain = isinstance(number, int | float) and not isinstance(number, bool)
        if not plain or not math.isfinite(number):  # type: ignore[arg-type]
            raise self._error(f"has {key} = {number!r}.", key, "Write a finite number.")
        return float(number)  # type: ignore[arg-type]

    def _point(self, key: str) -> complex:
        """Return a real number or a ``[real, imaginary]`` pair."""
        value = self._table[key]
        if isinstance(value, list) and len(value) == 2:
            return complex(self._number(key, value[0]), self._number(key, value[1]))
        return complex(self._number(key, value))

    def _quantity(self, value: complex) -> CheckedQuantity:
        word = self._text("quantity")
        words = tuple(kind.value for kind in CheckedQuantity)
        if word not in words:
            raise self._error(
                f"asks for the quantity {word!r}.", word, did_you_mean(word, words)
            )
        quantity = CheckedQuantity(word)
        if value.imag and quantity in (CheckedQuantity.GAIN, CheckedQuantity.DC_GAIN):
            raise self._error(f"has a complex {word}.", "value", "Gains are real.")
        return quantity

    def _one_of(self, keys: tuple[str, ...]) -> str | None:
        given = [key for key in keys if key in self._table]
        if len(given) > 1:
            raise self._error(
                f"has both {given[0]} and {given[1]}.", given[1], "Keep one of them."
            )
        return given[0] if given else None

    def _tolerance(self, value: complex) -> Tolerance:
        key = self._one_of(_TOLERANCES)
        if key is None:
            raise self._error(
                "has no tolerance.",
                "tolerance",
                f"Add one of {', '.join(_TOLERANCES)}.",
            )
        if key == "digits":
            return self._decimals(value)
        amount = self._number(key, self._table[key])
        if amount < 0:
            raise self._error(f"has {key} = {amount:g}.", key, "Make it positive.")
        return Absolute(amount) if key == "tolerance" else Relative(amount)

    def _decimals(self, value: complex) -> Decimals:
        digits = self._whole("digits")
        for part in (value.real, value.imag):
            if round(part, digits) != part:
                raise self._error(
                    f"has the value {part!r}, which has more than {digits} decimals.",
                    "digits",
                    "Nothing rounds to it; raise digits or round the value.",
                )
        return Decimals(digits)

    def _whole(self, key: str) -> int:
        number = self._table[key]
        if not isinstance(number, int) or isinstance(number, bool) or number < 0:
            raise self._error(f"has {key} = {number!r}.", key, "Write 0, 1, 2, ….")
        return number

    def _selection(self, quantity: CheckedQuantity, value: complex) -> Selection:
        key = self._one_of(_SELECTIONS)
        if key is None:
            return Nearest(value)
        if quantity not in (CheckedQuantity.POLE, CheckedQuantity.ZERO):
            raise self._error(
                f"has {key}, but a {quantity} is one number.", key, f"Remove {key}."
            )
        return Index(self._whole(key)) if key == "index" else Nearest(self._point(key))

    def _parameters(self) -> Mapping[str, float] | str:
        given = self._table.get("parameters", {})
        if isinstance(given, str):
            return self._text("parameters")
        if not isinstance(given, dict):
            raise self._error(
                f"has parameters = {given!r}.",
                "parameters",
                'Write {name = value, …} or name a ParameterSet, "file.py:NAME".',
            )
        return {name: self._number(name, value) for name, value in given.items()}
