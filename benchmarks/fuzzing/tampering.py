"""One damaged file through the real program: served, or refused in one line.

Each trial runs the program's own ``main`` in a fork of this process, so that loading
the libraries costs nothing, with its memory, time and output limited and looked at.
"""

import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

from benchmarks.fuzzing.damage import DAMAGES
from benchmarks.fuzzing.samples import KINDS, MODEL, csv

SECONDS = 10
"""Of processor time."""

WALL = 900
"""Seconds on the wall, where others use the machine too."""

MEMORY = 1 << 30
"""Bytes of memory on top of what the program has before it reads anything."""


class FileEnd(StrEnum):
    """What became of a damaged file."""

    SERVED = "still readable: served, or answered with no"
    REFUSED_FILE = "refused in one line"
    BROKEN = "a traceback, several lines, too long, too large, or killed"


OUTPUT_SHOWN = 400
COMMANDS = "derive check draw simulate fit diagnose shape export diff".split()
LIBRARIES = "scipy.io h5py pyarrow.parquet bondgraph.numeric.kernel.machine".split()
LONGEST_LINE = 2000


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What the program did with one command line."""

    status: int
    stdout: str
    stderr: str
    seconds: float
    memory: int

    @property
    def complaint(self) -> str:
        """What is wrong with the answer, nothing where it is as promised."""
        if self.status < 0:
            return f"killed by {signal.Signals(-self.status).name}"
        if self.memory > MEMORY:
            return f"took {self.memory / 2**20:.0f} MiB"
        if self.seconds > SECONDS:
            return f"took {self.seconds:.1f} s of processor time"
        if "Traceback" in self.stderr:
            return "shows a traceback"
        if "bug in bondgraph" in self.stderr:
            return "calls itself a bug"
        if self.status not in (0, 1, 2):
            return f"ends with {self.status}"
        return _refusal_complaint(self) if self.status == 2 else ""


def _refusal_complaint(answer: Answer) -> str:
    lines = answer.stderr.splitlines()
    if len(lines) != 1 or not lines[0].startswith("bondgraph: "):
        return f"refuses in {len(lines)} lines"
    if len(lines[0]) > LONGEST_LINE:
        return f"refuses in {len(lines[0])} characters"
    return ""


def load() -> None:
    """Import what the trials use, before the first fork."""
    for name in (*(f"bondgraph.cli.{command}" for command in COMMANDS), *LIBRARIES):
        import_module(name)
    from bondgraph.loading import load_model  # noqa: PLC0415
    from bondgraph.recordings.model_channels import read_for  # noqa: PLC0415

    with tempfile.TemporaryDirectory() as folder:
        model, recording = Path(folder) / "model.py", Path(folder) / "good.csv"
        model.write_bytes(MODEL)
        recording.write_bytes(csv())
        read_for(load_model(str(model)), recording)


def asked(words: list[str], folder: Path, *, search: bool = False) -> Answer:
    """Run the program in a fork, in `folder`, under the limits.

    Unless `search` is true, a diagnosis stops where its search would begin: what is
    looked at here is what happens to files.
    """
    begin = time.perf_counter()
    out, err = folder / ".stdout", folder / ".stderr"
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    child = os.fork()
    if child == 0:
        _run(words, folder, out, err, search=search)
    deadline = begin + WALL
    while True:
        ended, status, usage = os.wait4(child, os.WNOHANG)
        if ended:
            break
        if time.perf_counter() > deadline:
            os.kill(child, signal.SIGKILL)
            _, status, usage = os.wait4(child, 0)
            break
        time.sleep(0.01)
    return Answer(
        status=os.waitstatus_to_exitcode(status),
        stdout=_text(out),
        stderr=_text(err),
        seconds=usage.ru_utime + usage.ru_stime,
        memory=max(0, usage.ru_maxrss * 1024 - before),
    )


def _text(path: Path) -> str:
    with path.open("rb") as file:
        return file.read(1 << 20).decode("utf-8", "replace")


def _run(
    words: list[str], folder: Path, out: Path, err: Path, *, search: bool
) -> NoReturn:
    """Be the program: never returns."""
    status = 99
    try:
        for path, stream in ((out, 1), (err, 2)):
            opened = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(opened, stream)
        sys.stdout = os.fdopen(1, "w", encoding="utf-8", closefd=False)
        sys.stderr = os.fdopen(2, "w", encoding="utf-8", closefd=False)
        os.chdir(folder)
        room = _address_space() + MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (room, room))
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 2))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if not search:
            import_module("bondgraph.cli.diagnosing").diagnose = _no_search
        program = import_module("bondgraph.cli.program").program
        program.main(words, prog_name="bondgraph")
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 98
    except BaseException:  # what got past the program is what is looked for
        traceback.print_exc()
    finally:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
        os._exit(status)


def _no_search(*_: Any, **__: Any) -> NoReturn:
    raise SystemExit(0)


def _address_space() -> int:
    with Path("/proc/self/statm").open() as file:
        return int(file.read().split()[0]) * resource.getpagesize()


def damaged_file(seed: int) -> dict[str, Any]:
    """Damage a file by a seed and ask the program about it; return what came of it."""
    if "bondgraph.cli.shape" not in sys.modules:
        load()
    draw = random.Random(seed)
    kind = list(KINDS)[seed % len(KINDS)]
    name, make, commands = KINDS[kind]
    damage: Callable[..., bytes] = draw.choice(DAMAGES[kind])
    words = list(draw.choice(commands))
    folder = Path(tempfile.mkdtemp(prefix="fuzzing"))
    try:
        (folder / "model.py").write_bytes(MODEL)
        (folder / "good.py").write_bytes(MODEL)
        (folder / "good.csv").write_bytes(csv())
        content = damage(draw, make())
        (folder / name).write_bytes(content)
        answer = asked(words, folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    said = (
        answer.stderr[-OUTPUT_SHOWN:]
        if answer.complaint
        else answer.stderr[:OUTPUT_SHOWN]
    )
    end = FileEnd.REFUSED_FILE if answer.status == 2 else FileEnd.SERVED
    return {
        "seed": seed,
        "kind": f"{kind}: {damage.__name__.replace('_', ' ')}",
        "end": (FileEnd.BROKEN if answer.complaint else end).name,
        "command": " ".join(words[:4]),
        "said": f"{answer.complaint}: {said}" if answer.complaint else said,
        "seconds": answer.seconds,
        "memory": answer.memory,
    }
