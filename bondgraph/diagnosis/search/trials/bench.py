"""A bench: the base model of a round, and the workshop that tries hypotheses on it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bondgraph.diagnosis.candidates import Candidate
from bondgraph.diagnosis.search.base.steps import solver_named
from bondgraph.diagnosis.search.trials.posing import coarse, light, thinned
from bondgraph.diagnosis.search.trials.surrogates import Baseline
from bondgraph.diagnosis.search.trials.trying import Start, Trial, restored
from bondgraph.diagnosis.work.journal import Plain, fingerprint
from bondgraph.diagnosis.work.workers import Work, Workshop
from bondgraph.fitting.estimate import FittedModel


@dataclass(slots=True)
class Bench:
    """The base model of a round and the workshop that tries hypotheses on it."""

    base: FittedModel
    shop: Workshop
    name: str
    few: FittedModel
    id: str

    @classmethod
    def of(cls, base: FittedModel, shop: Workshop, name: str) -> "Bench":
        """Return the bench for a base model; `name` is of the round, for progress."""
        problem = base.problem
        told = fingerprint(
            base.graph, base.optimum.theta, base.optimum.initial, problem.sigma,
            problem.start, problem.shots.time, problem.shots.inputs,
            problem.shots.outputs, problem.shots.edges, base.settings,
        )  # fmt: skip
        return cls(base, shop, name, coarse(thinned(base)), told)

    def run(
        self, work: Work, trials: Sequence[Trial], what: str, *, few: bool = False,
        whole: bool = False,
    ) -> list[Plain]:  # fmt: skip
        """Do a piece of work for every trial, on few data or on all.

        There may be no time for some, but where the `whole` is asked for.
        """
        common = light(self.few if few else self.base)
        return self._run(work, common, trials, what, whole=whole)

    def screen(self, work: Work, trials: Sequence[Trial], what: str) -> list[Plain]:
        """Do a piece of work that needs the base model's residual, on few data."""
        residuals = self.few.optimum.linearisation.residuals
        common = Baseline(light(self.few), residuals)
        return self._run(work, common, trials, what)

    def _run(
        self, work: Work, common: object, trials: Sequence[Trial], what: str, *,
        whole: bool = False,
    ) -> list[Plain]:  # fmt: skip
        keys = [f"{work.__name__} {self.id} {_told(trial)}" for trial in trials]
        step = f"{self.name}: {what}"
        return self.shop.each(work, common, trials, keys, step, whole=whole)

    def candidates(
        self, trials: Sequence[Trial], results: Sequence[Plain]
    ) -> list[Candidate]:
        """Return the fitted models that fits of `trials` have ended in."""
        found = []
        for trial, result in zip(trials, results, strict=True):
            if "refused" not in result:
                fitted = restored(self.base, ended(trial, result))
                more = len(fitted.problem.free) - len(self.base.problem.free)
                found.append(Candidate(trial.hypothesis, fitted, more))
        return found


def _told(trial: Trial) -> str:
    starts = [(sorted(s.values.items()), s.initial) for s in trial.starts]
    states = [np.zeros(0) if initial is None else initial for _, initial in starts]
    values = [v for v, _ in starts]
    solvers = [str(s.solver) for s in trial.starts]
    return fingerprint(
        trial.hypothesis, values, solvers, trial.enough, trial.chunks, *states
    )


def ended(trial: Trial, result: Plain) -> Trial:
    """Return the trial that starts where the fit of another ended."""
    start = Start(
        result["values"], np.array(result["initial"]), solver_named(*result["solver"])
    )
    return Trial(trial.hypothesis, (start,), chunks=trial.chunks)
