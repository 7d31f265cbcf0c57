"""Where a look begins: the base model fitted, and fitted otherwise for further looks.

Fitted to whole recordings, what is slow shows. And a parameter that has run away takes
with it what would have shown the way: a store from which a path is missing ends as
large as it may be, and from there nothing promises anything. So it is held, weakly, to
what is stated of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.search.base.between_samples import finely_stepped
from bondgraph.diagnosis.search.base.horizons import sharpened
from bondgraph.diagnosis.search.base.runaway import run_away
from bondgraph.diagnosis.search.options import Options
from bondgraph.errors import FitError
from bondgraph.fitting.either_hold import fitted_either_way
from bondgraph.fitting.estimate import FitSettings, FittedModel, fit_model
from bondgraph.fitting.horizon import Automatic, WholeRecordings
from bondgraph.recordings.binding import BoundRecording
from bondgraph.structure.graph import FinishedGraph

Array = NDArray[np.float64]
RUNAWAY = 10.0
"""A value so many times larger or smaller than is stated has run away."""


def base_fit(
    graph: FinishedGraph,
    recordings: Sequence[BoundRecording],
    settings: FitSettings,
    noise: Array,
    options: Options,
) -> FittedModel:
    """Return the model without additions fitted to recordings, finely stepped.

    Raises
    ------
    FitError
        If it cannot be simulated at all.
    """
    fit = fitted_either_way if options.recordings_decide_hold else fit_model
    base = fit(graph, recordings, settings)
    if not np.isfinite(base.optimum.cost):
        raise FitError(
            f"{graph.name!r} cannot be simulated at its start values.",
            (graph.name,),
            "Give start values nearer to the machine, or bounds that keep it finite.",
        )
    return finely_stepped(base, noise)


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """The model as its author knows it, and what further looks may begin from."""

    graph: FinishedGraph
    recordings: Sequence[BoundRecording]
    noise: Array
    options: Options

    @property
    def settings(self) -> FitSettings:
        """Of further looks: over whole recordings, unless a window is asked for."""
        own = self.options.settings
        automatic = isinstance(own.horizon, Automatic)
        return replace(own, horizon=WholeRecordings()) if automatic else own

    def fitted_again(self, base: FittedModel) -> FittedModel:
        """Return the base model fitted as for further looks, as far as it can be."""
        fits = self.settings.horizon == WholeRecordings()
        windowed = base.problem.shots.n_windows > len(self.recordings)
        if not (fits and windowed):
            return base
        return self._fitted(self.graph) or base

    def as_stated(self, long: FittedModel) -> tuple[FittedModel, ...]:
        """Return the fit with what has run away held to its stated value, weakly."""
        runaway = [
            replace(self.graph.parameters[name], std=abs(value))
            for name, value in run_away(long, RUNAWAY).items()
        ]
        if not runaway:
            return ()
        held = self._fitted(self.graph.with_parameters(runaway))
        return () if held is None else (held,)

    def released(self, final: FittedModel, base: FittedModel) -> FittedModel:
        """Return the model fitted again, holding no more than is stated.

        Parameters
        ----------
        base
            The model without additions from which the look began.
        """
        there = final.graph.with_parameters(final.values)
        stated = [
            replace(one, std=self.graph.parameters[one.name].std)
            for one in there.parameters.members
            if one.name in self.graph.parameters
        ]
        free = there.with_parameters(stated)
        if free.parameters == there.parameters:
            return final
        freed = replace(final, graph=free)
        return sharpened(freed, self.recordings, self.options, base)

    def _fitted(self, graph: FinishedGraph) -> FittedModel | None:
        try:
            return base_fit(
                graph, self.recordings, self.settings, self.noise, self.options
            )
        except FitError:
            return None
