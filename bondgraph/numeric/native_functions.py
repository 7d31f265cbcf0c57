"""Elementary functions that native code calls."""

from collections.abc import Collection


def declarations(called: Collection[str], lanes: int) -> list[str]:
    """Return the lines that make the called functions known."""
    return sorted(called)
