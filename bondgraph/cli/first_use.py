"""What is said when loops have to be compiled first, as once after an installation.

That takes a minute in which nothing else happens, and a new user does not know why.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

ONCE = (
    "Loops are compiled now, as once after an installation; this takes a minute or "
    "two, and later runs start at once."
)
ALWAYS = (
    "Loops are compiled now, which takes a minute or two, and at every run: there is "
    "no folder to keep them in. NUMBA_CACHE_DIR names one."
)


@contextmanager
def told_of_compiling(tell: Callable[[str], object]) -> Iterator[None]:
    """Tell once if a loop of this package is not found among those kept on disk.

    The code of a single model, which is compiled in moments, is not told.
    """
    # numba is slow to load; who asks for this is about to run its loops.
    from numba.core import event  # noqa: PLC0415

    from bondgraph.numeric.compiled.loops import FOLDER  # noqa: PLC0415

    words = [ALWAYS if FOLDER is None else ONCE]

    class Told(event.Listener):
        def on_start(self, event: Any) -> None:
            module = event.data["dispatcher"].py_func.__module__ or ""
            if words and module.startswith("bondgraph."):
                tell(words.pop())

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Told()):
        yield
