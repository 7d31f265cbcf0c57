"""Elementary functions that native code calls; on lanes, without a branch per lane.

A vector of numbers has no sine of its own. Exponential, hyperbolic tangent, sine and
cosine are written here as polynomials after an exact reduction of the argument (S. L.
Moshier, *Cephes Mathematical Library*, 1989), correct to one or two units in the last
place; all others, and large angles, are taken lane by lane from the system's library.
"""

import math
import re
from collections.abc import Callable, Collection, Sequence

from bondgraph.numeric.native.code import Assembly

_ROUND = 1.5 * 2.0**52
"""Adding this leaves the rounded number in the lowest bits."""
_LN2 = (6.93145751953125e-1, 1.42860682030941723212e-6)
_HALF_PI = (
    2 * 7.85398125648498535156e-1,
    2 * 3.77489470793079817668e-8,
    2 * 2.69515142907905952645e-15,
)
_LARGEST_ANGLE = 1e6
_EXP = tuple(1.0 / math.factorial(k) for k in range(13, -1, -1))
_TANH = (-9.64399179425052238628e-1, -9.92877231001918586564e1,
         -1.61468768441708447952e3)  # fmt: skip
_TANH_BELOW = (1.0, 1.12811678491632931402e2, 2.23548839060100448583e3,
               4.84406305325125486048e3)  # fmt: skip
_SIN = (1.58962301576546568060e-10, -2.50507477628578072866e-8,
        2.75573136213857245213e-6, -1.98412698295895385996e-4,
        8.33333333332211858878e-3, -1.66666666666666307295e-1)  # fmt: skip
_COS = (-1.13585365213876817300e-11, 2.08757008419747316778e-9,
        -2.75573141792967388112e-7, 2.48015872888517045348e-5,
        -1.38888888888730564116e-3, 4.16666666666665929218e-2)  # fmt: skip


def declarations(called: Collection[str], lanes: int) -> list[str]:
    """Return the lines that make the called functions known."""
    if lanes == 1:
        return sorted(called)
    lines, outside = [], {"declare double @llvm.fabs.f64(double)"}
    for declaration in sorted(called):
        found = re.search(r"@lanes\.(\w+)\((.*)\)", declaration)
        if found is None:
            outside.add(declaration)
            continue
        name, arguments = found[1], found[2].count("double")
        lines += _one_by_one(name, arguments, lanes)
        outside.add(f"declare double @{name}({', '.join(['double'] * arguments)})")
        if name in _WRITTEN:
            lines += _written(name, lanes, outside)
        else:
            lines += _renamed(name, arguments, lanes)
    return [*sorted(outside), *lines]


def _renamed(name: str, arguments: int, lanes: int) -> list[str]:
    real = f"<{lanes} x double>"
    given = ", ".join(f"{real} %x{i}" for i in range(arguments))
    return [
        f"define internal {real} @lanes.{name}({given}) nounwind {{",
        f"  %y = call {real} @each.{name}({given})",
        f"  ret {real} %y",
        "}",
    ]


def _one_by_one(name: str, arguments: int, lanes: int) -> list[str]:
    """Write the function that takes each lane from the system's library."""
    real, last = f"<{lanes} x double>", "undef"
    given = ", ".join(f"{real} %x{i}" for i in range(arguments))
    lines = [f"define internal {real} @each.{name}({given}) noinline nounwind {{"]
    for k in range(lanes):
        for i in range(arguments):
            lines.append(f"  %x{i}.{k} = extractelement {real} %x{i}, i64 {k}")
        each = ", ".join(f"double %x{i}.{k}" for i in range(arguments))
        lines.append(f"  %y{k} = call double @{name}({each})")
        lines.append(f"  %z{k} = insertelement {real} {last}, double %y{k}, i64 {k}")
        last = f"%z{k}"
    return [*lines, f"  ret {real} {last}", "}"]


def _written(name: str, lanes: int, outside: set[str]) -> list[str]:
    code = Assembly(lanes)
    result = _WRITTEN[name](code, "%x0")
    real = code.real
    head = f"define internal {real} @lanes.{name}({real} %x0) nounwind {{"
    outside |= code.called
    if name not in {"sin", "cos"}:
        return [head, *code.lines, f"  ret {real} {result}", "}"]
    outside.add(f"declare i1 @llvm.vector.reduce.and.v{lanes}i1(<{lanes} x i1>)")
    limit = code.constant(_LARGEST_ANGLE)
    return [
        head,
        f"  %size = call {real} @llvm.fabs.v{lanes}f64({real} %x0)",
        f"  %small = fcmp olt {real} %size, {limit}",
        f"  %all = call i1 @llvm.vector.reduce.and.v{lanes}i1({code.truth} %small)",
        "  br i1 %all, label %near, label %far",
        "near:",
        *code.lines,
        f"  ret {real} {result}",
        "far:",
        f"  %each = call {real} @each.{name}({real} %x0)",
        f"  ret {real} %each",
        "}",
    ]


def _polynomial(code: Assembly, x: str, coefficients: Sequence[float]) -> str:
    total = code.constant(coefficients[0])
    for c in coefficients[1:]:
        total = code.add(code.multiply(total, x), code.constant(c))
    return total


def _rounded(code: Assembly, x: str, unit: float) -> tuple[str, str]:
    """Return x / unit rounded, as a number and as the bits of an integer."""
    shifted = code.add(code.multiply(x, code.constant(1 / unit)), code.constant(_ROUND))
    integers = f"<{code.lanes} x i64>"
    bits = code.write(f"bitcast {code.real} {shifted} to {integers}")
    return code.subtract(shifted, code.constant(_ROUND)), bits


def _remainder(code: Assembly, x: str, n: str, unit: Sequence[float]) -> str:
    for share in unit:
        x = code.subtract(x, code.multiply(n, code.constant(share)))
    return x


def _integers(code: Assembly, value: int) -> str:
    return "<" + ", ".join([f"i64 {value}"] * code.lanes) + ">"


def _exp(code: Assembly, x: str) -> str:
    low, high = code.constant(-708.0), code.constant(709.0)
    inside = code.choose(code.compare("olt", x, high), x, high)
    inside = code.choose(code.compare("ogt", inside, low), inside, low)
    n, bits = _rounded(code, inside, math.log(2))
    series = _polynomial(code, _remainder(code, inside, n, _LN2), _EXP)
    integers = f"<{code.lanes} x i64>"
    moved = code.write(f"add {integers} {bits}, {_integers(code, 1023)}")
    scaled = code.write(f"shl {integers} {moved}, {_integers(code, 52)}")
    power = code.write(f"bitcast {integers} {scaled} to {code.real}")
    value = code.multiply(series, power)
    value = code.choose(code.compare("olt", x, low), code.zero, value)
    value = code.choose(code.compare("ogt", x, high), code.constant(math.inf), value)
    return code.choose(code.compare("uno", x, x), x, value)


def _tanh(code: Assembly, x: str) -> str:
    size = code.call("llvm.fabs", x)
    bound = code.constant(22.0)
    size = code.choose(code.compare("olt", size, bound), size, bound)
    power = _exp(code, code.add(size, size))
    share = code.divide(code.constant(2.0), code.add(power, code.one))
    large = code.call("llvm.copysign", code.subtract(code.one, share), x)
    square = code.multiply(x, x)
    ratio = code.divide(
        _polynomial(code, square, _TANH), _polynomial(code, square, _TANH_BELOW)
    )
    small = code.add(x, code.multiply(code.multiply(x, square), ratio))
    near = code.compare("olt", size, code.constant(0.625))
    value = code.choose(near, small, large)
    return code.choose(code.compare("uno", x, x), x, value)


def _quarter(code: Assembly, x: str, ahead: int) -> str:
    """Return the sine of x plus `ahead` quarters of a turn."""
    n, bits = _rounded(code, x, math.pi / 2)
    r = _remainder(code, x, n, _HALF_PI)
    square = code.multiply(r, r)
    cube = code.multiply(r, square)
    sine = code.add(r, code.multiply(cube, _polynomial(code, square, _SIN)))
    half = code.multiply(code.constant(0.5), square)
    quartic = code.multiply(square, square)
    cosine = code.add(
        code.subtract(code.one, half),
        code.multiply(quartic, _polynomial(code, square, _COS)),
    )
    integers = f"<{code.lanes} x i64>"
    turned = code.write(f"add {integers} {bits}, {_integers(code, ahead)}")
    odd = code.write(f"and {integers} {turned}, {_integers(code, 1)}")
    is_odd = code.write(f"icmp ne {integers} {odd}, {_integers(code, 0)}")
    two = code.write(f"and {integers} {turned}, {_integers(code, 2)}")
    is_minus = code.write(f"icmp ne {integers} {two}, {_integers(code, 0)}")
    value = code.choose(is_odd, cosine, sine)
    return code.choose(is_minus, code.negate(value), value)


def _sin(code: Assembly, x: str) -> str:
    return _quarter(code, x, 0)


def _cos(code: Assembly, x: str) -> str:
    return _quarter(code, x, 1)


_WRITTEN: dict[str, Callable[[Assembly, str], str]] = {
    "exp": _exp,
    "tanh": _tanh,
    "sin": _sin,
    "cos": _cos,
}
