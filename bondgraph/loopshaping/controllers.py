"""Controllers as choice objects: a kind is a class, its numbers are its fields.

Each kind knows its factored form; products of kinds are controllers again. What a
design leaves open is a field named by its path, such as ``"lead.pole"``, so that the
same records serve a controller that is given, sized by a rule, or optimised.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar

from bondgraph.choices import is_finite, is_number
from bondgraph.errors import LoopShapingError, did_you_mean
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain


@dataclass(frozen=True, slots=True)
class AbstractController(ABC):
    """Anything that turns an error into a command; write a subclass for a new kind."""

    kind: ClassVar[str]

    @property
    @abstractmethod
    def transfer(self) -> ZeroPoleGain:
        """The factored form."""

    def scaled(self, factor: float) -> "AbstractController":
        """Return the controller with its gain multiplied by `factor`."""
        return self.with_value("gain", factor * self.value("gain"))

    def paths(self) -> tuple[str, ...]:
        """Return the names of the numbers in it."""
        return tuple(field.name for field in fields(self))

    def value(self, path: str) -> float:
        """Return the number at `path`."""
        name = self._field(path)
        return float(getattr(self, name))

    def with_value(self, path: str, value: float) -> "AbstractController":
        """Return the controller with another number at `path`."""
        return replace(self, **{self._field(path): value})

    def _field(self, path: str) -> str:
        name = path.removeprefix(f"{self.kind}.")
        if name not in self.paths():
            raise LoopShapingError(
                f"A {self.kind} controller has no {path!r}.",
                (path,),
                did_you_mean(path, self.paths()),
            )
        return name

    def _finite(self, *names: str) -> None:
        self._check(names, is_finite, "Give a finite number.")

    def _not_negative(self, *names: str) -> None:
        self._check(
            names,
            lambda x: is_finite(x) and x >= 0,
            "Give a finite number that is not negative.",
        )

    def _positive(self, *names: str) -> None:
        self._check(names, lambda x: is_number(x) and x > 0, "Give a positive number.")

    def _check(
        self, names: tuple[str, ...], right: Callable[[Any], bool], remedy: str
    ) -> None:
        for name in names:
            value = getattr(self, name)
            if not right(value):
                raise LoopShapingError(
                    f"The {name} of a {self.kind} controller is {value!r}.",
                    (name,),
                    remedy,
                )

    def __mul__(self, other: "AbstractController") -> "Product":
        return Product((*_parts(self), *_parts(other)))


@dataclass(frozen=True, slots=True)
class Gain(AbstractController):
    """A proportional controller."""

    gain: float = 1.0

    kind: ClassVar[str] = "gain"

    def __post_init__(self) -> None:
        self._finite("gain")

    @property
    def transfer(self) -> ZeroPoleGain:
        """The gain alone."""
        return ZeroPoleGain(gain=self.gain)


@dataclass(frozen=True, slots=True)
class Lead(AbstractController):
    """``gain (s + zero) / (1 + s/pole)``, the form of the FlegX thesis (eq. 5.12).

    ``zero`` and ``pole`` in rad/s; an infinite pole leaves the zero alone (a PD).
    """

    gain: float = 1.0
    zero: float = 1.0
    pole: float = math.inf

    kind: ClassVar[str] = "lead"

    def __post_init__(self) -> None:
        self._finite("gain")
        self._not_negative("zero")
        self._positive("pole")

    @property
    def transfer(self) -> ZeroPoleGain:
        """Zero, and pole where it is finite."""
        if math.isinf(self.pole):
            return ZeroPoleGain(zeros=(-self.zero,), gain=self.gain)
        poles, gain = (-self.pole,), self.gain * self.pole
        return ZeroPoleGain(zeros=(-self.zero,), poles=poles, gain=gain)


@dataclass(frozen=True, slots=True)
class LeadLag(AbstractController):
    """``gain (s + zero) / (1 + s/pole) · (s + lag_zero) / (s + lag_pole)``.

    The lag lifts the gain at rest by lag_zero / lag_pole.
    """

    gain: float = 1.0
    zero: float = 1.0
    pole: float = math.inf
    lag_zero: float = 1.0
    lag_pole: float = 1.0

    kind: ClassVar[str] = "lead_lag"

    def __post_init__(self) -> None:
        self._finite("gain")
        self._not_negative("zero", "lag_zero", "lag_pole")
        self._positive("pole")

    @property
    def transfer(self) -> ZeroPoleGain:
        """The lead times the lag."""
        lag = ZeroPoleGain(zeros=(-self.lag_zero,), poles=(-self.lag_pole,))
        return Lead(self.gain, self.zero, self.pole).transfer * lag


@dataclass(frozen=True, slots=True)
class PI(AbstractController):
    """``gain (s + zero) / s``: no error at rest under a constant disturbance."""

    gain: float = 1.0
    zero: float = 1.0

    kind: ClassVar[str] = "pi"

    def __post_init__(self) -> None:
        self._finite("gain")
        self._not_negative("zero")

    @property
    def transfer(self) -> ZeroPoleGain:
        """Zero and integrator."""
        return ZeroPoleGain(zeros=(-self.zero,), poles=(0,), gain=self.gain)


@dataclass(frozen=True, slots=True)
class Notch(AbstractController):
    """``(s² + 2 depth width ω s + ω²) / (s² + 2 width ω s + ω²)``, gain one at rest.

    ``depth`` is the gain at ``omega`` (0 removes it), ``width`` the damping ratio of
    the poles.
    """

    omega: float
    depth: float = 0.1
    width: float = 0.5
    gain: float = 1.0

    kind: ClassVar[str] = "notch"

    def __post_init__(self) -> None:
        self._finite("gain", "omega", "width")
        self._not_negative("depth")
        self._positive("omega", "width")

    @property
    def transfer(self) -> ZeroPoleGain:
        """A pair of zeros inside a pair of poles."""
        return ZeroPoleGain(
            zeros=_pair(self.omega, self.depth * self.width),
            poles=_pair(self.omega, self.width),
            gain=self.gain,
        )


@dataclass(frozen=True, slots=True)
class RollOff(AbstractController):
    """A Butterworth low pass, gain one at rest and 1/√2 at ``omega``."""

    omega: float
    order: int = 2
    gain: float = 1.0

    kind: ClassVar[str] = "roll_off"

    def __post_init__(self) -> None:
        self._finite("gain", "omega")
        self._positive("omega")
        self._check(
            ("order",),
            lambda n: is_finite(n) and n >= 1 and float(n).is_integer(),
            "Give a whole number, at least one.",
        )

    @property
    def transfer(self) -> ZeroPoleGain:
        """Poles on a half circle."""
        n = int(self.order)
        angles = [math.pi * (2 * k + n + 1) / (2 * n) for k in range(n)]
        poles = [self.omega * complex(math.cos(a), math.sin(a)) for a in angles]
        if n % 2:
            poles[n // 2] = complex(-self.omega)
        return ZeroPoleGain(poles=tuple(poles), gain=self.gain * self.omega**n)


@dataclass(frozen=True, slots=True)
class Product(AbstractController):
    """Controllers in series; paths name the factor, as ``"roll_off.omega"``."""

    factors: tuple[AbstractController, ...]

    kind: ClassVar[str] = "product"

    @property
    def transfer(self) -> ZeroPoleGain:
        """The product of the factors."""
        whole = ZeroPoleGain()
        for factor in self.factors:
            whole = whole * factor.transfer
        return whole

    def paths(self) -> tuple[str, ...]:
        """Return the names of the numbers in it; of equal kinds, those of the first."""
        return tuple(
            f"{part.kind}.{name}" for part in self.factors for name in part.paths()
        )

    def value(self, path: str) -> float:
        """Return the number at `path`."""
        return self.factors[self._place(path)].value(path)

    def with_value(self, path: str, value: float) -> "Product":
        """Return the product with another number at `path`."""
        k = self._place(path)
        changed = self.factors[k].with_value(path, value)
        return Product((*self.factors[:k], changed, *self.factors[k + 1 :]))

    def _place(self, path: str) -> int:
        if path == "gain":
            return 0
        for k, part in enumerate(self.factors):
            if path.startswith(f"{part.kind}."):
                return k
        raise LoopShapingError(
            f"No factor of the controller has {path!r}.",
            (path,),
            did_you_mean(path, self.paths()),
        )


def _parts(controller: AbstractController) -> tuple[AbstractController, ...]:
    return controller.factors if isinstance(controller, Product) else (controller,)


def _pair(omega: float, damping: float) -> tuple[complex, ...]:
    if damping >= 1:
        spread = math.sqrt(damping**2 - 1)
        return (-omega * (damping - spread), -omega * (damping + spread))
    root = omega * complex(-damping, math.sqrt(1 - damping**2))
    return (root, root.conjugate())
