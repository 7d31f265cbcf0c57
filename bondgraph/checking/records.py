"""One declared value: what of which model, how far it may be off, around which loop."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain

ONE = ZeroPoleGain()
"""A part of a loop that is left out."""


class CheckedQuantity(StrEnum):
    """What of a transfer function, or of a loop around it, is compared."""

    GAIN = "gain"
    DC_GAIN = "dc_gain"
    POLE = "pole"
    ZERO = "zero"
    GAIN_CROSSOVER = "gain_crossover"
    PHASE_CROSSOVER = "phase_crossover"
    PHASE_MARGIN = "phase_margin"
    GAIN_MARGIN = "gain_margin"
    DELAY_MARGIN = "delay_margin"
    MODULUS_MARGIN = "modulus_margin"
    BANDWIDTH = "bandwidth"

    @property
    def of_a_loop(self) -> bool:
        """Whether it is measured of a closed loop."""
        return self.value.endswith(("_margin", "_crossover", "bandwidth"))


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
    controller, feedback
        Of the loop around the model, for quantities of a loop.
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
    controller: ZeroPoleGain = ONE
    feedback: ZeroPoleGain = ONE
