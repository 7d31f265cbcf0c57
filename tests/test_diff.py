"""Two versions of a model told apart on the command line, and in sentences."""

import json
from itertools import pairwise
from pathlib import Path

import pytest
import sympy
from click.testing import CliRunner, Result

from bondgraph import BondGraph, C, CField, FinishedGraph, I, R, Se, ports
from bondgraph.cli.program import program
from bondgraph.reporting.differences import describe_difference

MODEL = """
from bondgraph import BondGraph, I, R, Se, TF

def model():
    g = BondGraph("drive", domain="rotation")
    g.one("motor", Se("torque"), I("j"))
    g.one("worm", I("j_worm"))
    g.join("motor", TF("k"), "worm")
    return g
"""


def run(*words: object) -> Result:
    return CliRunner().invoke(program, [str(word) for word in words])


@pytest.fixture
def versions(tmp_path: Path) -> tuple[str, str]:
    before, after = tmp_path / "before.py", tmp_path / "after.py"
    before.write_text(MODEL)
    after.write_text(MODEL.replace('I("j_worm")', 'I("j_worm"), R("friction")'))
    return f"{before}:model", f"{after}:model"


def test_equal_models_have_no_difference(versions: tuple[str, str]) -> None:
    result = run("diff", versions[0], versions[0])
    assert (result.exit_code, result.output) == (0, "no difference\n")


def test_a_difference_is_a_sentence_and_status_one(versions: tuple[str, str]) -> None:
    result = run("diff", *versions, "--json", "-")
    assert result.exit_code == 1
    assert json.loads(result.output)["differences"] == [
        "one R added at worm",
        "parameter friction added: no value",
    ]
    assert run("diff", *versions).output.startswith("one R added at worm\n")


def test_a_missing_model_is_one_line_and_status_two(versions: tuple[str, str]) -> None:
    result = run("diff", versions[0], "nowhere.py:model")
    assert result.exit_code == 2
    assert result.output.startswith("bondgraph: ")
    assert result.output.count("\n") == 1


def body(
    stiffness: str = "k", on: tuple[str, str] = ("a", "b"), domain: str = "translation"
) -> BondGraph:
    q1, q2 = ports("q", 2)
    k, other = sympy.Symbol("k"), sympy.Symbol(stiffness)
    g = BondGraph("body", domain=domain)
    g.one("a", Se("u"), I("m"))
    g.one("b", R("r"))
    g.put(CField("spring", (k * q1, other * q2)), on=on)
    return g


def told(before: BondGraph, after: BondGraph) -> tuple[str, ...]:
    return describe_difference(before.finish(), after.finish())


def test_the_laws_of_a_field_are_compared() -> None:
    found = told(body(), body("k2"))
    assert found[0] == (
        "the law of spring replaced: (q[1]*k, q[2]*k) before, (q[1]*k, q[2]*k2) now"
    )


def test_the_order_of_a_field_s_ports_is_a_change() -> None:
    found = told(body(), body(on=("b", "a")))
    assert "the ports of spring are at b, a, before a, b" in found


def test_a_wish_for_causality_is_a_change() -> None:
    wished = body()
    wished.prefer("m", "derivative")
    assert told(body(), wished) == (
        "the preferred causality of m is derivative, before left open",
    )
    assert told(wished, body()) == (
        "the preferred causality of m is left open, before derivative",
    )


def test_another_domain_is_a_change() -> None:
    found = told(body(), body(domain="rotation"))
    assert "the bond u>a is of rotation, before translation" in found


def ring(*names: str) -> FinishedGraph:
    g = BondGraph("ring")
    g.one("a", Se("u"), R("r"))
    g.zero("b", C("c"))
    for tail, head in pairwise(names):
        g.join(tail, head)
    return g.finish()


def test_bonds_between_the_same_junctions_are_told_apart() -> None:
    assert describe_difference(ring("a", "b"), ring("a", "b", "a")) == (
        "the bond b>a added",
    )
    assert describe_difference(ring("a", "b"), ring("b", "a")) == (
        "the half arrow of a>b reversed",
    )
