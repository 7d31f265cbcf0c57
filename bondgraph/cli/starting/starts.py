"""The machines that ``bondgraph new`` starts from, and the files it makes of one."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from io import StringIO

import numpy as np

from bondgraph.cli.starting.benches import (
    Array,
    motor_columns,
    spring_columns,
    tanks_columns,
)

SAMPLES = 800
TRAIN, HELD_OUT = "recordings/train.csv", "recordings/held_out.csv"
READING, CHECKS, README = "reading.toml", "checks.toml", "README.md"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Start:
    """A machine to start from.

    Parameters
    ----------
    name
        Of the machine, of its model file and of the function in it.
    is_what
        The machine in a few words.
    channels
        The recording's column for each name of the model.
    check
        A gain that is declared: input, output, value in SI units.
    place, hidden
        Where the recorded machine has more than the model, and what, in words.
    columns
        Returns a recording of so many samples with this seed.
    """

    name: str
    is_what: str
    channels: Mapping[str, str]
    check: tuple[str, str, float]
    place: str
    hidden: str
    columns: Callable[[int, int], Mapping[str, Array]]


STARTS = {
    one.name: one
    for one in (
        Start(
            name="motor",
            is_what="a DC motor that turns a flywheel",
            channels={"time": "t", "voltage": "U", "current": "i", "speed": "n"},
            check=("voltage", "speed", 250.0 / 12.6),
            place="shaft",
            hidden="dry friction of 0.012 N·m in the bearing",
            columns=motor_columns,
        ),
        Start(
            name="spring",
            is_what="a carriage on a spring, shaken by a force",
            channels={"time": "t", "force": "F", "position": "x"},
            check=("force", "position", 0.01),
            place="carriage",
            hidden="a spring that hardens, by 4·10⁴ N/m³ times the position cubed",
            columns=spring_columns,
        ),
        Start(
            name="tanks",
            is_what="two tanks in a row, filled by a pump",
            channels={
                "time": "t", "pump": "Q", "upper_level": "p1", "lower_level": "p2",
            },
            check=("pump", "lower_level", 1e7),
            place="upper",
            hidden="water that runs over its edge from 3.2 kPa on",
            columns=tanks_columns,
        ),
    )
}  # fmt: skip


def files_of(start: Start, name: str) -> dict[str, str]:
    """Return the text of every file of a new folder, by its path in the folder.

    Parameters
    ----------
    start
        The machine to start from.
    name
        What the user calls the folder.
    """
    model = files("bondgraph.cli.starting").joinpath(f"{start.name}.py")
    return {
        f"{start.name}.py": model.read_text(encoding="utf-8"),
        READING: _reading(start),
        CHECKS: _checks(start),
        TRAIN: _csv(start.columns(SAMPLES, 1)),
        HELD_OUT: _csv(start.columns(SAMPLES, 2)),
        README: _readme(start, name),
    }


def commands(start: Start) -> dict[str, str]:
    """Return the commands to type in a new folder, each with what it does."""
    model, read = f"{start.name}.py", f"--reading {READING}"
    return {
        f"bondgraph derive {model}": "causality, equations, transfer functions",
        f"bondgraph draw {model} -o {start.name}.svg": "the bond graph as a picture",
        f"bondgraph check {CHECKS}": "derived gains against declared ones, for CI",
        f"bondgraph simulate {model} {TRAIN} {read}": "how far the model is off",
        f"bondgraph fit {model} {TRAIN} {read} -o fitted.py": "its parameters, fitted",
        f"bondgraph diagnose {model} {TRAIN} --held-out {HELD_OUT} {read} "
        "--html report.html": "what the model leaves out",
    }


def _reading(start: Start) -> str:
    lines = "\n".join(f'{ours} = "{theirs}"' for ours, theirs in start.channels.items())
    return f"""\
# How the recordings are read: --reading {READING} stands for these options.
# Units come from the header, as in "n [rpm]"; where a file has none, write
# name = "column[unit]". Other lines that may stand above [map]:
#   gaps = "drop"     order = "sort"    decimal = ","     delimiter = ";"
#   begin = 2.5       end = 60.0        (seconds: what lies outside is left out)

hold = "zero"  # inputs keep their value between two samples, as a converter's output

[map]  # the model's name = "the file's column"
{lines}
"""


def _checks(start: Start) -> str:
    source, output, value = start.check
    return f"""\
# What must stay true of the model when somebody edits it: bondgraph check {CHECKS}

[[check]]
name = "{output} per {source}, at rest"
model = "{start.name}.py:{start.name}"
input = "{source}"
output = "{output}"
quantity = "dc_gain"
value = {value!r}
relative_tolerance = 1e-6
"""


def _readme(start: Start, name: str) -> str:
    listed = "\n".join(
        f"{command}  # {does}" for command, does in commands(start).items()
    )
    first, rest = start.is_what[0], start.is_what[1:]
    return f"""\
# {name}

{first.upper()}{rest}: a model, two recordings, and what to type.

```sh
{listed}
```

Open `report.html` afterwards.

| File | Is |
| --- | --- |
| `{start.name}.py` | the model: edit it until it is your machine |
| `{TRAIN}`, `{HELD_OUT}` | recordings: put your own in their place |
| `{READING}` | which column of a recording is which channel of the model |
| `{CHECKS}` | gains, poles and margins that must stay what they are |

To make it yours: record the inputs and outputs of your machine in a CSV with a header
such as `{",".join(start.columns(1, 1))}`, draw it in `{start.name}.py`, and map the
columns in `{READING}`. There `hold = "zero"` says that the input keeps its value
between two samples, as a converter's output does; write `"first"` where it goes on in
straight lines. Move the machine in both directions, fast and slow, through the whole
range; what no recording excites, no diagnosis can see.

The recordings here come from a simulated machine. It has one thing that the model lacks
(at `{start.place}`): {start.hidden}. `bondgraph diagnose` should find it.
"""


def _csv(columns: Mapping[str, Array]) -> str:
    text = StringIO()
    table = np.column_stack(list(columns.values()))
    header = ",".join(columns)
    np.savetxt(text, table, delimiter=",", header=header, comments="", fmt="%.7g")
    return text.getvalue()
