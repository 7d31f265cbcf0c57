"""The command line: what it answers, its exit status, and how it refuses.

Exit status 0: fine, 1: the answer is no, 2: refused in one line, 130: interrupted.
"""

import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from handmade_diagnosis import cart_diagnosis

from bondgraph import Recording, read_recording
from bondgraph.cli import demo, diagnosing
from bondgraph.cli.fit_answer import hold_words
from bondgraph.cli.inputs import as_options
from bondgraph.cli.program import COMMANDS, program
from bondgraph.diagnosis.experiment.records import Experiment, ExperimentStatus
from bondgraph.diagnosis.records import Verdict
from bondgraph.loading import load_model
from bondgraph.simulation.solvers import Hold

MASS, VISCOUS = 2.0, 0.8
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


def run(*words):
    return CliRunner().invoke(program, [str(word) for word in words])


def refused(result):
    """Return the sentence of a refusal, after checking that it is one."""
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith("bondgraph: ")
    return line.removeprefix("bondgraph: ")


def recorded(
    path,
    *,
    header="time [s],force [N],velocity [m/s]",
    noise=1e-3,
    seed=3,
    held=20,
):
    """Write the cart's exact answer to a stepped force, plus noise, to a CSV file."""
    generator = np.random.default_rng(seed)
    step, count = 0.02, 400
    force = np.repeat(generator.uniform(-1, 1, count // held), held)
    decay = np.exp(-VISCOUS / MASS * step)
    velocity = np.zeros(count)
    for k in range(count - 1):
        velocity[k + 1] = decay * velocity[k] + (1 - decay) / VISCOUS * force[k]
    velocity += noise * generator.normal(size=count)
    rows = np.column_stack([step * np.arange(count), force, velocity])
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.9g")
    return path


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "cart.py"
    path.write_text(MODEL)
    return f"{path}:cart"


@pytest.fixture
def recording(tmp_path):
    return recorded(tmp_path / "run.csv")


# What the commands answer


def test_help_lists_every_command_without_importing_it():
    result = run()
    assert result.exit_code == 0
    for name, sentence in COMMANDS.items():
        assert f"{name} " in result.stdout
        assert sentence in result.stdout


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_explains_itself_and_has_json(name):
    result = run(name, "--help")
    assert result.exit_code == 0
    assert f"bondgraph {name}" in result.stdout.replace("program", "bondgraph")
    assert "--json" in result.stdout


def test_derive_gives_causality_equations_and_transfer_function(model):
    result = run("derive", model, "--set", "mass=8/2", "--reasons")
    assert result.exit_code == 0
    assert "integral: mass" in result.stdout
    assert "d(p_mass)/dt = " in result.stdout
    assert "velocity/force = 1/(mass*s + viscous)" in result.stdout
    assert "gain  0.25, and 2 at s = 0" in result.stdout
    assert "linear about" not in result.stdout
    assert "poles -0.125" in result.stdout


def test_derive_as_json_alone_on_stdout(model):
    answer = json.loads(run("derive", model, "--json", "-").stdout)
    assert answer["causality"]["integral"] == ["mass"]
    assert answer["transfer_functions"][0]["poles"] == [[-0.5, 0.0]]
    assert answer["transfer_functions"][0]["dc_gain"] == pytest.approx(2.0)
    assert set(answer["causality"]["strokes"]) == {
        *("force>carriage", "carriage>mass", "carriage>viscous")
    }


def test_derive_says_where_a_nonlinear_model_is_linear(tmp_path):
    path = tmp_path / "drag.py"
    law = 'R("viscous", law=Symbol("viscous") * f * Abs(f))'
    text = MODEL.replace('R("viscous")', law).replace("N*s/m", "N*s**2/m**2")
    imports = "from sympy import Abs, Symbol\nfrom bondgraph import f\n"
    path.write_text(imports + text)
    moving = run("derive", f"{path}:cart", "--at", "p_mass=3", "--json", "-")
    # d(viscous v |v|)/dv = 2 viscous v, over the mass
    (transfer,) = json.loads(moving.stdout)["transfer_functions"]
    assert transfer["poles"] == [[pytest.approx(-2 * 0.5 * 3.0), 0.0]]
    said = run("derive", f"{path}:cart", "--at", "p_mass=3").stdout
    assert "linear about p_mass=3 and all else 0" in said
    still = run("derive", f"{path}:cart").stdout
    assert "linear about all states and inputs 0" in still
    assert "gain  1\n" in still  # an integrator: there is none at s = 0


DRY = """
from bondgraph import BondGraph, C, I, R, Se, f
from sympy import Symbol, sign

def axis():
    g = BondGraph("axis", domain="translation")
    dry = R("dry", law=Symbol("coulomb") * sign(f) + Symbol("viscous") * f)
    g.one("carriage", Se("force"), I("mass"), dry)
    g.zero("grip")
    g.one("load", I("tip"))
    g.one("give", C("spring"))
    for end in ("carriage", "load", "give"):
        g.join(*(("carriage", "grip") if end == "carriage" else ("grip", end)))
    g.measure("speed", flow="carriage")
    for name, value, unit in (
        ("mass", 2.0, "kg"), ("coulomb", 1.0, "N"), ("viscous", 3.0, "N*s/m"),
        ("tip", 1.0, "kg"), ("spring", 0.01, "m/N"),
    ):
        g.parameter(name, value, unit)
    return g
"""


def test_derive_takes_the_speed_of_a_body_for_its_momentum(tmp_path):
    path = tmp_path / "axis.py"
    path.write_text(DRY)
    at = ("derive", f"{path}:axis", "--json", "-", "--at")
    by_speed = run(*at, "carriage=1.5")
    by_momentum = run(*at, "p_mass=3")
    assert by_speed.exit_code == by_momentum.exit_code == 0
    assert by_speed.stdout == by_momentum.stdout
    assert "viscous" in by_speed.stdout
    said = refused(run(*at, "give=1.5"))
    assert "does not stand for one state" in said
    assert said.endswith("Give states: p_mass, p_tip, q_spring.")


def test_derive_says_where_a_law_jumps(tmp_path):
    path = tmp_path / "axis.py"
    path.write_text(DRY)
    said = run("derive", f"{path}:axis").stdout
    assert "a law jumps at f_carriage = 0, it has no slope there" in said
    assert "DiracDelta" not in said
    said = run("derive", f"{path}:axis", "--at", "p_mas=1").stdout
    assert "no state or input 'p_mas'" in said
    assert "dforce" not in said


def test_derive_as_latex(model):
    result = run("derive", model, "--latex")
    assert r"\begin{aligned}" in result.stdout
    assert r"\frac{\mathrm{velocity}}{\mathrm{force}}" in result.stdout


CHECK = """
[[check]]
name = "gain"
model = "cart.py:cart"
input = "force"
output = "velocity"
quantity = "gain"
value = {value}
relative_tolerance = 1e-6
"""


def test_check_is_green_when_derived_as_declared(model, tmp_path):
    checks, junit = tmp_path / "checks.toml", tmp_path / "junit.xml"
    checks.write_text(CHECK.format(value=1.0))
    result = run("check", checks, "--junit", junit)
    assert result.exit_code == 0
    assert "1 of 1 as declared" in result.stdout
    assert 'failures="0"' in junit.read_text()


def test_check_is_red_when_a_gain_is_off(model, tmp_path):
    checks, answer = tmp_path / "checks.toml", tmp_path / "answer.json"
    checks.write_text(CHECK.format(value=1.01))
    result = run("check", checks, "--json", answer)
    assert result.exit_code == 1
    assert "OFF" in result.stdout
    assert "1 of 1 not as declared" in result.stdout
    assert json.loads(answer.read_text())["ok"] is False


def test_draw_writes_a_picture_with_strokes_and_blame(model, tmp_path):
    blame, picture = tmp_path / "result.json", tmp_path / "cart.svg"
    blame.write_text('{"blame": {"carriage": 0.42}}')
    assert run("draw", model, "-o", picture, "--blame", blame).exit_code == 0
    drawn = picture.read_text().split("</style>")[-1]
    assert "causal" in drawn
    assert "42" in drawn
    bare = run("draw", model, "--no-strokes").stdout
    assert bare.startswith("<svg")
    assert "causal" not in bare.split("</style>")[-1]


def test_simulate_compares_the_model_with_a_recording(model, recording, tmp_path):
    words = ("simulate", model, recording, "--hold", "zero", "--json", "-")
    wrong = json.loads(run(*words).stdout)
    out = tmp_path / "simulated.csv"
    right = json.loads(
        run(
            *words, "--set", f"mass={MASS}", "--set", f"viscous={VISCOUS}", "-o", out
        ).stdout
    )
    assert wrong["nrmse"] > 0.3
    assert right["rmse"]["velocity"] == pytest.approx(1e-3, rel=0.15)
    table = np.loadtxt(out, delimiter=",", skiprows=1)
    error = table[:, 1] - table[:, 2]
    assert np.sqrt(np.mean(error**2)) == pytest.approx(right["rmse"]["velocity"])
    assert out.read_text().startswith(
        "time [s],velocity [m/s],velocity_simulated [m/s]\n"
    )


RUNAWAY = MODEL.replace("bounds=(0, 100)", "bounds=(-100, 100)")


def test_simulate_of_what_runs_away_names_the_window(recording, tmp_path):
    model = tmp_path / "runaway.py"
    model.write_text(RUNAWAY)
    words = ("simulate", model, recording, "--set", "viscous=-5")
    assert "goes astray" in run(*words).stdout
    assert "--window SECONDS" in run(*words).stdout
    assert "goes astray" not in run(*words, "--window", 0.2).stdout
    assert "goes astray" not in run(*words[:3]).stdout


def test_smaller_steps_are_more_exact(model, tmp_path):
    path = recorded(tmp_path / "run.csv", noise=0.0)
    true = ("--set", f"mass={MASS}", "--set", f"viscous={VISCOUS}", "--hold", "zero")
    one, four = (
        json.loads(run("simulate", model, path, *true, *more, "--json", "-").stdout)
        for more in ((), ("--substeps", 4))
    )
    assert four["rmse"]["velocity"] < 0.2 * one["rmse"]["velocity"]
    assert "--substeps" in refused(run("simulate", model, path, "--substeps", 0))


@pytest.mark.parametrize(("held", "why"), [(20, "stay the same"), (1, "fits better")])
def test_simulate_tells_held_inputs_also_where_they_always_change(
    model, tmp_path, held, why
):
    true = ("--set", f"mass={MASS}", "--set", f"viscous={VISCOUS}")
    words = ("simulate", model, recorded(tmp_path / "run.csv", held=held), *true)
    said = run(*words).stdout
    assert "Inputs are taken to be held" in said
    assert why in said
    quiet = run(*words, "--quiet").stdout
    assert "rms" in quiet
    assert "Inputs" not in quiet
    errors = [
        json.loads(run(*words, "--hold", hold, "--json", "-").stdout)["nrmse"]
        for hold in ("auto", "zero", "first")
    ]
    assert errors[0] == errors[1] < 0.5 * errors[2]


def test_simulate_and_fit_leave_misreadings_out_and_say_so(model, recording, tmp_path):
    lines = Path(recording).read_text().splitlines()
    column = lines[0].split(",").index("velocity [m/s]")
    for row in (40, 171):
        cells = lines[row + 1].split(",")
        cells[column] = "-70"
        lines[row + 1] = ",".join(cells)
    spoilt = tmp_path / "spoilt.csv"
    spoilt.write_text("\n".join(lines))
    true = ("--set", f"mass={MASS}", "--set", f"viscous={VISCOUS}", "--hold", "zero")
    said = run("simulate", model, spoilt, *true, "--quiet").stdout
    assert (
        "velocity of spoilt jumps away and back at 0.8 s, 3.42 s (samples 40, 171, "
        in said
    )
    share = float(re.search(r"That is (.*) % of", said)[1])
    assert share < 1.0
    found = run("fit", model, spoilt, "--hold", "zero").stdout
    assert "taken for a misreading" in found
    mass = re.search(r"mass +\S+ +(\S+) ±", found)[1]
    assert float(mass) == pytest.approx(MASS, rel=0.02)


def test_fit_finds_the_parameters_and_writes_the_model(model, recording, tmp_path):
    fitted = tmp_path / "fitted.py"
    words = ("fit", model, recording, "--hold", "zero", "-o", fitted, "--json", "-")
    result = run(*words)
    assert result.exit_code == 0
    found = json.loads(result.stdout)["parameters"]
    for name, truth in (("mass", MASS), ("viscous", VISCOUS)):
        assert abs(found[name]["value"] - truth) < 5 * found[name]["std"] + 1e-3
        assert found[name]["std"] < 0.02
    again = load_model(f"{fitted}:model")
    assert again.parameters["mass"].value == pytest.approx(found["mass"]["value"])


def test_recordings_that_do_not_agree_on_steps_are_told_as_one():
    steps, waves = (
        SimpleNamespace(input_names=("force",), inputs=values[:, None])
        for values in (np.repeat(np.arange(10.0), 20), np.arange(200.0))
    )
    said = hold_words(Hold.FIRST, [steps, waves])
    assert "change from sample to sample, all recordings taken together" in said
    assert "taken together" not in hold_words(Hold.FIRST, [waves, waves])
    assert "taken together" not in hold_words(Hold.ZERO, [steps, steps])


def test_fit_says_how_far_it_ended_from_what_is_stated(model, recording, tmp_path):
    stated = tmp_path / "stated.py"
    old = 'parameter("mass", 1.0, "kg", bounds=(0.01, 100))'
    new = f'parameter("mass", {MASS + 0.3}, "kg", std=0.1)'
    stated.write_text(MODEL.replace(old, new))
    said = run("fit", stated, recording, "--hold", "zero").stdout
    (told,) = re.findall(r"how many of it away: mass (\S+)\.\n", said)
    assert float(told) == pytest.approx(3.0, abs=0.1)
    assert "how many of it away" not in run("fit", model, recording).stdout


def test_export_to_python_makes_the_same_graph(model, tmp_path):
    copy = tmp_path / "copy.py"
    assert run("export", model, "--to", "python", "-o", copy).exit_code == 0
    assert load_model(f"{copy}:model") == load_model(model)


def test_export_to_python_control_makes_a_system_with_names(model):
    scope = {}
    text = run("export", model, "--to", "python-control").stdout
    exec(text, scope)
    system = scope["system"]
    assert system.poles() == pytest.approx([-0.5])
    assert (system.input_labels, system.output_labels) == (["force"], ["velocity"])


def test_export_to_json_and_latex(model):
    system = json.loads(run("export", model, "--to", "json").stdout)
    assert system["A"] == [[-0.5]]
    assert system["units"]["outputs"] == ["m/s"]
    assert r"\begin{aligned}" in run("export", model, "--to", "latex").stdout


# Diagnosis: which recordings are shown, and what is told


@pytest.fixture
def asked(monkeypatch):
    """Replace the long search by a diagnosis made by hand; return what it was asked."""
    asked = {}

    def diagnose(graph, recordings, *, held_out, options, progress):
        progress("looking")
        asked.update(graph=graph, train=recordings, held_out=held_out, options=options)
        return asked.get("answer", cart_diagnosis())

    monkeypatch.setattr(diagnosing, "diagnose", diagnose)
    return asked


def test_diagnose_holds_out_the_last_part_and_says_so(model, recording, asked):
    result = run("diagnose", model, recording)
    assert result.exit_code == 0
    assert "the first 60 % of each recording trains" in result.stderr
    (train,), (held_out,) = asked["train"], asked["held_out"]
    assert len(train) == 240
    assert train.time[-1] < held_out.time[0]
    assert cart_diagnosis().statement in result.stdout
    assert "Physics is missing" in result.stdout
    (name, noise), *_ = cart_diagnosis().noise_floor.items()
    times = cart_diagnosis().held_out.after.rmse[name] / noise
    assert f"held-out error at the end: {times:.2g} times that" in result.stdout


def test_diagnose_takes_another_split_and_another_window(model, recording, asked):
    words = ("--split", "0.25", "--window", "1.5", "--hold", "zero")
    assert run("diagnose", model, recording, *words).exit_code == 0
    assert len(asked["train"][0]) == 100
    settings = asked["options"].settings
    assert settings.horizon.duration == 1.5
    assert settings.hold.name == "ZERO"


def test_diagnose_keeps_the_held_out_recordings_apart(
    model, recording, asked, tmp_path
):
    other = recorded(tmp_path / "other.csv", seed=4)
    page, answer = tmp_path / "r.html", tmp_path / "r.json"
    result = run(
        *("diagnose", model, recording, "--held-out", other),
        *("--html", page, "--json", answer),
    )
    assert result.exit_code == 0
    assert [r.name for r in asked["train"]] == ["run"]
    assert [r.name for r in asked["held_out"]] == ["other"]
    assert "first 60 %" not in result.output
    assert f"Report page: {page}\nLook first at the held-out" in result.stdout
    assert page.read_text().startswith("<!DOCTYPE html>")
    assert json.loads(answer.read_text())["verdict"] == "physics_missing"


def test_diagnose_gives_json_alone_on_stdout(model, recording, asked):
    result = run("diagnose", model, recording, "--json", "-")
    assert json.loads(result.stdout)["schema"] == 1


def test_diagnose_writes_what_to_play_next_or_why_there_is_nothing(
    model, recording, asked, tmp_path
):
    path, answer = tmp_path / "play.csv", tmp_path / "answer.json"
    words = ("diagnose", model, recording, "--next-experiment", path)
    result = run(*words, "--json", answer)
    assert result.exit_code == 0
    assert f"{path} was not written: there is nothing to tell apart." in result.stderr
    assert not path.exists()
    # Whoever has the JSON can ask again.
    command = json.loads(answer.read_text())["provenance"]["command"]
    assert command.startswith(f"bondgraph diagnose {model} {recording} ")

    time = 0.01 * np.arange(100)
    played = Recording.from_arrays("steps", time, {"force": (np.sign(time - 0.5), "N")})
    designed = Experiment(
        status=ExperimentStatus.DECISIVE,
        statement="Play steps.",
        sigmas=30.0,
        recorded_sigmas=2.0,
        input=played,
        inputs=(),
        sensors=(),
    )
    asked["answer"] = replace(cart_diagnosis(), experiment=designed)
    assert run(*words).exit_code == 0
    np.testing.assert_array_equal(
        read_recording(path).channel("force").values, played.channel("force").values
    )


@pytest.mark.parametrize("verdict", Verdict)
def test_every_verdict_is_an_answer(model, recording, asked, verdict):
    asked["answer"] = replace(cart_diagnosis(), verdict=verdict)
    assert run("diagnose", model, recording).exit_code == 0


def test_diagnose_does_not_show_on_what_it_trained_on(model, recording, asked):
    said = refused(run("diagnose", model, recording, "--held-out", recording))
    assert "held out and has the same content" in said


def test_files_of_one_name_are_told_apart(model, recording, asked, tmp_path):
    (tmp_path / "b").mkdir()
    other = recorded(tmp_path / "b" / "run.csv", seed=5)
    run("diagnose", model, recording, "--held-out", other)
    assert asked["train"][0].name != asked["held_out"][0].name


def test_an_interrupted_run_says_what_was_kept(model, recording, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(diagnosing, "diagnose", interrupted)
    result = run("diagnose", model, recording)
    assert result.exit_code == 130
    assert "bondgraph: interrupted; nothing was written." in result.stderr


def test_an_unexpected_error_is_named_a_bug_and_never_hidden(
    model, recording, monkeypatch
):
    def broken(*_, **__):
        raise ZeroDivisionError("float division by zero")

    monkeypatch.setattr(diagnosing, "diagnose", broken)
    result = run("diagnose", model, recording)
    assert result.exit_code == 2
    assert "this is a bug in bondgraph" in result.stderr
    assert "ZeroDivisionError: float division by zero" in result.stderr
    assert "Traceback" not in result.stderr
    shown = run("--traceback", "diagnose", model, recording)
    assert "Traceback" in shown.stderr
    assert "in broken" in shown.stderr


# The demo, with the search replaced: what it hides, writes and concludes


@pytest.fixture
def short_demo(asked, monkeypatch, tmp_path):
    """Return a function that runs the demo with half a second of recording."""
    monkeypatch.setattr(demo, "DURATION", 0.5)
    asked["answer"] = cart_diagnosis()

    def short(*words):
        return run("demo", "--out", tmp_path / "out", *words)

    return short


def with_finding(**changes):
    answer = cart_diagnosis()
    (finding,) = answer.findings
    return replace(answer, findings=(replace(finding, **changes),))


def test_the_demo_diagnoses_the_files_it_wrote(short_demo, asked, tmp_path):
    asked["answer"] = with_finding(
        physics="load_dependent_friction",
        place="motor",
        indistinguishable_places=("worm",),
    )
    result = short_demo()
    assert result.exit_code == 0
    assert "What was hidden is found." in result.stdout
    folder = tmp_path / "out"
    assert {path.name for path in folder.iterdir()} == {
        *("train.csv", "held_out.csv", "report.html", "result.json")
    }
    assert asked["train"][0].source == str(folder / "train.csv")
    assert asked["held_out"][0].source == str(folder / "held_out.csv")
    assert len(asked["train"][0]) == 201


@pytest.mark.parametrize(
    "changes",
    [
        {"physics": "coulomb_friction", "place": "worm"},
        {"physics": "load_dependent_friction", "place": "joint"},
    ],
)
def test_the_demo_says_no_when_another_thing_is_found(short_demo, asked, changes):
    asked["answer"] = with_finding(**changes)
    result = short_demo()
    assert result.exit_code == 1
    assert "not found, or not where it is" in result.stdout


@pytest.mark.parametrize(
    ("verdict", "status", "said"),
    [
        (Verdict.ADEQUATE, 0, "Nothing was hidden, and nothing is found."),
        (Verdict.PHYSICS_MISSING, 1, "a false alarm"),
    ],
)
def test_the_demo_without_effect(short_demo, asked, verdict, status, said):
    asked["answer"] = replace(cart_diagnosis(), verdict=verdict)
    result = short_demo("--without-effect")
    assert result.exit_code == status
    assert said in result.stdout


def test_the_demo_without_its_machine_is_refused(short_demo, monkeypatch):
    monkeypatch.setattr(demo, "find_spec", lambda _: None)
    assert "flegx_models, is not installed" in refused(short_demo())


def test_an_interrupted_demo_says_that_its_recordings_are_kept(
    short_demo, monkeypatch, tmp_path
):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(diagnosing, "diagnose", interrupted)
    result = short_demo()
    assert result.exit_code == 130
    assert f"kept {tmp_path / 'out' / 'train.csv'} and " in result.stderr


# Refusals: one clear line each

BAD_MODELS = {
    "dangling bond": (
        'graph.join("carriage", TF("lever"), "wall")',
        "There is no junction 'wall'",
    ),
    "two flow sources": (
        'graph.put(Sf("v1"), on="carriage"); graph.put(Sf("v2"), on="carriage")',
        "v2",
    ),
    "unknown parameter": (
        'graph.parameter("vicsous", 1.0)',
        "No law of 'cart' uses the parameter 'vicsous'. Did you mean viscous?",
    ),
    "wrong unit of a parameter": (
        'graph.put(R("more"), on="carriage"); graph.parameter("more", 1.0, "kg")',
        "R 'more' is in 'kg'",
    ),
    "an error in the user's code": ("1 / 0", "cart.py, line 10: ZeroDivisionError"),
}


@pytest.mark.parametrize(("line", "said"), BAD_MODELS.values(), ids=BAD_MODELS)
def test_a_bad_model_is_refused_in_one_line(tmp_path, line, said):
    path = tmp_path / "cart.py"
    text = MODEL.replace("import BondGraph", "import TF, BondGraph, Sf")
    path.write_text(text.replace("    return graph", f"    {line}\n    return graph"))
    assert said in refused(run("derive", f"{path}:cart"))


def test_a_dangling_two_port_is_refused(tmp_path):
    path = tmp_path / "cart.py"
    path.write_text(
        MODEL.replace("import BondGraph", "import TF, BondGraph").replace(
            'R("viscous"))', 'R("viscous"), TF("lever"))'
        )
    )
    assert "not a one-port" in refused(run("derive", f"{path}:cart"))


def spoiled(recording, change):
    lines = recording.read_text().splitlines()
    recording.write_text("\n".join(change(lines)) + "\n")
    return recording


def cell(row, column, text):
    def change(lines):
        cells = lines[row].split(",")
        cells[column] = text
        return [*lines[:row], ",".join(cells), *lines[row + 1 :]]

    return change


def header(text):
    return lambda lines: [text, *lines[1:]]


BAD_RECORDINGS = {
    "missing channel": (
        header("time [s],force [N],speed [m/s]"),
        ("has no column 'velocity'", "--map velocity=COLUMN"),
    ),
    "wrong unit": (
        header("time [s],force [N],velocity [rad]"),
        ("'velocity' of the model is in 'm/s'", "'rad'"),
    ),
    "no unit": (header("time [s],force [N],velocity"), ("--unit velocity=UNIT",)),
    "NaN": (cell(7, 2, "nan"), ("not a finite number", "--gaps drop")),
    "empty cell": (cell(7, 2, ""), ("not a finite number", "--gaps drop")),
    "not a number": (cell(7, 2, "fast"), ("fast", "Line 8 of")),
    "unsorted time": (
        lambda lines: [*lines[:5], lines[6], lines[5], *lines[7:]],
        ("runs backward", "--order sort"),
    ),
    "duplicate time": (
        lambda lines: [*lines[:6], *lines[5:]],
        ("repeats", "--repeats first"),
    ),
    "header alone": (lambda lines: lines[:1], ("sample",)),
}


@pytest.mark.parametrize("command", ["simulate", "fit", "diagnose"])
@pytest.mark.parametrize(
    ("change", "said"), BAD_RECORDINGS.values(), ids=BAD_RECORDINGS
)
def test_a_bad_recording_is_refused_in_one_line(
    model, recording, command, change, said
):
    line = refused(run(command, model, spoiled(recording, change)))
    for part in said:
        assert part in line


@pytest.mark.parametrize(
    ("problem", "option"),
    [
        (lambda lines: [*lines[:6], *lines[5:]], ("--repeats", "first")),
        (cell(7, 2, "nan"), ("--gaps", "drop")),
        (
            lambda lines: [*lines[:5], lines[6], lines[5], *lines[7:]],
            ("--order", "sort"),
        ),
        (header("time [s],force [N],v [m/s]"), ("--map", "velocity=v")),
        (header("time [s],force [N],velocity"), ("--unit", "velocity=m/s")),
        (header("clock [s],force [N],velocity [m/s]"), ("--time", "clock")),
    ],
)
def test_the_way_out_that_a_refusal_names_works(model, recording, problem, option):
    words = ("simulate", model, spoiled(recording, problem))
    assert option[0] in refused(run(*words))
    assert run(*words, *option).exit_code == 0


def test_an_empty_file_is_refused(model, tmp_path):
    empty = tmp_path / "empty.csv"
    empty.touch()
    assert "is empty" in refused(run("fit", model, empty))


def test_a_missing_file_is_refused_with_its_neighbours(model, recording):
    said = refused(run("fit", model, recording.parent / "rum.csv"))
    assert "Did you mean run.csv?" in said


WRONG_WORDS = {
    "command": (("diagnos",), "Did you mean diagnose?"),
    "option": (("derive", "MODEL", "--jsn", "x"), "--json"),
    "no model": (("derive",), "Missing argument 'MODEL'"),
    "no recording": (("fit", "MODEL"), "Missing argument 'REC...'"),
    "no such file": (("derive", "nowhere.py:cart"), "There is no file"),
    "no such module": (("derive", "nowhere.at:all"), "There is no module"),
    "no such check file": (("check", "nowhere.toml"), "There is no check file"),
    "a model to check": (("check", "nowhere.py:axis"), "'bondgraph derive' says"),
    "a model of a module": (("check", "nowhere.at:axis"), "'bondgraph derive' says"),
    "no form": (("export", "MODEL"), "Missing option '--to'"),
    "no such form": (("export", "MODEL", "--to", "fortran"), "'fortran'"),
    "unknown parameter": (("derive", "MODEL", "--set", "mas=1"), "Did you mean mass?"),
    "no number": (("derive", "MODEL", "--set", "mass=heavy"), "--set name=value"),
    "no ratio": (("derive", "MODEL", "--set", "mass=1/0"), "--set name=value"),
    "no point": (("derive", "MODEL", "--at", "p_mass"), "--at name=value"),
    "window": (("fit", "MODEL", "REC", "--window", "long"), "number of seconds"),
    "negative window": (("fit", "MODEL", "REC", "--window", "-1"), "number of seconds"),
    "split": (("diagnose", "MODEL", "REC", "--split", "1.5"), "1.5"),
    "split of nothing": (
        ("diagnose", "MODEL", "REC", "--split", "0.5", "--held-out", "REC"),
        "--split has no use",
    ),
    "unit": (("fit", "MODEL", "REC", "--unit", "force"), "--unit name=unit"),
    "mapping": (("fit", "MODEL", "REC", "--map", "force"), "name=channel"),
    "place of output": (("draw", "MODEL", "-o", "no/such/x.svg"), "cannot be written"),
    "form of a picture": (
        ("draw", "MODEL", "-o", "x.gif"),
        "'x.gif' ends in .gif, and what is written is .svg or .png.",
    ),
    # Before anything is read: there is no such recording either.
    "place of a page": (
        ("diagnose", "MODEL", "none.csv", "--html", "no/such/x.html"),
        "'no/such/x.html' cannot be written",
    ),
    "place of an experiment": (
        ("diagnose", "MODEL", "none.csv", "--next-experiment", "no/such/x.csv"),
        "'no/such/x.csv' cannot be written",
    ),
    "place of JSON": (
        ("diagnose", "MODEL", "none.csv", "--json", "no/such/x.json"),
        "'no/such/x.json' cannot be written",
    ),
    "place of a fitted model": (
        ("fit", "MODEL", "none.csv", "-o", "."),
        "'.' cannot be written (Is a directory)",
    ),
    "place of results": (
        ("check", "none.toml", "--junit", "no/such/x.xml"),
        "'no/such/x.xml' cannot be written",
    ),
    "two answers on stdout": (("draw", "MODEL", "--json", "-"), "both go to stdout"),
    "blame": (("draw", "MODEL", "--blame", "REC"), "not the JSON of a diagnosis"),
}


@pytest.mark.parametrize(("words", "said"), WRONG_WORDS.values(), ids=WRONG_WORDS)
def test_a_wrong_command_line_is_refused_in_one_line(model, recording, words, said):
    given = {"MODEL": model, "REC": str(recording)}
    assert said in refused(run(*(given.get(word, word) for word in words)))


@pytest.mark.parametrize(
    ("remedy", "option"),
    [
        (
            'Drop those rows with gaps="drop", or leave the channel out with '
            "channels=(...).",
            "Drop those rows with --gaps drop.",
        ),
        ('Give decimal=",".', "Give --decimal ','."),
        ('Give encoding="utf-16", or save it as UTF-8.', "Give --encoding utf-16, or"),
        ("It has ';' in it: try delimiter=';'.", "try --delimiter ';'."),
        ("Name the time column with time=..., give", "with --time NAME, give"),
        ("say steady=True if every row", "say --steady if every row"),
        ("Map it: theta=CHANNEL.", "Map it: --map theta=CHANNEL."),
    ],
)
def test_remedies_name_options_of_the_command_line(remedy, option):
    assert option in as_options(remedy)


def test_a_real_process_refuses_without_a_traceback(model, tmp_path):
    empty = tmp_path / "empty.csv"
    empty.touch()
    program_file = Path(sys.executable).with_name("bondgraph")
    done = subprocess.run(
        [program_file, "fit", model, empty], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == (
        f"bondgraph: {str(empty)!r} is empty. "
        "Check that the recording was saved completely.\n"
    )


def test_a_real_process_with_two_flow_sources_names_the_chain(tmp_path):
    path = tmp_path / "cart.py"
    path.write_text(
        MODEL.replace("import BondGraph", "import BondGraph, Sf").replace(
            "    return",
            '    graph.put(Sf("v1"), on="carriage")\n'
            '    graph.put(Sf("v2"), on="carriage")\n    return',
        )
    )
    program_file = Path(sys.executable).with_name("bondgraph")
    done = subprocess.run(
        [program_file, "derive", f"{path}:cart"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "v1" in line
    assert "v2" in line
    assert "carriage" in line


def test_a_diagnosis_through_the_whole_program_finds_dry_friction(tmp_path, model):
    # No law of the toolkit: the machine is stepped by hand, every 0.1 ms.
    def push(path, seed):
        generator = np.random.default_rng(seed)
        force = np.repeat(generator.uniform(-3, 3, 25), 20)
        velocity, rows = 0.0, []
        for k, pull in enumerate(force):
            noisy = velocity + 1e-3 * generator.normal()
            rows.append(f"{0.02 * k:.2f},{pull:.6f},{noisy:.6f}")
            for _ in range(200):
                free = velocity + 1e-4 / MASS * (pull - VISCOUS * velocity)
                dry = 1e-4 / MASS * 0.6
                velocity = np.sign(free) * max(abs(free) - dry, 0.0)
        path.write_text("time [s],force [N],velocity [m/s]\n" + "\n".join(rows) + "\n")
        return path

    train, held_out = push(tmp_path / "a.csv", 1), push(tmp_path / "b.csv", 2)
    result = run(
        *("diagnose", model, train, "--held-out", held_out, "--hold", "zero"),
        *("--json", "-"),
    )
    assert result.exit_code == 0
    answer = json.loads(result.stdout)
    assert answer["verdict"] == "physics_missing"
    assert answer["findings"][0]["physics"] == "coulomb_friction"
    assert answer["findings"][0]["place"] == "carriage"
    found = answer["findings"][0]["parameters"]
    assert any(abs(p["value"] - 0.6) < 0.03 for p in found.values())
    after, before = (answer["fit"]["held_out"][k]["nrmse"] for k in ("after", "before"))
    assert after < 0.3 * before
