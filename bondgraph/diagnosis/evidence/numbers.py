"""Whether numbers of a law are told from none."""

from collections.abc import Sequence

ERRORS = 2.0
"""A number within so many standard errors of none is not told from it."""


def none_told(numbers: Sequence[tuple[float, float | None]]) -> bool:
    """Return whether there are numbers, each with its error, and none is told from 0.

    An error that is not known, None or not a number, tells nothing.
    """
    return bool(numbers) and not any(
        std is not None and abs(value) > ERRORS * std for value, std in numbers
    )
