"""The numbers that a controller is computed in: double, single, or fixed point.

Each kind rounds coefficients and signals as the processor will, operation by operation
in the order in which the C text has them, so that our simulation and the compiled code
agree to the last bit.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bondgraph.errors import LoopShapingError


class AbstractArithmetic(ABC):
    """A kind of number."""

    __slots__ = ()

    @abstractmethod
    def number(self, value: float) -> Any:
        """Return the nearest number of this kind.

        Raises
        ------
        LoopShapingError
            If it is out of range.
        """

    @abstractmethod
    def value(self, number: Any) -> float:
        """Return what a number of this kind stands for."""

    @abstractmethod
    def sum_of_products(self, factors: Sequence[Any], signals: Sequence[Any]) -> Any:
        """Return Σ factor · signal, rounded as the processor does."""

    def signal(self, value: float) -> Any:
        """Return a signal as a number; the end of the range if it is beyond."""
        return self.number(value)

    def clipped(self, number: Any) -> Any:
        """Return the result of an addition, kept within the range."""
        return number

    def allow(self, factors: Sequence[Any]) -> None:  # noqa: B027  (most have no limit)
        """Refuse factors whose sum of products could overflow whatever the signals."""


@dataclass(frozen=True, slots=True)
class Double(AbstractArithmetic):
    """64-bit floating point."""

    def number(self, value: float) -> float:
        """Return the value."""
        return float(value)

    def value(self, number: float) -> float:
        """Return the value."""
        return number

    def sum_of_products(
        self, factors: Sequence[float], signals: Sequence[float]
    ) -> float:
        """Return the sum from left to right."""
        total = 0.0
        for factor, signal in zip(factors, signals, strict=True):
            total = total + factor * signal
        return total


@dataclass(frozen=True, slots=True)
class Single(AbstractArithmetic):
    """32-bit floating point."""

    def number(self, value: float) -> np.float32:
        """Return the nearest 32-bit number."""
        return np.float32(value)

    def value(self, number: np.float32) -> float:
        """Return the value."""
        return float(number)

    def sum_of_products(
        self, factors: Sequence[np.float32], signals: Sequence[np.float32]
    ) -> np.float32:
        """Return the sum from left to right, each operation in 32 bits."""
        total = np.float32(0.0)
        for factor, signal in zip(factors, signals, strict=True):
            total = np.float32(total + np.float32(factor * signal))
        return total


@dataclass(frozen=True, slots=True, kw_only=True)
class FixedPoint(AbstractArithmetic):
    """32-bit integers that stand for themselves over ``2^fraction_bits``.

    Products are summed in 64 bits and rounded once, half away from zero; what does not
    fit 32 bits stays at the end of the range.
    """

    fraction_bits: int = 16

    def __post_init__(self) -> None:
        if not 1 <= self.fraction_bits <= 30:
            raise LoopShapingError(
                f"{self.fraction_bits} fraction bits do not fit a 32-bit word.",
                remedy="Give 1 to 30.",
            )

    def number(self, value: float) -> int:
        """Return the nearest integer to ``value · 2^fraction_bits``."""
        size = math.floor(abs(value) * 2.0**self.fraction_bits + 0.5)
        if size >= 2**31:
            raise LoopShapingError(
                f"{value:g} does not fit 32 bits with {self.fraction_bits} fraction "
                f"bits.",
                remedy="Give fewer fraction bits, or scale the controller's units.",
            )
        return -size if value < 0 else size

    def value(self, number: int) -> float:
        """Return the value."""
        return float(number) / 2.0**self.fraction_bits

    def signal(self, value: float) -> int:
        """Return a signal, at the end of the range if beyond."""
        most = (2**31 - 1) / 2.0**self.fraction_bits
        return self.number(min(max(value, -most), most))

    def allow(self, factors: Sequence[int]) -> None:
        """Refuse factors whose products with 32-bit signals do not fit 64 bits.

        Raises
        ------
        LoopShapingError
            If they do not.
        """
        if sum(abs(f) for f in factors) >= 2**32 - 1:
            raise LoopShapingError(
                f"The coefficients of one sum are too large for {self.fraction_bits} "
                f"fraction bits.",
                remedy="Give fewer fraction bits, or scale the controller's units.",
            )

    def sum_of_products(self, factors: Sequence[int], signals: Sequence[int]) -> int:
        """Return the sum, rounded once and kept within 32 bits."""
        total = sum(f * s for f, s in zip(factors, signals, strict=True))
        half = 1 << (self.fraction_bits - 1)
        size = (abs(total) + half) >> self.fraction_bits
        return self.clipped(-size if total < 0 else size)

    def clipped(self, number: int) -> int:
        """Return the number, or the end of the range."""
        return max(min(number, 2**31 - 1), -(2**31 - 1))
