"""Curves that no store, no loss and no input has are refuted."""

from types import SimpleNamespace

import numpy as np
from judged_candidates import BASE, RULE

from bondgraph import BondGraph, C, R, Recording, Sf, bind_to
from bondgraph.diagnosis.candidates import Candidate, propose_all
from bondgraph.diagnosis.evidence.judged import judge
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.records import Support
from bondgraph.diagnosis.search.laws import drawing
from bondgraph.diagnosis.search.laws.drawing import drawn_finely
from bondgraph.diagnosis.search.trials.impossible import (
    BEYOND_COMMAND,
    NEGATIVE_LOSS,
    NEGATIVE_STORE,
    impossible,
)
from bondgraph.diagnosis.search.trials.judging import stable
from bondgraph.diagnosis.search.trials.trying import Start, Trial, restored
from bondgraph.fitting.estimate import FitSettings, fit_model
from bondgraph.physics.smooth import Smooth
from bondgraph.physics.unknown import UnknownRelation

TIME = np.arange(400.0)
PUSH = np.where(TIME % 100 < 50, 1.0, 0.0)


def block():
    """A block that is heated and loses heat."""
    g = BondGraph("block", domain="thermal")
    g.zero("block", Sf("heater"), C("capacity"), R("loss"))
    g.measure("temperature", effort="block")
    g.parameter("capacity", 20.0, "J/K", bounds=(1, 100))
    g.parameter("loss", 2.0, "K/W", bounds=(0.1, 100))
    return g.finish(), "heater", "W", "temperature", "K"


def mast():
    """A mast whose foot, a spring, is moved against something that drags."""
    g = BondGraph("mast", domain="translation")
    g.one("mast", R("rub"))
    g.zero("foot", C("spring"), Sf("speed"))
    g.join("foot", "mast")
    g.measure("force", effort="foot")
    g.parameter("spring", 20.0, "m/N", bounds=(1, 100))
    g.parameter("rub", 2.0, "N*s/m", bounds=(0.1, 100))
    return g.finish(), "speed", "m/s", "force", "N"


def as_answers(machine, heights):
    """Return the candidate whose store answers along its law and these heights."""
    graph, source, unit, output, read = machine
    answer, own = np.zeros(TIME.size), 0.0
    for k, now in enumerate(PUSH):
        answer[k] = own
        own += (now - own / 2.0) / 20.0
    channels = {source: (PUSH, unit), output: (answer, read)}
    bound = [bind_to(graph, Recording.from_arrays("run", TIME, channels))]
    base = fit_model(graph, bound, FitSettings())
    laws = propose_all(base, [UnknownRelation()])
    (law,) = (one for one in laws if "holds along" in one.words)
    numbers = dict(zip(law.strengths, heights, strict=True))
    fitted = restored(base, Trial(law, (Start({**base.values, **numbers}),)))
    return Candidate(law, fitted, len(heights))


RISING = 0.3 * np.linspace(0.0, 1.0, 8) ** 2
WAVES = 0.8 * np.sin(np.arange(8.0) * 2.0)


def test_a_block_does_not_cool_as_it_takes_heat():
    assert not impossible(as_answers(block(), RISING))
    falling = as_answers(block(), WAVES)
    assert impossible(falling) == NEGATIVE_STORE
    after = LeftOutErrors(0.1 * BASE.chunks)
    believed = judge(falling, BASE, after, 1.0, RULE)
    assert believed.support is Support.SUPPORTED
    refuted = stable(believed)
    assert refuted.support is Support.REFUTED
    assert refuted.reason == NEGATIVE_STORE


def test_a_spring_may_push_less_the_further_it_is_bent():
    assert not impossible(as_answers(mast(), 20.0 * WAVES))


def fanned(heights, *, finely=False):
    """Return the candidate whose loss a fan steers along these heights."""
    g = BondGraph("fanned block", domain="thermal")
    g.zero("block", Sf("heater"), C("capacity"), R("loss"))
    g.one("air", Sf("fan"), domain="analogue")
    g.measure("temperature", effort="block")
    g.parameter("capacity", 20.0, "J/K", bounds=(1, 100))
    g.parameter("loss", 2.0, "K/W", bounds=(0.1, 100))
    graph, fan = g.finish(), 0.5 + 0.5 * np.sin(TIME / 30.0)
    warm = 2.0 * (1.0 - np.exp(-TIME / 40.0))
    channels = {
        "heater": (np.ones(TIME.size), "W"),
        "fan": (fan, "1"),
        "temperature": (warm, "K"),
    }
    bound = [bind_to(graph, Recording.from_arrays("run", TIME, channels))]
    base = fit_model(graph, bound, FitSettings())
    laws = propose_all(base, [UnknownRelation()])
    (law,) = (one for one in laws if one.words == "loss changes with fan")
    numbers = dict(zip(law.strengths, heights, strict=True))
    if finely:
        drawn = UnknownRelation(Smooth(tuple(heights), 8, 1.0))
        law = drawing._proposed(SimpleNamespace(base=base), law, drawn)
        numbers = law.starts[0]
    fitted = restored(base, Trial(law, (Start({**base.values, **numbers}),)))
    return Candidate(law, fitted, len(heights))


def test_a_loss_that_something_steers_does_not_give_back():
    assert impossible(fanned([0.5, 0.0, -0.3, -0.9], finely=True)) is None
    turned = fanned([0.5, 0.0, -1.0, -3.0], finely=True)
    assert impossible(turned) == NEGATIVE_LOSS


def commanded(more):
    """Return the candidate whose heater gives so many watts more than commanded."""
    graph, source, unit, output, read = block()
    channels = {
        source: (1.0 + np.sin(TIME / 30.0), unit),
        output: (np.ones(TIME.size), read),
    }
    bound = [bind_to(graph, Recording.from_arrays("run", TIME, channels))]
    base = fit_model(graph, bound, FitSettings())
    laws = propose_all(base, [UnknownRelation()])
    (law,) = (one for one in laws if "acts along" in one.words)
    numbers = dict.fromkeys(law.strengths, more)
    fitted = restored(base, Trial(law, (Start({**base.values, **numbers}),)))
    return Candidate(law, fitted, len(numbers))


def test_an_input_does_not_act_a_hundred_times_more_than_it_was_commanded():
    assert impossible(commanded(0.5)) is None
    assert impossible(commanded(1e3)) == BEYOND_COMMAND


def test_what_no_element_has_is_not_drawn_finely(monkeypatch):
    broken = fanned([0.5, 0.0, -0.3, -0.9])
    curved = fanned([0.5, 0.0, -1.0, -3.0], finely=True)

    class Bench:
        def run(self, *_):
            return [None]

        def candidates(self, *_):
            return [self.ends]

    bench, smooth = Bench(), Smooth((0.5, 0.0, -0.3, -0.9), 8, 1.0)
    begin = Start.where_ended(broken.fitted)
    monkeypatch.setattr(drawing, "_proposed", lambda *_: broken.hypothesis)
    for bench.ends, drawn in ((broken, broken), (curved, None)):
        assert drawn_finely(bench, broken.hypothesis, smooth, begin) is drawn
