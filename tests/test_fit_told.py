"""What ``bondgraph fit`` says beside the estimates: channels, bounds, steps."""

from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

from bondgraph.cli.fit_answer import _reaching_far
from bondgraph.cli.program import program
from bondgraph.fitting.certainty import combinations

STEP, MASS, VISCOUS = 0.02, 2.0, 1.0

MODEL = '''"""A cart that is pushed."""
from bondgraph import BondGraph, I, R, Se


def cart():
    g = BondGraph("cart", domain="translation")
    g.one("cart", Se("force"), I("mass"), R("viscous"))
    g.measure("velocity", flow="cart")
    g.parameter("mass", START, "kg", bounds=(0.5, HIGH))
    g.parameter("viscous", 0.8, "N*s/m", bounds=(0.0, 10.0))
    return g
'''


def recorded(path, every):
    """Write a recording of a force that changes at every so many samples."""
    random = np.random.default_rng(3)
    samples = 1000
    force = np.repeat(random.uniform(-1.0, 1.0, samples // every), every)
    kept = np.exp(-STEP * VISCOUS / MASS)
    velocity = np.zeros(samples)
    for k in range(samples - 1):
        velocity[k + 1] = kept * velocity[k] + (1.0 - kept) / VISCOUS * force[k]
    velocity += 1e-3 * random.standard_normal(samples)
    columns = np.column_stack((STEP * np.arange(samples), force, velocity))
    header = "time [s],force [N],velocity [m/s]"
    np.savetxt(path, columns, delimiter=",", header=header, comments="")
    return path


@pytest.fixture
def told(tmp_path):
    def fitted(high, every, *options, status=0):
        model = tmp_path / "cart.py"
        text = MODEL.replace("HIGH", str(high)).replace("START", str(min(high, 1.9)))
        model.write_text(text, "utf-8")
        run = recorded(tmp_path / "run.csv", every)
        words = ["fit", str(model), str(run), *options]
        result = CliRunner().invoke(program, words, catch_exceptions=False)
        assert result.exit_code == status
        return result.stdout

    return fitted


def test_errors_are_told_by_channel_in_its_unit(told):
    said = told(10.0, 25, "--hold", "zero")
    assert "(velocity 0.00" in said
    assert "m/s rms)" in said
    assert "bound" not in said


def test_a_parameter_at_its_bound_is_told(told):
    said = told(1.95, 25, "--hold", "zero")
    assert "mass ended at its bound of 1.95 kg" in said


def test_what_inputs_do_between_samples_is_chosen_and_told(told):
    said = (
        "held between samples, as they mostly stay the same from one sample to the next"
    )
    assert said in told(10.0, 25)
    assert "held between samples, as that fits better" in told(10.0, 1)
    said = told(10.0, 25, "--hold", "first")
    assert "between samples" not in said


def test_windows_do_not_hide_what_whole_recordings_are_missed_by(told):
    short = told(10.0, 25, "--hold", "zero", "--window", "0.2")
    assert "Error over windows of " in short
    assert short.count("Error over whole recordings") == 1
    assert "Mind the error over those" not in short
    whole = told(10.0, 25, "--hold", "zero", "--window", "whole")
    assert "windows" not in whole
    assert whole.count("Error over whole recordings") == 1


def test_an_error_that_adds_up_beyond_a_window_is_pointed_out(told):
    said = told(0.8, 25, "--hold", "zero", "--window", "0.2")
    assert "Mind the error over those" in said


@pytest.mark.parametrize(
    ("share", "said"), [(2.71, "270 %"), (0.0123, "1.2 %"), (0.5, "50 %")]
)
def test_a_share_is_written_as_a_person_would(share, said):
    assert combinations._percent(share) == said


def test_a_fit_that_stops_early_says_what_to_do(told):
    said = told(10.0, 25, "--hold", "zero", "--iterations", "1", status=1)
    assert "--iterations" in said


def test_much_more_than_noise_that_is_left_points_to_diagnose(tmp_path):
    model, run = tmp_path / "cart.py", recorded(tmp_path / "run.csv", 25)

    def said(text):
        model.write_text(text, "utf-8")
        words = ["fit", str(model), str(run), "--hold", "zero"]
        return CliRunner().invoke(program, words, catch_exceptions=False).output

    text = MODEL.replace("HIGH", "10.0").replace("START", "1.9")
    bent = text.replace('R("viscous")', 'R("viscous", law=viscous * f**3)').replace(
        "I, R, Se", 'I, R, Se, f\nimport sympy\nviscous = sympy.Symbol("viscous")'
    )
    hint = "in times its noise: velocity"
    assert hint not in said(text)
    assert hint in said(bent)


def test_intervals_that_reach_far_say_why():
    def words(high):
        known = SimpleNamespace(value=1.0, std=0.1, interval=(0.8, high))
        return list(_reaching_far(SimpleNamespace(estimates=(known,))))

    assert not words(1.2)
    (said,) = words(2.3)
    assert "as far as 13 standard deviations" in said
