"""The tangents of a Runge-Kutta step, several directions side by side.

The step itself is written once; its slopes are shared by all directions, which follow
in one loop of vector code.
"""

from collections.abc import Collection, Sequence
from functools import reduce

from bondgraph.numeric.native.code import Assembly, Function, Row
from bondgraph.numeric.native.step import (
    NODES,
    WEIGHTS,
    Sizes,
    Stages,
    step_body,
    store,
)
from bondgraph.numeric.tape import Tape

ABREAST = 4
"""Directions that are followed side by side: one AVX2 register."""


def step_tangents(tape: Tape, sizes: Sizes, along: Collection[int]) -> Function:
    """Return the code of a step with tangents, and what it calls.

    ``void step_tangents(double *v, double *d, double *own, int64 *where, int64 stride,
    int64 n)``: ``d[i * stride + m]`` is the tangent of state i along direction m;
    parameter k among `along` is the direction ``where[k]``, n where it is none, and
    those that are not among them count as zero. ``own`` is scratch, zero at first: in
    row ``stage * n_states + i`` the slopes of ẋᵢ along parameters. `ABREAST` directions
    are followed at a time, beyond n as well: the stride is more than n.
    """
    code = Assembly()
    first = sizes.first_parameter
    columns = [
        *range(sizes.states),
        *(first + k if k in along else -1 for k in range(sizes.parameters)),
    ]
    stages = step_body(code, tape, sizes, columns)
    for i, value in enumerate(stages.new):
        store(code, "%v", i, value)
    tangents = _Tangents(stages, sizes.states)
    lines = [
        "define void @step_tangents(ptr noalias %v, ptr noalias %d, ptr noalias %own, "
        "ptr noalias %where, i64 %stride, i64 %n) nounwind {",
        "start:",
        *code.lines,
        *tangents.before,
        "  %some = icmp sgt i64 %n, 0",
        "  br i1 %some, label %along, label %done",
        "along:",
        "  %m = phi i64 [0, %start], [%next, %along]",
        *tangents.each,
        f"  %next = add nuw nsw i64 %m, {ABREAST}",
        "  %more = icmp slt i64 %next, %n",
        "  br i1 %more, label %along, label %done",
        "done:",
        "  ret void",
        "}",
    ]
    return Function(lines, code.called)


class _Tangents:
    """The tangents of a step along the directions from ``%m`` on.

    ``before`` spreads what all directions share over the lanes, and puts each slope
    along a parameter where its direction is; ``each`` is done for each `ABREAST` of
    them.
    """

    def __init__(self, stages: Stages, states: int) -> None:
        self._code, self._states = Assembly(ABREAST, "%w"), states
        code = self._code
        rows = [
            [{c: code.spread(d) for c, d in row.items() if c < states} for row in stage]
            for stage in stages.rows
        ]
        half, h, sixth = map(code.spread, (stages.half, stages.h, stages.sixth))
        own = self._put([row for stage in stages.rows for row in stage])
        self.before = [*code.lines]
        code.lines.clear()
        self._write(rows, own, {0.5: half, 1.0: h}, sixth)
        self.each = code.lines

    def _put(self, rows: Sequence[Row]) -> set[int]:
        """Put slopes along parameters into ``own``; return the rows that have some."""
        lines, put = self._code.lines, set()
        for k in sorted({c for row in rows for c in row if c >= self._states}):
            at = k - self._states
            lines += [
                f"  %where{k}.p = getelementptr i64, ptr %where, i64 {at}",
                f"  %where{k} = load i64, ptr %where{k}.p, align 8",
            ]
        for i, row in enumerate(rows):
            for k, slope in row.items():
                if k >= self._states:
                    put.add(i)
                    lines += [
                        f"  %put{i}.{k}.r = mul i64 %stride, {i}",
                        f"  %put{i}.{k}.i = add i64 %put{i}.{k}.r, %where{k}",
                        f"  %put{i}.{k} = getelementptr double, ptr %own, "
                        f"i64 %put{i}.{k}.i",
                        f"  store double {slope}, ptr %put{i}.{k}, align 8",
                    ]
        return put

    def _write(
        self,
        stages: Sequence[Sequence[Row]],
        own: set[int],
        parts: dict[float, str],
        sixth: str,
    ) -> None:
        code, states = self._code, range(self._states)
        d = [self._element("%d", i) for i in states]
        dk: list[str] = []
        total: list[str] = []
        for s, (node, weight, rows) in enumerate(
            zip(NODES, WEIGHTS, stages, strict=True)
        ):
            here = d
            if node:
                step = parts[node]
                here = [
                    code.add(a, code.multiply(step, b))
                    for a, b in zip(d, dk, strict=True)
                ]
            at = s * self._states
            dk = [self._product(rows[i], here, at + i, own) for i in states]
            share = [code.multiply(code.constant(weight), a) for a in dk]
            total = share if not total else list(map(code.add, total, share))
        for i in states:
            new = code.add(d[i], code.multiply(sixth, total[i]))
            code.lines.append(f"  store {code.real} {new}, ptr %d{i}.p, align 8")

    def _product(self, row: Row, d: Sequence[str], at: int, own: set[int]) -> str:
        code = self._code
        terms = [code.multiply(slope, d[k]) for k, slope in row.items()]
        if at in own:
            terms.append(self._element("%own", at))
        return reduce(code.add, terms) if terms else code.zero

    def _element(self, base: str, row: int) -> str:
        name, real = f"{base}{row}", self._code.real
        self._code.lines += [
            f"  {name}.r = mul i64 %stride, {row}",
            f"  {name}.i = add i64 {name}.r, %m",
            f"  {name}.p = getelementptr double, ptr {base}, i64 {name}.i",
            f"  {name} = load {real}, ptr {name}.p, align 8",
        ]
        return name
