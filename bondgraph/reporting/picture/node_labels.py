"""What is written at a node: its letter, its name, and a line in small print.

On the skeleton and above or below it the lines are stacked, the letter nearest to the
bond; beside it they read as in the textbooks, ``I : J_motor``.
"""

from dataclasses import dataclass
from xml.sax.saxutils import escape

from bondgraph.reporting.layout.boxes import Box, LabelSize, Side, text_width

LETTER_SIZE = 17.0
NAME_SIZE = 12.5
SMALL_SIZE = 11.0
LONGEST = 34
_LINES = {"letter": (LETTER_SIZE, 20.0), "name": (NAME_SIZE, 16.0)}
_SMALL = (SMALL_SIZE, 14.0)
_BETWEEN = " : "


@dataclass(frozen=True, slots=True)
class NodeLabel:
    """The texts of a node or sensor."""

    letter: str
    name: str
    small: str = ""

    @property
    def size(self) -> LabelSize:
        """The room it takes, stacked and in one line."""
        widths = [text_width(text, size) for text, _, (size, _) in self._lines()]
        height = 8.0 + sum(line for _, _, (_, line) in self._lines())
        inline = sum(widths) + text_width(_BETWEEN, NAME_SIZE) + 8
        return LabelSize((max(max(widths) + 14, 34.0), height), (inline, 28.0))

    def _lines(self) -> list[tuple[str, str, tuple[float, float]]]:
        lines = [
            (shortened(self.letter), "letter", _LINES["letter"]),
            (shortened(self.name), "name", _LINES["name"]),
        ]
        if self.small:
            lines.append((shortened(self.small), "small", _SMALL))
        return lines

    def svg(self, box: Box, side: Side) -> str:
        """Return the texts set in their box."""
        if side in (Side.LEFT, Side.RIGHT):
            return self._inline(box, side)
        lines = self._lines()
        y = box.top + 4
        parts = []
        for text, css, (size, line) in reversed(lines) if side is Side.ABOVE else lines:
            parts.append(
                f'<text class="{css}" x="{box.x:.1f}" y="{y + 0.76 * line:.1f}" '
                f'font-size="{size:g}">{escape(text)}</text>'
            )
            y += line
        return "".join(parts)

    def _inline(self, box: Box, side: Side) -> str:
        spans = [
            f'<tspan class="{css}" font-size="{size:g}">{escape(text)}</tspan>'
            for text, css, (size, _) in self._lines()
        ]
        spans.insert(1, f'<tspan font-size="{NAME_SIZE:g}">{_BETWEEN}</tspan>')
        if len(spans) > 3:
            spans.insert(3, "<tspan> </tspan>")
        x = box.left + 3
        css = "start"
        if side is Side.LEFT:
            spans, x, css = spans[::-1], box.right - 3, "end"
        return (
            f'<text class="{css}" x="{x:.1f}" y="{box.y + 0.36 * LETTER_SIZE:.1f}" '
            f'font-size="{NAME_SIZE:g}" xml:space="preserve">{"".join(spans)}</text>'
        )


def shortened(text: str) -> str:
    """Return a text that is not too long for a picture."""
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"
