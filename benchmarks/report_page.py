"""How a report page with long recordings behaves in a browser: size, unpacking, zoom.

    python -m benchmarks.report_page [SAMPLES]

Writes a page with one output of SAMPLES samples (a million), opens it in Chromium, and
measures there: the time to unpack it when it is looked at closely first, and the time
to draw each of a hundred views from the whole recording down to a thousandth of it. The
CPU time is that of all the browser's processes, painting included.
"""

import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from bondgraph import BondGraph, I, R, Se, report_html
from bondgraph.diagnosis.records import Comparison, Diagnosis, Trace, Verdict
from bondgraph.fitting.result import FitResult, FitStatus, Score

UNPACK = """async () => {
  const one = document.querySelector('[data-recording]').recording;
  const at = performance.now();
  one.show(400, 200);
  await one.unpack();
  await new Promise(requestAnimationFrame);
  return performance.now() - at;
}"""
VIEWS = 100
MOVE = """async (views) => {
  const one = document.querySelector('[data-recording]').recording;
  const frame = () => new Promise(requestAnimationFrame);
  const painted = [];
  for (let k = 0; k < views; k += 1) {
    const width = 1000 * 0.001 ** (k / (views - 1));
    const at = performance.now();
    one.show(300 + k, width);
    await frame(); await frame();
    painted.push(performance.now() - at);
  }
  return painted;
}"""


def long_diagnosis(samples: int) -> Diagnosis:
    """Return an answer about a cart with one long recording of sines and noise."""
    cart = BondGraph("cart", domain="translation")
    cart.one("carriage", Se("force"), I("mass"), R("viscous"))
    cart.measure("speed", flow="carriage")
    clock = np.arange(samples) / 1000.0
    truth = np.sin(clock) + 0.3 * np.sin(7.3 * clock)
    noise = 0.05 * np.random.default_rng(1).standard_normal(samples)
    score = Score(nrmse=0.05, rmse={"speed": 0.05})
    fit = FitResult(
        status=FitStatus.CONVERGED,
        model=cart.finish(),
        estimates=(),
        score=score,
        cost=1.0,
        iterations=1,
        window=1.0,
    )
    trace = Trace(
        recording="long",
        channel="speed",
        unit="m/s",
        time=clock,
        measured=truth + noise,
        before=np.sin(clock),
        after=truth,
    )
    return Diagnosis(
        verdict=Verdict.ADEQUATE,
        statement="Nothing is missing.",
        findings=(),
        train=Comparison(before=score, after=score),
        held_out=Comparison(before=score, after=score),
        noise_floor={"speed": 0.05},
        false_alarm_probability=0.01,
        next_experiment="",
        candidates=(),
        blame={},
        fit_before=fit,
        fit_after=fit,
        traces=(trace,),
    )


def main() -> None:
    samples = int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000
    started = time.process_time()
    html = report_html(long_diagnosis(samples))
    print(f"samples             {samples}")
    print(f"page made in        {time.process_time() - started:.1f} s of CPU time")
    print(f"page                {len(html) / 1e6:.1f} MB")
    from playwright.sync_api import sync_playwright  # noqa: PLC0415  (an extra)

    with tempfile.TemporaryDirectory() as folder, sync_playwright() as started_browser:
        path = Path(folder) / "long.html"
        path.write_text(html, encoding="utf-8")
        browser = started_browser.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(path.as_uri())
        session = browser.new_browser_cdp_session()

        def cpu_time() -> float:
            processes = session.send("SystemInfo.getProcessInfo")["processInfo"]
            return 1000 * sum(process["cpuTime"] for process in processes)

        at = cpu_time()
        unpacked = page.evaluate(UNPACK)
        unpacking, at = cpu_time() - at, cpu_time()
        painted = page.evaluate(MOVE, VIEWS)
        moving = (cpu_time() - at) / VIEWS
        browser.close()
    print(f"unpacked in         {unpacked:.0f} ms, {unpacking:.0f} ms of CPU time")
    print(f"a view costs        {moving:.1f} ms of CPU time, all processes")
    median, most = np.median(painted), np.max(painted)
    print(f"two frames take     {median:.0f} ms, at most {most:.0f} ms")


if __name__ == "__main__":
    main()
