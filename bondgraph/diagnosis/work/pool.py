"""Processes that work for this one and end when it does, however it ends.

Every worker holds one end of a pipe and this process the other. When this process is
done, interrupted or killed, its end is closed and the workers end at once: none stays
behind to finish what nobody will read, or to wait for more.
"""

import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from threading import Thread
from typing import Any

from bondgraph.simulation.threads import THREADS

LINEAR_ALGEBRA = "OMP_NUM_THREADS"
"""Where its libraries read, when they are loaded, on how many threads they work."""


class Pool(Executor):
    """Processes of this machine, started when work is first submitted.

    A process that is lost (killed, or out of memory) breaks all that was submitted
    with it; after `end`, what is submitted starts others.
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._processes: ProcessPoolExecutor | None = None
        self._ended: ProcessPoolExecutor | None = None
        self._line: Connection | None = None

    def submit(
        self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any
    ) -> Future[Any]:
        """Have ``fn(*args, **kwargs)`` done by a process, and return its future."""
        if self._processes is None:
            # A fork of a process with threads may hang.
            context = get_context("spawn")
            theirs, self._line = context.Pipe(duplex=False)
            self._processes = ProcessPoolExecutor(
                self.workers,
                mp_context=context,
                initializer=_end_with,
                initargs=(theirs,),
            )
        with _deaf(), _on_one_thread():
            return self._processes.submit(fn, *args, **kwargs)

    def end(self, *, now: bool) -> None:
        """End the processes: at once, or when they have done what was submitted."""
        if self._processes is None or self._line is None:
            return
        # Before the workers end: what is cancelled must be known when they are missed.
        self._processes.shutdown(wait=not now, cancel_futures=now)
        self._line.close()
        # Kept, for what it has cancelled is told only to an executor that is there.
        self._ended, self._processes, self._line = self._processes, None, None


@contextmanager
def _deaf() -> Iterator[None]:
    """Let processes started meanwhile never hear an interrupt from the keyboard.

    This process hears it, afterwards, and ends them; each of them would only print
    where it was.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _on_one_thread() -> Iterator[None]:
    """Let processes started meanwhile do their linear algebra on one thread each.

    On several, workers wait for each other at every small product. What the user has
    set stands.
    """
    if LINEAR_ALGEBRA in os.environ:
        yield
        return
    os.environ[LINEAR_ALGEBRA] = "1"
    try:
        yield
    finally:
        os.environ.pop(LINEAR_ALGEBRA, None)


def _end_with(line: Connection) -> None:
    """Have this worker end as soon as the other end of `line` is closed.

    It simulates on one thread: the other cores are for the other workers.
    """
    os.environ.setdefault(THREADS, "1")
    Thread(target=_wait_and_end, args=(line,), daemon=True).start()


def _wait_and_end(line: Connection) -> None:
    with suppress(EOFError, OSError):
        line.recv_bytes()
    os._exit(1)
