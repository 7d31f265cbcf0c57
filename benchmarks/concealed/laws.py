"""The laws that can be concealed: what each does to the flow at its place.

A slot is a law hung on a place of a machine. It opposes the place's flow ``w`` with an
effort that depends on the flow, on the displacement ``s``, on the effort ``load`` that
the place transmits, or on a memory. On a place that stores (a tank, a heated mass) the
same laws oppose the effort there with a flow.

Dry laws are set-valued: `dry_limits` gives the interval of efforts that can hold the
place at rest, and the stepping projects on it (Moreau; Acary and Brogliato, Numerical
Methods for Nonsmooth Dynamical Systems, 2008).
"""

import math

import numpy as np

from benchmarks.concealed.compiling import compiled

NUMBERS = 6
"""Numbers per slot."""
MEMORIES = 6
"""Memory cells per slot."""

VISCOUS, QUADRATIC, SPRING, CUBIC, GRAVITY, COGGING, BIAS = range(7)
BOUC_WEN, MAXWELL_SLIP, LUGRE, TABULATED, PERIODIC_QUADRATIC = range(7, 12)
OVERFLOW, ROOT, RADIATION = range(12, 15)
DRY = 20  # from here on: set-valued
COULOMB, STRIBECK, LOAD, DIRECTION, STOP = range(DRY, DRY + 5)

TABLE = np.array([0.0, 1.0, 0.25, 0.9, 0.35])
"""Heights of the tabulated odd law at equal distances: no law of any textbook."""


@compiled()
def smooth_effort(kind, a, s, w, memory):  # noqa: C901, PLR0912 - a branch per law
    """Return the effort against the motion of a law that is a function."""
    effort = 0.0
    if kind == VISCOUS:
        effort = a[0] * w
    elif kind == QUADRATIC:
        effort = a[0] * w * abs(w)
    elif kind == SPRING:
        effort = a[0] * (s - a[1])
    elif kind == CUBIC:
        effort = a[0] * s**3
    elif kind == GRAVITY:
        effort = a[0] * math.sin(s + a[1])
    elif kind == COGGING:
        effort = a[0] * math.sin(a[1] * s + a[2])
    elif kind == BIAS:
        effort = a[0]
    elif kind == BOUC_WEN:
        effort = a[0] * memory[0]
    elif kind == MAXWELL_SLIP:
        for i in range(4):
            effort += a[0] * (s - memory[i]) / (a[1] * 2.0**i) / 4.0
    elif kind == LUGRE:
        effort = a[3] * memory[0]
    elif kind == TABULATED:
        x = min(abs(w) / a[1] * (TABLE.size - 1), TABLE.size - 1.0001)
        i = int(x)
        effort = a[0] * (TABLE[i] + (x - i) * (TABLE[i + 1] - TABLE[i]))
        effort *= np.sign(w)
    elif kind == PERIODIC_QUADRATIC:
        effort = a[0] * (math.sin(a[1] * s) + 0.6 * (s / a[2]) ** 2)
    elif kind == OVERFLOW:
        effort = a[0] * max(w - a[1], 0.0)
    elif kind == ROOT:
        effort = a[0] * math.sqrt(max(w, 0.0))
    elif kind == RADIATION:
        effort = a[0] * ((w + a[1]) ** 4 - a[1] ** 4)
    return effort


@compiled()
def dry_limits(kind, a, s, w, load):
    """Return the largest effort forward and backward that a dry law can oppose with.

    Both are positive; the effort on the machine lies between minus the backward and
    the forward one.
    """
    forward, backward = 0.0, 0.0
    if kind == COULOMB:
        forward = backward = a[0]
    elif kind == STRIBECK:
        forward = backward = a[0] + a[1] * math.exp(-((w / a[2]) ** 2))
    elif kind == LOAD:
        forward = backward = a[0] * abs(load)
    elif kind == DIRECTION:
        backward, forward = a[0], a[1]
    elif kind == STOP:
        backward = 1e300 if s >= a[0] else 0.0
        forward = 1e300 if s <= a[1] else 0.0
    return forward, backward


@compiled()
def remember(kind, a, s, w, memory, h):
    """Move the memory of a law on by `h` seconds at flow `w` and displacement `s`."""
    if kind == BOUC_WEN:
        z = memory[0]
        shape = 1.0 - abs(z) ** a[2] * (0.5 + 0.5 * np.sign(w * z))
        memory[0] = min(max(z + h * w / a[1] * shape, -1.0), 1.0)
    elif kind == MAXWELL_SLIP:
        for i in range(4):
            reach = a[1] * 2.0**i
            memory[i] = min(max(memory[i], s - reach), s + reach)
    elif kind == LUGRE:
        level = (a[0] + a[1] * math.exp(-((w / a[2]) ** 2))) / a[3]
        settled = level * np.sign(w)
        memory[0] = settled + (memory[0] - settled) * math.exp(-abs(w) / level * h)
