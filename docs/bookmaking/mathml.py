"""Mathematics as MathML, which browsers draw themselves: no script, nothing to load."""

import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert


def register(app: Any) -> None:
    """Make ``mathml`` a choice of `html_math_renderer`."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))


def _readable(tex: str) -> str:
    """Return TeX whose upright words are words, and not letters one after another."""
    return re.sub(
        r"\\mathrm\{((?:[^{}\\]|\\,){2,})\}",
        lambda found: rf"\text{{{found[1].replace(chr(92) + ',', ' ')}}}",
        tex,
    )


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(convert(_readable(node.astext())))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.math_block) -> None:
    drawn = convert(_readable(node.astext()), display="block")
    translator.body.append(f'<div class="formula" tabindex="0">{drawn}</div>')
    raise nodes.SkipNode
