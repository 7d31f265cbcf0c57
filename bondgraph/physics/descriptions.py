"""What is to be said of a law beyond its formula: when it is met, and taken for what.

The words stand in ``descriptions.toml``, one table per law of the library, so that
pages and reports say the same.
"""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from bondgraph.physics.hypothesis import AbstractPhysics


@dataclass(frozen=True, slots=True, kw_only=True)
class Confusion:
    """Another law that recordings may not tell from this one.

    Parameters
    ----------
    other
        The name of its class.
    when
        In which recordings the two look alike.
    apart
        What to measure or to do so that they do not.
    """

    other: str
    when: str
    apart: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Description:
    """A law in words.

    Parameters
    ----------
    title
        What an engineer calls it.
    about
        What it is and where it is met.
    look
        What to look at where its signature is drawn.
    confusions
        What it is taken for.
    sources
        Where to read on, as Markdown.
    real
        Real recordings in which it was found; empty where there are none.
    """

    title: str
    about: str
    look: str
    confusions: tuple[Confusion, ...]
    sources: tuple[str, ...]
    real: str = ""


def describe(physics: AbstractPhysics) -> Description | None:
    """Return what is said of a law; None of one that is not in the library."""
    found = _tables().get(type(physics).__name__)
    if found is None:
        return None
    cited = _tables()["sources"]
    return Description(
        title=found["title"],
        about=found["about"],
        look=found["look"],
        confusions=tuple(
            Confusion(other=c["with"], when=c["when"], apart=c["apart"])
            for c in found["confused"]
        ),
        sources=tuple(cited[key] for key in found["sources"]),
        real=found.get("real", ""),
    )


@cache
def _tables() -> dict[str, dict[str, Any]]:
    text = files("bondgraph.physics").joinpath("descriptions.toml").read_text("utf-8")
    return tomllib.loads(text)
