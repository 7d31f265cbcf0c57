"""What is said of bad recordings, on the command line, and that it is written down.

docs/robustness.md has a row for each of these inputs; a test compares the two.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bondgraph.cli.program import program

PAGE = Path(__file__).parents[1] / "docs" / "robustness.md"
HEADER = "time [s],force [N],velocity [m/s]"
MODEL = """
from bondgraph import BondGraph, I, R, Se

def cart() -> BondGraph:
    graph = BondGraph("cart", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), R("viscous"))
    graph.measure("velocity", flow="carriage")
    graph.parameter("mass", 1.0, "kg", bounds=(0.01, 100))
    graph.parameter("viscous", 0.5, "N*s/m", bounds=(0, 100))
    return graph
"""

Table = list[list[str]]


def table(rows: int = 60) -> Table:
    """Return rows of time, force and what the cart answers."""
    time = 0.02 * np.arange(rows)
    force = np.sign(np.sin(9.0 * time))
    velocity = np.zeros(rows)
    for k in range(rows - 1):
        velocity[k + 1] = 0.99 * velocity[k] + 0.02 * force[k]
    columns = zip(time, force, velocity, strict=True)
    return [[f"{x:.6g}" for x in row] for row in columns]


def text(rows: Table, header: str = HEADER, between: str = ",") -> str:
    lines = [header.replace(",", between), *(between.join(row) for row in rows)]
    return "\n".join(lines) + "\n"


def with_cell(row: int, column: int, word: str) -> str:
    rows = table()
    rows[row][column] = word
    return text(rows)


def with_times(change: Callable[[int, float], float]) -> str:
    rows = table()
    for i, row in enumerate(rows):
        row[0] = f"{change(i, float(row[0])):.15g}"
    return text(rows)


def every_other_empty(column: int) -> str:
    rows = table()
    for row in rows[1::2]:
        row[column] = ""
    return text(rows)


def with_degrees() -> bytes:
    header = f"{HEADER},temperature [°C]"
    return text([[*row, "20"] for row in table()], header).encode("latin-1")


@dataclass(frozen=True)
class Bad:
    """A bad recording, what is said of it, and the options that mend it, if any."""

    content: Callable[[], str | bytes]
    said: str
    way_out: tuple[str, ...] = ()


SWAPPED_UNITS = HEADER.replace("[N]", "[x]").replace("[m/s]", "[N]")
REFUSED = {
    "NaN": Bad(
        lambda: with_cell(6, 2, "nan"),
        "is not a finite number in 1 of 60 samples, first nan at line 8.",
        ("--gaps", "drop"),
    ),
    "infinite": Bad(
        lambda: with_cell(6, 2, "inf"),
        "is not a finite number in 1 of 60 samples, first inf at line 8.",
        ("--gaps", "keep"),
    ),
    "absurdly large": Bad(
        lambda: with_cell(6, 2, "1e300"),
        "is beyond 1e+100 in 1 of 60 samples, first 1e+300 at line 8.",
        ("--gaps", "keep"),
    ),
    "empty cell of an input": Bad(
        lambda: with_cell(6, 1, ""),
        "Channel 'force' of 'run.csv' is not a finite number",
        ("--gaps", "drop"),
    ),
    "word for a missing cell": Bad(
        lambda: with_cell(6, 2, "#N/A"),
        "Line 8 of 'run.csv' has '#N/A' in column 3 ('velocity [m/s]'), which is not "
        "a number.",
    ),
    "time that runs backward": Bad(
        lambda: text([*table()[:9], *table()[8:4:-1], *table()[9:]]),
        "runs backward in",
    ),
    "one swapped pair of rows": Bad(
        lambda: text([*table()[:5], *table()[6:4:-1], *table()[7:]]),
        "runs backward in one place, line 8:",
        ("--order", "sort"),
    ),
    "time that repeats": Bad(
        lambda: text([*table()[:6], *table()[5:]]),
        "repeats in one place, line 8:",
        ("--repeats", "first"),
    ),
    "time that stands still": Bad(
        lambda: with_times(lambda i, time: 1.0), "repeats in 59 places, first at line 3"
    ),
    "two clocks in one table, of outputs": Bad(
        lambda: every_other_empty(2),
        "is not a finite number in 30 of 60 samples",
        ("--gaps", "keep"),
    ),
    "two clocks in one table, of inputs": Bad(
        lambda: every_other_empty(1), "is not a finite number in 30 of 60 samples"
    ),
    "header of another unit": Bad(
        lambda: text(table(), HEADER.replace("m/s", "rad/s")),
        "'velocity' of the model is in 'm/s', and channel 'velocity' of 'run' is in "
        "'rad/s'",
    ),
    "channels whose units were swapped": Bad(
        lambda: text(table(), SWAPPED_UNITS.replace("[x]", "[m/s]")),
        "'force' of the model is in 'N', and channel 'force' of 'run' is in 'm/s'",
    ),
    "channel without a unit": Bad(
        lambda: text(table(), HEADER.replace(" [m/s]", "")),
        "Channel 'velocity' of 'run.csv' has no unit.",
        ("--unit", "velocity=m/s"),
    ),
    "row cut short": Bad(
        lambda: text(table())[: text(table()).rindex(",")],
        "Line 61 of 'run.csv' has 2 cells and the header 3.",
    ),
    "header repeated in the middle": Bad(
        lambda: text([*table()[:30], HEADER.split(","), *table()[30:]]),
        "Line 32 of 'run.csv' has 'time [s]' in column 1",
    ),
    "one row": Bad(
        lambda: text(table()[:1]), "has 1 sample; at least 8 are needed. Record longer"
    ),
    "header alone": Bad(lambda: text([]), "has a header and no samples."),
    "nothing": Bad(lambda: "", "is empty."),
    "UTF-16": Bad(
        lambda: text(table()).encode("utf-16"),
        "is not UTF-8 text; it looks like UTF-16.",
        ("--encoding", "utf-16"),
    ),
    "UTF-16 without its mark": Bad(
        lambda: text(table()).encode("utf-16-le"),
        "is not UTF-8 text; it looks like UTF-16-LE.",
        ("--encoding", "utf-16-le"),
    ),
    "UTF-32": Bad(
        lambda: text(table()).encode("utf-32"),
        "is not UTF-8 text; it looks like UTF-32.",
        ("--encoding", "utf-32"),
    ),
    "Latin-1": Bad(
        with_degrees,
        "Line 1 of 'run.csv' has the byte 0xb0, which is not UTF-8 text.",
        ("--encoding", "latin-1"),
    ),
    "semicolons": Bad(
        lambda: text(table(), between=";"),
        "is one column when cut at ','. It has ';' in it",
        ("--delimiter", ";"),
    ),
    "tabs": Bad(
        lambda: text(table(), between="\t"),
        "is one column when cut at ','. It has '\\t' in it",
        ("--delimiter", "\t"),
    ),
    "semicolons and decimal commas": Bad(
        lambda: text(table(), between=";").replace(".", ","),
        "is one column when cut at ','. It has ';' in it",
        ("--delimiter", ";", "--decimal", ","),
    ),
}

SERVED = {
    "jitter of the clock": lambda: with_times(
        lambda i, time: time + 0.004 * np.sin(7.0 * i)
    ),
    "a hole in time": lambda: text([*table()[:20], *table()[40:]]),
    "seconds since 1970": lambda: with_times(lambda i, time: 1.7e9 + time),
    "a mark of UTF-8": lambda: b"\xef\xbb\xbf" + text(table()).encode(),
    "line ends of Windows": lambda: text(table()).replace("\n", "\r\n"),
    "kilonewtons": lambda: text(
        [[time, f"{float(x) / 1e3:g}", v] for time, x, v in table()],
        HEADER.replace("[N]", "[kN]"),
    ),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("cart.py").write_text(MODEL)
    return tmp_path


def simulated(content, *options):
    data = content.encode() if isinstance(content, str) else content
    Path("run.csv").write_bytes(data)
    return CliRunner().invoke(program, ["simulate", "cart.py", "run.csv", *options])


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.usefixtures("folder")
def test_a_bad_recording_is_refused_in_one_line_with_its_place(name):
    result = simulated(REFUSED[name].content())
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.splitlines()
    assert REFUSED[name].said in line
    assert result.stdout == ""


@pytest.mark.parametrize("name", [n for n, bad in REFUSED.items() if bad.way_out])
@pytest.mark.usefixtures("folder")
def test_the_way_out_works(name):
    result = simulated(REFUSED[name].content(), *REFUSED[name].way_out)
    assert result.exit_code == 0, result.output


@pytest.mark.parametrize("name", SERVED)
@pytest.mark.usefixtures("folder")
def test_what_looks_odd_and_is_not_wrong_is_simulated_right(name):
    result = simulated(SERVED[name](), "--hold", "zero")
    assert result.exit_code == 0, result.output
    assert result.stderr == ""
    error = float(result.stdout.split(" m/s rms")[0].split()[-1])
    # Exact but for 0.99 in the place of exp(-0.01), and for the jitter of the inputs.
    assert error < (6e-3 if "jitter" in name else 2e-3)


@pytest.mark.parametrize("name", REFUSED)
def test_the_page_says_what_is_said(name):
    (row,) = (x for x in PAGE.read_text().splitlines() if x.startswith(f"| {name} |"))
    assert REFUSED[name].said in row


@pytest.mark.parametrize("value", ["0.1", "0"])
@pytest.mark.usefixtures("folder")
def test_an_error_is_not_relative_to_a_channel_that_never_changes(value):
    # The mean of 60 times 0.1 is not 0.1: to the last bit, its spread is not zero.
    header = f"{HEADER},travel [m]"
    Path("cart.py").write_text(
        MODEL.replace('flow="carriage")', 'flow="carriage"){}').format(
            '\n    graph.measure("travel", displacement="carriage")'
        )
    )
    both = text([[*row, value] for row in table()], header)
    result = simulated(both, "--json", "run.json")
    assert result.exit_code == 0, result.output
    assert "(without travel: recorded as one value only)" in result.stdout
    assert json.loads(Path("run.json").read_text())["nrmse"] < 0.2
    neither = text([[*row[:2], value, value] for row in table()], header)
    result = simulated(neither, "--json", "run.json")
    assert result.exit_code == 0, result.output
    assert "Together that is no share of the standard deviation" in result.stdout
    assert json.loads(Path("run.json").read_text())["nrmse"] is None
