"""Stopped at any moment, and wherever it is worked on: the answer is the same."""

import json
import os
import signal
import time
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from itertools import count as counting

import numpy as np
import pytest

from bondgraph import BondGraph, R, Recording, Sf, bind_to
from bondgraph.diagnosis.diagnose import Options, diagnose
from bondgraph.diagnosis.work import journal as journals
from bondgraph.diagnosis.work import limit as limits
from bondgraph.diagnosis.work import workers
from bondgraph.diagnosis.work.journal import FILE, Journal
from bondgraph.diagnosis.work.workers import Here, On, Processes, workshop
from bondgraph.errors import BondGraphError
from bondgraph.physics.library import LIBRARY
from bondgraph.reporting.diagnosis_json import diagnosis_to_dict

LAWS = ("coulomb_friction", "spring", "quadratic_drag", "unknown_relation", "dead_zone")
ITEMS = list(range(1, 9))
KEYS = [f"item {item}" for item in ITEMS]
EXPECTED = [{"value": 1.0 / item} for item in ITEMS]


def slider():
    """A rubbing slider that is pulled at known speeds: diagnosed in a second."""
    graph = BondGraph("slider", domain="translation")
    graph.one("body", Sf("speed"), R("rub"))
    graph.measure("force", effort="speed")
    graph.parameter("rub", 2.0, "N*s/m", bounds=(0, 100))
    return graph.finish()


def pulled(graph, seed, samples):
    random = np.random.default_rng(seed)
    time_ = 0.01 * np.arange(samples)
    speed = 0.05 * np.cumsum(random.standard_normal(samples))
    speed -= speed.mean()
    force = 2.2 * speed + 0.5 * np.sign(speed) + 0.01 * random.standard_normal(samples)
    channels = {"speed": (speed, "m/s"), "force": (force, "N")}
    return bind_to(graph, Recording.from_arrays(f"pull {seed}", time_, channels))


def answer(resume=None, where=None, progress=lambda _: None, seconds=None):
    """Return the whole answer as the JSON that programs read."""
    graph = slider()
    options = Options(
        library=tuple(physics for physics in LIBRARY if physics.word in LAWS),
        most_findings=1,
        resume=resume,
        where=where or Here(),
        seconds=seconds,
    )
    found = diagnose(
        graph,
        [pulled(graph, 1, 600)],
        held_out=[pulled(graph, 2, 300)],
        options=options,
        progress=progress,
    )
    return json.dumps(diagnosis_to_dict(found))


@pytest.fixture(scope="module")
def whole():
    return answer()


def test_killed_at_any_byte_of_its_journal_it_goes_on_to_the_same_answer(
    tmp_path, whole
):
    assert answer(tmp_path) == whole
    file = tmp_path / FILE
    content = file.read_bytes()
    assert content.count(b"\n") > 8
    cuts = np.random.default_rng(1).integers(0, len(content), 3)
    for cut in (len(content) - 1, *map(int, cuts)):
        file.write_bytes(content[:cut])
        assert answer(tmp_path) == whole


def test_interrupted_at_any_sentence_it_goes_on_to_the_same_answer(tmp_path, whole):
    heard = []
    answer(progress=heard.append)
    for count in np.linspace(1, len(heard), 3).astype(int):
        folder = tmp_path / str(count)
        with pytest.raises(KeyboardInterrupt):
            answer(folder, progress=interrupting(count))
        assert answer(folder) == whole


@pytest.mark.parametrize("seconds", [1, 12, 120])
def test_ended_by_its_time_limit_it_says_so_and_goes_on_to_the_same_answer(
    tmp_path, whole, seconds, monkeypatch
):
    """By a clock that goes on by a second whenever it is looked at."""
    clock = counting()
    for module in (limits, workers):
        monkeypatch.setattr(module, "monotonic", lambda: float(next(clock)))
    told = json.loads(answer(tmp_path, seconds=seconds))
    assert told["complete"] is (seconds == 120)
    if told["complete"]:
        assert told == json.loads(whole)
    else:
        assert any("cut short to end within" in note for note in told["notes"])
        assert "Time ran out before everything had been tried." in told["statement"]
        assert (told["verdict"] == "cannot_tell") is (told["findings"] == [])
    assert not any("time ran out" in note for note in told["notes"])
    assert answer(tmp_path) == whole


def test_without_a_time_limit_everything_is_tried(whole):
    assert json.loads(whole)["complete"] is True


def interrupting(count):
    """A progress that presses Ctrl-C at the `count`-th sentence."""
    heard = []

    def progress(sentence):
        heard.append(sentence)
        if len(heard) == count:
            raise KeyboardInterrupt

    return progress


def test_no_result_is_worked_out_twice(tmp_path):
    heard = []
    with pytest.raises(KeyboardInterrupt):
        answer(tmp_path, progress=interrupting(6))
    before = (tmp_path / FILE).read_bytes()
    answer(tmp_path, progress=heard.append)
    after = (tmp_path / FILE).read_bytes()
    assert after.startswith(before)
    keys = [json.loads(line)["key"] for line in after.splitlines()]
    assert len(set(keys)) == len(keys)


@pytest.mark.parametrize(
    "line",
    [
        b"5",
        b"null",
        b"[]",
        b'{"key": 5}',
        b'{"key": "a"}',
        b'{"key": ["a"], "result": {}}',
        b'{"key": "a", "result": 3}',
        b'{"key": "a", "result": {"value": 1}}',
        b'{"key": "a", "by": "another version", "result": {"value": 1}}',
        b"\x00\xff\xfe",
        b"[" * 100_000,
        b"!!python/object/apply:os.system ['true']",
        b"\x80\x04\x95",
    ],
    ids=lambda line: repr(line[:20]),
)
def test_a_line_that_this_program_did_not_write_is_not_believed(tmp_path, line):
    (tmp_path / FILE).write_bytes(line + b"\n")
    found = Journal(tmp_path)
    assert found.get("a") is None
    found.put("a", {"value": 2})
    assert Journal(tmp_path).get("a") == {"value": 2}


def test_results_of_other_sources_are_not_believed(tmp_path, monkeypatch):
    Journal(tmp_path).put("a", {"value": 1})
    monkeypatch.setattr(journals, "sources", lambda: "changed since")
    assert Journal(tmp_path).get("a") is None


def test_a_result_is_the_same_fresh_and_read_back(tmp_path):
    fresh = Journal(tmp_path).put(
        "a", {"pair": (1.0, float("inf")), "by_number": {1: 2}}
    )
    assert fresh == Journal(tmp_path).get("a") == Journal().put("a", fresh)


def divided(common, item):
    return {"value": common / item}


class Breaking:
    """An executor that does `good` batches and then breaks."""

    def __init__(self, good, error):
        self.good, self.error = good, error

    def submit(self, work, *args):
        future = Future()
        if self.good:
            self.good -= 1
            future.set_result(work(*args))
        else:
            future.set_exception(self.error)
        return future


@pytest.mark.parametrize("good", [0, 1, 3])
@pytest.mark.parametrize("error", [CancelledError(), OSError("gone"), RuntimeError()])
def test_an_executor_that_breaks_is_done_without(good, error):
    heard = []
    with workshop(On(Breaking(good, error), 2), Journal(), heard.append) as shop:
        assert shop.each(divided, 1.0, ITEMS, KEYS, "dividing") == EXPECTED
        assert shop.each(divided, 1.0, [9], ["item 9"], "more") == [{"value": 1 / 9}]
    assert sum("going on here" in sentence for sentence in heard) == 1
    assert heard.count("dividing, 8 of 8") == 1
    assert heard[-1] == "more, 1 of 1"


def test_what_fails_in_the_work_itself_is_said_wherever_it_is_done():
    with (
        ThreadPoolExecutor(2) as pool,
        pytest.raises(ZeroDivisionError),
        workshop(On(pool), Journal(), lambda _: None) as shop,
    ):
        shop.each(divided, 1.0, [1, 0, 2], ["a", "b", "c"], "dividing")


def killing_once(marker, item):
    """Divide; but the first process to get the item 5 is killed."""
    if item == 5 and not os.path.exists(marker):
        open(marker, "w").close()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"value": 1.0 / item}


def killing_always(folder, item):
    """Divide; but whatever process gets the item 5 is killed, after the others."""
    if item == 5:
        deadline = time.monotonic() + 10.0
        while len(os.listdir(folder)) < 3 and time.monotonic() < deadline:
            time.sleep(0.01)
        time.sleep(0.5)  # What they have worked out is on its way.
        os.kill(os.getpid(), signal.SIGKILL)
    open(os.path.join(folder, str(item)), "w").close()
    return {"value": 1.0 / item}


def process(common, item):
    return {"process": os.getpid()}


def is_there(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def test_lost_and_ended_processes(tmp_path, monkeypatch):
    """One test for all, because processes take their time to start."""
    monkeypatch.setattr(workers, "POOL_PAYS", -1.0)
    monkeypatch.setattr(workers, "PATIENCE", 2)
    heard, journal = [], Journal(tmp_path)
    with workshop(Processes(2), journal, heard.append) as shop:
        marker = str(tmp_path / "marker")
        assert shop.each(killing_once, marker, ITEMS, KEYS, "dividing") == EXPECTED
        assert sum("starting another" in sentence for sentence in heard) == 1
        keys = [f"who {item}" for item in ITEMS]
        told = shop.each(process, None, ITEMS, keys, "asking")
        folder = tmp_path / "done"
        folder.mkdir()
        with pytest.raises(BondGraphError, match="2 times in a row"):
            shop.each(
                killing_always, str(folder), [4, 5, 6, 7], list("abcd"), "dividing"
            )
        assert {"a", "c", "d"} <= journal._known.keys()
        shop.close(now=True)
        theirs = {result["process"] for result in told} - {os.getpid()}
        assert theirs
        deadline = time.monotonic() + 10.0
        while any(map(is_there, theirs)) and time.monotonic() < deadline:
            time.sleep(0.02)
        assert not any(map(is_there, theirs))
