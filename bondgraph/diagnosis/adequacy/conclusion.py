"""From numbers to the answer: which status, and the sentences that go with it."""

from collections.abc import Sequence

from bondgraph.diagnosis.adequacy.records import (
    Adequacy,
    AdequacyStatus,
    Dependence,
    OutputCheck,
)
from bondgraph.fitting.estimate import FittedModel

UNCONVERGED = 0.05
LARGE = 1.5
"""A residual more than so many times the white noise is coloured or a disturbance."""


def too_few(fitted: FittedModel, residuals: int, level: float) -> Adequacy:
    """Return the answer where a fit leaves too few residuals to judge."""
    return Adequacy(
        status=AdequacyStatus.TOO_FEW_SAMPLES,
        p_value=1.0,
        level=level,
        draws=0,
        outputs=(),
        dependences=(),
        unconverged=0.0,
        reasons=(
            f"{residuals} residuals are left of a fit with "
            f"{len(fitted.optimum.theta)} parameters.",
        ),
    )


def conclude(
    found: Sequence[Dependence],
    checks: tuple[OutputCheck, ...],
    p_value: float,
    level: float,
    draws: int,
    promise: float,
    fitted: FittedModel,
) -> Adequacy:
    """Return the record with its status and reasons."""
    reasons = []
    if found:
        first = found[0]
        reasons.append(
            f"Of {len(found)} families the residual follows {first.form} "
            f"{first.variable} at {first.place} most surely: {100 * first.share:.2g} % "
            "of it; noise like the residual's own does as well with chance "
            f"{p_value:.2g}."
        )
    coloured = [c for c in checks if _is_coloured(c, level)]
    status = AdequacyStatus.ADEQUATE
    if not fitted.optimum.converged and promise > UNCONVERGED:
        status = AdequacyStatus.NOT_CONVERGED
        reasons.append(
            f"A further step of the fit promises {100 * promise:.2g} % less."
        )
    elif found and p_value <= level:
        status = AdequacyStatus.STRUCTURE
    elif coloured:
        status = AdequacyStatus.COLOURED
    reasons += [_words(check) for check in coloured]
    return Adequacy(
        status=status,
        p_value=p_value,
        level=level,
        draws=draws,
        outputs=checks,
        dependences=tuple(found),
        unconverged=promise,
        reasons=tuple(reasons),
    )


def _is_coloured(check: OutputCheck, level: float) -> bool:
    unwhite = check.white_p_value is not None and check.white_p_value <= level
    large = check.noise_is_white and check.ratio is not None and check.ratio > LARGE
    return unwhite or large


def _words(check: OutputCheck) -> str:
    size = "" if check.ratio is None else f", {check.ratio:.2g} times the white noise"
    return (
        f"The residual of {check.name} is {check.residual:.3g} {check.unit}{size}; "
        f"from one sample to the next it correlates by {check.correlation:.2g}."
    )
