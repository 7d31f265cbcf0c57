"""A new folder as a new user meets it: what its README says can be typed, and works."""

import json
import re
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner

from bondgraph.cli.program import program
from bondgraph.cli.starting.starts import STARTS, TRAIN
from bondgraph.loading import load_model

READ = ("--reading", "reading.toml")


def run(*words):
    return CliRunner().invoke(program, [str(word) for word in words])


@pytest.fixture(params=STARTS)
def folder(request, tmp_path, monkeypatch):
    """Make a folder as the command does, and go there; return the machine's name."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert run("new", "mine", "--like", request.param).exit_code == 0
    monkeypatch.chdir(tmp_path / "mine")
    return request.param


def printed_commands():
    readme = Path("README.md").read_text("utf-8")
    (block,) = re.findall(r"^```sh\n(.*?)^```", readme, flags=re.M | re.S)
    return [shlex.split(line, comments=True)[1:] for line in block.splitlines()]


def test_every_printed_command_but_the_long_one_works(folder):
    commands = printed_commands()
    names = [words[0] for words in commands]
    assert names == ["derive", "draw", "check", "simulate", "fit", "diagnose"]
    for words in commands[:-1]:
        result = run(*words)
        assert result.exit_code == 0, result.output
    assert Path(f"{folder}.svg").read_text().startswith("<svg")
    assert load_model("fitted.py").name == load_model(f"{folder}.py").name


def test_a_folder_is_named_as_a_shell_reads_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = run("new", "my motor")
    assert said.exit_code == 0, said.output
    (line,) = (line for line in said.output.splitlines() if "  cd " in line)
    assert shlex.split(line) == ["cd", "my motor"]


def test_the_made_recordings_do_not_fit_the_model_alone(folder):
    words = ("fit", f"{folder}.py", TRAIN, *READ, "--json", "-")
    fitted = json.loads(run(*words).stdout)
    assert fitted["nrmse"] > 0.03


def test_what_the_readme_says_is_hidden_is_found(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert run("new", ".", "--like", "tanks").exit_code == 0
    diagnose = printed_commands()[-1]
    result = run(*diagnose, "--workers", 1, "--json", "-")
    assert result.exit_code == 0, result.output
    (finding,) = json.loads(result.stdout)["findings"]
    assert (finding["physics"], finding["place"]) == ("overflow", "upper")
    level = finding["parameters"]["overflow_level_upper"]["value"]
    assert level == pytest.approx(3.2e3, rel=0.01)
    assert Path("report.html").stat().st_size > 10_000


def test_nothing_is_written_over(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine").mkdir()
    Path("mine/notes.txt").write_text("mine")
    result = run("new", "mine")
    assert result.exit_code == 2
    assert "is not empty" in result.stderr
    assert [path.name for path in Path("mine").iterdir()] == ["notes.txt"]


def test_a_folder_that_cannot_be_made_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("file").touch()
    result = run("new", "file/mine")
    assert result.exit_code == 2
    assert "cannot be made" in result.stderr


def test_the_answer_as_json_names_the_files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    answer = json.loads(run("new", "mine", "--json", "-").stdout)
    assert all((tmp_path / "mine" / file).exists() for file in answer["files"])
    readme = Path("mine/README.md").read_text("utf-8")
    assert "A DC motor that turns a flywheel: a model" in readme
