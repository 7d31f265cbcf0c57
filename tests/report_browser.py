"""A browser for the tests of the report page, and what every page must have."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

playwright = pytest.importorskip(
    "playwright.sync_api", reason="the report page is clicked through with Playwright"
)
CHROMIUM = os.environ.get("BONDGRAPH_CHROMIUM") or next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))),
    None,
)
needs_chromium = pytest.mark.skipif(
    CHROMIUM is None, reason="no Chromium on this machine; BONDGRAPH_CHROMIUM names one"
)
PHONE = {"width": 360, "height": 740}
DESK = {"width": 1280, "height": 900}


@contextmanager
def chromium() -> Iterator[Any]:
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox"]
        )
        yield browser
        browser.close()


@contextmanager
def opened(browser: Any, path: Path, **choices: Any) -> Iterator[Any]:
    """Open a page, offline; what its console says and it asks for is an error."""
    choices.setdefault("viewport", DESK)
    context = browser.new_context(offline=True, **choices)
    page = context.new_page()
    page.set_default_timeout(20_000)
    said: list[str] = []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: said.append(request.url))
    page.goto(path.as_uri())
    yield page
    assert said == [path.as_uri()]
    context.close()


def accessibility_faults(page: Any) -> list[str]:
    """Return what axe-core finds wrong: names, roles, contrast, headings, landmarks."""
    axe = pytest.importorskip(
        "axe_playwright_python", reason="axe-core comes with axe-playwright-python"
    )
    script = Path(axe.__file__).with_name("axe.min.js").read_text("utf-8")
    page.evaluate(script)
    found = page.evaluate("axe.run({resultTypes: ['violations']})")
    return [
        f"{one['id']}: {node['target']} {node['failureSummary']}"
        for one in found["violations"]
        for node in one["nodes"]
    ]
