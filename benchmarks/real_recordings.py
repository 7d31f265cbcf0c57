"""Every set of real recordings diagnosed as its example says, in one table.

    .venv/bin/python -m benchmarks.real_recordings ../shared/recordings out
    .venv/bin/python -m benchmarks.real_recordings ../shared/recordings out --only emps

The commands are those that the docstrings of ``examples/recordings`` print. ``out``
gets the report page and the JSON of each, and ``table.md``. A set that has an answer
there already is not run again. The recordings are not part of this project; what is
expected of them comes from the papers and files that the examples name.
"""

import argparse
import json
import re
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

EXAMPLES = Path(__file__).parent.parent / "examples" / "recordings"
PREPARED = ("servos", "seals", "damper", "draining_tank")
NOTHING = frozenset[str]()


@dataclass(frozen=True, slots=True)
class Known:
    """What is known of a set: physics that has to be said, and an error reached."""

    physics: frozenset[str]
    error: str


KNOWN = {
    "emps": Known(frozenset({"coulomb_friction"}), "2.07 N force equivalent"),
    "xl330": Known(frozenset({"load_dependent_friction"}), "0.048 rad mean"),
    "sts3215": Known(frozenset({"load_dependent_friction"}), "0.038 rad mean"),
    "worm_drive": Known(
        frozenset({"load_dependent_friction", "direction_dependent_friction"}),
        "0.04 mN m, odd rows",
    ),
    "tanks": Known(frozenset({"square_root_orifice", "overflow"}), "0.32 V"),
    "draining_tank": Known(frozenset({"square_root_orifice"}), "0.5 cm"),
    "damper": Known(frozenset({"hysteresis", "backlash", "compliance"}), "1360 N"),
    "seals": Known(frozenset({"load_dependent_friction"}), "0.15 N of friction"),
    "heater": Known(frozenset({"lag"}), "0.68 K"),
    "silverbox": Known(frozenset({"hardening_spring"}), "1.2 mV"),
    "two_link_flexible": Known(frozenset({"coulomb_friction"}), "0.030, 0.047 A"),
    "spring_mass": Known(NOTHING, "nothing missing"),
}
"""Where several words are given one of them is enough, but for the tanks."""


def commands() -> Iterator[tuple[str, str]]:
    """Yield the name of each set and its diagnose command."""
    for path in sorted(EXAMPLES.glob("*.py")):
        text = path.read_text("utf-8").split('"""')[1].replace("\\\\\n", "\\\n")
        for line in re.sub(r"\\\n\s+", " ", text).splitlines():
            if line.strip().startswith("bondgraph diagnose"):
                words = line.strip()
                model = words.split()[2]
                factory = model.partition(":")[2]
                yield (factory if path.stem == "servos" else path.stem), words


def expanded(line: str, recordings: Path, prepared: Path) -> list[str]:
    """Return the words of a command as a shell would, with its files found."""
    later = re.search(r"\$\(printf -- '--held-out %s ' (\S+)\)", line)
    words = shlex.split(line.replace(later[0], "") if later else line)[1:]
    if later:
        for path in sorted(prepared.glob(later[1].removeprefix("prepared/"))):
            words += ["--held-out", str(path)]
    found: list[str] = []
    for word in words:
        if word.startswith("prepared/"):
            found += map(str, sorted(prepared.glob(word.removeprefix("prepared/"))))
        else:
            real = word.replace("../shared/recordings", str(recordings))
            found.append(real.replace("examples/recordings", str(EXAMPLES)))
    return found


def run(name: str, words: Sequence[str], out: Path, workers: int) -> str:
    """Diagnose one set; return what went wrong, or nothing."""
    files = ["--json", str(out / f"{name}.json"), "--html", str(out / f"{name}.html")]
    began = time.perf_counter()
    done = subprocess.run(
        [
            *(sys.executable, "-c", "from bondgraph.cli import main; main()"),
            *(*words, *files, "--workers", str(workers), "-q"),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    took = time.perf_counter() - began
    (out / f"{name}.seconds").write_text(f"{took:.0f}\n")
    if done.returncode:
        return done.stderr.strip() or f"ended with status {done.returncode}"
    return ""


def row(name: str, answer: dict[str, Any], seconds: str) -> str:
    """Return the row of the table of one answer."""
    said = [f"{f['physics']} at {f['place']}" for f in answer["findings"]]
    others = {
        other["physics"]
        for finding in answer["findings"]
        for other in finding["alternatives"]
        if other["support"] == "supported"
    }
    fit = answer["fit"]["held_out"]
    errors = ", ".join(
        f"{channel} {before:.3g} → {_shown(fit['after']['rmse'][channel])}"
        for channel, before in fit["before"]["rmse"].items()
    )
    known = KNOWN[name]
    cells = (
        name,
        answer["verdict"].replace("_", " "),
        "; ".join(said) or "-",
        ", ".join(sorted(others)) or "-",
        errors,
        known.error,
        judged(answer, name),
        seconds,
    )
    return f"| {' | '.join(cells)} |"


def _shown(error: float | None) -> str:
    """Return an error as the table has it; none of a model that does not run."""
    return "does not run" if error is None else f"{error:.3g}"


def judged(answer: dict[str, Any], name: str) -> str:
    """Return whether the answer is right, silent or wrong."""
    known = KNOWN[name].physics
    said = {finding["physics"] for finding in answer["findings"]}
    if not known:
        return "right" if answer["verdict"] == "adequate" else "wrong"
    if answer["verdict"] in ("cannot_tell", "adequate"):
        return "does not say"
    enough = known <= said if name == "tanks" else bool(known & said)
    return "right" if enough else "wrong"


def main() -> None:
    """Run what has no answer yet, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recordings", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--workers", type=int, default=2)
    chosen = parser.parse_args()
    out, prepared = chosen.out, chosen.out / "prepared"
    prepared.mkdir(parents=True, exist_ok=True)
    recordings = chosen.recordings.resolve()
    for kind in PREPARED:
        prepare = [EXAMPLES / "prepare.py", kind, recordings, prepared]
        subprocess.run([sys.executable, *map(str, prepare)], check=True)
    rows = [
        "| recordings | verdict | said | or | held out, before → after | known "
        "| it is | seconds |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for name, line in commands():
        if chosen.only and name not in chosen.only:
            continue
        answer = out / f"{name}.json"
        if not answer.exists():
            words = expanded(line, recordings, prepared)
            wrong = run(name, words, out, chosen.workers)
            if wrong:
                print(f"{name}: {wrong}", file=sys.stderr)
                continue
        told = json.loads(answer.read_text("utf-8"))
        rows.append(row(name, told, (out / f"{name}.seconds").read_text().strip()))
        print(rows[-1], flush=True)
    (out / "table.md").write_text("\n".join(rows) + "\n", "utf-8")


if __name__ == "__main__":
    main()
