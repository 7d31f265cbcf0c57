"""All loops of a family at all frequencies of a grid at once, for the optimiser.

Only here is a grid used: to steer. What is found is then checked on the exact response
(see `requirements`), and where the grid was too coarse the frequency that it missed is
added and the search goes on.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.loopshaping.curve import Curve, curve
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.synthesis.structure import ControllerStructure
from bondgraph.loopshaping.zero_pole_gain import ComplexArray, FloatArray

POINTS_PER_DECADE = 30
BESIDE_A_RESONANCE = np.array([-3.0, -1.0, -0.3, 0.0, 0.3, 1.0, 3.0])  # half widths


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GriddedLoops:
    """Loops ``[plant, frequency]`` with one controller.

    Parameters
    ----------
    omega
        rad/s, ascending.
    size, phase
        ln|L|, and the continuous phase of L in rad.
    controller, feedback
        Responses of the controller, and of each feedback branch.
    loop
        L, with its size limited so that nothing overflows.
    needed_turn
        By how much 1 + L of a stable loop turns from zero to infinite frequency, rad.
    """

    omega: FloatArray
    size: FloatArray
    phase: FloatArray
    controller: ComplexArray
    feedback: ComplexArray
    loop: ComplexArray
    needed_turn: FloatArray

    def unstable(self) -> FloatArray:
        """Return per plant how many closed-loop poles look unstable."""
        around = 1 + self.loop
        turned = np.angle(around[:, 1:] / around[:, :-1]).sum(axis=1)
        turned -= np.angle(around[:, -1])  # 1 + L ends at one
        return np.asarray(np.abs(np.round((self.needed_turn - turned) / math.pi)))

    def phase_margins(self) -> FloatArray:
        """Return per plant the smallest phase margin, rad; π without crossover."""
        least = np.full(len(self.size), math.pi)
        plant, k = np.nonzero(self.size[:, 1:] * self.size[:, :-1] <= 0)
        first, last = self.size[plant, k], self.size[plant, k + 1]
        share = np.where(
            first == last, 0.0, first / np.where(first == last, 1.0, first - last)
        )
        phase = self.phase[plant, k] * (1 - share) + self.phase[plant, k + 1] * share
        margin = math.pi - np.abs((phase + math.pi) % (2 * math.pi) - math.pi)
        # Of an unstable loop the angle counts the wrong way; `unstable` sees to that.
        np.minimum.at(least, plant, margin)
        return least

    def gain_margins(self) -> FloatArray:
        """Return per plant ln of the smallest gain margin; 20 at most."""
        least = np.full(len(self.size), 20.0)
        turns = (self.phase + math.pi) / (2 * math.pi)
        plant, k = np.nonzero(np.floor(turns[:, 1:]) != np.floor(turns[:, :-1]))
        first, last = turns[plant, k], turns[plant, k + 1]
        level = np.maximum(np.floor(first), np.floor(last))
        share = (level - first) / (last - first)
        size = self.size[plant, k] * (1 - share) + self.size[plant, k + 1] * share
        below = size < 0
        np.minimum.at(least, plant[below], -size[below])
        return least

    def crossovers(self) -> FloatArray:
        """Return per plant ln of the first frequency at which the gain is one."""
        changes = self.size[:, :-1] * self.size[:, 1:] <= 0
        return self._crossings(changes, changes.argmax(axis=1))

    def last_crossovers(self) -> FloatArray:
        """Return per plant ln of the last frequency at which the gain is one."""
        changes = self.size[:, :-1] * self.size[:, 1:] <= 0
        k = changes.shape[1] - 1 - changes[:, ::-1].argmax(axis=1)
        return self._crossings(changes, k)

    def _crossings(self, changes: NDArray[np.bool_], k: NDArray[np.intp]) -> FloatArray:
        """Return ln of the crossings after places k; the lowest frequency without."""
        logarithm = np.log(self.omega)
        rows = np.arange(len(self.size))
        first, last = self.size[rows, k], self.size[rows, k + 1]
        some = changes.any(axis=1) & (first != last)
        share = np.where(some, first / np.where(some, first - last, 1.0), 0.0)
        here = logarithm[k] * (1 - share) + logarithm[k + 1] * share
        return np.asarray(np.where(some, here, logarithm[0]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FamilyGrid:
    """What of a family's loops does not depend on the controller, on a grid."""

    structure: ControllerStructure
    omega: FloatArray
    rest: ComplexArray
    fixed: ComplexArray
    feedback: ComplexArray
    needed_turn: FloatArray
    nominal: Curve
    sign: float

    def loops(self, crossover: float, numbers: FloatArray) -> GriddedLoops:
        """Return all loops, the first of which has gain one at `crossover` (rad/s)."""
        zeros, poles = self.structure.roots(numbers)
        own = _logarithm(zeros, poles, self.omega)
        gain = math.log(abs(self._leading(crossover, zeros, poles)))
        total = self.rest + (own + gain)[None, :]
        return GriddedLoops(
            omega=self.omega,
            size=total.real,
            phase=total.imag,
            controller=np.exp(own + gain) * self.fixed,
            feedback=self.feedback,
            loop=np.exp(np.clip(total.real, -200, 200) + 1j * total.imag),
            needed_turn=self.needed_turn,
        )

    def gain(self, crossover: float, numbers: FloatArray) -> float:
        """Return the controller's leading gain for that crossover, with its sign."""
        return self._leading(crossover, *self.structure.roots(numbers))

    def _leading(
        self, crossover: float, zeros: ComplexArray, poles: ComplexArray
    ) -> float:
        here = np.array([crossover])
        size = self.nominal.logarithm(here)[0].real
        own = _logarithm(zeros, poles, here)[0].real
        return self.sign * math.exp(float(-size - own))


def family_grid(
    loops: Sequence[Loop],
    structure: ControllerStructure,
    *,
    around: float,
    more: Iterable[float] = (),
) -> FamilyGrid:
    """Return the grid for loops whose own controllers are left out.

    Parameters
    ----------
    around
        A typical crossover, rad/s; the grid reaches two decades to either side.
    more
        Frequencies to add, rad/s.
    """
    curves = [curve(structure.fixed * one.plant * one.feedback) for one in loops]
    omega = _frequencies(curves, structure, around, more)
    rest = np.array([c.logarithm(omega) for c in curves])
    sign = math.copysign(1.0, curves[0].gain)
    if sign < 0:  # the controller's gain is negative, too
        rest = rest + 1j * math.pi
    return FamilyGrid(
        structure=structure,
        omega=omega,
        rest=rest,
        fixed=structure.fixed.response(omega),
        feedback=np.array([one.feedback.response(omega) for one in loops]),
        needed_turn=np.array([_needed_turn(c, structure.integrators) for c in curves]),
        nominal=curves[0],
        sign=sign,
    )


def _frequencies(
    curves: Sequence[Curve],
    structure: ControllerStructure,
    around: float,
    more: Iterable[float],
) -> FloatArray:
    low = min(around / 100, structure.slowest / 5)
    high = max(around * 100, structure.fastest * 10)
    count = math.ceil(POINTS_PER_DECADE * math.log10(high / low))
    parts = [np.geomspace(low, high, count), np.array(list(more), dtype=float)]
    for one in curves:
        undamped = one.roots[
            (one.roots.imag > 0) & (np.abs(one.roots.real) < 0.2 * np.abs(one.roots))
        ]
        for root in undamped:
            width = max(abs(root.real), 1e-6 * abs(root))
            parts.append(abs(root) + width * BESIDE_A_RESONANCE)
    omega = np.unique(np.concatenate(parts))
    omega = omega[(omega >= low) & (omega <= high)]
    for one in curves:
        omega = omega[~np.isin(omega, one.undamped())]
    return omega


def _needed_turn(one: Curve, integrators: int) -> float:
    """Return the turn of 1 + L by which Nyquist's criterion says stable."""
    poles = one.roots[one.orders < 0]
    axis = int((poles.real == 0).sum()) + integrators
    return math.pi * (int((poles.real > 0).sum()) + axis / 2)


def _logarithm(
    zeros: ComplexArray, poles: ComplexArray, omega: FloatArray
) -> ComplexArray:
    """Return ln of ``Π(jω - zero) / Π(jω - pole)``, phase continuous, roots stable."""
    above = np.log(1j * omega[:, None] - zeros).sum(axis=1)
    return np.asarray(above - np.log(1j * omega[:, None] - poles).sum(axis=1))
