"""The command line as people expect it: help, quiet, colour, completion, resuming."""

import json
import os
import pty
import re
import shlex
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import click
import numpy as np
import pytest
from click.shell_completion import ShellComplete
from click.testing import CliRunner
from handmade_diagnosis import cart_diagnosis

from bondgraph.cli import diagnosing, simulate
from bondgraph.cli.program import COMMANDS, program
from bondgraph.cli.session import Session
from bondgraph.diagnosis.work.journal import FILE, Journal

MODEL = """
from bondgraph import BondGraph, I, R, Se

def cart() -> BondGraph:
    graph = BondGraph("cart", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), R("viscous"))
    graph.measure("velocity", flow="carriage")
    graph.parameter("mass", 2.0, "kg", bounds=(0.01, 100))
    graph.parameter("viscous", 0.8, "N*s/m", bounds=(0, 100))
    return graph

def sled() -> BondGraph:
    return cart()

def _private() -> BondGraph:
    return cart()
"""
ESCAPE = "\x1b["
BONDGRAPH = Path(sys.executable).with_name("bondgraph")


def run(*words, **environment):
    return CliRunner(env=environment).invoke(program, [str(word) for word in words])


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """Work in a folder with a model and a recording of it; return the folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    Path("cart.py").write_text(MODEL)
    time = 0.02 * np.arange(200)
    decay = np.exp(-0.4 * time)
    rows = np.column_stack([time, np.ones(200), (1 - decay) / 0.8])
    header = "t [s],F [N],v [km/h]"
    rows[:, 2] *= 3.6
    np.savetxt("run.csv", rows, delimiter=",", header=header, comments="")
    Path("bench.toml").write_text('[map]\ntime = "t"\nforce = "F"\nvelocity = "v"\n')
    return tmp_path


@pytest.fixture
def diagnosed(monkeypatch):
    """Replace the long search by a diagnosis made by hand."""

    def diagnose(*_, progress, **__):
        progress("round 1: fitting, 2 to do")
        progress("round 1: fitting, 1 of 2, about 3 s left")
        progress("round 1: fitting, 2 of 2")
        return cart_diagnosis()

    monkeypatch.setattr(diagnosing, "diagnose", diagnose)


def command_named(name):
    context = click.Context(program, info_name="bondgraph")
    return program.get_command(context, name)


EXAMPLES = [
    (name, line) for name in COMMANDS for line, _ in command_named(name).examples
]


@pytest.mark.parametrize("name", COMMANDS)
def test_help_has_examples(name):
    said = run(name, "--help").stdout
    assert "Examples:" in said
    assert f"    bondgraph {name}" in said


@pytest.mark.parametrize(("name", "line"), EXAMPLES)
def test_every_example_is_a_command_line_that_is_understood(name, line):
    first, *words = shlex.split(line)
    words = words[: words.index(">")] if ">" in words else words
    words = words[: words.index(">>")] if ">>" in words else words
    assert first == name
    parent = click.Context(program, info_name="bondgraph", obj=Session())
    command_named(name).make_context(name, words, parent=parent)


# Quiet and verbose


def test_quiet_leaves_the_answer_alone(bench, diagnosed):
    words = ("diagnose", "cart.py:cart", "run.csv", "--reading", "bench.toml")
    result = run(*words, "-q")
    assert result.exit_code == 0
    assert result.stderr == ""
    first, *rest = result.stdout.splitlines()
    assert first == "Physics is missing."
    assert "\n".join(rest) == cart_diagnosis().statement
    assert run("-q", *words).stdout == result.stdout
    assert len(run(*words).stdout) > len(result.stdout)


def test_verbose_says_each_step_once_and_how_it_ended(bench, diagnosed):
    words = ("diagnose", "cart.py:cart", "run.csv", "--reading", "bench.toml", "-v")
    steps = [s for s in run(*words).stderr.splitlines() if " s] " in s]
    said = [step.partition(" s] ")[2] for step in steps]
    assert said == ["round 1: fitting, 2 to do", "round 1: fitting, 2 of 2"]


# Colour


def test_text_is_coloured_only_where_it_is_asked_for(bench, diagnosed):
    words = ("diagnose", "cart.py:cart", "run.csv", "--reading", "bench.toml")
    assert ESCAPE not in run(*words).output
    coloured = run(*words, "--color", "always").stdout
    assert ESCAPE in coloured
    plain = re.sub(r"\x1b\[[0-9;]*m", "", coloured)
    assert plain.split() == run(*words).stdout.split()
    assert run(*words, "--colour", "never").output == run(*words).output


@pytest.mark.parametrize(
    ("environment", "coloured"),
    [({}, True), ({"NO_COLOR": "1"}, False), ({"TERM": "dumb"}, False)],
)
def test_a_terminal_is_coloured_unless_it_says_no(bench, environment, coloured):
    outer, inner = pty.openpty()
    clean = {k: v for k, v in os.environ.items() if k != "NO_COLOR"}
    subprocess.run(
        [BONDGRAPH, "derive", "nowhere.py"],
        env={**clean, "TERM": "xterm", **environment},
        stdout=subprocess.PIPE,
        stderr=inner,
        check=False,
    )
    os.close(inner)
    said = os.read(outer, 10_000).decode()
    os.close(outer)
    assert "There is no file" in said
    assert (ESCAPE in said) is coloured


def test_control_codes_in_a_name_do_not_reach_the_terminal(bench):
    text = MODEL.replace('BondGraph("cart"', r'BondGraph("\x1b[2Jca\x07rt\r"')
    Path("evil.py").write_text(text)
    for words in ((), ("--color", "always")):
        said = run("derive", "evil.py:cart", *words).stdout
        assert not set("\x1b\x07\r") & set(said)
        assert r"\x1b[2Jca\x07rt" in said


# Wrong words


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("derive", "m.py", "--laetx"), "There is no option --laetx. Did you mean"),
        (("fit", "m.py", "r", "--hold", "zreo"), "no 'zreo'. Did you mean zero?"),
        (("fit", "m.py", "r", "--loss", "L1"), "It is one of squared, huber, student."),
        (("fit", "m.py", "r", "--starts", "two"), "'two' is not a valid whole number"),
        (("completion", "bsh"), "Did you mean bash"),
        (("new", "x", "--like", "tank"), "Did you mean tanks?"),
        (("fit", "m.py", "r", "--color", "on"), "auto, always, never"),
    ],
)
def test_a_wrong_word_is_answered_with_the_nearest(words, said):
    result = run(*words)
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert said in line


# Completion


def completed(*words, begun=""):
    shell = ShellComplete(program, {}, "bondgraph", "_BONDGRAPH_COMPLETE")
    return [item.value for item in shell.get_completions(list(words), begun)]


def test_commands_options_and_models_are_completed(bench):
    assert completed(begun="d") == ["derive", "draw", "diagnose", "diff", "demo"]
    assert "--reading" in completed("fit", "cart.py", begun="--re")
    assert completed("fit", "m.py", "r", "--loss", begun="h") == ["huber"]
    assert completed("derive", begun="cart.py:") == ["cart.py:cart", "cart.py:sled"]
    assert completed("derive", begun="nothing.py:") == []


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_text_for_a_shell_calls_this_program(shell):
    text = run("completion", shell).stdout
    assert "_BONDGRAPH_COMPLETE" in text


def test_bash_completes_with_the_printed_text(tmp_path):
    script = tmp_path / "completion.bash"
    script.write_text(run("completion", "bash").stdout)
    asked = (
        f"source {script}; COMP_WORDS=(bondgraph dia); COMP_CWORD=1; "
        f"_bondgraph_completion {BONDGRAPH}; echo ${{COMPREPLY[@]}}"
    )
    done = subprocess.run(
        ["bash", "-c", asked], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "diagnose"


# A file of reading options


def test_a_file_says_how_recordings_are_read(bench):
    words = ("simulate", "cart.py:cart", "run.csv")
    assert run(*words).exit_code == 2
    result = run(*words, "--reading", "bench.toml", "--json", "-")
    assert json.loads(result.stdout)["nrmse"] < 1e-3


def test_the_command_line_goes_before_the_file(bench):
    Path("bench.toml").write_text('gaps = "drop"\n' + Path("bench.toml").read_text())
    words = ("simulate", "cart.py:cart", "run.csv", "--reading", "bench.toml")
    lines = Path("run.csv").read_text().splitlines()
    Path("run.csv").write_text("\n".join([*lines[:9], "0.16,1,nan", *lines[10:]]))
    assert run(*words).exit_code == 0
    assert run(*words, "--gaps", "refuse").exit_code == 2


def test_a_file_says_what_lies_between_the_samples_of_an_input(bench):
    Path("bench.toml").write_text('hold = "zero"\n' + Path("bench.toml").read_text())
    lines = Path("run.csv").read_text().splitlines()
    pushed = [line.replace(",1", f",{k % 2}", 1) for k, line in enumerate(lines[1:])]
    Path("run.csv").write_text("\n".join([lines[0], *pushed]))
    words = ("simulate", "cart.py:cart", "run.csv", "--reading", "bench.toml")

    def error(*more):
        return json.loads(run(*words, *more, "--json", "-").stdout)["nrmse"]

    held = error()
    assert held == error("--hold", "zero")
    assert held != error("--hold", "first")


def test_what_lies_before_and_after_a_time_is_left_out(bench):
    lines = Path("run.csv").read_text().splitlines()
    filled = [f"{line.split(',')[0]},5,9" for line in lines[1:51]]
    Path("run.csv").write_text("\n".join([lines[0], *filled, *lines[51:]]))
    words = ("simulate", "cart.py:cart", "run.csv", "--reading", "bench.toml")
    assert json.loads(run(*words, "--json", "-").stdout)["nrmse"] > 0.1
    part = (*words, "--begin", "1", "--end", "3")
    result = run(*part, "--json", "-", "-o", "both.csv")
    assert json.loads(result.stdout)["nrmse"] < 1e-3
    times = np.loadtxt("both.csv", delimiter=",", skiprows=1)[:, 0]
    np.testing.assert_allclose(times, np.arange(50, 151) * 0.02)
    nothing = run(*words, "--begin", "4")
    assert nothing.exit_code == 2
    assert "It was recorded from 0 to 3.98 s." in nothing.stderr
    steady = run(*part, "--steady")
    assert steady.exit_code == 2
    assert "Leave out --begin and --end, or --steady." in steady.stderr


def test_rows_of_a_table_without_a_solution_are_counted():
    measured = np.arange(10.0)[:, None]
    simulated = np.where(measured % 5.0 == 2.0, np.nan, measured)
    solution = SimpleNamespace(
        measured=measured, simulated=simulated, recording="table", reason="at t = 2 s"
    )
    table, run = (SimpleNamespace(name="table", steady=s) for s in (True, False))
    told = simulate._failed("valve", table, solution)
    assert "2 of the 10 rows of 'table' have no solution with 'valve'" in str(told)
    assert "the first is row 2, counted from 0" in str(told)
    assert "SECONDS" not in str(told)
    assert "at t = 2 s" in str(simulate._failed("valve", run, solution))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("gap = 1\n", "says 'gap', which is no option for recordings. Did you mean ga"),
        ('map = "t"\n', "'map' in 'bench.toml' has the wrong form. Write [map]"),
        ("[gaps]\n", "'gaps' in 'bench.toml' has the wrong form. Write gaps = ..."),
        ('gaps = "fill"\n', "there is no 'fill'. It is one of refuse, drop, keep."),
        ("map\n", "cannot be read as TOML"),
    ],
)
def test_a_bad_file_of_reading_options_is_refused(bench, text, said):
    Path("bench.toml").write_text(text)
    result = run("simulate", "cart.py:cart", "run.csv", "--reading", "bench.toml")
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert said in line


# What is said of a fit, and of a model that nothing drives

COASTING = """
from bondgraph import BondGraph, I, R

def coasting() -> BondGraph:
    graph = BondGraph("coasting", domain="translation")
    graph.one("carriage", I("mass"), R("viscous"))
    graph.measure("velocity", flow="carriage")
    graph.parameter("mass", 1.0, "kg")
    graph.parameter("viscous", 1.0, "N*s/m"FREE)
    return graph
"""


@pytest.fixture
def coasting(bench):
    time = 0.02 * np.arange(200)
    noise = 1e-4 * np.random.default_rng(1).normal(size=time.size)
    rows = np.column_stack([time, np.exp(-0.4 * time) + noise])
    header = "time [s],velocity [m/s]"
    np.savetxt("run.csv", rows, delimiter=",", header=header, comments="")
    Path("free.py").write_text(COASTING.replace("FREE", ""))
    Path("known.py").write_text(COASTING.replace("FREE", ", std=0.0"))


def test_what_cannot_be_told_comes_with_a_way_out_that_works(coasting):
    said = run("fit", "free.py", "run.csv").stdout
    assert "mass and viscous only as" in said
    assert "with std=0.0 it stays at its value" in said
    assert "95 % interval" not in said
    known = run("fit", "known.py", "run.csv").stdout
    assert "Not identifiable" not in known
    assert "std=0.0" not in known
    assert known.count("95 % interval") == 1


def test_intervals_are_listed_where_lines_are_too_short_for_a_column(coasting):
    short = run("fit", "known.py", "run.csv", COLUMNS="40").stdout
    assert short.count("95 % interval") == 1
    assert re.search(r"^  mass: 2\.\S+ to 2\.\S+ kg$", short, re.MULTILINE)


def test_a_model_that_nothing_drives_is_said_to_have_no_transfer_functions(coasting):
    said = run("derive", "free.py").stdout
    assert "transfer functions: none without an input and a measurement" in said


# Interrupted, and gone on with


def test_an_interrupted_diagnosis_goes_on_with_the_same_command(bench, monkeypatch):
    seen = []

    def interrupted(*_, options, **__):
        journal = Journal(options.resume)
        seen.append(journal.get("first"))
        if seen == [None]:
            journal.put("first", {"found": 1})
            raise KeyboardInterrupt
        return cart_diagnosis()

    monkeypatch.setattr(diagnosing, "diagnose", interrupted)
    words = ("diagnose", "cart.py:cart", "run.csv", "--reading", "bench.toml")
    first = run(*words)
    assert first.exit_code == 130
    assert "interrupted; the same command goes on from 1 result." in first.stderr
    second = run(*words)
    assert second.exit_code == 0
    assert "Going on from 1 result of an interrupted diagnosis." in second.stderr
    assert seen == [None, {"found": 1}]
    assert not list((bench / "cache").rglob(FILE))
