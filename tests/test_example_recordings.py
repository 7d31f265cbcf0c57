"""The commands that examples/recordings print can be typed: files, units, channels."""

import importlib.util
import os
import re
import shlex
from pathlib import Path

import pytest

from bondgraph.cli import diagnose as command_module
from bondgraph.cli import main

ROOT = Path(__file__).parent.parent
REAL = Path(
    os.environ.get("BONDGRAPH_RECORDINGS", ROOT.parent / "shared" / "recordings")
)
EXAMPLES = ROOT / "examples" / "recordings"
pytestmark = pytest.mark.skipif(
    not REAL.is_dir(), reason=f"the real recordings are not at {REAL}"
)


def commands():
    """Return the diagnose commands of all docstrings, joined to one line each."""
    for path in sorted(EXAMPLES.glob("*.py")):
        text = path.read_text().split('"""')[1]
        lines = re.sub(r"\\\n\s+", " ", text.replace("\\\\\n", "\\\n")).splitlines()
        for line in lines:
            if line.strip().startswith("bondgraph diagnose"):
                yield pytest.param(line.strip(), id=f"{path.stem}-{line.split()[2]}")


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    pytest.importorskip("pandas")
    spec = importlib.util.spec_from_file_location("prepare", EXAMPLES / "prepare.py")
    prepare = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(prepare)
    target = tmp_path_factory.mktemp("prepared")
    for made in (prepare.servos, prepare.seals, prepare.damper, prepare.draining_tank):
        made(REAL, target)
    return target


def expanded(line, prepared):
    """Return the words of a command as a shell would, with its files found."""
    held_out = re.search(r"\$\(printf -- '--held-out %s ' (\S+)\)", line)
    words = shlex.split(line.replace(held_out[0], "") if held_out else line)[1:]
    if held_out:
        for path in sorted(prepared.glob(held_out[1].removeprefix("prepared/"))):
            words += ["--held-out", str(path)]
    found = []
    for word in words:
        if word.startswith("prepared/"):
            paths = sorted(prepared.glob(word.removeprefix("prepared/")))
            assert paths, word
            found += map(str, paths)
        else:
            real = word.replace("../shared/recordings", str(REAL))
            found.append(real.replace("examples/", f"{ROOT}/examples/"))
    return found


@pytest.mark.parametrize("line", list(commands()))
def test_a_printed_command_finds_what_it_needs(line, prepared, monkeypatch):
    asked = []

    def answer(session, graph, training, held_out, **choices):
        asked.append((graph, training, held_out))

    monkeypatch.setattr(command_module, "answer", answer)
    monkeypatch.setattr("sys.argv", ["bondgraph", *expanded(line, prepared)])
    with pytest.raises(SystemExit) as left:
        main()
    assert left.value.code in (0, None)
    ((graph, training, held_out),) = asked
    names = tuple(m.name for m in graph.measurements)
    assert all(r.output_names == names for r in (*training, *held_out))
    assert training
    assert held_out


def test_every_recording_set_has_a_command():
    told = "".join(path.read_text() for path in EXAMPLES.glob("*.py"))
    for folder in sorted(REAL.iterdir()):
        if folder.is_dir():
            assert folder.name in told or folder.name.split("_")[0] in told
