"""No command writes over what it reads."""

import shlex

import pytest
from click.testing import CliRunner

from bondgraph.cli.program import program

MODEL = "def leg(): raise SystemExit('it was run')"
RECORDING = "time [s],T [N*m],theta [rad]"


@pytest.mark.parametrize(
    ("words", "file"),
    [
        ("simulate leg.py:leg r.csv -o r.csv", "r.csv"),
        ("simulate leg.py:leg r.csv --json ./r.csv", "r.csv"),
        ("fit leg.py r.csv -o leg.py", "leg.py"),
        ("export leg.py:leg --to latex -o ../bench/leg.py", "leg.py"),
        ("export leg.py:leg --to c -o leg.py", "leg.py"),
        ("diagnose leg.py:leg a.csv --held-out r.csv --html r.csv", "r.csv"),
        ("diagnose leg.py:leg a.csv r.csv --next-experiment r.csv", "r.csv"),
        ("check leg.py --junit leg.py", "leg.py"),
    ],
)
def test_what_is_read_is_not_written_over(words, file, tmp_path, monkeypatch):
    bench = tmp_path / "bench"
    bench.mkdir()
    monkeypatch.chdir(bench)
    (bench / "leg.py").write_text(MODEL)
    (bench / "r.csv").write_text(RECORDING)
    before = (bench / file).read_text()
    result = CliRunner().invoke(program, shlex.split(words))
    assert result.exit_code == 2
    assert "would write over it" in result.stderr
    assert (bench / file).read_text() == before


def test_two_answers_do_not_go_into_one_file():
    words = shlex.split("diagnose leg.py:leg r.csv --html answer --json answer")
    result = CliRunner().invoke(program, words)
    assert result.exit_code == 2
    assert "'answer' is written by" in result.stderr
