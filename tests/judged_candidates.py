"""What the tests of evidence judge: candidates, left-out errors, a fitted slider."""

from types import SimpleNamespace

import numpy as np

from bondgraph import BondGraph, R, Recording, Sf, bind_to
from bondgraph.diagnosis.evidence.gain import compare
from bondgraph.diagnosis.evidence.judged import Judged, Rule
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Support
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.fitting.horizon import WholeRecordings

RULE = Rule()
BASE = LeftOutErrors(1.0 + 0.3 * np.sin(np.arange(24.0)))


def slider(samples=600, noise=0.1, horizon=None):
    """Return a fitted slider whose friction is viscous, and what was recorded."""
    graph = BondGraph("slider", domain="translation")
    graph.one("body", Sf("speed"), R("rub"))
    graph.measure("force", effort="rub")
    graph.parameter("rub", 2.0, "N*s/m")
    random = np.random.default_rng(1)
    time = 0.01 * np.arange(samples)
    speed = random.standard_normal(samples)
    force = 2.2 * speed + noise * random.standard_normal(samples)
    channels = {"speed": (speed, "m/s"), "force": (force, "N")}
    recording = bind_to(graph.finish(), Recording.from_arrays("a", time, channels))
    settings = FitSettings(horizon=horizon or WholeRecordings())
    return fit_model(graph.finish(), [recording], settings), speed, force


def with_residuals(residuals, windows=1):
    shots = SimpleNamespace(n_windows=windows, timeless=windows == len(residuals))
    at = SimpleNamespace(residuals=residuals)
    return SimpleNamespace(
        optimum=SimpleNamespace(linearisation=at), problem=SimpleNamespace(shots=shots)
    )


def errors(*values):
    return LeftOutErrors(np.array(values, dtype=float))


def candidate(
    physics="drag",
    place="body",
    complexity=1,
    extends=(),
    domain="",
    by_output=(1.0,),
    depends_on=(),
    samples=1000,
):
    domains = [SimpleNamespace(name=domain)] if domain else []
    hypothesis = SimpleNamespace(
        physics=physics,
        place=place,
        other_end="",
        extends=extends,
        factor=1,
        depends_on=depends_on,
    )
    return SimpleNamespace(
        hypothesis=hypothesis,
        told=hypothesis,
        complexity=complexity,
        left_by_output=np.array(by_output),
        fitted=SimpleNamespace(
            graph=SimpleNamespace(domains_at=lambda _: domains),
            residuals=lambda: np.zeros((samples, 1)),
        ),
    )


def judged(left, support=Support.SUPPORTED, noise=1.0, **kinds):
    """Return a candidate that leaves `left` of every chunk's error, give or take.

    Of that, the share `noise` is known to be noise.
    """
    ripple = 1.0 + 0.01 * np.sin(np.arange(24) * len(str(kinds)))
    chunks = BASE.chunks * left * ripple
    after = LeftOutErrors(chunks, noise=noise * float(chunks.sum()))
    gain = compare(BASE, after)
    return Judged(candidate(**kinds), after, gain, support, "")
