"""The site in a real browser, as it was last built: wide and narrow, light and dark.

sphinx-build -q -W --keep-going -d build/doctrees docs build/site
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from report_browser import DESK, PHONE, accessibility_faults, chromium, needs_chromium

SITE = Path(__file__).parent.parent / "build" / "site"
PAGES = (
    "index.html",
    "command_line.html",
    "cookbook/generated/coulomb_friction.html",
    "tutorials/first_bond_graph.html",
    "reference/generated/structure.html",
)
OWN_NOTES = "[PST]"  # the theme notes on the console which light it has chosen

pytestmark = [
    needs_chromium,
    pytest.mark.skipif(
        not (SITE / "index.html").exists(), reason="the site has not been built"
    ),
]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as started:
        yield started


@pytest.mark.parametrize(
    ("width", "scheme"), [(DESK, "light"), (PHONE, "dark")], ids=["desk", "phone"]
)
@pytest.mark.parametrize("name", PAGES)
def test_a_page_is_read_by_everybody_and_from_a_folder(
    browser: Any, name: str, width: dict[str, int], scheme: str
) -> None:
    context = browser.new_context(offline=True, viewport=width, color_scheme=scheme)
    page = context.new_page()
    said: list[str] = []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("requestfailed", lambda request: said.append(request.url))
    page.goto((SITE / name).as_uri())
    assert [one for one in said if not one.startswith(OWN_NOTES)] == []
    assert page.evaluate("document.documentElement.dataset.theme") == scheme
    sideways = page.evaluate("document.documentElement.scrollWidth - innerWidth")
    assert sideways <= 0
    assert accessibility_faults(page) == []
    context.close()


def test_a_page_loads_nothing_from_elsewhere() -> None:
    loaded = re.compile(
        r"<(?:link|script|img|iframe)\b[^>]*(?:href|src)=\"(https?:[^\"]+)"
    )
    for page in SITE.rglob("*.html"):
        assert loaded.findall(page.read_text(encoding="utf-8")) == [], page.name
