"""Progress of long work, shown where somebody watches.

Work that takes long, such as `diagnose`, takes a function and tells it each step in
words: ``round 1: fitting, 3 of 24, about 9 s left``. What is counted as *3 of 24*
becomes a bar, anything else a line. A notebook shows it in its cell, a terminal in its
last line, which is cleared at the end; where nobody watches, nothing is printed.
"""

import re
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from html import escape
from importlib import import_module

Step = Callable[[str], None]
_COUNTED = re.compile(r"^(?P<what>.*?), (?P<done>\d+) of (?P<total>\d+)(?P<rest>.*)$")
_TO_DO = re.compile(r"^(?P<what>.*?), (?P<total>\d+) to do$")
_LEAST = 0.1  # s between two pictures of a bar in a notebook, which travel as messages


@dataclass(frozen=True, slots=True, kw_only=True)
class Count:
    """A step read as a count.

    Parameters
    ----------
    what
        The step without the count.
    done, total
        How far it is; both None where the step is not counted.
    rest
        What is said behind the count.
    """

    what: str
    done: int | None = None
    total: int | None = None
    rest: str = ""


def count(step: str) -> Count:
    """Return what a step says of how far the work is.

    Examples
    --------
    >>> count("round 1: fitting, 3 of 24, about 9 s left").total
    24
    """
    found = _COUNTED.match(step)
    if found is not None:
        return Count(
            what=found["what"],
            done=int(found["done"]),
            total=int(found["total"]),
            rest=found["rest"].removeprefix(", "),
        )
    begun = _TO_DO.match(step)
    if begun is not None:
        return Count(what=begun["what"], done=0, total=int(begun["total"]))
    return Count(what=step)


def shown_progress() -> AbstractContextManager[Step]:
    """Return a context that yields a function to be told each step.

    Examples
    --------
    >>> with shown_progress() as progress:
    ...     progress("fitting, 1 of 2")
    """
    if _in_notebook():
        return _notebook()
    if sys.stderr.isatty():
        return _terminal()
    return Silent().shown()


@dataclass(frozen=True, slots=True)
class Silent:
    """Shows nothing."""

    @contextmanager
    def shown(self) -> Iterator[Step]:
        """Yield a function that drops what it is told."""
        yield lambda _: None


@dataclass(slots=True)
class Steps:
    """Prints each step once, with the seconds since the start; counts only their ends.

    Parameters
    ----------
    line
        Prints a line.
    """

    line: Step
    _started: float = field(default_factory=time.monotonic, init=False)
    _last: str = field(default="", init=False)

    @contextmanager
    def shown(self) -> Iterator[Step]:
        """Yield a function that prints what it is told."""
        yield self._tell

    def _tell(self, step: str) -> None:
        here = count(step)
        ended = here.done is not None and here.done == here.total and here.done > 0
        if here.what != self._last or ended:
            self.line(f"[{time.monotonic() - self._started:7.1f} s] {step}")
        self._last = here.what


def _in_notebook() -> bool:
    """Return whether a Jupyter kernel runs this: it has a front end for pictures."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return shell is not None and hasattr(shell, "kernel")


@contextmanager
def _terminal() -> Iterator[Step]:
    from rich.console import Console  # noqa: PLC0415  (0.1 s, only on a terminal)
    from rich.progress import (  # noqa: PLC0415  # noqa: PLC0415
        BarColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeElapsedColumn,
    )

    columns = (
        SpinnerColumn(),
        TimeElapsedColumn(),
        BarColumn(24),
        TextColumn("{task.description}", markup=False),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True) as shown:
        task = shown.add_task("", total=None)

        def tell(step: str) -> None:
            here = count(step)
            shown.update(
                task, description=step, total=here.total, completed=here.done or 0
            )

        yield tell


@contextmanager
def _notebook() -> Iterator[Step]:
    front_end = import_module("IPython.display")
    begun = time.monotonic()
    handle = front_end.display(
        front_end.HTML(_bar(Count(what="starting"), 0.0)), display_id=True
    )

    def show(html: str) -> None:
        handle.update(front_end.HTML(html))

    last = begun

    def tell(step: str) -> None:
        nonlocal last
        here, now = count(step), time.monotonic()
        if here.done and here.done != here.total and now - last < _LEAST:
            return
        last = now
        show(_bar(here, now - begun))

    try:
        yield tell
    except BaseException:
        show(f"<small>stopped after {_seconds(begun)}</small>")
        raise
    show(f"<small>done in {_seconds(begun)}</small>")


def _seconds(begun: float) -> str:
    return f"{time.monotonic() - begun:.1f} s"


def _bar(here: Count, elapsed: float) -> str:
    """Return a bar; one without a value where the step is not counted."""
    value = "" if here.done is None else f' value="{here.done}" max="{here.total}"'
    far = "" if here.done is None else f", {here.done} of {here.total}"
    rest = f", {here.rest}" if here.rest else ""
    words = escape(f"{elapsed:.0f} s · {here.what}{far}{rest}")
    label = escape(here.what, quote=True)
    return f'<progress aria-label="{label}"{value}></progress> {words}'
