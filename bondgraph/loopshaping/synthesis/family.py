"""The plants that what was identified allows: a posterior, ranges, other hypotheses.

A fit does not give a plant but a distribution of plants; a diagnosis that could not
decide gives several. A `PlantFamily` is a list of hypotheses, each a model with what is
known about its numbers and a weight, and draws plants from it.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, product

import numpy as np

from bondgraph.errors import LoopShapingError, ParameterError
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.zero_pole_gain import FloatArray
from bondgraph.structure.parameters import ParameterSet

_TRIES = 1000  # draws for one sample within the bounds
Values = Mapping[str, float]


class AbstractUncertainty(ABC):
    """What is known about some parameters."""

    __slots__ = ()

    @abstractmethod
    def nominal(self) -> dict[str, float]:
        """Return the most likely values."""

    @abstractmethod
    def draw(self, generator: np.random.Generator) -> dict[str, float]:
        """Return values drawn at random."""

    def extremes(self) -> list[dict[str, float]]:
        """Return values at the corners, where there are any."""
        return []


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Posterior(AbstractUncertainty):
    """Parameters with a mean and a covariance, as a fit gives them.

    Draws outside the bounds are drawn again.

    Parameters
    ----------
    names, mean, covariance
        In SI units.
    bounds
        Least and greatest value by name, for those that have bounds.
    """

    names: tuple[str, ...]
    mean: FloatArray
    covariance: FloatArray
    bounds: Mapping[str, tuple[float, float]]

    def __post_init__(self) -> None:
        n = len(self.names)
        if self.mean.shape != (n,) or self.covariance.shape != (n, n):
            raise LoopShapingError(
                f"A covariance of shape {self.covariance.shape} does not belong to "
                f"{n} parameters.",
                self.names,
                "Give one row and column per parameter.",
            )
        least = float(np.linalg.eigvalsh(self.covariance).min(initial=0.0))
        size = float(np.abs(self.covariance).max(initial=0.0))
        if least < -1e-9 * size or not np.allclose(self.covariance, self.covariance.T):
            raise LoopShapingError(
                "The covariance is not symmetric and positive.",
                self.names,
                "Give the covariance of the estimates.",
            )

    @classmethod
    def of(
        cls,
        parameters: ParameterSet,
        *,
        covariance: FloatArray | None = None,
        names: Iterable[str] | None = None,
    ) -> "Posterior":
        """Return the posterior of parameters, such as ``fit.model.parameters``.

        Parameters
        ----------
        covariance
            Of the parameters in `names`. Without it they are taken as independent with
            their standard deviations, which is wrong where a fit knows only products
            or ratios of them.
        names
            Those that are uncertain; all with a positive standard deviation otherwise.

        Raises
        ------
        ParameterError
            If one of them has no value, or no standard deviation and no covariance.
        """
        chosen = (
            tuple(names)
            if names is not None
            else tuple(p.name for p in parameters.values() if p.std)
        )
        members = [parameters.find(name) for name in chosen]
        for member in members:
            if member.value is None or (covariance is None and member.std is None):
                raise ParameterError(
                    f"Nothing says how uncertain {member.name!r} is.",
                    (member.name,),
                    "Give it a value and a standard deviation, or a covariance.",
                )
        stds = np.array([float(m.std or 0.0) for m in members])
        limits = {m.name: _limits(m.bounds) for m in members}
        return cls(
            names=chosen,
            mean=np.array([float(m.value or 0.0) for m in members]),
            covariance=np.diag(stds**2) if covariance is None else covariance,
            bounds=limits,
        )

    def nominal(self) -> dict[str, float]:
        """Return the means."""
        return dict(zip(self.names, map(float, self.mean), strict=True))

    def draw(self, generator: np.random.Generator) -> dict[str, float]:
        """Return values drawn from the normal distribution within the bounds."""
        for _ in range(_TRIES):
            drawn = generator.multivariate_normal(
                self.mean, self.covariance, method="eigh"
            )
            values = dict(zip(self.names, map(float, drawn), strict=True))
            if all(a <= values[n] <= b for n, (a, b) in self.bounds.items()):
                return values
        raise LoopShapingError(
            "Hardly any draw of the posterior lies within the parameters' bounds.",
            self.names,
            "Fit again with these bounds, or widen them.",
        )


def _limits(bounds: tuple[float | None, float | None] | None) -> tuple[float, float]:
    low, high = bounds or (None, None)
    return (
        -math.inf if low is None else float(low),
        math.inf if high is None else float(high),
    )


@dataclass(frozen=True, slots=True)
class Ranges(AbstractUncertainty):
    """Positive parameters each known to lie in a range, any size alike (log-uniform).

    ``low_high`` by name; the nominal value is the geometric mean, corners are extremes.
    """

    low_high: Mapping[str, tuple[float, float]]

    def __post_init__(self) -> None:
        for name, (low, high) in self.low_high.items():
            if not 0 < low <= high < math.inf:
                raise LoopShapingError(
                    f"{name!r} cannot lie between {low:g} and {high:g}.",
                    (name,),
                    "Give two positive limits, the lower one first.",
                )

    def nominal(self) -> dict[str, float]:
        """Return the geometric means."""
        return {n: math.sqrt(a * b) for n, (a, b) in self.low_high.items()}

    def draw(self, generator: np.random.Generator) -> dict[str, float]:
        """Return values drawn evenly in the logarithm."""
        return {
            n: math.exp(generator.uniform(math.log(a), math.log(b)))
            for n, (a, b) in self.low_high.items()
        }

    def extremes(self) -> list[dict[str, float]]:
        """Return all corners, or 64 of them where there are more."""
        names = list(self.low_high)
        corners = product(*(dict.fromkeys(self.low_high[n]) for n in names))
        return [dict(zip(names, c, strict=True)) for c in islice(corners, 64)]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantHypothesis:
    """One model of the plant, with what is known about its numbers.

    Parameters
    ----------
    build
        Gives the loop without its controller for parameter values by name.
    uncertainty
        Several may be given; later ones override earlier ones.
    weight
        How likely it is against the others of the family.
    """

    name: str
    build: Callable[[Values], Loop]
    uncertainty: tuple[AbstractUncertainty, ...]
    weight: float = 1.0

    def member(self, values: Values) -> "Member":
        """Return the plant at these values."""
        return Member(
            hypothesis=self.name, values=dict(values), loop=self.build(values)
        )

    def nominal(self) -> "Member":
        """Return the plant at the most likely values."""
        return self.member(_joined(u.nominal() for u in self.uncertainty))

    def draw(self, generator: np.random.Generator) -> "Member":
        """Return a plant drawn at random."""
        return self.member(_joined(u.draw(generator) for u in self.uncertainty))

    def extremes(self) -> list["Member"]:
        """Return plants at the corners of each range, the rest nominal."""
        base = _joined(u.nominal() for u in self.uncertainty)
        corners = [corner for u in self.uncertainty for corner in u.extremes()]
        return [self.member({**base, **corner}) for corner in corners]


def _joined(parts: Iterable[Values]) -> dict[str, float]:
    return {name: value for part in parts for name, value in part.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """One plant of a family, in its loop without controller."""

    hypothesis: str
    values: Values
    loop: Loop

    def __str__(self) -> str:
        numbers = ", ".join(f"{n} = {v:.4g}" for n, v in self.values.items())
        return f"{self.hypothesis} at {numbers}" if numbers else self.hypothesis


@dataclass(frozen=True, slots=True)
class PlantFamily:
    """All plants that what is known allows; the first hypothesis is the nominal one."""

    hypotheses: tuple[PlantHypothesis, ...]

    def __post_init__(self) -> None:
        if not self.hypotheses or any(not h.weight > 0 for h in self.hypotheses):
            raise LoopShapingError(
                "A plant family needs hypotheses, each with a positive weight.",
                tuple(h.name for h in self.hypotheses),
                "Leave out what is not believed.",
            )

    def corners(self) -> list[Member]:
        """Return the nominal plant of every hypothesis, then all extremes."""
        nominal = [h.nominal() for h in self.hypotheses]
        return nominal + [m for h in self.hypotheses for m in h.extremes()]

    def draw(self, count: int, seed: int | Sequence[int]) -> list[Member]:
        """Return plants drawn at random, hypotheses by their weights."""
        generator = np.random.default_rng(seed)
        weights = np.array([h.weight for h in self.hypotheses])
        chosen = generator.choice(len(weights), size=count, p=weights / weights.sum())
        return [self.hypotheses[k].draw(generator) for k in chosen]
