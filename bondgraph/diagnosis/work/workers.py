"""Work on many items: here, in processes, or on any executor; same answer everywhere.

A piece of work is a pure function of something common to all items and one item. It
returns plain data (numbers, texts, lists), which a journal can keep, so that work that
was interrupted goes on where it stopped. Results come back in the order of the items,
whoever finished first.
"""

import math
import os
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

from bondgraph.diagnosis.work.clock import Clock, Progress
from bondgraph.diagnosis.work.journal import Journal, Plain
from bondgraph.diagnosis.work.limit import OUT_OF_TIME, Limit
from bondgraph.diagnosis.work.pool import Pool
from bondgraph.errors import BondGraphError

Work = Callable[[Any, Any], Plain]

BATCHES = 6
"""Batches per worker and list of items: few enough that the common part is sent seldom,
many enough that nobody waits long for the slowest."""

POOL_PAYS = 20.0
"""Seconds of work from which starting processes pays; each needs some to begin."""

PATIENCE = 3
"""Workers that may be lost, one after another, before any answers in between."""


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
        Anything with the interface of `concurrent.futures`; it is not shut down. Where
        it breaks, what is left is done in this process.
    workers
        How many pieces of work it does at a time.
    """

    executor: Executor
    workers: int = 2


Where = Here | Processes | On


@dataclass(slots=True)
class Workshop:
    """Where work is done during one diagnosis: its journal, progress and time limit."""

    where: Where
    journal: Journal
    progress: Progress
    limit: Limit = field(default_factory=Limit)
    _pool: Pool | None = field(default=None, init=False)
    _broken: bool = field(default=False, init=False)

    def each(
        self, work: Work, common: Any, items: Sequence[Any], keys: Sequence[str],
        what: str, *, whole: bool = False,
    ) -> list[Plain]:  # fmt: skip
        """Return ``work(common, item)`` for every item, in their order.

        What there was no time for is refused.

        Parameters
        ----------
        keys
            What each result is called in the journal; it says everything the result
            depends on.
        what
            The step, for the progress: ``round 1: screening``.
        whole
            Whether all is done, whatever time it takes.

        Raises
        ------
        BondGraphError
            If processes of this machine are lost again and again.
        """
        found = {key: self.journal.get(key) for key in keys}
        missing = {
            key: item
            for key, item in zip(keys, items, strict=True)
            if found[key] is None
        }
        clock = Clock(what, len(missing), self.progress)
        until = math.inf if whole else self.limit.of_step()
        with closing(self._done(work, common, missing, clock, until)) as done:
            for key, result in done:
                found[key] = self.journal.put(key, result)
                clock.tick()
        self.limit.undone += clock.total - clock.done
        return [found[key] or {"refused": OUT_OF_TIME} for key in keys]

    def _done(
        self, work: Work, common: Any, items: dict[str, Any], clock: Clock, until: float
    ) -> Generator[tuple[str, Plain], None, None]:
        """Yield results as they come: some here, the rest where it pays."""
        waiting, lost = dict(items), 0
        while waiting and monotonic() < until:
            executor = self._executor(clock.left, len(waiting))
            if executor is None:
                key = next(iter(waiting))
                yield key, work(common, waiting.pop(key))
                continue
            # After a loss one each, so that the others do not depend on what lost it.
            size = 1 if lost else -(-len(waiting) // (BATCHES * self._workers))
            try:
                for key, result in _sent(executor, work, common, waiting, size, until):
                    del waiting[key]
                    lost = 0
                    yield key, result
            except Exception as error:
                lost += 1
                self._go_on_after(error, lost, clock.what)
        if waiting:
            self.close(now=True)  # Not to wait for what there is no time for.

    def _go_on_after(self, error: Exception, lost: int, what: str) -> None:
        """Prepare to go on after a failure of an executor, or raise the error.

        If it was the work that failed on the user's executor, it will fail here too.
        """
        if isinstance(self.where, On):
            self._broken = True
            self.progress(f"{what}: the executor failed ({error!r}), going on here")
        elif not isinstance(error, BrokenProcessPool):
            raise error
        elif lost < PATIENCE:
            self.close(now=True)
            self.progress(f"{what}: a worker process was lost, starting another")
        else:
            raise BondGraphError(
                f"{what}: a worker process was lost {lost} times in a row.",
                (what,),
                "If memory ran out, use fewer workers. Where there is a directory to "
                "resume from, what was worked out is kept.",
            ) from error

    @property
    def _workers(self) -> int:
        return 1 if isinstance(self.where, Here) else self.where.workers

    def _executor(self, seconds_left: float, items: int) -> Executor | None:
        """Return where to send work of which so much is left, or None for here."""
        match self.where:
            case On(executor=executor) if not self._broken:
                return executor
            case Processes() if self._workers > 1:
                if self._pool is None and seconds_left > POOL_PAYS and items > 1:
                    self._pool = Pool(self._workers)
                return self._pool
        return None

    def close(self, *, now: bool) -> None:
        """End the processes that were started, waiting for them unless `now`."""
        if self._pool is not None:
            self._pool.end(now=now)


@contextmanager
def workshop(
    where: Where, journal: Journal, progress: Progress, limit: Limit | None = None
) -> Iterator[Workshop]:
    """Yield a workshop, and end its processes afterwards, whatever happens."""
    shop = Workshop(where, journal, progress, limit or Limit())
    try:
        yield shop
    except BaseException:
        shop.close(now=True)
        raise
    shop.close(now=False)


def _sent(
    executor: Executor, work: Work, common: Any, items: dict[str, Any], size: int,
    until: float,
) -> Iterator[tuple[str, Plain]]:  # fmt: skip
    """Yield what an executor makes of items, `size` at a time, as it comes."""
    names = list(items)
    batches = [names[i : i + size] for i in range(0, len(names), size)]
    futures: dict[Future[list[Plain]], list[str]] = {}
    try:
        for batch in batches:
            parts = [items[name] for name in batch]
            futures[executor.submit(_batch, work, common, parts)] = batch
        for future in _completed(futures, until):
            yield from zip(futures[future], future.result(), strict=True)
    finally:
        for future in futures:
            future.cancel()


def _completed(
    futures: Iterable[Future[list[Plain]]], until: float
) -> Iterator[Future[list[Plain]]]:
    """Yield futures as they are done, until time has run out."""
    waiting = set(futures)
    while waiting and (left := until - monotonic()) > 0.0:
        done, waiting = wait(
            waiting, None if left == math.inf else left, FIRST_COMPLETED
        )
        # What is done counts before what was lost with the process of another.
        yield from sorted(done, key=_has_failed)


def _has_failed(future: Future[list[Plain]]) -> bool:
    return future.cancelled() or future.exception() is not None


def _batch(work: Work, common: Any, items: Sequence[Any]) -> list[Plain]:
    return [work(common, item) for item in items]
