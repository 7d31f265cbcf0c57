"""The verdict: nothing missing, physics missing, a curve without a name, or unclear.

What is left unexplained is compared with the measurement noise, which is estimated from
the recordings alone.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.decision import CURVE
from bondgraph.diagnosis.records import Finding, Support, Verdict
from bondgraph.diagnosis.search import Round
from bondgraph.diagnosis.wording import name_of
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.noise import estimate_noise

Array = NDArray[np.float64]

ADEQUATE_RATIO = 3.0
"""A residual below this many times the noise floor needs no more explanation."""


def noise_floor(recordings: Sequence[BoundRecording]) -> dict[str, float]:
    """Return the measurement noise of each output, the largest over recordings."""
    return {
        name: max((std for std, _ in _noise(recordings, i)), default=0.0)
        for i, name in enumerate(recordings[0].output_names)
    }


def white_noise(recordings: Sequence[BoundRecording]) -> Array:
    """Return the noise of each output where it is certain: 0 unless it looks white.

    Fast motion looks like noise to an estimate that sees one channel; only where the
    estimate agrees with itself may it excuse a residual.
    """
    certain = [
        [std if white else 0.0 for std, white in _noise(recordings, output)]
        for output in range(len(recordings[0].output_names))
    ]
    return np.array([min(stds, default=0.0) for stds in certain])


def _noise(
    recordings: Sequence[BoundRecording], output: int
) -> list[tuple[float, bool]]:
    estimates = [
        estimate_noise(r.time, r.outputs[:, output]) for r in recordings if not r.steady
    ]
    return [(estimate.std, estimate.white) for estimate in estimates]


def verdict_of(
    findings: Sequence[Finding],
    base: FittedModel,
    floor: Mapping[str, float],
    first: Round,
) -> tuple[Verdict, str]:
    """Return the verdict and the statement that goes with it."""
    told = " ".join(finding.statement for finding in findings)
    if any(finding.physics != CURVE for finding in findings):
        return Verdict.PHYSICS_MISSING, told
    if findings:
        return Verdict.UNEXPLAINED, told
    ratios = residual_over_noise(base, floor)
    worst = max(ratios.values(), default=float("nan"))
    undecided = [j for j in first.judged if j.support is Support.UNDECIDED]
    if undecided and not worst <= ADEQUATE_RATIO:
        names = ", ".join(
            dict.fromkeys(f"{name_of(j.physics)} at {j.place}" for j in undecided[:3])
        )
        return Verdict.CANNOT_TELL, (
            f"These recordings do not decide: {names} would help, but not reliably on "
            "data that were left out."
        )
    if worst > ADEQUATE_RATIO:
        return Verdict.UNEXPLAINED, (
            f"The residual is {worst:.1f} times the measurement noise, and none of the "
            f"{first.tried} candidates explains it on data that were left out."
        )
    return Verdict.ADEQUATE, (
        "Nothing is missing that these recordings could show: "
        f"{_residual_words(worst)}{_tried_words(first.tried)}."
    )


def _residual_words(ratio: float) -> str:
    if np.isnan(ratio):
        return "the noise of a steady table is not known"
    return f"the residual is {ratio:.1f} times the measurement noise"


def _tried_words(tried: int) -> str:
    if not tried:
        return ", and no more than noise is left to explain"
    return (
        f", and none of {tried} candidates improves the prediction of data that were "
        "left out"
    )


def residual_over_noise(
    fitted: FittedModel, floor: Mapping[str, float]
) -> dict[str, float]:
    """Return per output how many times the residual exceeds the noise floor."""
    rms = np.sqrt(np.nanmean(fitted.residuals() ** 2, axis=0))
    names = fitted.problem.model.output_names
    return {
        name: float(size / floor[name])
        for name, size in zip(names, rms, strict=True)
        if floor[name] > 0.0
    }
