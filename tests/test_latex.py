"""Equations as LaTeX: readable names, and text that a parser of mathematics takes."""

from functools import cache

import pytest
import sympy
from catalogue import CASES, Case

from bondgraph import BondGraph, C, I, R, Se, as_latex, derive
from bondgraph.equations.latex_names import latex, latex_name
from bondgraph.structure.signals import f


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("p_I_motor", r"p_{\mathrm{I\,motor}}"),
        ("K_worm_gear", r"K_{\mathrm{worm\,gear}}"),
        ("m1", r"m_{1}"),
        ("m_12", r"m_{12}"),
        ("p_m1", r"p_{m_{1}}"),
        ("q_c_", r"q_{c}'"),
        ("friction", r"\mathrm{friction}"),
        ("mu_s", r"\mu_{s}"),
        ("omega2", r"\omega_{2}"),
        ("θ_1", r"\theta_{1}"),
        ("Ω", r"\Omega"),
        ("lambda_2", r"\lambda_{2}"),
        ("p_body[1]", r"p_{\mathrm{body}[1]}"),
        ("50%", r"50\%"),
    ],
)
def test_names_read_as_in_a_book(name: str, shown: str) -> None:
    assert latex_name(name) == shown


def test_a_rate_has_a_dot_over_its_letter() -> None:
    rate, state = sympy.symbols("dp_I_motor p_I_motor")
    assert latex(rate, {rate: state}) == r"\dot{p}_{\mathrm{I\,motor}}"


@cache
def parse_once(side: str) -> None:
    """Let matplotlib's parser read it; half of the catalogue's sides come again."""
    mathtext = pytest.importorskip("matplotlib.mathtext")
    mathtext.MathTextParser("path").parse(f"${side}$")


def parsed(text: str) -> None:
    """Let matplotlib's parser of TeX mathematics read every line."""
    head, *lines, tail = text.splitlines()
    assert (head, tail) == (r"\begin{aligned}", r"\end{aligned}")
    for line in lines:
        left, right = line.removesuffix(r"\\").split("&=")
        for side in (left, right):
            parse_once(side.strip())


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_equation_of_the_catalogue_is_mathematics(case: Case) -> None:
    equations = derive(case.graph())
    if equations.states or equations.outputs:
        parsed(as_latex(equations))


def test_hostile_names_are_mathematics_too() -> None:
    g = BondGraph("hostile")
    laws = ("a_b_c_", "50% $x$", "#1_{2}^3", "\\end", "θ_ä", "x y", "__", "q''", "~")
    law = sum(sympy.Symbol(name) for name in laws) * f
    g.one("while_loop", Se("u_"), R("r", law=law), I("lambda_"), C("c__2"))
    g.measure("50% of\n\\y_{max}", flow="while_loop")
    parsed(as_latex(derive(g.finish())))


def test_many_states_are_shown_as_they_are_sorted() -> None:
    graph = BondGraph("chain")
    graph.one("m0", Se("push"), I("i0"), R("r"))
    for k in range(1, 8):
        graph.zero(f"s{k}", C(f"c{k}"))
        graph.one(f"m{k}", I(f"i{k}"))
        graph.join(f"m{k - 1}", f"s{k}")
        graph.join(f"s{k}", f"m{k}")
    graph.measure("v", flow="m7")
    equations = derive(graph.finish())
    shown = as_latex(equations)
    parsed(shown)
    lines = len(equations.assignments) + len(equations.rates) + 1
    assert shown.count("&=") == lines
    assert shown.count(r"\dot{") == len(equations.states) == 15
    assert r"\dot{q}_{c_{7}} &=" in shown


def test_a_space_in_a_name_is_a_space() -> None:
    assert latex_name("a b") == r"a\ b"
    assert r"\ " in latex_name("a\u0007b")
