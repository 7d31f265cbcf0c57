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

A loop is declared by the controller in front of the model and what is in its feedback
branch, each as factors; 1 where left out::

    quantity = "phase_margin"  # degrees; or gain_margin, delay_margin (s),
                               # modulus_margin, gain_crossover, phase_crossover,
                               # bandwidth (rad/s)
    controller = {gain = 70.0, zeros = [-0.18], poles = [-50.0]}
    feedback = {gain = 24674.0, poles = [[-111.1, 111.1], [-111.1, -111.1]]}

The same selection says which crossover is meant. Zeros and poles are in rad/s and the
gain is that of ``gain · Π(s - zero) / Π(s - pole)``; ``delay`` is in seconds.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bondgraph.checking.records import (
    ONE,
    Absolute,
    Check,
    CheckedQuantity,
    Decimals,
    Index,
    Nearest,
    Relative,
    Selection,
    Tolerance,
)
from bondgraph.checking.written import NotTomlError, finite, shown, toml
from bondgraph.errors import CheckError, LoopShapingError, did_you_mean
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain

OF_A_MODEL = (
    "Whether a model is well made, 'bondgraph derive' says, and what it does, "
    "'bondgraph simulate'."
)


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
        return toml(path)
    except FileNotFoundError:
        written = "Write one with [[check]] tables, or name another file."
        raise CheckError(
            f"There is no check file {str(path)!r}.",
            (str(path),),
            OF_A_MODEL if ":" in path.name else written,
        ) from None
    except OSError as error:
        raise CheckError(
            f"The check file {str(path)!r} cannot be read: {error.strerror}.",
            (str(path),),
            "Name a file that may be read.",
        ) from error
    except NotTomlError as error:
        if path.suffix == ".py":
            raise CheckError(
                f"{path.name} is Python; a check file is TOML and declares values.",
                (str(path),),
                OF_A_MODEL,
            ) from error
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


MOST = 1000
"""A number of digits or of a pole beyond it is a slip of the pen."""

_REQUIRED = ("name", "model", "input", "output", "quantity", "value")
_TOLERANCES = ("tolerance", "relative_tolerance", "digits")
_SELECTIONS = ("index", "nearest")
_AROUND = ("controller", "feedback")
_FACTORS = ("gain", "zeros", "poles", "delay")
_KEYS = (*_REQUIRED, *_TOLERANCES, *_SELECTIONS, *_AROUND, "parameters")
_SEVERAL = (
    *(CheckedQuantity.POLE, CheckedQuantity.ZERO),
    *(CheckedQuantity.GAIN_CROSSOVER, CheckedQuantity.PHASE_CROSSOVER),
)


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
                    f"has the unknown key {shown(key)}.", key, did_you_mean(key, _KEYS)
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
            controller=self._part("controller", quantity),
            feedback=self._part("feedback", quantity),
        )

    def _text(self, key: str) -> str:
        text = self._table[key]
        if not isinstance(text, str) or not text.strip():
            raise self._error(
                f"has {key} = {shown(text)}.", key, "Write a text in quotes."
            )
        return text

    def _number(self, key: str, number: object) -> float:
        found = finite(number)
        if found is None:
            raise self._error(
                f"has {key} = {shown(number)}.", key, "Write a finite number."
            )
        return found

    def _point(self, key: str) -> complex:
        """Return a real number or a ``[real, imaginary]`` pair."""
        return self._complex(key, self._table[key])

    def _complex(self, key: str, value: object) -> complex:
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
        if value.imag and quantity not in (CheckedQuantity.POLE, CheckedQuantity.ZERO):
            raise self._error(
                f"has a complex {word}.", "value", "Only poles and zeros are."
            )
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
        if not isinstance(number, int) or isinstance(number, bool):
            raise self._no_count(key, number)
        if not 0 <= number <= MOST:
            raise self._no_count(key, number)
        return number

    def _no_count(self, key: str, number: object) -> CheckError:
        return self._error(f"has {key} = {shown(number)}.", key, "Write 0, 1, 2, ….")

    def _selection(self, quantity: CheckedQuantity, value: complex) -> Selection:
        key = self._one_of(_SELECTIONS)
        if key is None:
            return Nearest(value)
        if quantity not in _SEVERAL:
            raise self._error(
                f"has {key}, but a {quantity} is one number.", key, f"Remove {key}."
            )
        return Index(self._whole(key)) if key == "index" else Nearest(self._point(key))

    def _part(self, key: str, quantity: CheckedQuantity) -> ZeroPoleGain:
        """Return the controller, or the feedback branch, from its factors."""
        given = self._table.get(key)
        if given is None:
            return ONE
        if not quantity.of_a_loop:
            raise self._error(
                f"has a {key}, but a {quantity} is of the model alone.",
                key,
                f"Remove {key}.",
            )
        if not isinstance(given, dict):
            raise self._error(
                f"has {key} = {given!r}.",
                key,
                "Write {gain = …, zeros = […], poles = […]}.",
            )
        for name in given:
            if name not in _FACTORS:
                raise self._error(
                    f"has {name!r} in {key}.", name, did_you_mean(name, _FACTORS)
                )
        try:
            return ZeroPoleGain(
                gain=self._number("gain", given.get("gain", 1.0)),
                zeros=self._roots("zeros", given),
                poles=self._roots("poles", given),
                delay=self._number("delay", given.get("delay", 0.0)),
            )
        except LoopShapingError as error:
            raise self._error(f"{key}: {error.problem}", key, error.remedy) from error

    def _roots(self, key: str, given: dict[str, Any]) -> tuple[complex, ...]:
        roots = given.get(key, [])
        if not isinstance(roots, list):
            raise self._error(f"has {key} = {shown(roots)}.", key, "Write them in [ ].")
        return tuple(self._complex(key, root) for root in roots)

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
