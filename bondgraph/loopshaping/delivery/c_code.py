"""The controller as C99: a header, a source, and a harness that runs it on a file.

The text is written from the rounded coefficients of a `DigitalController`, term by term
in the order in which our simulation adds them, so that both give the same bits
(compiled without fused multiply-add: ``-ffp-contract=off`` where the processor has it).
No allocation, no library, no global state.
"""

from dataclasses import dataclass
from typing import assert_never

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.delivery.anti_windup import (
    BackCalculation,
    Clamping,
    NoAntiWindup,
)
from bondgraph.loopshaping.delivery.arithmetic import (
    AbstractArithmetic,
    Double,
    FixedPoint,
    Single,
)
from bondgraph.loopshaping.delivery.digital import DigitalController, Sum

FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off")
"""What the text is compiled with in our tests."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CController:
    """C99 text: ``NAME.h``, ``NAME.c`` and a program ``NAME_main.c``.

    The program reads lines ``reference measurement feed-forward`` and writes a command
    per line, all as decimal numbers.
    """

    name: str
    header: str
    source: str
    harness: str

    def files(self) -> dict[str, str]:
        """Return the texts by file name."""
        return {
            f"{self.name}.h": self.header,
            f"{self.name}.c": self.source,
            f"{self.name}_main.c": self.harness,
        }


def controller_to_c99(controller: DigitalController) -> CController:
    """Return a controller as C99.

    Raises
    ------
    LoopShapingError
        If its arithmetic is of a kind that has no C text.
    """
    words = _words(controller.arithmetic)
    return CController(
        name=controller.name,
        header=_header(controller, words),
        source=_source(controller, words),
        harness=_harness(controller, words),
    )


@dataclass(frozen=True, slots=True)
class _Words:
    """The C words of an arithmetic: its type, and conversions to and from double."""

    kind: str
    include: str
    suffix: str
    scale: float | None = None
    bits: int = 0

    def literal(self, number: object) -> str:
        """Return a number that reads back exactly."""
        if self.scale is not None:
            return f"INT64_C({number})"
        if self.suffix:
            return f"{float(number).hex()}F"  # type: ignore[arg-type]
        return float(number).hex()  # type: ignore[arg-type]


def _words(arithmetic: AbstractArithmetic) -> _Words:
    match arithmetic:
        case Double():
            return _Words("double", "", "")
        case Single():
            return _Words("float", "", "F")
        case FixedPoint():
            bits = arithmetic.fraction_bits
            return _Words("int32_t", "#include <stdint.h>\n", "", 2.0**bits, bits)
        case _:
            raise LoopShapingError(
                f"{type(arithmetic).__name__} has no C text.",
                remedy="Use Double(), Single() or FixedPoint().",
            )


def _header(controller: DigitalController, words: _Words) -> str:
    name, kind = controller.name, words.kind
    sums = controller.sums()
    n, m = max(len(sums["x"]), 1), max(len(sums["xf"]), 1)
    guard = f"{name.upper()}_H"
    unit = (
        f"Numbers are integers that stand for themselves over 2^{words.bits}."
        if words.scale
        else "Numbers are in the units of the design."
    )
    return f"""/* {name}: a controller sampled every {controller.period!r} s.
 * Written by bondgraph. {unit}
 */
#ifndef {guard}
#define {guard}
{words.include}
typedef struct {{
    {kind} x[{n}];  /* controller */
    {kind} xf[{m}]; /* filter of the measurement */
}} {name}_state;

/* All states zero. */
void {name}_reset({name}_state *s);

/* One sample: returns the command. */
{kind} {name}_step({name}_state *s, {kind} reference, {kind} measured,
    {kind} feedforward);

#endif
"""


def _source(controller: DigitalController, words: _Words) -> str:
    name, kind = controller.name, words.kind
    sums = controller.sums()
    lines = [
        f'#include "{name}.h"',
        "",
        *_helpers(words),
        f"void {name}_reset({name}_state *s)",
        "{",
        *_reset(sums),
        "}",
        "",
        f"{kind} {name}_step({name}_state *s, {kind} reference, {kind} measured,",
        f"    {kind} feedforward)",
        "{",
        *([] if sums["x"] or sums["xf"] else ["    (void)s; /* no memory */"]),
        f"    const {kind} filtered = {_sum(sums['f'][0], 'xf', 'measured', words)};",
        f"    const {kind} error = {_plus('reference', '-', 'filtered', words)};",
        f"    const {kind} raw = {_sum(sums['v'][0], 'x', 'error', words)};",
        f"    const {kind} wanted = {_plus('raw', '+', 'feedforward', words)};",
        f"    {kind} command = wanted;",
        *_limit(controller, words),
        *_update(sums["xf"], "xf", "measured", words),
        *_states(controller, sums["x"], words),
        "    return command;",
        "}",
        "",
    ]
    return "\n".join(lines)


def _helpers(words: _Words) -> list[str]:
    if words.scale is None:
        return []
    return [
        "static int32_t clipped(int64_t v)",
        "{",
        "    return v > INT32_MAX ? INT32_MAX : v < -INT32_MAX ? -INT32_MAX"
        " : (int32_t)v;",
        "}",
        "",
        "/* Over 2^fraction bits, half away from zero. */",
        "static int32_t rounded(int64_t v)",
        "{",
        f"    const int64_t half = INT64_C({1 << (words.bits - 1)});",
        f"    return clipped(v < 0 ? -((-v + half) >> {words.bits})"
        f" : (v + half) >> {words.bits});",
        "}",
        "",
    ]


def _reset(sums: dict[str, list[Sum]]) -> list[str]:
    return [
        f"    s->{state}[{k}] = 0;"
        for state in ("x", "xf")
        for k in range(max(len(sums[state]), 1))
    ]


def _sum(row: Sum, state: str, source: str, words: _Words) -> str:
    """Return the text of a sum; the signal behind the states is `source`."""
    last = _last(row, state, source)
    terms = [
        f"{words.literal(f)} * {last[k]}"
        for f, k in zip(row.factors, row.signals, strict=True)
    ]
    if words.scale is not None:
        return f"rounded({' + '.join(terms) or '0'})"
    zero = "0.0F" if words.suffix else "0.0"
    return "\n        + ".join([zero, *terms]) if terms else zero


def _last(row: Sum, state: str, source: str) -> dict[int, str]:
    return {k: source if k == row.width else f"s->{state}[{k}]" for k in row.signals}


def _plus(one: str, sign: str, other: str, words: _Words) -> str:
    if words.scale is None:
        return f"{one} {sign} {other}"
    return f"clipped((int64_t){one} {sign} {other})"


def _limit(controller: DigitalController, words: _Words) -> list[str]:
    if controller.limits is None:
        return []
    low, high = (
        words.literal(controller.arithmetic.number(v)) for v in controller.limits
    )
    cast = f"({words.kind})" if words.scale is not None else ""
    return [
        f"    if (wanted < {low})",
        f"        command = {cast}{low};",
        f"    else if (wanted > {high})",
        f"        command = {cast}{high};",
    ]


def _update(rows: list[Sum], state: str, source: str, words: _Words) -> list[str]:
    """Return the statements that move states on, all from the old ones."""
    if not rows:
        return []
    new = [
        f"        const {words.kind} next{k} = {_sum(row, state, source, words)};"
        for k, row in enumerate(rows)
    ]
    put = [f"        s->{state}[{k}] = next{k};" for k in range(len(rows))]
    return ["    {", *new, *put, "    }"]


def _states(controller: DigitalController, rows: list[Sum], words: _Words) -> list[str]:
    match controller.anti_windup:
        case NoAntiWindup():
            return _update(rows, "x", "error", words)
        case Clamping():
            up, down = ("error > 0", "error < 0")
            if controller.controller.gain < 0:
                up, down = down, up
            moved = _update(rows, "x", "error", words)
            if not moved:
                return []
            test = f"    if (!((wanted > command && {up})"
            return [test, f"            || (wanted < command && {down})))", *moved]
        case BackCalculation():
            missing = _plus("command", "-", "wanted", words)
            factor = words.literal(controller.follow())
            scaled = f"{factor} * missing"
            if words.scale is not None:
                scaled = f"rounded({scaled})"
            elif words.scale is None:
                scaled = f"(0.0{words.suffix} + {scaled})"
            seen = _plus("error", "+", "change", words)
            if not rows:
                return []
            return [
                f"    const {words.kind} missing = {missing};",
                f"    const {words.kind} change = {scaled};",
                f"    const {words.kind} seen = {seen};",
                *_update(rows, "x", "seen", words),
            ]
        case _ as never:
            assert_never(never)


def _harness(controller: DigitalController, words: _Words) -> str:
    name, kind = controller.name, words.kind
    into, out = f"({kind})v", "(double)u"
    if words.scale is not None:
        most = (2**31 - 1) / words.scale
        out = f"(double)u / {words.scale!r}"
        into = (
            f"(v > {most!r} ? INT32_MAX : v < -{most!r} ? -INT32_MAX : v < 0\n"
            f"        ? -(int32_t)(-v * {words.scale!r} + 0.5)"
            f" : (int32_t)(v * {words.scale!r} + 0.5))"
        )
    return f"""#include <stdio.h>
#include "{name}.h"

static {kind} number(double v)
{{
    return {into};
}}

int main(void)
{{
    {name}_state s;
    double r, y, w;
    {name}_reset(&s);
    while (scanf("%lf %lf %lf", &r, &y, &w) == 3) {{
        const {kind} u = {name}_step(&s, number(r), number(y), number(w));
        printf("%.17g\\n", {out});
    }}
    return 0;
}}
"""
