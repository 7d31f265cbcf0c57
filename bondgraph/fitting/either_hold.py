"""Inputs between samples, held or joined by lines: as fits the model better.

Which of the two it is few recordings say. Half a sample of delay would else be found as
physics.
"""

from collections.abc import Sequence
from dataclasses import replace

from bondgraph.fitting.estimate import fit_model
from bondgraph.fitting.fine_steps import simulated_as
from bondgraph.fitting.fitted import FittedModel
from bondgraph.fitting.settings import FitSettings
from bondgraph.fitting.simulate import Solution, SolveStatus, simulate
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.commands import go_in_steps
from bondgraph.simulation.solvers import Hold
from bondgraph.structure.graph import FinishedGraph

FITS_BETTER = 0.98
"""The other way inputs can behave must leave less than this share of the error."""


def fitted_either_way(
    graph: FinishedGraph, recordings: Sequence[BoundRecording], settings: FitSettings
) -> FittedModel:
    """Return the model fitted with inputs joined by lines or held, as fits better.

    Where both fit alike, held if they stay the same from most samples to the next: so
    does a command that goes in steps.
    """
    if go_in_steps(recordings):
        settings = replace(settings, hold=Hold.ZERO)
    own = fit_model(graph, recordings, settings)
    if not own.problem.model.input_names or not own.problem.model.n_states:
        return own
    changed = replace(settings, hold=settings.hold.other)
    rival = fit_model(graph, recordings, changed, sigma=own.problem.sigma)
    return rival if rival.optimum.cost < FITS_BETTER * own.optimum.cost else own


def held_as_fits(fitted: FittedModel) -> FittedModel:
    """Return the model with inputs held or joined, as fits better from where it is.

    What a base model leaves hides a difference that shows once it has been explained.
    """
    if not fitted.problem.model.input_names or not fitted.problem.model.n_states:
        return fitted
    rival = simulated_as(fitted, fitted.problem.solver, fitted.problem.hold.other)
    return rival if rival.optimum.cost < FITS_BETTER * fitted.optimum.cost else fitted


def simulated_either_way(
    graph: FinishedGraph, recording: BoundRecording, settings: FitSettings
) -> tuple[Solution, Hold | None]:
    """Return the run with inputs joined by lines or held, as comes nearer, and which.

    Where both come as near, held if they stay the same from most samples to the next.
    None where no input drives a state.
    """
    expected = Hold.ZERO if go_in_steps([recording]) else settings.hold
    own = simulate(graph, recording, settings=replace(settings, hold=expected))
    if not recording.input_names or not own.runs[0].state_names:
        return own, None
    changed = replace(settings, hold=expected.other)
    rival = simulate(graph, recording, settings=changed)
    ran = rival.status is SolveStatus.SUCCESSFUL
    if own.status is SolveStatus.FAILED:
        return (rival, changed.hold) if ran else (own, expected)
    nearer = ran and _of_squares(rival, own) < FITS_BETTER
    return (rival, changed.hold) if nearer else (own, expected)


def _of_squares(rival: Solution, own: Solution) -> float:
    """Return which share of its squared error an output keeps in the mean.

    Each output is measured by what it misses, as in a fit: what is known to little
    would else hide what is known well.
    """
    before, after = own.score.rmse, rival.score.rmse
    shares = [(after[name] / size) ** 2 for name, size in before.items() if size > 0.0]
    return sum(shares) / len(shares) if shares else 1.0
