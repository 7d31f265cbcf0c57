"""Parameters on the page: given, before, after, with intervals, as text and drawn."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from bondgraph.diagnosis.candidates import CURVE
from bondgraph.diagnosis.records import Diagnosis
from bondgraph.fitting.result import Estimate
from bondgraph.reporting.diagnosis_json import delivered
from bondgraph.reporting.page.evidence import Whisker
from bondgraph.reporting.wording import (
    NOTHING,
    blind_words,
    interval_words,
    number_words,
    unit_words,
    with_deviation,
)

EVEN = 50.0
INTERVAL = 1.96  # standard deviations of 95 % of a normal distribution


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """One estimate as text, with its 95 % interval and its place on the row's line."""

    text: str
    interval: str = ""
    whisker: Whisker | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterRow:
    """One parameter: as given, before, after, and in the model handed on.

    ``of_curve`` says that it is a point of a curve without a name, which tells nothing
    by itself.
    """

    name: str
    unit: str
    given: str
    before: Shown
    after: Shown
    everything: Shown
    new: bool
    of_curve: bool = False


def parameter_rows(diagnosis: Diagnosis) -> list[ParameterRow]:
    """Return the parameters of a diagnosis, new ones last."""
    before = {e.name: e for e in diagnosis.fit_before.estimates}
    after = {e.name: e for e in diagnosis.fit_after.estimates}
    everything = {e.name: e for e in delivered(diagnosis).estimates}
    points = {
        estimate.name
        for finding in diagnosis.findings
        if finding.physics == CURVE
        for estimate in finding.estimates
    }
    rows = []
    for name in dict.fromkeys((*before, *after)):
        three = [known.get(name) for known in (before, after, everything)]
        given = next((e.start for e in three if e is not None), None)
        new = name not in diagnosis.model_before.parameters
        shown = _shown(three)
        rows.append(
            ParameterRow(
                name=name,
                unit=unit_words((after.get(name) or before[name]).unit),
                given=NOTHING if new else number_words(given),
                before=shown[0],
                after=shown[1],
                everything=shown[2],
                new=new,
                of_curve=name in points,
            )
        )
    return rows


def _shown(estimates: Sequence[Estimate | None]) -> list[Shown]:
    """Return estimates of one parameter, their whiskers on one common line."""
    spans = [_span(one) for one in estimates]
    ends = [end for span in spans if span is not None for end in span]
    low, high = min(ends, default=0.0), max(ends, default=0.0)
    shown = []
    for one, span in zip(estimates, spans, strict=True):
        if one is None:
            shown.append(Shown(text=NOTHING))
        elif one.std is None:
            shown.append(Shown(text=blind_words(one.value, one.start)))
        else:
            shown.append(_known(one, span, (low, high)))
    return shown


def _known(
    one: Estimate, span: tuple[float, ...] | None, limits: tuple[float, float]
) -> Shown:
    text = with_deviation(one.value, one.std)
    if span is None:
        return Shown(text=text)
    low, high = limits
    places = [100 * (end - low) / (high - low) if high > low else EVEN for end in span]
    interval = "" if one.interval is None else interval_words(*one.interval)
    return Shown(text=text, interval=interval, whisker=Whisker(*places))


def _span(one: Estimate | None) -> tuple[float, float, float] | None:
    """Return low end, value and high end of the 95 % interval, if all are known."""
    if one is None or one.std is None:
        return None
    reach = INTERVAL * one.std
    low, high = one.interval or (one.value - reach, one.value + reach)
    span = (min(low, one.value), one.value, max(high, one.value))
    return span if all(map(math.isfinite, span)) else None
