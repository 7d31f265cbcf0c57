"""How answers are put into words and numbers, the same on paper and in the terminal."""

import math

from bondgraph.diagnosis.records import Diagnosis, Verdict
from bondgraph.fitting.result import Score
from bondgraph.structure.units import plain_unit

VERDICTS = {
    Verdict.ADEQUATE: "Nothing is missing",
    Verdict.PHYSICS_MISSING: "Physics is missing",
    Verdict.UNEXPLAINED: "Something is missing that no known law explains",
    Verdict.CANNOT_TELL: "These recordings cannot tell",
}
FOUND_WANTING = "Something is missing, and what was found does not explain it"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
NOTHING = "–"
BEYOND = 100.0
"""A share beyond it says that it is large, and nothing else."""

DIGITS = 1e-15
"""A deviation below this share of a number lies beyond its last digit."""


def headline(diagnosis: Diagnosis) -> str:
    """Return the verdict in a few words; laws that fall short are told as such."""
    named = any(one.physics != "unknown_relation" for one in diagnosis.findings)
    if diagnosis.verdict is Verdict.UNEXPLAINED and named:
        return FOUND_WANTING
    return VERDICTS[diagnosis.verdict]


def sentence_start(text: str) -> str:
    """Return `text` with its first letter raised and the others as they are."""
    return text[:1].upper() + text[1:]


def percent(share: float | None) -> str:
    """Return a share in per cent, three digits; a dash where there is no number."""
    if share is None or not math.isfinite(share):
        return NOTHING
    if share > BEYOND:
        return f"more than {100 * BEYOND:g} %"  # An unstable model runs away.
    return f"{number_words(100 * share, 3)} %"


def relative_error(score: Score, of: str) -> str:
    """Return a score in per cent `of` something, and which channels do not count."""
    share = f"{percent(score.nrmse)} of {of}"
    if not score.unchanging:
        return share
    resting = f"without {' and '.join(score.unchanging)}: recorded as one value only"
    if len(score.unchanging) == len(score.rmse):
        return f"no share of {of}, which never changes"
    return f"{share} ({resting})"


def number_words(value: float | None, digits: int = 4) -> str:
    """Return a number to read, with `digits` significant digits."""
    if value is None or math.isnan(value):
        return NOTHING
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    return _typeset(f"{value:.{digits}g}")


HIDES = 10.0
"""A deviation so many times the value leaves it no digit but one: each is written."""

RUN_AWAY = 1e6
"""A value so many times its start, or its start so many times it, has run away."""


def with_deviation(value: float, std: float | None) -> str:
    """Return ``value ± std``, rounded to two digits of the standard deviation."""
    if std is None or not math.isfinite(std) or not math.isfinite(value):
        return number_words(value)
    if std <= DIGITS * abs(value):
        return number_words(value, 6)
    if value and std > HIDES * abs(value):
        return f"{number_words(value)} ± {number_words(std, 2)}"
    size = max(abs(value), std)
    power = math.floor(math.log10(size))
    if -4 <= power < 6:
        power = 0
    places = max(0, 1 - math.floor(math.log10(std / 10.0**power)))
    texts = (f"{x / 10.0**power:.{places}f}" for x in (value, std))
    both = " ± ".join(_typeset(text) for text in texts)
    return f"({both})·10{str(power).translate(_SUPERSCRIPT)}" if power else both


def blind_words(value: float, start: float | None) -> str:
    """Return a value that nothing determines, in words where it has run away."""
    size = abs(value / start) if start else 1.0
    if size > RUN_AWAY:
        return "has grown without bound (not identifiable)"
    if size < 1.0 / RUN_AWAY:
        return "has shrunk to nothing (not identifiable)"
    return f"{number_words(value)} (not identifiable)"


def interval_words(low: float, high: float) -> str:
    """Return ``low to high`` with digits enough to tell the two apart, to a tenth."""
    size, width = max(abs(low), abs(high)), abs(high - low)
    digits = 4
    if math.isfinite(size) and width > 0:
        digits = max(2, 2 + math.ceil(math.log10(size / width)))
    return " to ".join(number_words(end, min(digits, 12)) for end in (low, high))


def with_unit(text: str, unit: str) -> str:
    """Return a number's text with its unit, which is left out for pure numbers."""
    return text if unit in {"", "1"} else f"{text} {unit_words(unit)}"


def unit_words(unit: str) -> str:
    """Return a unit to read: ``N·m/rad``, ``kg·m²``."""
    text = plain_unit(unit).replace("**", "^").replace("*", "·")
    for power in ("^-1", "^-2", "^-3", "^2", "^3", "^4"):
        text = text.replace(power, power[1:].translate(_SUPERSCRIPT))
    return text


def _typeset(text: str) -> str:
    """Return a printed number with a real minus and powers of ten."""
    mantissa, _, exponent = text.partition("e")
    mantissa = mantissa.replace("-", "−")
    if not exponent:
        return mantissa
    return f"{mantissa}·10{str(int(exponent)).translate(_SUPERSCRIPT)}"
