"""Small dense linear systems, compiled: LU with partial pivoting, in place."""

from bondgraph.numeric.compiled.loops import Array, Integers, lean

SINGULAR = 1e-300


@lean
def factor(a: Array, n: int, pivot: Integers) -> bool:
    """Factor ``a[:n, :n]`` in place; return False if it is singular."""
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        pivot[k] = best
        if not abs(a[best, k]) > SINGULAR:
            return False
        if best != k:
            for j in range(n):
                a[k, j], a[best, j] = a[best, j], a[k, j]
        for i in range(k + 1, n):
            if a[i, k] != 0.0:
                a[i, k] /= a[k, k]
                for j in range(k + 1, n):
                    a[i, j] -= a[i, k] * a[k, j]
    return True


@lean
def substitute(a: Array, n: int, pivot: Integers, b: Array, m: int) -> None:
    """Solve in place for the `m` columns of ``b[:n, :m]`` after `factor`."""
    for k in range(n):
        best = pivot[k]
        if best != k:
            for j in range(m):
                b[k, j], b[best, j] = b[best, j], b[k, j]
    for k in range(n):
        for i in range(k + 1, n):
            share = a[i, k]
            if share != 0.0:
                for j in range(m):
                    b[i, j] -= share * b[k, j]
    for k in range(n - 1, -1, -1):
        for j in range(m):
            b[k, j] /= a[k, k]
        for i in range(k):
            share = a[i, k]
            if share != 0.0:
                for j in range(m):
                    b[i, j] -= share * b[k, j]
