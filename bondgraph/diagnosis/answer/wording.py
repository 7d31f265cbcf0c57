"""The sentences of a diagnosis, in the words of the field."""

import math
from collections.abc import Mapping, Sequence

from bondgraph.diagnosis.evidence.judged import Judged
from bondgraph.diagnosis.experiment.records import Experiment
from bondgraph.diagnosis.records import Finding
from bondgraph.fitting.estimate import FittedModel
from bondgraph.fitting.result import Estimate
from bondgraph.physics.hypothesis import Hypothesis
from bondgraph.physics.names import name_with
from bondgraph.structure.domains import ROTATION, TRANSLATION
from bondgraph.structure.mirror import mirror_images
from bondgraph.structure.units import plain_unit

SURE, UNSURE = "was left out", "may have been left out"
"""What is said of a finding, and of one that is less probable than not."""

WEAK = 0.25
"""An effect that explains less than this share of the error is called weak."""

DIGITS = 1e-15
"""A deviation below this share of a number lies beyond its last digit."""

LONG = 6
"""Numbers with more digits before the point are told with a power of ten."""

PROPORTION = "known in proportion to the model's own numbers only"


def value_with_error(estimate: Estimate, in_proportion: Sequence[str] = ()) -> str:
    """Return ``value ± std unit`` with as many digits as the error allows."""
    unit = unit_after(estimate.unit)
    if estimate.name in in_proportion:
        return f"{estimate.value:.4g}{unit}, {PROPORTION}"
    if estimate.std is None:
        return f"{estimate.value:.4g}{unit} (not determined by these recordings)"
    return f"{to_digits_of(estimate.value, estimate.std)}{unit}"


def unit_after(unit: str) -> str:
    """Return a unit as it stands behind a number, nothing where there is none."""
    return "" if unit == "1" else f" {plain_unit(unit)}"


def to_digits_of(value: float, std: float) -> str:
    """Return ``value ± std``, both to the second digit of the standard deviation."""
    size = max(abs(value), std)
    if not (DIGITS * abs(value) < std < math.inf and size < math.inf):
        return f"{value:.4g} ± {std:.2g}"
    power = math.floor(math.log10(size))
    if -4 <= power < LONG:
        power = 0
    places = max(0, 1 - math.floor(math.log10(std / 10.0**power)))
    both = " ± ".join(f"{number / 10.0**power:.{places}f}" for number in (value, std))
    return f"({both})e{power}" if power else both


def finding_statement(
    chosen: Judged,
    places: Sequence[str],
    others: Sequence[Judged],
    estimates: Sequence[Estimate],
    in_proportion: Sequence[str] = (),
) -> str:
    """Return what was left out, where, how much, and what it may be instead."""
    hypothesis = chosen.candidate.told
    numbers = ", ".join(
        f"{estimate.name} = {value_with_error(estimate, in_proportion)}"
        for estimate in estimates
    )
    if chosen.physics == "unknown_relation":
        opening = (
            f"A relation is missing at {chosen.place} that has no name here: "
            f"{hypothesis.words}; the curve shows it."
        )
        numbers = ""
    else:
        values = {estimate.name: estimate.value for estimate in estimates}
        name = name_with(values, chosen.physics, chosen.domain)
        opening = f"{_capital(name)} {_where(hypothesis)} {SURE}: {hypothesis.words}"
    text = f"{opening} ({numbers})." if numbers else f"{opening.rstrip('.')}."
    if places:
        text += f" These recordings do not tell {chosen.place} from {listed(places)}."
    other_laws = dict.fromkeys(j.name for j in others if j.physics != chosen.physics)
    if other_laws:
        text += f" It cannot be told apart here from {listed(tuple(other_laws))}."
    if chosen.gain.value < WEAK:
        text += (
            f" It is weak: it explains {100 * chosen.gain.value:.0f} % of the error."
        )
    return text


def _where(hypothesis: Hypothesis) -> str:
    """Return where a law sits: at a place, or between two."""
    if hypothesis.other_end:
        return f"between {hypothesis.place} and {hypothesis.other_end}"
    return f"at {hypothesis.place}"


def hedged(statement: str) -> str:
    """Return a finding's statement as one of what is less probable than not."""
    return statement.replace(f" {SURE}: ", f" {UNSURE}: ", 1)


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def listed(names: Sequence[str], word: str = "or") -> str:
    """Return names as a sentence lists them, `word` before the last."""
    if len(names) == 1:
        return names[0]
    return f"{', '.join(names[:-1])} {word} {names[-1]}"


def next_experiment(
    findings: Sequence[Finding],
    others: Mapping[str, Sequence[Judged]],
    base: FittedModel,
    designed: Experiment | None = None,
) -> str:
    """Return the experiment that would separate what could not be told apart.

    Parameters
    ----------
    designed
        The input to play, where one was designed.
    """
    advice: list[str] = []
    for finding in findings:
        close = others.get(finding.element, ())
        advice += _separate_laws(finding, close, base)
        if finding.indistinguishable_places:
            advice += _separate_places(finding, base)
    if designed is not None:
        advice.append(designed.statement)
    return " ".join(dict.fromkeys(advice))


def _separate_places(finding: Finding, base: FittedModel) -> list[str]:
    """Return what would tell a finding's place from those that it may be at as well."""
    place, others = finding.place, finding.indistinguishable_places
    images = {image.of(place) for image in mirror_images(base.graph)}
    changed = [other for other in others if other in images]
    alike = [other for other in others if other not in images]
    advice = [_separate_alike((place, *alike), base)] if alike else []
    if changed:
        advice.append(
            f"To tell {' and '.join((place, *changed))} apart, measure at one of them, "
            "or state a value that one has and the other has not."
        )
    return advice


def _separate_alike(alike: Sequence[str], base: FittedModel) -> str:
    sensors = [name for name in alike if not base.graph.has_place(name)]
    if sensors:
        return (
            f"To tell {' and '.join(alike)} apart, compare {listed(sensors)} with a "
            "reference that is known to read right."
        )
    domain = base.graph.domain_at(alike[0])
    moving = domain in (TRANSLATION, ROTATION)
    return (
        f"To tell {' and '.join(alike)} apart, measure the {domain.effort} on a bond "
        "between them"
        + ("; no motion sensor can while they move together." if moving else ".")
    )


def _separate_laws(
    finding: Finding, close: Sequence[Judged], base: FittedModel
) -> list[str]:
    words = {finding.physics, *(j.physics for j in close)}
    advice = []
    if "load_dependent_friction" in words and len(words) > 1:
        loads = dict.fromkeys(
            variable
            for j in close
            for variable in j.candidate.hypothesis.depends_on
            if variable.startswith("effort(")
        )
        what = f" ({', '.join(loads)})" if loads else ""
        advice.append(
            f"Repeat the recording with a different load{what}, at least doubled: "
            "friction that grows with the load changes in proportion, constant and "
            "direction-dependent friction do not."
        )
    if "stribeck_friction" in words and len(words) > 1:
        advice.append(
            "Record slow motion through zero speed, below a tenth of the speeds seen "
            "so far: only Stribeck friction rises there."
        )
    if {"quadratic_drag", "viscous_friction"} & words and len(words) > 1:
        advice.append(
            "Record at twice the speed: linear, quadratic and constant laws part there."
        )
    if {"spring", "hardening_spring", "gravity"} & words and len(words) > 1:
        advice.append("Record over a larger range of displacement.")
    variables = _known_variables(close, base)
    if not advice and len(words) > 1 and variables:
        advice.append(
            "Record a larger range of the variables these laws depend on: "
            f"{', '.join(variables)}."
        )
    return advice


def _known_variables(close: Sequence[Judged], base: FittedModel) -> list[str]:
    """Return what laws depend on, as far as the user's model has it too."""
    found = []
    for judged in close:
        for variable in judged.candidate.hypothesis.depends_on:
            quantity, _, elsewhere = variable.rstrip(")").partition("(")
            place = elsewhere or judged.place
            if base.graph.has_place(place):
                found.append(f"{quantity} at {place}")
    return list(dict.fromkeys(found))
