"""Colours and type of a picture, for light paper, dark screens, or whichever is read.

Every rule begins with ``.bondgraph``, so that a picture inside a page or notebook never
restyles what is around it.
"""

from dataclasses import dataclass
from enum import StrEnum

FONTS = '"Segoe UI","Helvetica Neue",Arial,"Liberation Sans","DejaVu Sans",sans-serif'

# An I without serifs is a bar, which here would read as a causal stroke.
SERIFS = 'Georgia,"Times New Roman","Liberation Serif","DejaVu Serif",serif'


class Theme(StrEnum):
    """Which colours a picture has; ``auto`` follows the reader's screen."""

    AUTO = "auto"
    LIGHT = "light"
    DARK = "dark"


@dataclass(frozen=True, slots=True)
class _Palette:
    paper: str
    ink: str
    quiet: str  # small print
    junction: str
    border: str
    blame: str
    inserted: str
    derivative: str
    chosen: str
    preferred: str
    unmet: str
    signal: str


_LIGHT = _Palette(
    paper="#ffffff",
    ink="#1f2328",
    quiet="#4d5761",
    junction="#eef2f7",
    border="#7b8896",
    blame="#e8590c",
    inserted="#0757ad",
    derivative="#b3123f",
    chosen="#8a5300",
    preferred="#2c6b23",
    unmet="#c2185b",
    signal="#6a3fa5",
)
_DARK = _Palette(
    paper="#171b21",
    ink="#e8ebef",
    quiet="#aeb8c4",
    junction="#242c36",
    border="#7d8b9b",
    blame="#ff7a2f",
    inserted="#7cbcff",
    derivative="#ff7d9d",
    chosen="#e3b25c",
    preferred="#83cf76",
    unmet="#ff6fb1",
    signal="#bd9bff",
)

_FORM = f"""
.bondgraph text{{font-family:{FONTS};text-anchor:middle}}
.bondgraph .letter{{font-family:{SERIFS};font-weight:700}}
.bondgraph .variable{{font-family:{SERIFS};font-style:italic}}
.bondgraph .start{{text-anchor:start}}
.bondgraph .end{{text-anchor:end}}
.bondgraph .junction rect.body{{stroke-width:1.2}}
.bondgraph path{{fill:none;stroke-width:1.5;stroke-linecap:round;stroke-linejoin:round}}
.bondgraph path.causal{{stroke-width:3;stroke-linecap:butt}}
.bondgraph .inserted.bond path{{stroke-width:2}}
.bondgraph .inserted.bond path.causal{{stroke-width:3}}
.bondgraph rect.mark{{fill:none;stroke-width:2;stroke-dasharray:5 3}}
.bondgraph .signal path{{stroke-width:1.1}}
"""


def _colours(palette: _Palette) -> str:
    rules = [
        f".bondgraph .sheet{{fill:{palette.paper}}}",
        f".bondgraph text{{fill:{palette.ink}}}",
        f".bondgraph .small,.bondgraph .number{{fill:{palette.quiet}}}",
        f".bondgraph .junction rect.body{{fill:{palette.junction};"
        f"stroke:{palette.border}}}",
        f".bondgraph rect.blame{{fill:{palette.blame}}}",
        f".bondgraph path{{stroke:{palette.ink}}}",
    ]
    for mark, colour in (
        ("chosen", palette.chosen),
        ("derivative", palette.derivative),
        ("preferred", palette.preferred),
        ("unmet", palette.unmet),
        ("inserted", palette.inserted),
        ("signal", palette.signal),
        ("sensor", palette.signal),
    ):
        rules.append(
            f".bondgraph .{mark} path{{stroke:{colour}}}"
            f".bondgraph .{mark} text{{fill:{colour}}}"
        )
    rules.append(f".bondgraph rect.mark{{stroke:{palette.inserted}}}")
    return "\n".join(rules)


def style(theme: Theme) -> str:
    """Return the style sheet of a picture."""
    if theme is Theme.DARK:
        return _FORM + _colours(_DARK)
    light = _FORM + _colours(_LIGHT)
    if theme is Theme.LIGHT:
        return light
    return (
        f"{light}\n@media screen and (prefers-color-scheme:dark){{{_colours(_DARK)}}}\n"
        "@media print{.bondgraph .sheet{fill:none}}"
    )
