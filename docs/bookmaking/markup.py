"""What Sphinx and its theme write for the eye alone is written for a reader as well.

A parameter list of several lines is a description list of descriptions without terms,
and the arrow that unfolds a part of the navigation has no name: screen readers stumble
over both. What scrolls sideways has to be reached by the keyboard.
"""

import re
from pathlib import Path
from typing import Any

_LINES = re.compile(
    r'\n\n<dl>\n((?:<dd><em class="sig-param">.*?</em>,</dd>\n)+)</dl>\n\n'
)
_LINE = re.compile(r"<dd>(.*?)</dd>\n")
_UNFOLD = re.compile(
    r"(<a[^>]*>)([^<]*)(</a><details[^>]*>)<summary>(?=<span class=.toctree-toggle)"
)


def mend_all(app: Any, exception: Exception | None) -> None:
    """Mend every page that was written."""
    if exception is not None or app.builder.format != "html":
        return
    for path in Path(app.outdir).rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        mended = mend(text)
        if mended != text:
            path.write_text(mended, encoding="utf-8")


def mend(text: str) -> str:
    """Return a page whose signatures and navigation can be read aloud."""
    text = _LINES.sub(
        lambda all_: _LINE.sub(r'<span class="sig-line">\1</span>', all_[1]), text
    )
    return _UNFOLD.sub(r'\1\2\3<summary aria-label="Pages below \2">', text)
