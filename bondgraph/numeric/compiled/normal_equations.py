"""Sums of squares of many windows, compiled: each window's own normal equations."""

from bondgraph.numeric.compiled.loops import Array, Integers, lean


@lean
def normal_blocks(
    jacobian: Array, residual: Array, edges: Integers, h: Array, g: Array, cost: Array
) -> None:
    """Write JᵀJ, Jᵀr and rᵀr of every window; J is (n, ny, nd), r is (n, ny)."""
    ny, nd = jacobian.shape[1], jacobian.shape[2]
    for window in range(len(edges) - 1):
        for row in range(edges[window], edges[window + 1]):
            for j in range(ny):
                r = residual[row, j]
                cost[window] += r * r
                for k in range(nd):
                    slope = jacobian[row, j, k]
                    g[window, k] += slope * r
                    for m in range(k + 1):
                        h[window, k, m] += slope * jacobian[row, j, m]
        for k in range(nd):
            for m in range(k):
                h[window, m, k] = h[window, k, m]
