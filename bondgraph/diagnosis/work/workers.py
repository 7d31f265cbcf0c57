"""Work on many items: here, in processes, or on any executor; same answer everywhere.

A piece of work is a pure function of something common to all items and one item. It
returns plain data (numbers, texts, lists), which a journal can keep, so that work that
was interrupted goes on where it stopped. Results come back in the order of the items,
whoever finished first.
"""

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing import get_context
from time import monotonic
from typing import Any

from bondgraph.diagnosis.work.journal import Journal, Plain

Work = Callable[[Any, Any], Plain]
Progress = Callable[[str], None]

BATCHES = 6
"""Batches per worker and list of items: few enough that the common part is sent seldom,
many enough that nobody waits long for the slowest."""

POOL_PAYS = 20.0
"""Seconds of work from which starting processes pays; each needs some to begin."""


@dataclass(frozen=True, slots=True)
class Here:
    """In this process, one after another."""


@dataclass(frozen=True, slots=True)
class Processes:
    """In processes of this machine; one per core where no number is given.

    They are started only where there is enough work left that it pays.
    """

    count: int | None = None

    @property
    def workers(self) -> int:
        """How many."""
        return self.count or os.cpu_count() or 1


@dataclass(frozen=True, slots=True)
class On:
    """On an executor of the user's: threads, Dask's, a cluster's.

    Parameters
    ----------
    executor
        Anything with the interface of `concurrent.futures`; it is not shut down.
    workers
        How many pieces of work it does at a time.
    """

    executor: Executor
    workers: int = 2


Where = Here | Processes | On


@dataclass(slots=True)
class Workshop:
    """Where work is done during one diagnosis, with its journal and its progress."""

    where: Where
    journal: Journal
    progress: Progress
    _pool: Executor | None = field(default=None, init=False)

    def each(
        self, work: Work, common: Any, items: Sequence[Any], keys: Sequence[str],
        what: str,
    ) -> list[Plain]:  # fmt: skip
        """Return ``work(common, item)`` for every item, in their order.

        Parameters
        ----------
        keys
            What each result is called in the journal; it says everything the result
            depends on.
        what
            The step, for the progress: ``round 1: screening``.
        """
        found = {key: self.journal.get(key) for key in keys}
        missing = {
            key: item
            for key, item in zip(keys, items, strict=True)
            if found[key] is None
        }
        clock = _Clock(what, len(missing), self.progress)
        for key, result in self._done(work, common, missing, clock):
            self.journal.put(key, result)
            found[key] = result
        return [_known(found[key]) for key in keys]

    def _done(
        self, work: Work, common: Any, items: dict[str, Any], clock: "_Clock"
    ) -> Iterator[tuple[str, Plain]]:
        """Yield results as they come: some here, the rest where it pays."""
        waiting = dict(items)
        executor = self._executor(0.0)
        while waiting and executor is None:
            key = next(iter(waiting))
            yield key, work(common, waiting.pop(key))
            left = clock.tick()
            executor = self._executor(left) if len(waiting) > 1 else None
        if not waiting or executor is None:
            return
        futures = self._submit(executor, work, common, waiting)
        try:
            for future in as_completed(futures):
                for key, result in zip(futures[future], future.result(), strict=True):
                    yield key, result
                    clock.tick()
        except BaseException:
            for future in futures:
                future.cancel()
            raise

    def _submit(
        self, executor: Executor, work: Work, common: Any, items: dict[str, Any]
    ) -> dict[Future[list[Plain]], list[str]]:
        names = list(items)
        size = max(-(-len(names) // (BATCHES * self._workers)), 1)
        batches = [names[i : i + size] for i in range(0, len(names), size)]
        return {
            executor.submit(_batch, work, common, [items[n] for n in batch]): batch
            for batch in batches
        }

    @property
    def _workers(self) -> int:
        return 1 if isinstance(self.where, Here) else self.where.workers

    def _executor(self, seconds_left: float) -> Executor | None:
        """Return where to send work of which so much is left, or None for here."""
        match self.where:
            case On(executor=executor):
                return executor
            case Processes() if self._workers > 1:
                if self._pool is None and seconds_left > POOL_PAYS:
                    # A fork of a process with threads may hang.
                    context = get_context("spawn")
                    self._pool = ProcessPoolExecutor(self._workers, mp_context=context)
                return self._pool
        return None

    def close(self, *, now: bool) -> None:
        """End the processes that were started, waiting for them unless `now`."""
        if isinstance(self._pool, ProcessPoolExecutor):
            self._pool.shutdown(wait=not now, cancel_futures=True)


@contextmanager
def workshop(where: Where, journal: Journal, progress: Progress) -> Iterator[Workshop]:
    """Yield a workshop, and end its processes afterwards, whatever happens."""
    shop = Workshop(where, journal, progress)
    try:
        yield shop
    except BaseException:
        shop.close(now=True)
        raise
    shop.close(now=False)


def _batch(work: Work, common: Any, items: Sequence[Any]) -> list[Plain]:
    return [work(common, item) for item in items]


def _known(result: Plain | None) -> Plain:
    assert result is not None
    return result


@dataclass(slots=True)
class _Clock:
    """Counts what is done and estimates what is left from the time it took."""

    what: str
    total: int
    progress: Progress
    done: int = 0
    started: float = field(default_factory=monotonic)

    def __post_init__(self) -> None:
        if self.total:
            self.progress(f"{self.what}, {self.total} to do")

    def tick(self) -> float:
        """Count one more; return the seconds left."""
        self.done += 1
        left = (monotonic() - self.started) / self.done * (self.total - self.done)
        words = f", about {left:.0f} s left" if left >= 1.0 else ""
        self.progress(f"{self.what}, {self.done} of {self.total}{words}")
        return left
