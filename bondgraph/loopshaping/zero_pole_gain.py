"""A loop's parts by their zeros, poles, gain and delay.

Factored form is the form of loop shaping: series connection joins lists, magnitude and
phase are sums over roots, and a pole at 1.6·10⁶ rad/s beside one at 10⁻³ costs no
digits, as it does in polynomial coefficients. The delay stays exp(-sT), never a Padé
fraction. The phase is continuous by construction, so that nothing is unwrapped.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import LoopShapingError

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class ZeroPoleGain:
    """``gain · Π(s - zero) / Π(s - pole) · exp(-s delay)``, one input, one output.

    Parameters
    ----------
    zeros, poles
        In rad/s, complex ones in conjugate pairs; of z where `period` is given.
    gain
        The ratio of leading coefficients, real, in the units of output over input.
    delay
        In seconds, not negative; a whole number of periods where sampled.
    period
        Sampling period in seconds; None for continuous time.

    Raises
    ------
    LoopShapingError
        If a complex root has no partner, or there are more zeros than poles.
    """

    zeros: tuple[complex, ...] = ()
    poles: tuple[complex, ...] = ()
    gain: float = 1.0
    delay: float = 0.0
    period: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "zeros", _paired(self.zeros, "zero"))
        object.__setattr__(self, "poles", _paired(self.poles, "pole"))
        object.__setattr__(self, "gain", float(self.gain))
        if not (math.isfinite(self.gain) and 0 <= self.delay < math.inf):
            raise LoopShapingError(
                f"A gain of {self.gain} with a delay of {self.delay} s is no system.",
                remedy="Give a finite gain and a delay that is not negative.",
            )
        if self.period is not None:
            self._check_sampling(self.period)

    def _check_sampling(self, period: float) -> None:
        if not 0 < period < math.inf:
            raise LoopShapingError(
                f"A sampling period of {period} s is no period.",
                remedy="Give a positive number of seconds.",
            )
        samples = self.delay / period
        if abs(samples - round(samples)) > 1e-9 * max(1.0, samples):
            raise LoopShapingError(
                f"A delay of {self.delay:g} s is {samples:g} sampling periods.",
                remedy="Put the fraction of a period into the plant's zeros and poles "
                "when it is discretised.",
            )

    def __mul__(self, other: "ZeroPoleGain") -> "ZeroPoleGain":
        if not isinstance(other, ZeroPoleGain):
            return NotImplemented
        return ZeroPoleGain(
            zeros=self.zeros + other.zeros,
            poles=self.poles + other.poles,
            gain=self.gain * other.gain,
            delay=self.delay + other.delay,
            period=_common_period(self, other),
        )

    def times(self, factor: float) -> "ZeroPoleGain":
        """Return the system with its gain multiplied by `factor`."""
        return replace(self, gain=self.gain * factor)

    @property
    def static(self) -> bool:
        """Whether this is a plain number, which fits any sampling period."""
        return not (self.zeros or self.poles or self.delay)

    @property
    def relative_degree(self) -> int:
        """Poles minus zeros; negative for an improper system."""
        return len(self.poles) - len(self.zeros)

    @property
    def dc_gain(self) -> float:
        """The value at zero frequency; infinite, with a sign, behind an integrator."""
        rest = 0.0 if self.period is None else 1.0
        zeros = [z for z in self.zeros if z != rest]
        poles = [p for p in self.poles if p != rest]
        order = (len(self.poles) - len(poles)) - (len(self.zeros) - len(zeros))
        top = complex(np.prod([rest - z for z in zeros]))
        value = (self.gain * top / complex(np.prod([rest - p for p in poles]))).real
        if order == 0:
            return float(value)
        return math.copysign(math.inf, value) if order > 0 else 0.0

    def at(self, point: ComplexArray | complex) -> ComplexArray:
        """Return the value at points of the s-plane (of the z-plane if sampled)."""
        x = np.asarray(point, dtype=complex)
        value = np.full(x.shape, complex(self.gain))
        for zero in self.zeros:
            value = value * (x - zero)
        for pole in self.poles:
            value = value / (x - pole)
        if self.delay and self.period is None:
            value = value * np.exp(-x * self.delay)
        elif self.delay and self.period is not None:
            value = value * x ** -round(self.delay / self.period)
        return np.asarray(value)

    def response(self, omega: FloatArray) -> ComplexArray:
        """Return the frequency response at `omega` in rad/s."""
        w = np.asarray(omega, dtype=float)
        return self.at(1j * w if self.period is None else np.exp(1j * w * self.period))

    def __str__(self) -> str:
        variable = "s" if self.period is None else "z"
        top = "".join(_factors(self.zeros, variable))
        bottom = "".join(_factors(self.poles, variable))
        number = f"{self.gain:.6g}"
        text = f"{number} {top}".strip() + (f" / [{bottom}]" if bottom else "")
        return text + (f" · exp(-{self.delay:g} s)" if self.delay else "")


def _common_period(a: ZeroPoleGain, b: ZeroPoleGain) -> float | None:
    if a.period == b.period or b.static:
        return a.period
    if a.static:
        return b.period
    raise LoopShapingError(
        f"Sampling periods of {a.period} s and {b.period} s meet in one loop.",
        remedy="Discretise the plant at the controller's rate first.",
    )


def _paired(roots: tuple[complex, ...], kind: str) -> tuple[complex, ...]:
    """Return the roots with conjugates made exact, by magnitude."""
    found = [complex(r) for r in roots]
    real = [complex(r.real) for r in found if _is_real(r)]
    upper = [r for r in found if not _is_real(r) and r.imag > 0]
    lower = [r for r in found if not _is_real(r) and r.imag < 0]
    pairs: list[complex] = []
    for root in upper:
        partner = min(lower, key=lambda r: abs(r.conjugate() - root), default=None)
        if partner is None or abs(partner.conjugate() - root) > 1e-6 * abs(root):
            raise _unpaired(kind, root)
        lower.remove(partner)
        pairs += [root, root.conjugate()]
    if lower:
        raise _unpaired(kind, lower[0])
    return tuple(sorted(real + pairs, key=lambda r: (abs(r), r.real, -r.imag)))


def _is_real(root: complex) -> bool:
    return abs(root.imag) <= 1e-14 * abs(root)


def _unpaired(kind: str, root: complex) -> LoopShapingError:
    return LoopShapingError(
        f"The {kind} {root:.6g} has no conjugate beside it.",
        remedy="Give complex roots in conjugate pairs.",
    )


def _factors(roots: tuple[complex, ...], variable: str) -> list[str]:
    written = []
    for root in roots:
        if root.imag == 0:
            shift = -root.real
            written.append(
                variable
                if shift == 0
                else f"({variable} {'+' if shift > 0 else '-'} {abs(shift):.6g})"
            )
        elif root.imag > 0:
            middle, end = -2 * root.real, abs(root) ** 2
            sign = "+" if middle >= 0 else "-"
            square = f"{variable}² {sign} {abs(middle):.6g} {variable} + {end:.6g}"
            written.append(f"({square})")
    return written
