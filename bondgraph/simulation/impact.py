"""An impact: what the flows are after it, by Newton's law of restitution.

The force of a contact acts for no time and leaves an impulse Λ ≥ 0. States jump by the
impulses times what a force does to their rates; the penetrations, which closed at
rates v, then close no faster than -e max(v, 0), and a gap that opens faster took no
impulse (Moreau 1988; Glocker, *Set-Valued Force Laws*, 2001): a linear complementarity
problem. Energies jump as other states do, by the mean of before and after, so what an
impact dissipates is its impulse times the mean rate of penetration (Thomson and Tait).
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondgraph.errors import EquationError
from bondgraph.numeric.dynamics import Dynamics
from bondgraph.numeric.model import ContactForm, evaluate

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

ITERATIONS = 40
CLOSE = 1e-13  # of the largest impulse, to which the impulses are found
ROUNDING = 1e-12  # of what a complementarity problem is made of


@dataclass(frozen=True, slots=True, eq=False)
class Instant:
    """Time, inputs and their rates."""

    time: float
    inputs: Array
    rates: Array


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """How a state answers to pushes at its contacts, all gaps open.

    Parameters
    ----------
    approach
        Rates of penetration, (contact,).
    pushes
        What each force adds to the rates of the states, (state, contact).
    compliance
        By how much each force slows each penetration's rate, per second.
    restitution
        Newton's e of every contact.
    """

    approach: Array
    pushes: Array
    compliance: Array
    restitution: Array


class ImpactLaw:
    """Impacts of one model with values for its parameters."""

    def __init__(self, form: ContactForm, parameters: Array) -> None:
        self.form = form
        held = form.held
        self.count = len(form.places)
        self.values = np.concatenate([parameters, np.zeros(2 * self.count)])
        self._dynamics = Dynamics(held, self.values)
        nx, nz = held.n_states, held.n_unknowns
        n = held.dynamics.n_variables
        self._along = np.zeros((n, nx + nz + self.count))
        self._along[nx : 2 * nx + nz, : nx + nz] = np.eye(nx + nz)
        self._along[n - 1 - self.count : n - 1, nx + nz :] = np.eye(self.count)

    def response(self, at: Instant, x: Array) -> Response:
        """Return how the state answers to pushes."""
        held, count = self.form.held, self.count
        nx, nw = held.n_states, held.n_states + held.n_unknowns
        nothing = np.zeros(held.n_unknowns)
        rates, z = self._dynamics.settle(at.time, x, nothing, at.inputs, at.rates)
        point = np.concatenate(
            [x, rates, z, at.inputs, at.rates, self.values, [at.time]]
        )
        _, slopes = evaluate(held.dynamics, point, self._along)
        slopes[:nx] *= -1.0
        slopes[:nx, :nx] += np.eye(nx)
        solved = np.linalg.lstsq(slopes[:, :nw], -slopes[:, nw:], rcond=None)[0]
        moved = solved.astype(float)
        values, along = evaluate(held.output, point, self._along)
        found = watched(self.form, values)
        bends = watched(self.form, along[:, :nw] @ moved + along[:, nw:]).bends
        return Response(
            approach=found.rates,
            pushes=moved[:nx],
            compliance=-bends.reshape(count, count),
            restitution=found.restitution,
        )

    def after(self, at: Instant, x: Array, touching: Flags, *, plastic: Flags) -> Array:
        """Return the states after an impact at the `touching` contacts.

        Parameters
        ----------
        plastic
            Contacts whose restitution counts as zero.

        Raises
        ------
        EquationError
            If no impulses are found that obey the law.
        """
        before = self.response(at, x)
        bounce = np.where(plastic, 0.0, before.restitution)
        wanted = -bounce * np.maximum(before.approach, 0.0)
        some = np.flatnonzero(touching)
        impulses = np.zeros(self.count)
        here, there = before, x
        for _ in range(ITERATIONS):
            compliance = here.compliance[np.ix_(some, some)]
            offset = (wanted - here.approach)[some] - compliance @ impulses[some]
            last = impulses.copy()
            found = complementary(compliance, offset)
            if found is None:
                break
            impulses[some] = found
            there = x + 0.5 * (before.pushes + here.pushes) @ impulses
            if np.abs(impulses - last).max() <= CLOSE * np.abs(impulses).max():
                return there
            here = self.response(at, there)
        named = tuple(self.form.places[k] for k in some)
        raise EquationError(
            f"The impact at {', '.join(named)} has no solution by Newton's law.",
            named,
            "Give the contacts one restitution, or put a mass between them.",
        )

    def refuse_pulling(self, at: Instant, x: Array) -> None:
        """Refuse a contact whose force would pull its gap further shut."""
        slowed = np.diag(self.response(at, x).compliance)
        wrong = tuple(self.form.places[k] for k in np.flatnonzero(slowed < 0.0))
        if wrong:
            raise EquationError(
                f"The hard contact of {', '.join(wrong)} pulls its gap further shut "
                f"instead of holding it.",
                wrong,
                "Turn the sign of the law: an upper stop is hard_contact(x - gap, e), "
                "a floor is -hard_contact(-x, e).",
            )


@dataclass(frozen=True, slots=True, eq=False)
class Watched:
    """What is told of contacts beside the outputs, ``[contact]`` or ``[state]``."""

    penetrations: Array
    rates: Array
    bends: Array
    forces: Array
    restitution: Array
    states: Array
    state_rates: Array


def watched(form: ContactForm, values: Array) -> Watched:
    """Return the parts of the outputs of `form`'s model; they lie along axis 0."""
    count, nx = len(form.places), form.held.n_states
    first = len(form.held.output_names) - 5 * count - 2 * nx
    ends = np.cumsum([first, *(5 * [count]), nx, nx])
    return Watched(*(values[a:b] for a, b in pairwise(ends.tolist())))


def complementary(matrix: Array, offset: Array) -> Array | None:
    """Return z ≥ 0 with w = matrix z + offset ≥ 0 and zᵀw = 0, or None.

    The index that is wrong and least changes sides, which ends for every P-matrix
    (Murty, Linear Algebra Appl. 7, 1974).
    """
    n = len(offset)
    pressed = np.zeros(n, dtype=bool)
    z = np.zeros(n)
    for _ in range(2 ** min(n, 10) + n):
        z[:] = 0.0
        if pressed.any():
            part = matrix[np.ix_(pressed, pressed)]
            z[pressed] = np.linalg.lstsq(part, -offset[pressed], rcond=None)[0]
        w = matrix @ z + offset
        slack = ROUNDING * (np.abs(matrix) @ np.abs(z) + np.abs(offset))
        wrong = np.where(pressed, z < 0.0, w < -slack)
        if not wrong.any():
            return z
        k = int(np.argmax(wrong))
        pressed[k] = not pressed[k]
    return None
