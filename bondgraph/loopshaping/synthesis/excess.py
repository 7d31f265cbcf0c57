"""How far loops miss a requirement, on a grid, for the optimiser to descend on.

Each is the logarithm that `AbstractRequirement.violation` gives of one exact loop:
negative where the requirement is met. A requirement without a form of its own here, of
a user perhaps, is asked of every loop exactly, which takes longer.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from scipy.special import sici

from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.requirements import (
    AbstractRequirement,
    Assessment,
    Crossover,
    DelayMargin,
    GainMargin,
    NoiseGain,
    PeakComplementary,
    PeakSensitivity,
    PhaseMargin,
)
from bondgraph.loopshaping.synthesis.gridded import GriddedLoops
from bondgraph.loopshaping.synthesis.limits import (
    ActuatorLimit,
    CrossoverAtMost,
    FirstCrossover,
    ModulusMargin,
    PeakNoiseGain,
)
from bondgraph.loopshaping.zero_pole_gain import FloatArray, ZeroPoleGain

LEAST = 1e-3  # of a margin in rad or in ln of a factor: below that it has none
_INSTANTS = np.geomspace(0.01, 30, 40)  # of the command after a step, per crossover


def noise_response(loops: GriddedLoops) -> FloatArray:
    """Return |command per measurement noise| ``[plant, frequency]``."""
    acting = np.abs(loops.controller)[None, :] * np.abs(loops.feedback)
    return np.asarray(acting / np.abs(1 + loops.loop))


def excess(
    requirement: AbstractRequirement,
    loops: GriddedLoops,
    whole: Callable[[], list[Loop]],
) -> FloatArray:
    """Return ``[plant]`` or ``[plant, frequency]``, positive where violated.

    Parameters
    ----------
    whole
        Gives the loops themselves, for requirements that have no form on a grid.
    """
    form = _FORMS.get(type(requirement))
    if form is not None:
        return form(requirement, loops)
    asked = [requirement.violation(Assessment(one)) for one in whole()]
    return np.array(asked)


Form = Callable[[AbstractRequirement, GriddedLoops], FloatArray]


def _phase_margin(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    margin = np.maximum(loops.phase_margins(), LEAST)
    return np.asarray(math.log(math.radians(asked.limit)) - np.log(margin))


def _delay_margin(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    margin = np.maximum(loops.phase_margins(), LEAST)
    late = np.log(margin) - loops.last_crossovers()
    return np.asarray(math.log(asked.limit) - late)


def _gain_margin(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    return np.asarray(math.log(asked.limit) - loops.gain_margins())


def _sensitivity(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    return np.asarray(-np.log(np.abs(1 + loops.loop)) - math.log(asked.limit))


def _modulus(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    return np.asarray(-np.log(np.abs(1 + loops.loop)) + math.log(asked.limit))


def _complementary(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    near = np.log(np.abs(1 + loops.loop))
    return np.asarray(np.clip(loops.size, -200, 200) - near - math.log(asked.limit))


def _first(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    return np.asarray(math.log(asked.limit) - loops.crossovers())


def _last(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    return np.asarray(math.log(asked.limit) - loops.last_crossovers())


def _at_most(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    return -_last(asked, loops)


def _peak_noise(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    return np.asarray(np.log(noise_response(loops)) - math.log(asked.limit))


def _noise(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    if not isinstance(asked, NoiseGain):
        raise TypeError(type(asked))
    place = np.log(max(asked.omega, loops.omega[0]))
    rows = np.log(noise_response(loops))
    here = [np.interp(place, np.log(loops.omega), row) for row in rows]
    return np.array(here) - math.log(asked.limit)


def _command(asked: AbstractRequirement, loops: GriddedLoops) -> FloatArray:
    """Return ``[plant, instant]``.

    The step response is the sine transform of the real part of C/(1 + L), which is
    taken as straight between the frequencies of the grid.
    """
    if not isinstance(asked, ActuatorLimit):
        raise TypeError(type(asked))
    response = (loops.controller[None, :] / (1 + loops.loop)).real
    omega = loops.omega
    times = _INSTANTS / math.exp(float(loops.crossovers()[0]))
    sine = np.asarray(sici(times[:, None] * omega)[0])
    cosine = np.cos(times[:, None] * omega) / times[:, None]
    slope = np.diff(response, axis=1) / np.diff(omega)
    level = response[:, :-1] - slope * omega[:-1]
    value = level @ np.diff(sine, axis=1).T - slope @ np.diff(cosine, axis=1).T
    value += response[:, :1] * sine[:, 0]
    value += response[:, -1:] * (math.pi / 2 - sine[:, -1])
    peak = np.maximum(np.abs(value) * 2 / math.pi, 1e-300)
    return np.asarray(np.log(peak * asked.step / asked.limit))


_FORMS: Mapping[type[AbstractRequirement], Form] = {
    PhaseMargin: _phase_margin,
    DelayMargin: _delay_margin,
    GainMargin: _gain_margin,
    PeakSensitivity: _sensitivity,
    ModulusMargin: _modulus,
    PeakComplementary: _complementary,
    Crossover: _last,
    FirstCrossover: _first,
    CrossoverAtMost: _at_most,
    PeakNoiseGain: _peak_noise,
    NoiseGain: _noise,
    ActuatorLimit: _command,
}


def with_controller(loops: list[Loop], controller: ZeroPoleGain) -> list[Loop]:
    """Return the loops, each with this controller."""
    return [replace(one, controller=controller) for one in loops]
