"""When Newton's method for one implicit stage ends, and how short a step may get.

The same on the tape and in native code, so that what one simulates the other does.
"""

TOLERANCE = 1e-7
"""Of the last Newton step, relative; the error left is about its square."""

ROUNDING = 1e-6
"""Steps below it that no longer shrink are rounding."""

SMALLEST_DAMPING = 1e-4

NUDGE = 1e-3
"""How far to look beside a point at which the equations are flat."""

GLANCE = 1e-6
"""Of a step: no more than this of it is an instant."""

SHORTEST = 0.01
"""Of a step, down to which it is halved where it has no solution."""
