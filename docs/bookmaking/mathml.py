"""Mathematics as MathML, which browsers draw themselves: no script, nothing to load."""

from typing import Any

from docutils import nodes
from latex2mathml.converter import convert


def register(app: Any) -> None:
    """Make ``mathml`` a choice of `html_math_renderer`."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.math_block) -> None:
    drawn = convert(node.astext(), display="block")
    translator.body.append(f'<div class="formula">{drawn}</div>')
    raise nodes.SkipNode
