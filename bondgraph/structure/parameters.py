"""A number carries its unit, its uncertainty, its bounds and its source.

``std`` says what is known about a value before any fit: ``0.0`` is exact (a tooth
count), a positive number is one standard deviation of what is known, and ``None``
means the value is only a starting guess, free to be fitted.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from bondgraph.choices import is_number
from bondgraph.errors import ParameterError, did_you_mean
from bondgraph.structure.units import conversion


@dataclass(frozen=True, slots=True)
class Assumed:
    """A value nobody measured: a guess, a default, a convention."""

    reason: str = ""


@dataclass(frozen=True, slots=True)
class Measured:
    """A value measured on the machine."""

    recording: str = ""
    method: str = ""


@dataclass(frozen=True, slots=True)
class Published:
    """A value from a document: data sheet, table, equation."""

    reference: str


@dataclass(frozen=True, slots=True)
class Fitted:
    """A value estimated from recordings by this toolkit."""

    recordings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Reconciled:
    """A value inferred so that published results come out; `reason` says which."""

    reason: str


Provenance = Assumed | Measured | Published | Fitted | Reconciled


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One number of a model, in SI units.

    Parameters
    ----------
    value, unit
        The number and its unit; ``None`` where no value is known yet.
    bounds
        Closed interval of physically possible values.
    std
        Standard deviation of what is known; see the module's head.
    interval
        Half-width of the rounding of a printed value, where there is one.
    source
        Where the number comes from.
    """

    name: str
    value: float | None = None
    unit: str = "1"
    bounds: tuple[float, float] = (-math.inf, math.inf)
    std: float | None = None
    rounding: float | None = None
    source: Provenance = field(default_factory=Assumed)

    def __post_init__(self) -> None:
        for what, number in (("value", self.value), ("standard deviation", self.std)):
            if number is not None:
                _check_number(self.name, number, what)
        low, high = self._interval()
        object.__setattr__(self, "bounds", (low, high))
        if not low < high:
            raise ParameterError(
                f"Parameter {self.name!r} has bounds ({low}, {high}).",
                (self.name,),
                "Give a lower bound below the upper one.",
            )
        if self.value is not None:
            if not math.isfinite(self.value):
                raise ParameterError(
                    f"Parameter {self.name!r} has the value {self.value}.",
                    (self.name,),
                    "Give a finite number.",
                )
            if not low <= self.value <= high:
                raise ParameterError(
                    f"Parameter {self.name!r} = {self.value:g} {self.unit} lies "
                    f"outside its bounds ({low:g}, {high:g}), which are in that unit.",
                    (self.name,),
                    "Correct the value or widen the bounds.",
                )
        if self.std is not None and not self.std >= 0:
            raise ParameterError(
                f"Parameter {self.name!r} has the standard deviation {self.std}.",
                (self.name,),
                "Give None (free), 0.0 (exact) or a positive number.",
            )

    def _interval(self) -> tuple[float, float]:
        bounds = self.bounds
        if not (isinstance(bounds, Sequence) and len(bounds) == 2):
            raise ParameterError(
                f"Parameter {self.name!r} has the bounds {bounds!r}.",
                (self.name,),
                "Give two numbers, the lower one first.",
            )
        for bound in bounds:
            _check_number(self.name, bound, "bound")
        return bounds

    @property
    def exact(self) -> bool:
        """Whether the value is known exactly and never fitted."""
        return self.std == 0.0

    def to(self, unit: str) -> "Parameter":
        """Return the parameter expressed in `unit` (value, std and bounds scaled)."""
        scale, offset = conversion(self.unit, unit)
        if (scale, offset) == (1.0, 0.0):
            return replace(self, unit=unit)

        def shift(x: float) -> float:
            return scale * x + offset

        low, high = sorted(map(shift, self.bounds))
        return replace(
            self,
            unit=unit,
            value=None if self.value is None else shift(self.value),
            bounds=(low, high),
            std=None if self.std is None else abs(scale) * self.std,
            rounding=None if self.rounding is None else abs(scale) * self.rounding,
        )


def _check_number(name: str, value: object, what: str) -> None:
    if not is_number(value):
        raise ParameterError(
            f"Parameter {name!r} has the {what} {value!r}.",
            (name,),
            "Give a number, and its unit beside it.",
        )


@dataclass(frozen=True, slots=True)
class ParameterSet(Mapping[str, Parameter]):
    """Parameters by name, in a fixed order; never modified."""

    members: tuple[Parameter, ...] = ()
    _index: dict[str, Parameter] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_index", {m.name: m for m in self.members})
        if len(self._index) < len(self.members):
            names = [member.name for member in self.members]
            name = next(n for n in names if names.count(n) > 1)
            raise ParameterError(
                f"Parameter {name!r} is given twice.", (name,), "Keep one of them."
            )

    def __getitem__(self, name: str) -> Parameter:
        return self._index[name]

    def __iter__(self) -> Iterator[str]:
        return (member.name for member in self.members)

    def __len__(self) -> int:
        return len(self.members)

    def find(self, name: str) -> Parameter:
        """Return the parameter called `name`.

        Raises
        ------
        ParameterError
            If there is none; names the closest ones.
        """
        try:
            return self[name]
        except KeyError:
            raise ParameterError(
                f"There is no parameter {name!r}.", (name,), did_you_mean(name, self)
            ) from None

    def merged(self, others: Iterable[Parameter]) -> "ParameterSet":
        """Return the set with `others` added, replacing those of the same name."""
        new = {member.name: member for member in self.members}
        new.update((other.name, other) for other in others)
        return ParameterSet(tuple(new.values()))

    def restricted(self, names: Iterable[str]) -> "ParameterSet":
        """Return only the parameters in `names`, in this set's order."""
        wanted = set(names)
        return ParameterSet(tuple(m for m in self.members if m.name in wanted))

    def with_values(self, values: Mapping[str, float]) -> "ParameterSet":
        """Return the set with new values for the parameters named in `values`."""
        for name, value in values.items():
            self.find(name)
            _check_number(name, value, "value")
        return ParameterSet(
            tuple(
                replace(m, value=float(values[m.name])) if m.name in values else m
                for m in self.members
            )
        )

    def values_by_name(self) -> dict[str, float]:
        """Return the values.

        Raises
        ------
        ParameterError
            If a parameter has no value.
        """
        missing = tuple(m.name for m in self.members if m.value is None)
        if missing:
            raise ParameterError(
                f"No value is given for {', '.join(missing)}.",
                missing,
                "Declare it with parameter(name, value, unit).",
            )
        return {m.name: m.value for m in self.members if m.value is not None}

    def assumed(self) -> tuple[Parameter, ...]:
        """Return the parameters that nobody measured."""
        return tuple(m for m in self.members if isinstance(m.source, Assumed))
