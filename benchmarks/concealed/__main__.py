"""``python -m benchmarks.concealed make | run | score | reduced | others | table``."""

import argparse
import tempfile
import time
from pathlib import Path

from benchmarks.concealed.seeds import SEED_SETS


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.concealed")
    commands = parser.add_subparsers(required=True)
    make = commands.add_parser("make", help="write cases, and the truth elsewhere")
    make.add_argument("--seed-set", choices=tuple(SEED_SETS), default="dev")
    make.add_argument("--out", type=Path, required=True)
    make.add_argument("--truth", type=Path, required=True)
    make.add_argument("--machines", nargs="*", default=())
    make.add_argument("--words", nargs="*", default=())
    make.add_argument("--most", type=int, help="how many cases from the beginning")
    make.set_defaults(work=_make)
    run = commands.add_parser("run", help="diagnose every case that has no answer")
    run.add_argument("--cases", type=Path, required=True)
    run.add_argument("--answers", type=Path, required=True)
    run.add_argument("--workers", type=int, default=1)
    run.add_argument("--limit", type=float, default=300.0, help="seconds per case")
    run.add_argument("--only", nargs="*", default=(), help="words in case names")
    run.add_argument("--most", type=int)
    run.add_argument("--seconds", type=float, default=float("inf"), help="for all")
    run.add_argument("--again", action="store_true", help="also what has failed")
    run.set_defaults(work=_run)
    score = commands.add_parser("score", help="compare the answers with the truth")
    score.add_argument("--answers", type=Path, required=True)
    score.add_argument("--truth", type=Path, required=True)
    score.add_argument("--out", type=Path, required=True)
    score.set_defaults(work=_score)
    reduced = commands.add_parser("reduced", help="nine small cases with a floor")
    reduced.add_argument("--folder", type=Path, help="kept; another run goes on there")
    reduced.set_defaults(work=_reduced)
    others = commands.add_parser("others", help="other methods on the same cases")
    others.add_argument("--cases", type=Path, required=True)
    others.add_argument("--truth", type=Path, required=True)
    others.add_argument("--out", type=Path, required=True)
    others.add_argument("--only", nargs="*", default=(), help="words in case names")
    others.add_argument("--answers", type=Path, help="the tool's, for a row of its own")
    others.set_defaults(work=_others)
    table = commands.add_parser("table", help="print which answers count as right")
    table.set_defaults(work=_table)
    chosen = parser.parse_args()
    chosen.work(chosen)


def _make(chosen: argparse.Namespace) -> None:
    from benchmarks.concealed.cases import cases  # noqa: PLC0415 - compiles
    from benchmarks.concealed.making import make  # noqa: PLC0415

    every = cases(
        chosen.seed_set, machines=tuple(chosen.machines), words=tuple(chosen.words)
    )
    for i, case in enumerate(every):
        if chosen.most is not None and i >= chosen.most:
            break
        begin = time.perf_counter()
        make(case, chosen.out, chosen.truth)
        print(f"{case.name} {time.perf_counter() - begin:.1f} s", flush=True)


def _run(chosen: argparse.Namespace) -> None:
    from benchmarks.concealed.running import run_all  # noqa: PLC0415

    run_all(
        chosen.cases,
        chosen.answers,
        workers=chosen.workers,
        limit=chosen.limit,
        names=tuple(chosen.only),
        most=chosen.most,
        again=chosen.again,
        budget=chosen.seconds,
    )


def _score(chosen: argparse.Namespace) -> None:
    from benchmarks.concealed.reporting import markdown, write_board  # noqa: PLC0415
    from benchmarks.concealed.scoring import score  # noqa: PLC0415

    scored = score(chosen.answers, chosen.truth)
    print(markdown(scored, write_board(scored, chosen.out)))


def _reduced(chosen: argparse.Namespace) -> None:
    from benchmarks.concealed.reduced import run_reduced  # noqa: PLC0415

    with tempfile.TemporaryDirectory() as temporary:
        found = run_reduced(chosen.folder or Path(temporary))
    print(found)
    raise SystemExit(0 if found.held else 1)


def _others(chosen: argparse.Namespace) -> None:
    from benchmarks.concealed.others.comparing import (  # noqa: PLC0415
        compare,
        of_the_tool,
        table,
    )

    chosen.out.mkdir(parents=True, exist_ok=True)
    kept = chosen.out / "others.json"
    rows = compare(chosen.cases, chosen.truth, tuple(chosen.only), kept)
    if chosen.answers:
        cases = {row["case"] for row in rows}
        rows += of_the_tool(chosen.answers, chosen.truth, cases)
    (chosen.out / "others.md").write_text(table(rows) + "\n", "utf-8")
    print(table(rows))


def _table(_: argparse.Namespace) -> None:
    from benchmarks.concealed.accepted import table  # noqa: PLC0415
    from benchmarks.concealed.machines import MACHINES  # noqa: PLC0415

    print(table(list(MACHINES.values())))


main()
