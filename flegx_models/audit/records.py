"""One row per printed result, with its verdict, and how formulas become rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import sympy

from bondgraph import (
    Parameter,
    ParameterSet,
    PublishedResult,
    Reconciliation,
    ReconciliationStatus,
    reconcile,
)


class Verdict(StrEnum):
    """How a printed result fares; the value is the word of the table."""

    REPRODUCED = "reproduced"
    CORRECTED = "reproduced with a named correction"
    NOT_REPRODUCIBLE = "not reproducible"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """A printed result beside what the thesis's own numbers give.

    Parameters
    ----------
    where
        Equation, table or section.
    printed, unit
        As printed, in `unit`.
    derived
        By the thesis's formula from its numbers; None where a number is missing.
    corrected
        With the correction that `cause` names; None without one.
    """

    chapter: int
    where: str
    quantity: str
    printed: float
    unit: str
    derived: float | None
    verdict: Verdict
    corrected: float | None = None
    cause: str = ""

    @property
    def relative_difference(self) -> float | None:
        """(derived - printed) / printed."""
        if self.derived is None:
            return None
        return (self.derived - self.printed) / self.printed


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """A group of results put to the reconciliation, with its answer."""

    title: str
    comment: str
    answer: Reconciliation


@dataclass(frozen=True, slots=True, kw_only=True)
class Remark:
    """What was computed around a result, in words with its numbers."""

    where: str
    statement: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Audit:
    """All rows, the reconciliations, and remarks, in the order of the thesis."""

    rows: tuple[Row, ...]
    questions: tuple[Question, ...]
    remarks: tuple[Remark, ...]

    def count(self, verdict: Verdict) -> int:
        """Return how many rows have that verdict."""
        return sum(row.verdict is verdict for row in self.rows)

    def find(self, where: str, quantity: str) -> Row:
        """Return the row of one printed result."""
        return next(
            row for row in self.rows if (row.where, row.quantity) == (where, quantity)
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the audit as plain values for JSON."""
        return {
            "schema": 1,
            "counts": {str(v): self.count(v) for v in Verdict},
            "rows": [
                {
                    "chapter": row.chapter,
                    "where": row.where,
                    "quantity": row.quantity,
                    "printed": row.printed,
                    "unit": row.unit,
                    "derived": row.derived,
                    "relative_difference": row.relative_difference,
                    "verdict": str(row.verdict),
                    "corrected": row.corrected,
                    "cause": row.cause,
                }
                for row in self.rows
            ],
            "reconciliations": [
                {"title": q.title, "comment": q.comment, **q.answer.to_dict()}
                for q in self.questions
            ],
            "remarks": [
                {"where": r.where, "statement": r.statement} for r in self.remarks
            ],
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class Correction:
    """Another formula or other data, and what that corrects."""

    cause: str
    formula: sympy.Expr | None = None
    data: ParameterSet | None = None


def row_of(
    printed: Parameter,
    formula: sympy.Expr,
    data: ParameterSet,
    *,
    place: tuple[int, str],
    quantity: str,
    unit: tuple[str, float] | None = None,
    correction: Correction | None = None,
    cause: str = "",
) -> Row:
    """Return the row of a result with a formula.

    Parameters
    ----------
    printed
        The result, with its rounding.
    unit
        Unit to show and its size in SI units; that of `printed` if None.
    correction
        Tried where the formula and data as printed do not reproduce the result.
    cause
        Why it cannot be reproduced, where no correction is known.
    """
    name, size = unit or (printed.unit, 1.0)
    derived, agrees = _tried(printed, formula, data)
    verdict, corrected = Verdict.REPRODUCED, None
    if not agrees:
        verdict = Verdict.NOT_REPRODUCIBLE
        if correction is not None:
            corrected, right = _tried(
                printed,
                formula if correction.formula is None else correction.formula,
                data if correction.data is None else correction.data,
            )
            verdict = Verdict.CORRECTED if right else verdict
            cause = correction.cause
    return Row(
        chapter=place[0],
        where=place[1],
        quantity=quantity,
        printed=_value(printed) / size,
        unit=name,
        derived=None if derived is None else derived / size,
        corrected=None if corrected is None else corrected / size,
        verdict=verdict,
        cause="" if verdict is Verdict.REPRODUCED else cause,
    )


def _tried(
    printed: Parameter, formula: sympy.Expr, data: ParameterSet
) -> tuple[float | None, bool]:
    """Return the value, and whether rounding leaves room for the printed one."""
    answer = reconcile([published(printed, formula)], data, most=0)
    (found,) = answer.as_printed
    agrees = answer.status is ReconciliationStatus.AGREES
    if found.derived is None:  # a number is missing: nothing is reproduced
        return None, False
    return found.derived, agrees


def published(
    printed: Parameter, formula: sympy.Expr, name: str = ""
) -> PublishedResult:
    """Return a printed parameter as a published result."""
    return PublishedResult(
        name=name or f"printed {printed.name}",
        value=_value(printed),
        rounding=printed.rounding or 0.0,
        formula=formula,
    )


def named(data: Mapping[str, Parameter], names: Sequence[str]) -> ParameterSet:
    """Return some of the parameters, by their names."""
    return ParameterSet(tuple(data[name] for name in names))


def _value(parameter: Parameter) -> float:
    assert parameter.value is not None
    return parameter.value
