"""The leg's drive as it is: worm mesh, tendon, flexible link, encoder filter.

A drive is a chain of inertias at the joint's scale, motor first; between them lie what
gives way, the tendon and the link. It moves by the benchmark's simulator
(`benchmarks.concealed`), so that what is concealed shares no law and no integrator with
the toolkit that must find it. All angles are in rad, all torques in N·m at the joint.

The encoder reads the joint. Its filter, twice a Butterworth low pass (eq. 3.34), is
four stores. Friction of the mesh is set-valued and hangs on the worm: a part that
grows with the torque passed on and a constant one.
"""

from benchmarks.concealed.compiling import FORCES, MASSES, READINGS, compiled

GEARBOX, WORM = 26.0, 9.67
RATIO = GEARBOX * WORM
MOST = 3
"""Inertias that a chain can have: motor, joint, and what the link carries."""

STIFFNESS = MOST
DAMPING = STIFFNESS + MOST - 1
VISCOUS = DAMPING + MOST - 1
JOINT, BEHIND, CARRIED, CUT_OFF = range(VISCOUS + 1, VISCOUS + 5)
"""Where the numbers stand: inertias, springs, dampers, and then single ones."""


@compiled(FORCES)
def forces(q, v, z, u, p, acceleration, F, g, load, stored):
    """Torques on the chain; the worm passes on what lies behind it."""
    joint = int(p[JOINT])
    passed = p[CARRIED] + p[VISCOUS] * v[0] + p[BEHIND] * acceleration[0]
    F[0] = RATIO * u[0]
    F[joint] -= p[VISCOUS] * v[joint]
    if u.size > 1:
        F[joint] += u[1]
        passed -= u[1]
    for i in range(v.size - 1):
        torque = p[STIFFNESS + i] * (q[i] - q[i + 1])
        torque += p[DAMPING + i] * (v[i] - v[i + 1])
        F[i] -= torque
        F[i + 1] += torque
        if i == 0 and joint == 1:
            passed = p[CARRIED] + torque
        elif i == 0:
            passed += torque
    load[0] = passed / WORM
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
    """Read the joint, behind the filter where there is one."""
    y[0] = z[2] if z.size > 0 else q[int(p[JOINT])]
