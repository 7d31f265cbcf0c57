"""Margins of declared loops: textbook figures and refusals."""

import math

import pytest

from bondgraph.checking import run_checks
from bondgraph.errors import CheckError

CART = """
from bondgraph import BondGraph, I, R, Se

def cart() -> BondGraph:
    cart = BondGraph("cart", domain="translation")
    cart.one("carriage", Se("force"), I("mass"), R("viscous"))
    cart.measure("position", displacement="carriage")
    cart.measure("speed", flow="carriage")
    cart.parameter("mass", 2.0, "kg")
    cart.parameter("viscous", 6.0, "N*s/m")
    return cart
"""

CHECK = """
[[check]]
name = "loop"
model = "cart.py:cart"
input = "force"
output = "{output}"
quantity = "{quantity}"
value = {value}
relative_tolerance = 1e-6
{rest}
"""


@pytest.fixture
def declared(tmp_path):
    (tmp_path / "cart.py").write_text(CART)

    def run(quantity, value=1.0, rest="", output="position"):
        text = CHECK.format(quantity=quantity, value=value, rest=rest, output=output)
        (tmp_path / "checks.toml").write_text(text)
        (result,) = run_checks(tmp_path / "checks.toml").results
        return result

    return run


# 36 / (s (2 s + 6)) is ωn² / (s (s + 2 ζ ωn)) with ωn² = 18, 2 ζ ωn = 3.
WN, ZETA = math.sqrt(18), 3 / (2 * math.sqrt(18))
INNER = math.sqrt(1 + 4 * ZETA**4) - 2 * ZETA**2
CROSSOVER = WN * math.sqrt(INNER)
MARGIN = math.degrees(math.atan2(2 * ZETA, math.sqrt(INNER)))


@pytest.mark.parametrize(
    ("quantity", "value"),
    [
        ("gain_crossover", CROSSOVER),
        ("phase_margin", MARGIN),
        ("delay_margin", math.radians(MARGIN) / CROSSOVER),
        (
            "bandwidth",
            WN * math.sqrt(1 - 2 * ZETA**2 + math.sqrt(2 - 4 * ZETA**2 + 4 * ZETA**4)),
        ),
    ],
)
def test_a_second_order_loop_has_its_textbook_figures(declared, quantity, value):
    result = declared(quantity, value, "controller = {gain = 36.0}")
    assert result.ok, result.statement
    assert not declared(quantity, 1.001 * value, "controller = {gain = 36.0}").ok


def test_feedback_and_delay_are_part_of_the_loop(declared):
    # 1/(s + 3)³ through two lags in the feedback: -180° at ω = 3 tan 60°
    rest = (
        "controller = {gain = 2.0}\n"
        "feedback = {gain = 9.0, poles = [-3.0, [-3.0, 0.0]]}"
    )
    omega = 3 * math.sqrt(3)
    assert declared("phase_crossover", omega, rest, output="speed").ok
    gain = 8 * 27 / 9
    assert declared("gain_margin", gain, rest, output="speed").ok
    late = declared("phase_margin", MARGIN, "controller = {gain = 36.0, delay = 0.01}")
    lag = math.degrees(0.01 * CROSSOVER)
    assert late.derived.real == pytest.approx(MARGIN - lag, rel=1e-9)


@pytest.mark.parametrize(
    ("quantity", "rest", "says"),
    [
        ("gain", "controller = {gain = 2.0}", "a gain is of the model alone"),
        ("phase_margin", "controller = 3", "has controller = 3"),
        ("phase_margin", "controller = {gian = 3.0}", "Did you mean gain"),
        ("phase_margin", "controller = {poles = 3}", "has poles = 3"),
        ("phase_margin", "controller = {gain = true}", "has gain = True"),
        ("phase_margin", "feedback = {poles = [[-1.0, 2.0]]}", "no conjugate"),
        ("phase_margin", "index = 0", "a phase_margin is one number"),
        ("gain_margin", "controller = {gain = 36.0}", "the loop has no gain margin"),
        ("phase_margin", "controller = {gain = -1.0}", "unstable, so it has no"),
    ],
)
def test_refusals_say_what_and_where(declared, quantity, rest, says):
    with pytest.raises(CheckError, match=says) as refused:
        declared(quantity, 1.0, rest)
    assert "checks.toml, check" in str(refused.value)
    assert refused.value.remedy
