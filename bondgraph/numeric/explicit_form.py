"""A model solved for its rates, where unknowns and rates enter as a linear system.

Dependent storages and most algebraic loops leave a handful of unknowns z in which the
equations are affine. Every operation of the tape is then one on affine forms
c + Σ aₖ zₖ, and elimination is a few operations more: what is left are the rates as a
function of x, u, p and t, which an explicit method steps. The order of elimination is
fixed beforehand; a pivot that vanishes at some point makes the numbers there infinite,
and a run says so.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from bondgraph.numeric.model import NumericModel
from bondgraph.numeric.tape import Op, Recorder, Tape, arguments, degrees, part

MOST_UNKNOWNS = 8
"""More would write longer code than the implicit method runs."""

Form = tuple[int | None, dict[int, int]]
"""The slots of c (None for zero) and of aₖ, by k."""

_ADD, _SUB, _MUL, _DIV = Op.ADD.value, Op.SUB.value, Op.MUL.value, Op.DIV.value
_POWI, _SELECT = Op.POWI.value, Op.SELECT.value


class _NotAffineError(Exception):
    """An unknown or a rate enters otherwise than in proportion."""


@dataclass(frozen=True, slots=True)
class _Key:
    """What tells models apart here, hashable."""

    model: NumericModel
    told: tuple[bytes, ...]

    def __hash__(self) -> int:
        return hash(self.told)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and self.told == other.told


@lru_cache(maxsize=256)
def explicit_form(model: NumericModel) -> NumericModel | None:
    """Return the model without unknowns, its rates a function of x, u, p and t alone.

    None where an unknown or a rate enters nonlinearly, or there are more than
    `MOST_UNKNOWNS`. A model that is explicit already is returned as it is.
    """
    parts = [
        array.tobytes()
        for tape in (model.dynamics, model.output)
        for array in (tape.constants, tape.code, tape.outputs)
    ]
    names = (model.state_names, model.input_names, model.parameter_names)
    told = (*parts, repr((names, model.output_names, model.unknown_names)).encode())
    key = _Key(model, told)
    return model if _is_explicit(key) else _solved(key)


@lru_cache(maxsize=256)
def _is_explicit(key: _Key) -> bool:
    model = key.model
    nx = model.n_states
    active = [False] * model.dynamics.n_variables
    active[nx : 2 * nx] = [True] * nx
    return model.n_unknowns == 0 and not degrees(model.dynamics, active).any()


@lru_cache(maxsize=256)
def _solved(key: _Key) -> NumericModel | None:
    model = key.model
    if model.n_unknowns > MOST_UNKNOWNS:
        return None
    try:
        return _Elimination(model).solved()
    except _NotAffineError:
        return None


class _Elimination:
    """The work on one model: x, ẋ, u, u̇, p and t are the variables of the new tape."""

    def __init__(self, model: NumericModel) -> None:
        self.model = model
        self.nx, self.nz = model.n_states, model.n_unknowns
        self.recorder = Recorder({})
        self.n_variables = model.dynamics.n_variables - self.nz

    def solved(self) -> NumericModel:
        nx, nz = self.nx, self.nz
        unknown: list[Form] = [(None, {k: self._constant(1.0)}) for k in range(nz)]
        first = self._results(self.model.dynamics, [None] * nx, unknown, nx)
        rates = [form for form in first if form is not None]
        if len(rates) < nx:
            raise _NotAffineError
        both = self._results(self.model.dynamics, rates, unknown, nx + nz)
        left = [form for form in both[nx:] if form is not None]
        values = self._eliminated(left)
        known: list[Form] = [(value, {}) for value in values]
        slots = [self._at(form, values) for form in rates]
        given: list[Form] = [(slot, {}) for slot in slots]
        read = self._results(self.model.output, given, known, None)
        whole = self.recorder.tape(
            self.n_variables,
            [*slots, *(self._at(form, values) for form in read if form is not None)],
        )
        return self._model(whole)

    def _model(self, whole: Tape) -> NumericModel:
        nx, count = self.nx, len(whole.outputs)
        later = self.n_variables - 2 * nx
        moving = [True] * (2 * nx) + [False] * later
        instant = [False] * nx + [True] * nx + [False] * later
        dynamics = part(whole, 0, nx, moving)
        return replace(
            self.model,
            dynamics=dynamics,
            output=part(whole, nx, count, instant),
            n_unknowns=0,
            unknown_names=(),
            linear=bool((dynamics.degree < 2).all()),
            instantaneous=False,
        )

    def _constant(self, value: float) -> int:
        return self.recorder.constant(value)

    def _results(
        self,
        tape: Tape,
        rates: Sequence[Form | None],
        unknowns: Sequence[Form],
        count: int | None,
    ) -> list[Form | None]:
        """Return the forms of a tape's first results; None where a rate is unknown."""
        nx, nz = self.nx, self.nz
        forms: list[Form | None] = [(i, {}) for i in range(nx)]
        forms += [*rates, *unknowns]
        forms += [(i, {}) for i in range(2 * nx, tape.n_variables - nz)]
        forms += [(self._constant(value), {}) for value in tape.constants.tolist()]
        for op, a, b, c in tape.code.tolist():
            forms.append(self._form(op, forms, a, b, c))
        return [forms[slot] for slot in tape.outputs.tolist()[:count]]

    def _form(
        self, op: int, forms: list[Form | None], a: int, b: int, c: int
    ) -> Form | None:
        slots = (a,) if op == _POWI else arguments((op, a, b, c))
        read = [form for form in (forms[slot] for slot in slots) if form is not None]
        if len(read) < len(slots):
            return None
        if not any(form[1] for form in read):
            plain = [self._value(form[0]) for form in read]
            return self.recorder.emit(
                Op(op), *plain, *((b,) if op == _POWI else ())
            ), {}
        if op in (_ADD, _SUB):
            return self._sum(op, *read)
        first, *rest = read
        if op == _MUL and not (first[1] and rest[0][1]):
            scaled, factor = (first, rest[0]) if first[1] else (rest[0], first)
            return self._scaled(_MUL, scaled, factor[0])
        if op == _DIV and not rest[0][1]:
            return self._scaled(_DIV, first, rest[0][0])
        if op == _SELECT and not first[1]:
            return self._chosen(first, *rest)
        raise _NotAffineError

    def _value(self, slot: int | None) -> int:
        return self._constant(0.0) if slot is None else slot

    def _sum(self, op: int, one: Form, other: Form) -> Form:
        slopes = {
            k: self._added(op, one[1].get(k), other[1].get(k))
            for k in sorted(one[1].keys() | other[1].keys())
        }
        if one[0] is None and other[0] is None:
            return None, slopes
        return self._added(op, one[0], other[0]), slopes

    def _added(self, op: int, one: int | None, other: int | None) -> int:
        if other is None:
            return self._value(one)
        if one is None and op == _ADD:
            return other
        return self.recorder.emit(Op(op), self._value(one), other)

    def _scaled(self, op: int, form: Form, factor: int | None) -> Form:
        by = self._value(factor)

        one = self._constant(1.0)

        def scaled(slot: int) -> int:
            if by == one:
                return slot
            if op == _MUL and slot == one:
                return by
            return self.recorder.emit(Op(op), slot, by)

        constant = None if form[0] is None else scaled(form[0])
        return constant, {k: scaled(slot) for k, slot in form[1].items()}

    def _chosen(self, condition: Form, one: Form, other: Form) -> Form:
        held = self._value(condition[0])

        def chosen(a: int | None, b: int | None) -> int:
            return self.recorder.emit(Op.SELECT, held, self._value(a), self._value(b))

        slopes = {
            k: chosen(one[1].get(k), other[1].get(k))
            for k in sorted(one[1].keys() | other[1].keys())
        }
        return chosen(one[0], other[0]), slopes

    def _eliminated(self, rows: list[Form]) -> list[int]:
        """Return the slots of the unknowns that make all `rows` vanish."""
        forms = dict(enumerate(rows))
        solved: list[tuple[int, Form]] = []
        for _ in rows:
            # The row with the fewest unknowns, by its own where it has it.
            i = min(forms, key=lambda row: (len(forms[row][1]) or len(rows) + 1, row))
            pivot = forms.pop(i)
            if not pivot[1]:
                raise _NotAffineError
            k = i if i in pivot[1] else min(pivot[1])
            own = pivot[1][k]
            rest = pivot[0], {j: slot for j, slot in pivot[1].items() if j != k}
            value = self._negative(self._scaled(_DIV, rest, own))
            solved.append((k, value))
            for j, form in forms.items():
                forms[j] = self._put(form, k, value)
        values = [0] * len(rows)
        known: dict[int, int] = {}
        for k, form in reversed(solved):
            total = form[0]
            for j, slope in form[1].items():
                product = self.recorder.emit(Op.MUL, slope, known[j])
                total = self._added(_ADD, total, product)
            known[k] = values[k] = self._value(total)
        return values

    def _put(self, form: Form, k: int, value: Form) -> Form:
        """Return a form with unknown k replaced by its value in terms of others."""
        if k not in form[1]:
            return form
        rest = form[0], {j: slot for j, slot in form[1].items() if j != k}
        return self._sum(_ADD, rest, self._scaled(_MUL, value, form[1][k]))

    def _negative(self, form: Form) -> Form:
        return self._sum(_SUB, (None, {}), form)

    def _at(self, form: Form, values: list[int]) -> int:
        """Return the slot of a form with the unknowns' values."""
        total = form[0]
        for k, slope in form[1].items():
            one = slope == self._constant(1.0)
            product = values[k] if one else self.recorder.emit(Op.MUL, slope, values[k])
            total = self._added(_ADD, total, product)
        return self._value(total)
