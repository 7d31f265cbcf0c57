"""The main job, whole: nothing is replaced, so this is what a new user sees."""

import json

import pytest
from click.testing import CliRunner

from bondgraph.cli.program import program


def demo(folder, *words):
    result = CliRunner().invoke(program, ["demo", "--out", str(folder), *words])
    assert result.exit_code == 0, result.output
    return json.loads((folder / "result.json").read_text())


@pytest.mark.long  # 84 s; CI diagnoses load-dependent friction with its nine cases
def test_the_hidden_worm_friction_is_found_with_its_class(tmp_path):
    answer = demo(tmp_path)
    assert answer["verdict"] == "physics_missing"
    (finding,) = answer["findings"]
    assert finding["physics"] == "load_dependent_friction"
    # On a rigid train an angle alone cannot tell these apart.
    places = {finding["place"], *finding["indistinguishable_places"]}
    assert places == {"motor", "worm", "joint"}
    (mu,) = finding["parameters"].values()
    assert mu["value"] == pytest.approx(0.4, rel=0.03)
    held_out = answer["fit"]["held_out"]
    assert held_out["after"]["nrmse"] < 0.05 * held_out["before"]["nrmse"]
    assert "measure the torque" in answer["next_experiment"]["statement"]
    assert "load_dependent_friction" in answer["model"]
    assert (tmp_path / "report.html").stat().st_size > 10_000


def test_nothing_is_found_where_nothing_is_hidden(tmp_path):
    answer = demo(tmp_path, "--without-effect")
    assert answer["verdict"] == "adequate"
    assert answer["findings"] == []
