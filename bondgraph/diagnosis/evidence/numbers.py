"""Whether numbers of a law are told from those at which it has no effect."""

from collections.abc import Sequence

ERRORS = 2.0
"""A number within so many standard errors of none is not told from it."""

FACTORS = ("sensor_scale", "input_scale")
"""How numbers begin that have no effect at 1, where others have none at 0."""

FORMS = (
    "mode_frequency",
    "mode_damping",
    "warming_time",
    "recovery_time",
    "fill_time",
    "relaxation_time",
    "induced_time",
    "presliding",
    "moment",
    "ripple_wave",
    "hysteresis_skew",
)
"""How numbers begin that say how something goes, and not that there is any of it."""


def none_told(numbers: Sequence[tuple[str, float, float | None]]) -> bool:
    """Return whether there are numbers, and none is told from having no effect.

    Beside others a form tells nothing: of what does not swing any frequency fits.

    Parameters
    ----------
    numbers
        Each with its name, its value and its error. An error that is not known, None or
        not a number, tells nothing.
    """
    sizes = [one for one in numbers if not one[0].startswith(FORMS)] or numbers
    return bool(sizes) and not any(
        std is not None and abs(value - _no_effect(name)) > ERRORS * std
        for name, value, std in sizes
    )


def _no_effect(name: str) -> float:
    return 1.0 if name.startswith(FACTORS) else 0.0
