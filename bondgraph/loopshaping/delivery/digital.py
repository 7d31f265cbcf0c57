"""A controller as a processor runs it: sampled, in its arithmetic, within its limits.

One step, at every sample::

    f  = Cf xf + Df y          the measurement, filtered
    e  = r - f
    v  = C x + D e + w         w: feed-forward
    u  = v within the limits
    xf ← Af xf + Bf y
    x  ← A x + B e'            e' = e but for anti-windup

Every line is a sum of products; `DigitalController` computes it with the arithmetic's
rounding, and the C text (see `c_code`) is written from the same numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, assert_never

from bondgraph.choices import refuse_other
from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.delivery.anti_windup import (
    AntiWindup,
    BackCalculation,
    Clamping,
    NoAntiWindup,
)
from bondgraph.loopshaping.delivery.arithmetic import AbstractArithmetic, Double
from bondgraph.loopshaping.delivery.discretise import AbstractDiscretisation, Tustin
from bondgraph.loopshaping.realisation import Matrices, realise
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain


@dataclass(frozen=True, slots=True, kw_only=True)
class Sum:
    """``Σ factor · signal``, the terms with a factor only.

    ``signals`` are places in the list of signals that the sum reads; ``width`` is the
    place of the last one, the input behind the states.
    """

    factors: tuple[Any, ...]
    signals: tuple[int, ...]
    width: int


@dataclass(frozen=True, slots=True, kw_only=True)
class DigitalController:
    """A controller ready to run.

    Parameters
    ----------
    period
        Seconds between samples.
    controller, filter
        Sampled, as they were before their coefficients were rounded.
    limits
        Least and greatest command; None for none.
    """

    name: str
    period: float
    controller: ZeroPoleGain
    filter: ZeroPoleGain
    arithmetic: AbstractArithmetic = field(default_factory=Double)
    limits: tuple[float, float] | None = None
    anti_windup: AntiWindup = field(default_factory=NoAntiWindup)

    def __post_init__(self) -> None:
        if not self.name.isidentifier():
            raise LoopShapingError(
                f"{self.name!r} cannot name functions in C.",
                (self.name,),
                "Use letters, digits and underscores.",
            )
        if self.limits is not None and not self.limits[0] < self.limits[1]:
            raise LoopShapingError(
                f"{self.limits[0]:g} to {self.limits[1]:g} are no limits.",
                remedy="Give the lower one first.",
            )
        for part in (self.controller, self.filter):
            if not part.static and part.period != self.period:
                raise LoopShapingError(
                    f"A part is sampled every {part.period} s, the controller every "
                    f"{self.period:g} s.",
                    remedy="Use digital_controller(...), which discretises both.",
                )
        if isinstance(self.anti_windup, BackCalculation) and not self.through:
            raise LoopShapingError(
                "Back calculation divides by the controller's direct gain, which is "
                "zero.",
                remedy="Use Clamping(), or discretise by Tustin().",
            )

    @property
    def through(self) -> float:
        """The direct gain D, from error to command in the same sample."""
        return float(_matrices(self.controller).D[0, 0])

    def sums(self) -> dict[str, list[Sum]]:
        """Return the sums by what they give: ``f``, ``xf``, ``v``, ``x``.

        The first signals are the states, the last one is the input (y or e).
        """
        ahead, behind = _matrices(self.controller), _matrices(self.filter)
        return {
            "f": self._rows(behind.C, behind.D),
            "xf": self._rows(behind.A, behind.B),
            "v": self._rows(ahead.C, ahead.D),
            "x": self._rows(ahead.A, ahead.B),
        }

    def _rows(self, states: FloatArray, source: FloatArray) -> list[Sum]:
        rows = []
        for by_state, by_input in zip(states, source, strict=True):
            all_ = [*by_state, *by_input]
            numbers = [self.arithmetic.number(float(c)) for c in all_]
            used = tuple(k for k, n in enumerate(numbers) if n != 0)
            factors = tuple(numbers[k] for k in used)
            self.arithmetic.allow(factors)
            rows.append(Sum(factors=factors, signals=used, width=len(by_state)))
        return rows

    def follow(self) -> Any:
        """Return γ/D of back calculation as a number; zero otherwise."""
        if isinstance(self.anti_windup, BackCalculation):
            share = self.anti_windup.share(self.period)
            return self.arithmetic.number(share / self.through)
        return self.arithmetic.number(0.0)

    def rounded(self) -> tuple[Matrices, Matrices]:
        """Return the matrices of controller and filter as the processor has them."""
        value = self.arithmetic.value

        def back(matrices: Matrices) -> Matrices:
            parts = []
            for matrix in matrices:
                copy = matrix.copy()
                for place, entry in enumerate(matrix.flat):
                    copy.flat[place] = value(self.arithmetic.number(float(entry)))
                parts.append(copy)
            return Matrices(*parts)

        return back(_matrices(self.controller)), back(_matrices(self.filter))

    def run(self) -> "Run":
        """Return a fresh run with all states zero."""
        return Run(self)


def _matrices(part: ZeroPoleGain) -> Matrices:
    return realise(part)


class Run:
    """A controller that is running; it has memory."""

    def __init__(self, controller: DigitalController) -> None:
        self.controller = controller
        self._sums = controller.sums()
        self._follow = controller.follow()
        arithmetic = controller.arithmetic
        self._x = [arithmetic.number(0.0)] * len(self._sums["x"])
        self._xf = [arithmetic.number(0.0)] * len(self._sums["xf"])
        limits = controller.limits
        self._limits = limits and tuple(arithmetic.number(v) for v in limits)

    def step(
        self, reference: float, measured: float, feedforward: float = 0.0
    ) -> float:
        """Return the command of one sample."""
        a = self.controller.arithmetic
        r, y, w = (a.signal(float(v)) for v in (reference, measured, feedforward))
        behind = [*self._xf, y]
        (filtered,) = self._all("f", behind)
        error = self._plus(r, filtered, sign=-1)
        ahead = [*self._x, error]
        (wanted,) = self._all("v", ahead)
        wanted = self._plus(wanted, w)
        command = wanted
        if self._limits:
            low, high = self._limits
            command = low if wanted < low else high if wanted > high else wanted
        self._xf = self._all("xf", behind)
        self._remember(ahead, wanted, command)
        return a.value(command)

    def _remember(self, ahead: list[Any], wanted: Any, command: Any) -> None:
        """Move the controller's states on."""
        error = ahead[-1]
        match self.controller.anti_windup:
            case NoAntiWindup():
                pass
            case Clamping():
                beyond = int(wanted > command) - int(wanted < command)
                if beyond * self._direction(error) > 0:
                    return
            case BackCalculation():
                missing = self._plus(command, wanted, sign=-1)
                a = self.controller.arithmetic
                change = a.sum_of_products([self._follow], [missing])
                ahead = [*ahead[:-1], self._plus(error, change)]
            case _ as never:
                assert_never(never)
        self._x = self._all("x", ahead)

    def _direction(self, error: Any) -> int:
        sign = int(error > 0) - int(error < 0)
        return sign if self.controller.controller.gain > 0 else -sign

    def _all(self, name: str, signals: Sequence[Any]) -> list[Any]:
        a = self.controller.arithmetic
        return [
            a.sum_of_products(s.factors, [signals[k] for k in s.signals])
            for s in self._sums[name]
        ]

    def _plus(self, one: Any, other: Any, *, sign: int = 1) -> Any:
        a = self.controller.arithmetic
        return a.clipped(one + other if sign > 0 else one - other)


def digital_controller(
    controller: ZeroPoleGain,
    period: float,
    *,
    name: str = "controller",
    filter: ZeroPoleGain | None = None,  # noqa: A002
    method: AbstractDiscretisation | None = None,
    filter_method: AbstractDiscretisation | None = None,
    arithmetic: AbstractArithmetic | None = None,
    limits: tuple[float, float] | None = None,
    anti_windup: AntiWindup | None = None,
) -> DigitalController:
    """Return a continuous controller as a processor runs it.

    Parameters
    ----------
    controller, filter
        Continuous: from error to command, and on the measurement.
    period
        Seconds between samples.
    method, filter_method
        `Tustin` if not given; the filter's is the controller's.
    arithmetic
        `Double` if not given.
    limits
        Least and greatest command.
    anti_windup
        `Clamping` if not given and there are limits.

    Raises
    ------
    LoopShapingError
        If a part cannot be discretised, a coefficient does not fit the arithmetic, or a
        choice is none of its family.
    """
    method = Tustin() if method is None else method
    filter_method = method if filter_method is None else filter_method
    arithmetic = Double() if arithmetic is None else arithmetic
    if anti_windup is None:
        anti_windup = NoAntiWindup() if limits is None else Clamping()
    for chosen, family, what in (
        (method, AbstractDiscretisation, "method"),
        (filter_method, AbstractDiscretisation, "filter_method"),
        (arithmetic, AbstractArithmetic, "arithmetic"),
        (anti_windup, AntiWindup, "anti_windup"),
    ):
        refuse_other(chosen, family, f"The {what} of {name!r}", LoopShapingError)
    made = DigitalController(
        name=name,
        period=period,
        controller=method(controller, period),
        filter=filter_method(filter or ZeroPoleGain(), period),
        arithmetic=arithmetic,
        limits=limits,
        anti_windup=anti_windup,
    )
    made.sums()  # refuses coefficients that do not fit
    return made
