"""The friction pendulum stepped by loops written by hand, in numba and in C."""

import ctypes
import math
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

SOURCE = """
#include <math.h>
void run(const double *v, const double *u, double h, double p, double q, double *y,
         long n) {
  const double J = v[0], w = v[1], c = v[2], b = v[3], s = v[4];
  for (long k = 0; k < n; k++) {
    y[k] = q;
    if (k + 1 == n) break;
    const double um = 0.5 * (u[k] + u[k + 1]);
    double r = p / J;
    const double a1 = u[k] - c * tanh(r / s) - b * r - w * sin(q), b1 = r;
    r = (p + h / 2 * a1) / J;
    const double a2 = um - c * tanh(r / s) - b * r - w * sin(q + h / 2 * b1), b2 = r;
    r = (p + h / 2 * a2) / J;
    const double a3 = um - c * tanh(r / s) - b * r - w * sin(q + h / 2 * b2), b3 = r;
    r = (p + h * a3) / J;
    const double a4 = u[k + 1] - c * tanh(r / s) - b * r - w * sin(q + h * b3), b4 = r;
    p += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    q += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4);
  }
}
"""


@njit(error_model="numpy")
def numba_loop(v: Array, u: Array, h: float, p: float, q: float, y: Array) -> None:
    """Write the angle at every sample; `v` as in the C source."""
    J, w, c, b, s = v
    for k in range(len(u)):
        y[k] = q
        if k + 1 == len(u):
            break
        um = 0.5 * (u[k] + u[k + 1])
        r = p / J
        a1, b1 = u[k] - c * math.tanh(r / s) - b * r - w * math.sin(q), r
        r = (p + h / 2 * a1) / J
        a2, b2 = um - c * math.tanh(r / s) - b * r - w * math.sin(q + h / 2 * b1), r
        r = (p + h / 2 * a2) / J
        a3, b3 = um - c * math.tanh(r / s) - b * r - w * math.sin(q + h / 2 * b2), r
        r = (p + h * a3) / J
        a4, b4 = u[k + 1] - c * math.tanh(r / s) - b * r - w * math.sin(q + h * b3), r
        p += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        q += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4)


def c_loop() -> Callable[..., None] | None:
    """Return the same in C, compiled by gcc; None where there is none."""
    folder = Path(tempfile.mkdtemp())
    source, library = folder / "loop.c", folder / "loop.so"
    source.write_text(SOURCE, "utf-8")
    flags = ["-O3", "-march=native", "-shared", "-fPIC", "-o", str(library)]
    try:
        subprocess.run(["gcc", *flags, str(source), "-lm"], check=True)
    except (FileNotFoundError, subprocess.CalledProcessError):
        return None
    function = ctypes.CDLL(str(library)).run
    pointer, number = np.ctypeslib.ndpointer(np.float64), ctypes.c_double
    function.argtypes = [pointer, pointer, number, number, number, pointer,
                         ctypes.c_long]  # fmt: skip
    function.restype = None

    def run(v: Array, u: Array, h: float, p: float, q: float, y: Array) -> None:
        function(v, u, h, p, q, y, len(u))

    return run
