"""The report page in a real browser: clicked through, by mouse, touch and keyboard."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from handmade_diagnosis import cart_diagnosis
from report_browser import (
    PHONE,
    accessibility_faults,
    chromium,
    needs_chromium,
    opened,
)

from bondgraph.diagnosis.records import LawCurve, Trace, Verdict
from bondgraph.reporting.report import write_report

pytestmark = needs_chromium

SAMPLES = 1_000_000
SPIKE, NEIGHBOUR = 654_321, 654_300


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as started:
        yield started


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = cart_diagnosis()
    law = found.recovered[0]
    rival = LawCurve(
        physics="viscous_friction", argument=law.curve_argument,
        value=60 * law.curve_argument,
    )  # fmt: skip
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(
        replace(
            found,
            recovered=(replace(law, others=(rival,)),),
            traces=found.traces[:2],
            candidates=tuple(
                replace(one, place=f"{one.place}{k}")
                for k in range(3)
                for one in found.candidates
            ),
        ),
        path,
        command="bondgraph diagnose cart.py bench07.csv",
    )
    return path


@pytest.fixture
def page(browser: Any, report: Path) -> Iterator[Any]:
    with opened(browser, report) as shown:
        yield shown


def view(page: Any) -> tuple[float, float]:
    """Return the stretch of time that is looked at, as the page says it."""
    said = page.locator(".said").first
    said.get_by_text("Showing").wait_for()
    page.wait_for_timeout(350)
    low, high = re.findall(r"\d+(?:\.\d+)?", said.inner_text())
    return float(low), float(high)


def drawn(page: Any, name: str = "measured") -> np.ndarray:
    """Return the points of a line of the first chart, in its square of 1000."""
    path = page.locator(f".plot >> nth=0 >> path[data-series={name}]")
    points = re.findall(r"[ML]([-\d.]+) ([-\d.]+)", path.get_attribute("d"))
    return np.array(points, dtype=float)


def test_buttons_zoom_move_and_show_all_charts_of_a_recording(page: Any) -> None:
    whole = drawn(page)
    page.get_by_role("button", name="Zoom in").click()
    page.get_by_role("button", name="Zoom in").click()
    assert view(page) == pytest.approx((3.0, 5.0), abs=0.01)
    ticks = page.locator(".xaxis").all_inner_texts()[:2]
    assert ticks[0] == ticks[1]
    measured, values = drawn(page), cart_diagnosis().traces[0].measured
    inside = (measured[:, 0] >= 0) & (measured[:, 0] <= 1000)
    assert inside.sum() == pytest.approx(1000, abs=2)  # 2 ms apart: every sample
    centre = measured[np.abs(measured[:, 0] - 500).argmin(), 1]
    assert centre == pytest.approx(
        np.interp(values[2000], values[[values.argmin(), values.argmax()]],
                  [whole[:, 1].max(), whole[:, 1].min()]), abs=2.0,
    )  # fmt: skip
    page.get_by_role("button", name="Later").click()
    assert view(page) == pytest.approx((3.5, 5.5), abs=0.01)
    page.get_by_role("button", name="Show all").click()
    assert view(page) == pytest.approx((0.0, 8.0), abs=0.01)
    assert np.array_equal(drawn(page), whole)


def test_dragging_zooms_and_pointing_reads_the_values(page: Any) -> None:
    plot = page.locator(".plot").first
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    y = box["y"] + 50
    page.mouse.move(box["x"] + 0.25 * box["width"], y)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], y, steps=4)
    page.mouse.up()
    assert view(page) == pytest.approx((2.0, 4.0), abs=0.03)
    page.mouse.move(box["x"] + 0.5 * box["width"], y)
    reading = page.locator(".reading").first
    reading.wait_for(state="visible")
    time, *values = map(
        float, re.findall(r"-?[\d.]+", reading.inner_text().replace("−", "-"))
    )
    trace = cart_diagnosis().traces[0]
    k = round(time / 2e-3)
    assert time == pytest.approx(3.0, abs=0.02)
    expected = [trace.measured[k], trace.before[k], trace.after[k]]
    assert values == pytest.approx(expected, abs=3e-5)


def test_the_keyboard_does_what_the_mouse_does(page: Any) -> None:
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.textContent") == "Skip to the answer"
    plot = page.locator(".plot").first
    plot.focus()
    page.keyboard.press("+")
    page.keyboard.press("ArrowRight")
    assert view(page) == pytest.approx((3.0, 7.0), abs=0.02)
    before = page.locator(".yaxis").first.inner_text()
    page.keyboard.press("f")
    fit = page.get_by_role("button", name="Fit height")
    fit.and_(page.locator("[aria-pressed=true]")).wait_for()
    page.wait_for_function(
        "was => document.querySelector('.yaxis').innerText !== was", arg=before
    )
    page.keyboard.press("Shift+ArrowRight")
    page.locator(".said").first.get_by_text("position at").wait_for()
    page.keyboard.press("0")
    assert view(page) == pytest.approx((0.0, 8.0), abs=0.01)
    assert fit.get_attribute("aria-pressed") == "false"


def test_everything_that_can_be_operated_is_reached_and_seen(page: Any) -> None:
    reached = []
    for _ in range(60):
        page.keyboard.press("Tab")
        kind, width = page.evaluate(
            """() => {const one = document.activeElement;
            return [one.className || one.tagName,
                    parseFloat(getComputedStyle(one).outlineWidth)]}"""
        )
        if kind == "BODY":
            break
        assert width >= 1, kind
        reached.append(kind)
    assert reached.count("plot") == 4
    operable = page.locator(
        "a, button:visible, summary:visible, [tabindex='0']:visible"
    )
    assert len(reached) == operable.count()


def test_the_model_is_copied_offline(browser: Any, report: Path) -> None:
    with opened(browser, report, permissions=["clipboard-read"]) as page:
        button = page.get_by_role("button", name="Copy the model")
        button.click()
        page.get_by_text("Copied.").wait_for()
        copied = page.evaluate("navigator.clipboard.readText()")
        assert copied.strip() == page.locator("#model-text").text_content().strip()
    assert "def model() -> BondGraph:" in copied


def test_what_is_folded_opens_and_is_on_paper(page: Any) -> None:
    more = page.get_by_text("4 more, among them")
    row = page.get_by_role("row", name=re.compile("carriage2")).last
    assert not row.is_visible()
    more.click()
    assert row.is_visible()
    more.click()
    numbers = page.locator("figure:has(.law) table")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert numbers.is_visible()
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert not numbers.is_visible()
    page.emulate_media(media="print", color_scheme="dark")
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert ground == "rgb(255, 255, 255)"
    assert page.pdf(format="A4").startswith(b"%PDF")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_no_fault_of_accessibility_in_either_light(
    browser: Any, report: Path, scheme: str
) -> None:
    with opened(browser, report, color_scheme=scheme) as page:
        page.locator("details").evaluate_all("all => all.forEach(o => o.open = true)")
        assert accessibility_faults(page) == []


def test_light_and_dark_can_be_chosen(page: Any) -> None:
    def colours() -> list[str]:
        return page.evaluate(
            """['body', '.bondgraph .sheet'].map(one => {
            const style = getComputedStyle(document.querySelector(one));
            return one === 'body' ? style.backgroundColor : style.fill})"""
        )

    light = colours()
    page.get_by_role("button", name="Dark").click()
    dark = colours()
    assert all(one != other for one, other in zip(light, dark, strict=True))
    page.get_by_role("button", name="Light").click()
    assert colours() == light


@pytest.mark.parametrize("verdict", list(Verdict))
def test_every_verdict_fits_a_telephone(
    browser: Any, report: Path, tmp_path: Path, verdict: Verdict
) -> None:
    found = cart_diagnosis()
    if verdict is not Verdict.PHYSICS_MISSING:
        nothing = np.array([])
        curve = replace(found.recovered[0], curve_argument=nothing, curve_value=nothing)
        same = tuple(replace(t, after=t.before) for t in found.traces[:1])
        found = replace(
            found,
            verdict=verdict,
            findings=(),
            fit_after=found.fit_before,
            traces=same,
            recovered=(curve,) if verdict is Verdict.UNEXPLAINED else (),
        )
    path = tmp_path / "report.html"
    write_report(found, path)
    with opened(browser, path, viewport=PHONE, has_touch=True) as page:
        page.locator("details").evaluate_all("all => all.forEach(o => o.open = true)")
        assert page.evaluate("document.documentElement.scrollWidth") == 360
        page.get_by_role("button", name="Zoom in").first.tap()
        assert view(page) == pytest.approx((2.0, 6.0), abs=0.01)
        names = page.locator(".plot path.line").evaluate_all(
            "all => [...new Set(all.map(one => one.dataset.series))]"
        )
        assert ("model" in names) is (verdict is not Verdict.PHYSICS_MISSING)


def test_what_was_inserted_is_seen_first_on_a_telephone(
    browser: Any, report: Path
) -> None:
    with opened(browser, report, viewport=PHONE) as page:
        left, right = page.locator(".bondgraph .inserted.element").evaluate(
            "one => (({left, right}) => [left, right])(one.getBoundingClientRect())"
        )
    assert 0 <= left < right <= PHONE["width"]


def test_a_million_samples_keep_every_spike_and_few_points(
    browser: Any, tmp_path: Path
) -> None:
    clock = np.arange(SAMPLES) / 1000.0
    measured = np.sin(clock / 50)
    measured[SPIKE] = 3.0
    measured[NEIGHBOUR] = np.nan
    long = Trace(
        recording="long", channel="position", unit="m", time=clock, measured=measured,
        before=np.zeros(SAMPLES), after=np.sin(clock / 50),
    )  # fmt: skip
    path = tmp_path / "long.html"
    write_report(replace(cart_diagnosis(), traces=(long,)), path)
    with opened(browser, path) as page:
        top = drawn(page)[:, 1].min()
        for width in (400.0, 20.0, 0.5):
            share = (SPIKE / 1000 - width / 3) / clock[-1]
            page.evaluate(
                """([left, width]) => { const one =
                document.querySelector('[data-recording]').recording;
                one.show(1000 * left, 1000 * width); return one.unpack(); }""",
                [share, width / clock[-1]],
            )
            page.wait_for_timeout(100)
            points = drawn(page)
            assert len(points) < 2500
            assert points[:, 1].min() == pytest.approx(top, abs=0.2)
        # Looked at so closely every sample is there, and the one missing is a gap.
        path_text = page.locator(".plot path[data-series=measured]").first
        assert path_text.get_attribute("d").count("M") == 2
        assert np.diff(points[:, 0]).max() == pytest.approx(4.0, abs=0.1)
