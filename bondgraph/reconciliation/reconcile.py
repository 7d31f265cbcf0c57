"""The smallest sets of changed numbers from which all published results follow.

Sets are tried by growing number of members, so that the first that work are smallest,
and every set of that number is tried, so that none that works goes unmentioned. For
each set a branch and bound finds the least total change or proves that there is none.
All other numbers stay within their rounding, wherever in it they are most useful.
"""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import sympy

from bondgraph.errors import ParameterError, did_you_mean
from bondgraph.reconciliation.problem import FloatArray, Problem, build
from bondgraph.reconciliation.published import PublishedResult
from bondgraph.reconciliation.records import (
    Change,
    Explanation,
    Reconciliation,
    ReconciliationStatus,
    ResultAtParameters,
)
from bondgraph.reconciliation.relaxation import Cost
from bondgraph.reconciliation.search import Answer, Found, cheapest
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import as_expression

_TIE_BREAK = 1e-3
"""Weight of a move inside a rounding interval: between two equals, the printed one."""


def reconcile(
    results: Sequence[PublishedResult],
    parameters: Mapping[str, Parameter],
    *,
    suspects: Iterable[str] | None = None,
    most: int = 3,
    largest_factor: float = 1e3,
    tie: float = 0.1,
) -> Reconciliation:
    """Return the smallest sets of changes that explain all results, within rounding.

    Parameters
    ----------
    results
        Published values, each with a formula in the parameters.
    parameters
        Printed values with ``rounding``. One without a value is inferred, which counts
        as no change.
    suspects
        What may be a misprint: names of parameters, and of results if these may be
        wrong themselves. Every parameter that is not exact, if None.
    most
        Largest number of changes that is tried.
    largest_factor
        By how much a changed number may be off, up or down. Its sign is kept.
    tie
        Explanations count as equally good if their sizes differ by less than this
        fraction of the smaller one.

    Raises
    ------
    ParameterError
        If a formula has an unknown symbol, or a suspect is not in any formula.
    EquationError
        If a formula has a function of which no bounds are known.
    """
    names = _suspects(results, parameters, suspects)
    problem = build(results, parameters, suspects=names, largest_factor=largest_factor)
    chosen = [problem.names.index(name) for name in names]
    printed = {n: p.value for n, p in parameters.items() if p.value is not None}
    as_printed = _at(results, printed)
    undecided: list[tuple[str, ...]] = []
    for count in range(min(most, len(chosen)) + 1):
        found = []
        for group in itertools.combinations(chosen, count):
            answer = _explained(problem, frozenset(group))
            if answer.found is Found.UNDECIDED:
                undecided.append(tuple(problem.names[k] for k in group))
            elif answer.found is Found.SOLUTION:
                found.append((answer, group))
        if found:
            return _explanations(problem, results, (found, undecided, as_printed), tie)
    contradictions = _contradictions(results, parameters, names, largest_factor)
    status = ReconciliationStatus.TOO_MANY
    if contradictions:
        status = ReconciliationStatus.CONTRADICTORY
    elif undecided:
        status = ReconciliationStatus.UNDECIDED
    return Reconciliation(
        status=status,
        as_printed=as_printed,
        contradictions=contradictions,
        undecided=tuple(undecided),
    )


def _suspects(
    results: Sequence[PublishedResult],
    parameters: Mapping[str, Parameter],
    suspects: Iterable[str] | None,
) -> tuple[str, ...]:
    """Return what may change, in the order of the parameters.

    A number that is zero within its rounding is none: no factor changes it.
    """
    used = {str(s) for r in results for s in as_expression(r.formula).free_symbols}
    if suspects is None:
        return tuple(
            name
            for name, parameter in parameters.items()
            if name in used and not parameter.exact and _has_size(parameter)
        )
    known = used | {result.name for result in results}
    chosen = tuple(dict.fromkeys(suspects))
    for name in chosen:
        if name not in known:
            raise ParameterError(
                f"The suspect {name!r} is in no formula.",
                (name,),
                did_you_mean(name, known),
            )
        if name in parameters and parameters[name].value == 0:
            raise ParameterError(
                f"The suspect {name!r} is zero: no factor changes it.",
                (name,),
                "Leave it out, or write the formula with a value that is not zero.",
            )
    # What was never printed is inferred anyway.
    return tuple(
        n for n in chosen if n not in parameters or parameters[n].value is not None
    )


def _has_size(parameter: Parameter) -> bool:
    value = parameter.value
    return value is not None and abs(value) > (parameter.rounding or 0.0)


def _explained(problem: Problem, free: frozenset[int]) -> Answer:
    """Return the least change of the quantities in `free` that explains all."""
    size = len(problem.quantities)
    origin = np.array([q.printed or 0.0 for q in problem.quantities])
    weights = np.zeros(size)
    for k, quantity in enumerate(problem.quantities):
        if k in free:
            weights[k] = 1.0
        elif quantity.printed is not None and k < size - problem.results:
            width = quantity.inside[1] - quantity.inside[0]
            weights[k] = _TIE_BREAK if width > 0 else 0.0
    return cheapest(problem, *problem.box(free), Cost(origin, weights, np.zeros(size)))


def _explanations(
    problem: Problem,
    results: Sequence[PublishedResult],
    search: tuple[
        list[tuple[Answer, tuple[int, ...]]],
        list[tuple[str, ...]],
        tuple[ResultAtParameters, ...],
    ],
    tie: float,
) -> Reconciliation:
    found, undecided, as_printed = search
    sized = sorted(
        ((_size(problem, answer, group), answer, group) for answer, group in found),
        key=lambda entry: entry[0],
    )
    limit = sized[0][0] * (1 + tie) + 1e-9
    explanations = tuple(
        _explanation(problem, results, (answer, group, size), ranges=size <= limit)
        for size, answer, group in sized
    )
    equal = tuple(e for e in explanations if e.size <= limit)
    status = ReconciliationStatus.EXPLAINED
    if not explanations[0].changes:
        status = ReconciliationStatus.AGREES
    elif len(equal) > 1:
        status = ReconciliationStatus.SEVERAL
    return Reconciliation(
        status=status,
        as_printed=as_printed,
        explanations=explanations,
        equally_good=equal,
        # Smaller sets that stayed undecided matter; larger ones were never tried.
        undecided=tuple(undecided),
    )


def _size(problem: Problem, answer: Answer, group: tuple[int, ...]) -> float:
    assert answer.point is not None
    return sum(
        abs(float(answer.point[k]) - (problem.quantities[k].printed or 0.0))
        for k in group
    )


def _explanation(
    problem: Problem,
    results: Sequence[PublishedResult],
    solved: tuple[Answer, tuple[int, ...], float],
    *,
    ranges: bool,
) -> Explanation:
    answer, group, size = solved
    assert answer.point is not None
    values = _values(problem, answer.point)
    changes = []
    for k in group:
        low, high = (
            _range_of(problem, frozenset(group), k) if ranges else (math.nan,) * 2
        )
        quantity = problem.quantities[k]
        changes.append(
            Change(
                name=quantity.name,
                printed=quantity.value(quantity.printed or 0.0),
                value=quantity.value(float(answer.point[k])),
                low=low,
                high=high,
            )
        )
    return Explanation(
        changes=tuple(changes),
        size=size,
        proven=answer.proven,
        values=values,
        results=_at(results, values),
    )


def _range_of(
    problem: Problem, free: frozenset[int], place: int
) -> tuple[float, float]:
    """Return the least and greatest value of one changed quantity."""
    size = len(problem.quantities)
    ends = []
    for sign in (1.0, -1.0):
        linear = np.zeros(size)
        linear[place] = sign
        cost = Cost(np.zeros(size), np.zeros(size), linear)
        answer = cheapest(problem, *problem.box(free), cost)
        if answer.point is None:
            return math.nan, math.nan
        ends.append(problem.quantities[place].value(float(answer.point[place])))
    return min(ends), max(ends)


def _contradictions(
    results: Sequence[PublishedResult],
    parameters: Mapping[str, Parameter],
    suspects: tuple[str, ...],
    largest_factor: float,
) -> tuple[tuple[str, ...], ...]:
    """Return the smallest groups of results that no parameter values give.

    Printed results are not suspects here: a group of misprints contradicts nothing.
    """
    for count in range(1, len(results) + 1):
        found = tuple(
            tuple(result.name for result in group)
            for group in itertools.combinations(results, count)
            if _impossible(
                build(
                    group,
                    parameters,
                    suspects=suspects,
                    largest_factor=largest_factor,
                ),
                suspects,
            )
        )
        if found:
            return found
    return ()


def _impossible(problem: Problem, suspects: tuple[str, ...]) -> bool:
    """Return whether no values of the suspects give the results of `problem`."""
    size = len(problem.quantities)
    free = frozenset(
        k
        for k, name in enumerate(problem.names[: size - problem.results])
        if name in suspects
    )
    nothing = Cost(np.zeros(size), np.zeros(size), np.zeros(size))
    return cheapest(problem, *problem.box(free), nothing).found is Found.NONE


def _values(problem: Problem, point: FloatArray) -> dict[str, float]:
    first = len(problem.quantities) - problem.results
    return {
        quantity.name: quantity.value(float(x))
        for quantity, x in zip(problem.quantities[:first], point, strict=False)
    }


def _at(
    results: Sequence[PublishedResult], values: Mapping[str, float]
) -> tuple[ResultAtParameters, ...]:
    """Return the results that the formulas give at `values`."""
    return tuple(
        ResultAtParameters(
            name=result.name,
            published=result.value,
            rounding=result.rounding,
            derived=_number(result.formula, values),
        )
        for result in results
    )


def _number(formula: sympy.Expr, values: Mapping[str, float]) -> float | None:
    """Return the value of `formula`, None where a parameter has none."""
    symbols = as_expression(formula).free_symbols
    if any(str(symbol) not in values for symbol in symbols):
        return None
    put = {symbol: sympy.Float(values[str(symbol)], 17) for symbol in symbols}
    number = complex(as_expression(formula).xreplace(put).evalf(17))
    return number.real if number.imag == 0 else None
