"""How channels are written: ``name [unit]`` in a file, ``name=channel`` in a map.

A name without brackets has no unit, which is not the same as having the unit 1: what
has no unit is refused later, where the file that lacks it can be named.
"""

import re
from collections.abc import Iterable

from bondgraph.errors import RecordingError

_WITH_UNIT = re.compile(r"^(?P<name>.*?)\s*\[(?P<unit>[^\[\]]*)\]$", re.DOTALL)


def split_header(text: str) -> tuple[str, str | None]:
    """Return the name and the unit of a header such as ``theta [rad]``.

    The unit is None where no brackets are written; empty brackets, ``[-]`` and ``[1]``
    all say dimensionless.
    """
    match = _WITH_UNIT.match(text.strip())
    if match is None:
        return text.strip(), None
    return match["name"].strip(), match["unit"].strip() or "1"


def join_header(name: str, unit: str) -> str:
    """Return the header of a channel, ``name [unit]``."""
    return f"{name} [{unit}]"


def parse_mapping(texts: Iterable[str]) -> dict[str, str]:
    """Return the mapping that a command line spells as ``name=channel`` words.

    Parameters
    ----------
    texts
        Words such as ``theta=joint_angle`` or, where the file has no units (MAT),
        ``position=qm[m]``. The left side is the name in the model, the right side the
        name in the file.

    Raises
    ------
    RecordingError
        If a word is not of that form, or two words give the same name.

    Examples
    --------
    >>> parse_mapping(["time=t[s]", "position=qm[m]"])
    {'time': 't [s]', 'position': 'qm [m]'}
    """
    mapping: dict[str, str] = {}
    for text in texts:
        name, equals, channel = (part.strip() for part in text.partition("="))
        source, unit = split_header(channel)
        if not (name and equals and source) or "[" in name:
            raise RecordingError(
                f"{text!r} does not map a name to a channel.",
                (text,),
                "Write name=channel, as theta=joint_angle, or position=qm[m].",
            )
        if name in mapping:
            raise RecordingError(
                f"{name!r} is mapped twice, to {mapping[name]!r} and {channel!r}.",
                (name,),
                "Keep one of the two.",
            )
        mapping[name] = source if unit is None else join_header(source, unit)
    return mapping
