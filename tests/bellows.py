"""Bellows whose spring gives way: what draws curves is tested on them."""

from contextlib import contextmanager

import numpy as np

from bondgraph import BondGraph, C, Hold, R, Recording, Se, bind_to
from bondgraph.diagnosis.probing import measure_scales
from bondgraph.diagnosis.search.trials.bench import Bench
from bondgraph.diagnosis.search.trials.trying import Start, Trial, fit_fully
from bondgraph.diagnosis.work.journal import Journal
from bondgraph.diagnosis.work.workers import Here, workshop
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.unknown import UnknownRelation

STEP = 0.01


def bellows():
    """Return bellows that a known force draws out against a stated spring."""
    g = BondGraph("bellows", domain="translation")
    g.one("plate", Se("force"), C("bellows"), R("damper"))
    g.measure("speed", flow="plate")
    g.parameter("bellows", 0.01, "m/N")
    g.parameter("damper", 20.0, "N*s/m")
    return g.finish()


def drawn_out(force_of, seed=1):
    """Return a recording of bellows that give ``force_of`` how far they are out."""
    time = STEP * np.arange(1500)
    force = 4.0 * np.sin(1.1 * time) + 2.0 * np.sin(2.9 * time + 1.0)
    out, speed = 0.0, np.zeros(time.size)
    for k, push in enumerate(force):
        for _ in range(20):
            now = (push - force_of(out)) / 20.0
            out += now * STEP / 20
        speed[k] = now
    speed += 1e-4 * np.random.default_rng(seed).normal(size=time.size)
    channels = {"force": (force, "N"), "speed": (speed, "m/s")}
    return bind_to(bellows(), Recording.from_arrays("run", time, channels))


@contextmanager
def searched(force_of):
    """Yield what bellows that give so much force are searched on, from the stated."""
    settings = FitSettings(hold=Hold.ZERO)
    run = drawn_out(force_of)
    base = fit_model(bellows(), [run], settings)
    with workshop(Here(), Journal(), lambda _: None) as shop:
        yield Bench.of(base, shop, "round 1")


def curve_over(bench, visited=None):
    """Return the curve of the displacement, fitted."""
    places = all_places(bench.base.graph, measure_scales(bench.base))
    (place,) = (one for one in places if one.name == "plate")
    curve = next(
        one
        for one in UnknownRelation(visited=visited).propose(place)
        if one.depends_on == ("displacement",) and one.factor == 1
    )
    trial = Trial(curve, (Start.where_ended(bench.base),))
    (found,) = bench.candidates([trial], bench.run(fit_fully, [trial], "a curve"))
    return found
