"""Work goes anywhere and gives the same answer; what was worked out is kept."""

import json
import math
import os
import shutil
import subprocess
import sys
import time
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np
import pytest

from bondgraph.diagnosis.evidence.gain import compare
from bondgraph.diagnosis.evidence.left_out import LeftOutErrors
from bondgraph.diagnosis.search.trials.screening import effective_number
from bondgraph.diagnosis.work import workers
from bondgraph.diagnosis.work.journal import FILE, Journal, fingerprint
from bondgraph.diagnosis.work.limit import OUT_OF_TIME, Limit
from bondgraph.diagnosis.work.pool import Pool
from bondgraph.diagnosis.work.workers import Here, On, Processes, workshop
from bondgraph.errors import BondGraphError


def divided(common, item):
    return {"value": common / item}


def interrupted(common, item):
    if item == common:
        raise KeyboardInterrupt
    return {"value": item}


ITEMS = [3.0, 7.0, 11.0, 13.0, 17.0]
KEYS = [f"divided {item}" for item in ITEMS]
EXPECTED = [{"value": 1.0 / item} for item in ITEMS]


def done(where, journal=None, heard=lambda _: None):
    with workshop(where, journal or Journal(), heard) as shop:
        return shop.each(divided, 1.0, ITEMS, KEYS, "dividing")


def test_results_come_in_the_order_of_the_items_wherever_the_work_is_done(monkeypatch):
    monkeypatch.setattr(workers, "POOL_PAYS", -1.0)
    assert done(Here()) == EXPECTED
    assert done(Processes(2)) == EXPECTED
    with ThreadPoolExecutor(2) as pool:
        assert done(On(pool)) == EXPECTED
        assert pool.submit(divided, 1.0, 2.0).result() == {"value": 0.5}


def test_little_work_starts_no_processes():
    with workshop(Processes(2), Journal(), lambda _: None) as shop:
        shop.each(divided, 1.0, ITEMS, KEYS, "dividing")
        assert shop._pool is None


def slow(common, item):
    time.sleep(item)
    return {"value": item}


@pytest.mark.parametrize("where", [Here(), Processes(2), "threads"])
def test_what_there_is_no_time_for_is_refused_and_done_when_the_work_goes_on(
    where, monkeypatch, tmp_path
):
    monkeypatch.setattr(workers, "POOL_PAYS", -1.0)
    items, keys = [0.0, 0.0, 0.0, 30.0, 30.0, 30.0, 30.0], list("abcdefg")
    if where == Here():
        items[3] = 0.8  # It is not cut off, but nothing is begun after it.
    seconds = 10.0 if where == Processes(2) else 1.0  # Processes take time to start.
    limit = Limit.after(seconds)
    with ThreadPoolExecutor(2) as pool:
        place = On(Abandoned(pool)) if where == "threads" else where
        with workshop(place, Journal(tmp_path), lambda _: None, limit) as shop:
            began = time.monotonic()
            results = shop.each(slow, None, items, keys, "waiting")
            assert time.monotonic() - began < seconds
            assert results[-1] == {"refused": OUT_OF_TIME}
            undone = sum("refused" in result for result in results)
            assert limit.undone == undone >= 3
            whole = shop.each(divided, 1.0, ITEMS, KEYS, "dividing", whole=True)
            assert whole == EXPECTED
        pool.shutdown(wait=False, cancel_futures=True)
    kept = Journal(tmp_path)
    assert [kept.get(key) is None for key in keys] == ["refused" in r for r in results]


class Abandoned:
    """An executor whose slow work never ends; the quick is done at once."""

    def __init__(self, pool):
        self.pool = pool

    def submit(self, work, *args):
        if any(item == 30.0 for item in args[-1]):
            return Future()
        return self.pool.submit(work, *args)


def test_a_step_may_take_half_of_the_time_left():
    limit = Limit.after(100.0)
    assert limit.of_step() == pytest.approx(time.monotonic() + 50.0, abs=1.0)
    assert not limit.passed
    assert Limit.after(-1.0).passed
    assert Limit.after(-1.0).of_step() <= time.monotonic()
    assert Limit.after(None).of_step() == Limit().end == math.inf


def test_what_shares_the_time_leaves_half_of_it_and_counts_what_it_left_undone():
    limit = Limit.after(100.0)
    end = limit.end
    with limit.shared():
        assert limit.end - time.monotonic() == pytest.approx(50.0, abs=1.0)
        limit.undone += 1
    assert (limit.end, limit.undone) == (end, 1)
    with pytest.raises(KeyboardInterrupt), limit.shared():
        raise KeyboardInterrupt
    assert limit.end == end
    with (endless := Limit()).shared():
        assert endless.end == math.inf


def test_progress_counts_what_is_done():
    heard = []
    done(Here(), heard=heard.append)
    assert heard[0] == "dividing, 5 to do"
    assert heard[-1].startswith("dividing, 5 of 5")


def test_interrupted_work_is_kept_and_goes_on(tmp_path):
    items, keys = [1.0, 2.0, 3.0], ["a", "b", "c"]
    journal = Journal(tmp_path)
    with (
        pytest.raises(KeyboardInterrupt),
        workshop(Here(), journal, lambda _: None) as shop,
    ):
        shop.each(interrupted, 3.0, items, keys, "working")
    heard = []
    with workshop(Here(), Journal(tmp_path), heard.append) as shop:
        results = shop.each(interrupted, -1.0, items, keys, "working")
    assert results == [{"value": item} for item in items]
    assert heard == ["working, 1 to do", "working, 1 of 1"]


def test_a_journal_gives_numbers_back_to_the_last_bit(tmp_path):
    numbers = list(np.random.default_rng(1).standard_normal(50) * 1e-200)
    Journal(tmp_path).put("key", {"numbers": numbers})
    kept = Journal(tmp_path).get("key")
    assert kept is not None
    assert kept["numbers"] == numbers


def test_a_line_that_was_cut_off_is_worked_out_anew(tmp_path):
    journal = Journal(tmp_path)
    journal.put("first", {"value": 1})
    journal.put("second", {"value": 2})
    file = tmp_path / FILE
    file.write_text(file.read_text()[:-5])
    mended = Journal(tmp_path)
    assert mended.get("first") == {"value": 1}
    assert mended.get("second") is None
    mended.put("second", {"value": 2})
    last = json.loads(file.read_text().splitlines()[-1])
    assert (last["key"], last["result"]) == ("second", {"value": 2})


def test_a_journal_that_cannot_be_written_is_refused(tmp_path):
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(BondGraphError, match="cannot be used"):
        Journal(file / "journal")


def test_a_journal_whose_folder_was_cleared_away_is_written_again(tmp_path):
    folder = tmp_path / "cache" / "run"
    journal = Journal(folder)
    journal.put("a", {"cost": 1.0})
    shutil.rmtree(tmp_path / "cache")
    journal.put("b", {"cost": 2.0})
    again = Journal(folder)
    assert [again.get(key) for key in "ab"] == [{"cost": 1.0}, {"cost": 2.0}]


def test_a_fingerprint_changes_with_every_part():
    array = np.arange(3.0)
    assert fingerprint("a", array) == fingerprint("a", array.copy())
    assert fingerprint("a", array) != fingerprint("a", array + 1e-15)
    assert fingerprint("a", "b") != fingerprint("ab")


def test_hypotheses_count_by_how_different_they_are():
    random = np.random.default_rng(3)
    different = random.random((20, 399))
    assert effective_number(different) == pytest.approx(20, rel=0.3)
    assert effective_number(np.repeat(different[:1], 20, axis=0)) == 1.0
    pairs = np.repeat(different[:10], 2, axis=0)
    assert effective_number(pairs) == pytest.approx(10, rel=0.3)


def test_small_gains_everywhere_count_beside_one_large_error():
    before = np.full(12, 1.0)
    before[3] = 200.0
    after = 0.7 * before
    after[3] = 199.0
    assert compare(LeftOutErrors(before), LeftOutErrors(after)).p_value < 1e-4


@pytest.mark.parametrize(("set_by_user", "told"), [(None, "1"), ("3", "3")])
def test_a_worker_does_its_linear_algebra_on_one_thread(monkeypatch, set_by_user, told):
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    if set_by_user:
        monkeypatch.setenv("OMP_NUM_THREADS", set_by_user)
    pool = Pool(1)
    try:
        assert pool.submit(os.getenv, "OMP_NUM_THREADS").result() == told
    finally:
        pool.end(now=True)
    assert os.getenv("OMP_NUM_THREADS") == set_by_user


ON_ITS_WAY = """
import time
from bondgraph.diagnosis.work.pool import Pool

if __name__ == "__main__":
    pool = Pool(2)
    for one in [pool.submit(time.sleep, 0.0) for _ in range(4)]:
        one.result()
    for _ in range(2):
        pool.submit(time.sleep, 600.0)
    time.sleep(0.5)
    work = [pool.submit(len, bytes(20_000_000)) for _ in range(8)]
    time.sleep(1.0)
    for one in work:
        one.cancel()
    pool.end(now=True)
"""
"""The pipe to the workers holds less than is submitted; nobody reads the rest."""


def test_work_on_its_way_to_workers_that_are_gone_keeps_nobody_waiting(tmp_path):
    script = tmp_path / "on_its_way.py"
    script.write_text(ON_ITS_WAY)
    ended = subprocess.run(
        [sys.executable, str(script)],
        check=True,
        timeout=60,
        capture_output=True,
        text=True,
    )
    assert ended.stderr == ""
