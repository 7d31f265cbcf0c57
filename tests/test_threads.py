"""Parts of a simulation on kept threads: each done once, whoever is busy or fails."""

import threading

import pytest

from bondgraph.simulation.threads import THREADS, _helpers, in_parallel


@pytest.fixture(autouse=True)
def on_three_threads(monkeypatch):
    monkeypatch.setenv(THREADS, "3")


def test_every_piece_is_done_once():
    for count in (1, 2, 3, 10, 101):
        done = []
        in_parallel(lambda first, last, to=done: to.extend(range(first, last)), count)
        assert sorted(done) == list(range(count))


def test_what_no_helper_has_time_for_is_done_here():
    busy = threading.Event()
    held = [_helpers(2).submit(busy.wait) for _ in range(2)]
    by = []
    try:
        in_parallel(lambda *part: by.append((part, threading.get_ident())), 9)
    finally:
        busy.set()
    assert [part for part, _ in by] == [(0, 3), (3, 6), (6, 9)]
    assert {thread for _, thread in by} == {threading.get_ident()}
    assert all(one.result() for one in held)


def test_an_error_is_raised_once_nothing_is_worked_on_any_more():
    begun, ended = threading.Event(), threading.Event()

    def work(first, last):
        if first == 0:
            assert begun.wait(60)
            raise KeyboardInterrupt
        begun.set()
        ended.wait(0.2)
        ended.set()

    with pytest.raises(KeyboardInterrupt):
        in_parallel(work, 3)
    assert ended.is_set()


def test_an_error_of_a_helper_is_raised():
    def work(first, last):
        if first == 2:
            raise ValueError(first)

    with pytest.raises(ValueError, match="2"):
        in_parallel(work, 3)
