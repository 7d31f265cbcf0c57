"""What a reconciliation answers: explanations by size, or why there is none."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

from bondgraph.structure.parameters import ParameterSet, Reconciled


class ReconciliationStatus(StrEnum):
    """What was found; the value is the sentence to show."""

    AGREES = "Every result follows from the parameters within their rounding."
    EXPLAINED = "One smallest set of changes explains every result."
    SEVERAL = "Several smallest sets of changes explain the results equally well."
    CONTRADICTORY = "Some results contradict each other whatever the parameters."
    TOO_MANY = "More parameters than were allowed would have to change."
    UNDECIDED = "The search ended before it could say."


@dataclass(frozen=True, slots=True, kw_only=True)
class ResultAtParameters:
    """One published result beside what its formula gives at some parameters.

    ``derived`` is None where a parameter has no value.
    """

    name: str
    published: float
    rounding: float
    derived: float | None

    @property
    def within_rounding(self) -> bool:
        """Whether the derived value would be printed as the published one."""
        if self.derived is None:
            return False
        slack = 1e-5 * self.rounding + 2e-9 * abs(self.published)
        return abs(self.derived - self.published) <= self.rounding + slack

    @property
    def relative_difference(self) -> float | None:
        """(derived - published) / published; None where either is missing or zero."""
        if self.derived is None or self.published == 0:
            return None
        return (self.derived - self.published) / self.published


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A printed number that must be another for the results to agree.

    ``value`` is that of the smallest total change; any value between `low` and `high`
    can be made to work by the other changes of the same explanation (NaN if not known).
    """

    name: str
    printed: float
    value: float
    low: float
    high: float

    @property
    def factor(self) -> float:
        """New value over printed value."""
        return self.value / self.printed

    def to_dict(self) -> dict[str, Any]:
        """Return the change as plain values for JSON."""
        return {
            "name": self.name,
            "printed": self.printed,
            "value": self.value,
            "range": None if math.isnan(self.low) else [self.low, self.high],
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class Explanation:
    """A set of changes from which every result follows.

    Parameters
    ----------
    size
        Sum of the changes |ln(new / printed)|.
    proven
        Whether no values of the same parameters need a smaller size.
    values
        All parameters of the formulas: those not changed lie inside their rounding.
    """

    changes: tuple[Change, ...]
    size: float
    proven: bool
    values: Mapping[str, float]
    results: tuple[ResultAtParameters, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """What is changed."""
        return tuple(change.name for change in self.changes)

    def applied_to(self, parameters: ParameterSet) -> ParameterSet:
        """Return `parameters` with these values; changed ones say so as source."""
        found = parameters.with_values(
            {name: v for name, v in self.values.items() if name in parameters}
        )
        reason = "so that the published results come out"
        names = set(self.names) | {
            name for name in self.values if parameters[name].value is None
        }
        return found.merged(
            replace(found[name], source=Reconciled(reason), rounding=None, std=None)
            for name in sorted(names & set(found))
        )

    def __str__(self) -> str:
        if not self.changes:
            return "nothing changes"
        return ", ".join(
            f"{c.name} {c.printed:.6g} → {c.value:.6g} ({100 * (c.factor - 1):+.3g} %)"
            for c in self.changes
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Reconciliation:
    """The answer of `reconcile`.

    Parameters
    ----------
    as_printed
        The results at the parameters as printed.
    explanations
        Every set of the least number of changes that works, smallest size first.
    equally_good
        The first of them, as many as cannot be told apart by size.
    contradictions
        Smallest groups of results that no parameter values give together.
    undecided
        Sets of which the search could not tell whether they work.
    """

    status: ReconciliationStatus
    as_printed: tuple[ResultAtParameters, ...]
    explanations: tuple[Explanation, ...] = ()
    equally_good: tuple[Explanation, ...] = ()
    contradictions: tuple[tuple[str, ...], ...] = ()
    undecided: tuple[tuple[str, ...], ...] = field(default=())

    @property
    def best(self) -> Explanation | None:
        """The explanation of the smallest size, if there is one."""
        return self.explanations[0] if self.explanations else None

    def to_dict(self) -> dict[str, Any]:
        """Return the answer as plain values for JSON."""
        return {
            "schema": 1,
            "status": self.status.name.lower(),
            "statement": self.status.value,
            "as_printed": [_plain(r) for r in self.as_printed],
            "explanations": [
                {
                    "changes": [change.to_dict() for change in e.changes],
                    "size": e.size,
                    "smallest_is_proven": e.proven,
                    "equally_good": e in self.equally_good,
                    "values": dict(e.values),
                    "results": [_plain(r) for r in e.results],
                }
                for e in self.explanations
            ],
            "contradictions": [list(group) for group in self.contradictions],
            "undecided": [list(group) for group in self.undecided],
        }

    def __str__(self) -> str:
        lines = [self.status.value]
        for result in self.as_printed:
            derived = "?" if result.derived is None else f"{result.derived:.6g}"
            verdict = "as printed" if result.within_rounding else "not as printed"
            lines.append(
                f"  {result.name}: printed {result.published:g}, derived {derived}, "
                f"{verdict}"
            )
        for explanation in self.explanations:
            mark = "=" if explanation in self.equally_good else "-"
            lines.append(f"  {mark} {explanation} [size {explanation.size:.3g}]")
        lines += [f"  no values give {' and '.join(g)}" for g in self.contradictions]
        lines += [
            f"  not decided: {', '.join(g) or 'no change'}" for g in self.undecided
        ]
        return "\n".join(lines)


def _plain(result: ResultAtParameters) -> dict[str, Any]:
    return {
        "name": result.name,
        "published": result.published,
        "rounding": result.rounding,
        "derived": result.derived,
        "within_rounding": result.within_rounding,
    }
