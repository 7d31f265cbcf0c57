"""Laws for many elements at once: equal up to names is one vectorised function.

The laws of a thousand cubic springs differ only in the names of their parameters and
in what they read. They form one group: the expression is differentiated and turned
into numpy code once, and evaluated with arrays that have one entry per element.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from operator import itemgetter
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from bondgraph.structure import signals

Array = NDArray[np.float64]
Index = NDArray[np.int64]

HAIR = 1e-10
"""How far beside a point a kink is looked for, against one plus its size."""


@dataclass(frozen=True, slots=True)
class Read:
    """A signed column: the value of a symbol is ``sign * z[column]``."""

    column: int
    sign: int


@dataclass(frozen=True, slots=True)
class LawRow:
    """``… = expression`` in one row; `reads` are its symbols that are columns."""

    row: int
    expression: sympy.Expr
    reads: Mapping[sympy.Symbol, Read]


@dataclass(frozen=True, slots=True, eq=False)
class LawGroup:
    """Rows whose expressions are equal up to names.

    Parameters
    ----------
    rows
        One per member.
    columns, signs
        What each member reads, ``[read, member]``.
    constants
        Values of parameters and literal numbers, ``[constant, member]``.
    linear
        Whether no partial depends on what is read or on time.
    value
        Takes reads, constants and t; gives the values.
    slopes
        Takes the same; gives a partial per read and the partial to t.
    """

    expression: sympy.Expr
    rows: Index
    columns: Index
    signs: Array
    constants: Array
    linear: bool
    value: Callable[..., Any]
    slopes: Callable[..., Sequence[Any]]

    def values(self, z: Array, t: float) -> Array:
        """Return the values ``[member]``."""
        reads = self.signs * z[self.columns]
        with np.errstate(all="ignore"):  # outside of its domain a law is nan
            found: Array = self.value(*reads, *self.constants, t)
        return found

    def partials(self, z: Array, t: float) -> tuple[Array, Array]:
        """Return the partials ``[read, member]`` and those to t."""
        reads = self.signs * z[self.columns]
        with np.errstate(all="ignore"):  # a kink or a pole shows as inf or nan
            results = self.slopes(*reads, *self.constants, t)
        found = np.empty((len(results), len(self.rows)))
        for k, result in enumerate(results):
            found[k] = result
        return self.signs * found[:-1], found[-1]

    def _all(self, z: Array, t: float) -> Array:
        values = np.broadcast_to(self.values(z, t), self.rows.shape)
        return np.vstack([values[None], self.partials(z, t)[0]])

    def at_kink(self, z: Array, t: float) -> NDArray[np.bool_]:
        """Return which members stand where their law jumps or changes its slope.

        Values and slopes are compared with those a hair beside the point: where the law
        is smooth they differ a hundred times more at a hundred hairs, at a jump or kink
        they differ as much at one.
        """
        kinked = np.zeros(len(self.rows), bool)
        if self.linear:
            return kinked
        step = np.zeros_like(z)
        used = np.unique(self.columns)
        directions = 1.0 + 0.3 * np.sin(1.0 + np.arange(len(used)))
        step[used] = HAIR * (1.0 + np.abs(z[used])) * directions
        here = self._all(z, t)
        for side in (-1.0, 1.0):
            near, far = (
                self._all(z + side * hairs * step, t) for hairs in (1.0, 100.0)
            )
            apart = np.abs(near - here)
            visible = apart > 1e-9 * np.maximum(np.abs(near), np.abs(here))
            kinked |= (visible & (apart > 0.5 * np.abs(far - here))).any(axis=0)
        return kinked


@dataclass(slots=True)
class _Members:
    """A group while it is being collected."""

    expression: sympy.Expr
    arguments: list[sympy.Symbol]
    n_reads: int
    rows: list[int] = field(default_factory=list)
    columns: list[list[int]] = field(default_factory=list)
    signs: list[list[int]] = field(default_factory=list)
    constants: list[list[float]] = field(default_factory=list)

    def frozen(self) -> LawGroup:
        size = len(self.rows)

        def by_argument(table: list[list[Any]], kind: type) -> NDArray[Any]:
            return np.array(table, kind).reshape(size, -1).T.copy()

        reads = self.arguments[: self.n_reads]
        arguments = [*self.arguments, signals.t]
        slopes = [self.expression.diff(x) for x in (*reads, signals.t)]
        partials = [_flat(slope) for slope in slopes]
        varying = {*reads, signals.t}
        return LawGroup(
            self.expression,
            np.array(self.rows, np.int64),
            by_argument(self.columns, np.int64),
            by_argument(self.signs, float),
            by_argument(self.constants, float),
            all(varying.isdisjoint(x.free_symbols) for x in slopes[:-1]),
            _compiled(arguments, self.expression),
            _compiled(arguments, partials),
        )


def _compiled(
    arguments: list[sympy.Symbol], results: sympy.Expr | list[sympy.Expr]
) -> Callable[..., Any]:
    found: Callable[..., Any] = sympy.lambdify(arguments, results, "numpy", cse=True)
    return found


def grouped(
    laws: Iterable[LawRow], parameters: Mapping[str, float]
) -> tuple[LawGroup, ...]:
    """Return the laws in groups that are evaluated together."""
    groups: dict[tuple[str, tuple[int, ...]], _Members] = {}
    for law in laws:
        shape, found = _shape(law.expression, law.reads)
        leaves = tuple(dict.fromkeys(found))
        key = shape, tuple(leaves.index(x) for x in found)
        reads = [x for x in leaves if x in law.reads]
        others = [x for x in leaves if x not in law.reads]
        group = groups.get(key)
        if group is None:
            group = groups[key] = _new_group(law.expression, reads, others)
        group.rows.append(law.row)
        group.columns.append([law.reads[x].column for x in reads])
        group.signs.append([law.reads[x].sign for x in reads])
        group.constants.append(
            [parameters[x.name] if x.is_Symbol else float(x) for x in others]
        )
    return tuple(group.frozen() for group in groups.values())


def _new_group(
    expression: sympy.Expr, reads: list[sympy.Expr], others: list[sympy.Expr]
) -> _Members:
    """Return an empty group; literal numbers get a symbol of their own."""
    twins = {x: sympy.Dummy(real=True) for x in others if not x.is_Symbol}
    arguments = [*reads, *(twins.get(x, x) for x in others)]
    return _Members(expression.xreplace(twins), arguments, len(reads))


def _shape(
    expression: sympy.Basic, reads: Mapping[sympy.Symbol, Read]
) -> tuple[str, list[sympy.Expr]]:
    """Return what is left of an expression without names, and what was in its place.

    Terms and factors are ordered by their shapes, because sympy orders them by names.
    """
    if expression == signals.t:
        return "t", []
    if expression.is_Symbol or expression.is_Float:
        return "read" if expression in reads else "constant", [expression]
    if not expression.args:
        return str(expression), []
    parts = [_shape(x, reads) for x in expression.args]
    if expression.is_Add or expression.is_Mul:
        parts.sort(key=itemgetter(0))
    shape = ",".join(part for part, _ in parts)
    leaves = [leaf for _, found in parts for leaf in found]
    return f"{expression.func.__name__}({shape})", leaves


def _flat(slope: sympy.Expr) -> sympy.Expr:
    """Return a derivative in which the jump of a sign has none and counts as flat."""
    flat: sympy.Expr = slope.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero)
    return flat
