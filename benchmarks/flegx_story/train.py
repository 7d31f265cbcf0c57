"""The leg's drive as it is: worm mesh, tendon, flexible link, encoder filter.

A drive is a chain of inertias at the joint's scale, motor first; between them lie what
gives way, the tendon and the link. It moves by the benchmark's simulator
(`benchmarks.concealed`), so that what is concealed shares no law and no integrator with
the toolkit that must find it. All angles are in rad, all torques in N·m at the joint.

The encoder reads the joint, the torque sensor sits between worm and joint. The
encoder's filter, twice a Butterworth low pass (eq. 3.34), is four stores. Friction of
the mesh is set-valued and hangs on the worm: a part that grows with the torque passed
on and a constant one.
"""

import numba

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled

GEARBOX, WORM = 26.0, 9.67
RATIO = GEARBOX * WORM
MOST = 3
"""Inertias that a chain can have: motor, joint, and what the link carries."""

STIFFNESS = MOST
DAMPING = STIFFNESS + MOST - 1
VISCOUS = DAMPING + MOST - 1
JOINT, BEHIND, CARRIED, CUT_OFF, TURNING = range(VISCOUS + 1, VISCOUS + 6)
"""Where the numbers stand: inertias, springs, dampers, and then single ones."""


@numba.njit
def between(i, q, v, p):
    """Return the torque in what gives way behind inertia `i`."""
    stiff = p[STIFFNESS + i] * (q[i] - q[i + 1])
    return stiff + p[DAMPING + i] * (v[i] - v[i + 1])


@numba.njit
def passed_on(q, v, u, p, acceleration):
    """Return the torque that the worm passes on to the joint, beyond the weight."""
    if int(p[JOINT]) == 1:
        return between(0, q, v, p)
    torque = p[VISCOUS] * v[0] + p[BEHIND] * acceleration[0]
    if u.size > 1:
        torque -= u[1]
    return torque + (between(0, q, v, p) if v.size > 1 else 0.0)


@numba.njit
def carried(q, v, p, acceleration):
    """Return the torque in the link, behind the joint."""
    joint = int(p[JOINT])
    if v.size > joint + 1:
        return between(joint, q, v, p)
    return (p[BEHIND] - p[TURNING]) * acceleration[joint]


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Torques on the chain; the worm passes on what lies behind it."""
    joint = int(p[JOINT])
    F[0] = RATIO * u[0]
    F[joint] -= p[VISCOUS] * v[joint]
    if u.size > 1:
        F[joint] += u[1]
    for i in range(v.size - 1):
        torque = between(i, q, v, p)
        F[i] -= torque
        F[i + 1] += torque
    load[0] = (p[CARRIED] + passed_on(q, v, u, p, acceleration)) / WORM
    for i in range(0, z.size, 2):
        enters = q[joint] if i == 0 else z[i - 2]
        g[i] = z[i + 1]
        g[i + 1] = p[CUT_OFF] ** 2 * (enters - z[i]) - 1.414 * p[CUT_OFF] * z[i + 1]


@compiled(MASSES)
def masses(q, v, p, M):
    """Inertias of the chain."""
    M[:] = 0.0
    for i in range(v.size):
        M[i, i] = p[i]


@compiled(READINGS)
def readings(q, v, z, u, p, acceleration, y):
    """Read the joint, behind the filter where there is one, and the torque sensor."""
    y[0] = z[2] if z.size > 0 else q[int(p[JOINT])]
    if y.size > 1:
        y[1] = passed_on(q, v, u, p, acceleration)
    if y.size > 2:
        y[2] = -carried(q, v, p, acceleration)
