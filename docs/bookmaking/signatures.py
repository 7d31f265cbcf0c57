"""A play drawn: the output with and without the law, and the law over its variable.

Two small pictures as SVG with text as text, to stand in the page itself: what is black
in them takes the colour of the page, so that they can be read in light and dark.
"""

import io
import re

from bookmaking.staging import Play

INK = "#010203"
"""Stands for the colour of the page's text."""
LAW, MODEL = "#b0413e", "#7f8c99"
POINTS = 1500


def course(play: Play, output: str) -> str:
    """Return the course of the output, without and with the law."""
    figure, axes = _axes("time [s]", output)
    axes.plot(*_thin(play.time, play.simple), color=MODEL, linewidth=1.2)
    axes.plot(*_thin(play.time, play.true), color=LAW, linewidth=1.4)
    return _svg(figure)


def curve(play: Play, labels: tuple[str, str], *, cloud: bool = False) -> str:
    """Return the law over its variable, as a line or as the samples alone."""
    figure, axes = _axes(*labels)
    if cloud:
        style = {"linestyle": "", "marker": ".", "markersize": 2.5}
        axes.plot(*_thin(play.across, play.up, 500), color=LAW, **style)
    else:
        axes.plot(*_thin(play.across, play.up), color=LAW, linewidth=1.2)
    return _svg(figure)


def _axes(across: str, up: str):  # type: ignore[no-untyped-def]
    from matplotlib.figure import Figure  # noqa: PLC0415

    figure = Figure(figsize=(4.0, 2.7))
    axes = figure.add_axes((0.2, 0.19, 0.77, 0.77))
    axes.set(xlabel=across, ylabel=up)
    axes.patch.set_alpha(0.0)
    axes.tick_params(colors=INK)
    axes.xaxis.label.set_color(INK)
    axes.yaxis.label.set_color(INK)
    axes.spines[["top", "right"]].set_visible(False)
    for spine in axes.spines.values():
        spine.set_color(INK)
    axes.axhline(0.0, color=INK, linewidth=0.4)
    return figure, axes


def _thin(x, y, points=POINTS):  # type: ignore[no-untyped-def]
    every = max(1, len(x) // points)
    return x[::every], y[::every]


def _svg(figure) -> str:  # type: ignore[no-untyped-def]
    """Return a figure as an SVG element that says the same every time."""
    import matplotlib as mpl  # noqa: PLC0415

    text = io.StringIO()
    choices = {"svg.fonttype": "none", "svg.hashsalt": "bondgraph", "font.size": 10}
    with mpl.rc_context(choices):
        figure.savefig(
            text, format="svg", transparent=True, metadata={"Date": None, "Creator": ""}
        )
    drawn = text.getvalue()
    drawn = drawn[drawn.index("<svg") :]
    drawn = re.sub(r"<metadata>.*?</metadata>", "", drawn, flags=re.S)
    drawn = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", drawn, count=1)
    drawn = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", drawn, count=1)
    drawn = drawn.replace("<svg", '<svg aria-hidden="true"', 1)
    drawn = re.sub(r"font: ([\d.]+)px '[^']*'[^;\"]*", r"font: \1px sans-serif", drawn)
    drawn = re.sub(r"<defs>\s*<style.*?</style>\s*</defs>", "", drawn, flags=re.S)
    drawn = re.sub(r'<g id="[^"]*"', "<g", drawn)
    return re.sub(r"\s*\n\s*", " ", drawn.replace(INK, "currentColor")).strip()
