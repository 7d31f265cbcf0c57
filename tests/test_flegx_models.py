"""The FlegX models against the thesis, and the reconciliation against its claims."""

import ast
import itertools
import math
import runpy
from decimal import Decimal
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from catalogue.evaluation import observed
from scipy.optimize import linprog

from bondgraph import Assumed, ParameterSet, Published, Reconciled, derive, linearise
from flegx_models import gains, models, nonlinear_stance
from flegx_models.gains import Agreement
from flegx_models.models import lowerleg_stance, upperleg_flight
from flegx_models.parameters import PRINTED, RECONCILED
from flegx_models.parameters_datasheets import DATASHEETS
from flegx_models.published import PUBLISHED

BY_MODEL = {published.model: published for published in PUBLISHED}
LOWER = ("I_gear_tendons", "I_lowerleg", "c_friction_lowerleg", "m_lowerleg")
UPPER = ("I_gear", "I_upperleg", "c_friction_upperleg", "m_upperleg")


def reflected(model, parameters):
    """Return N, J and c by hand (eq. 4.3, 4.9, 4.26, 4.32 times the load inertia)."""
    v = {p.name: p.value for p in parameters.members}
    gear, link, friction, mass = LOWER if model.startswith("lower") else UPPER
    N = v["K_gearbox"] * v["K_worm_gear"]
    J = (v["I_motor"] + v["I_gearbox"]) * N**2 + v["I_worm"] * v["K_worm_gear"] ** 2
    J += v[gear] + v[link]
    if model.endswith("stance"):
        lever = 2 * v["L"] * math.sin(v["theta_0"])
        J += (v["m_motors_support"] + v[mass]) * lever**2
    return N, J, v[friction]


@pytest.mark.parametrize("published", PUBLISHED, ids=lambda p: p.model)
def test_reconciled_gives_the_printed_gains_to_the_printed_digits(published):
    gain, _ = gains.derived(getattr(models, published.model)(RECONCILED))
    assert round(gain, published.gain_decimals) == published.gain


@pytest.mark.parametrize(
    ("model", "gain"), [("lowerleg_flight", 180.35), ("upperleg_flight", 164.87)]
)
def test_printed_parameters_give_other_flight_gains(model, gain):
    derived, _ = gains.derived(getattr(models, model)(PRINTED))
    assert round(derived, 2) == gain
    assert derived / BY_MODEL[model].gain == pytest.approx(1.02, abs=0.004)


@pytest.mark.parametrize("model", BY_MODEL)
def test_gain_is_n_over_j_and_friction_pole_is_c_over_j(model):
    """At values that belong to no set, so that nothing can be typed in."""
    generator = np.random.default_rng(7)
    odd = RECONCILED.with_values(
        {p.name: p.value * generator.uniform(0.5, 2) for p in RECONCILED.members}
    )
    gain, pole = gains.derived(getattr(models, model)(odd))
    N, J, c = reflected(model, odd)
    assert gain == pytest.approx(N / J, rel=1e-12)
    assert pole == pytest.approx(c / J, rel=1e-9)


def test_the_gain_is_a_formula_of_the_parameters():
    graph = upperleg_flight().finish()
    system = linearise(derive(graph))
    gain = system.transfer_function("theta", "T_motor").gain
    assert {str(symbol) for symbol in gain.free_symbols} == {
        *("K_gearbox", "K_worm_gear", "I_motor", "I_gearbox", "I_worm"),
        *("I_gear", "I_upperleg"),
    }


@pytest.mark.parametrize(
    ("model", "ratio"),
    [
        ("lowerleg_flight", 116),
        ("upperleg_flight", 26),
        ("lowerleg_stance", 190),
        ("upperleg_stance", 40),
    ],
)
def test_printed_gain_and_printed_pole_need_different_inertias(model, ratio):
    """One J in gain = N/J, another in pole = c/J: the two printed forms conflict."""
    published = BY_MODEL[model]
    N, _, c = reflected(model, RECONCILED)
    from_gain, from_pole = N / published.gain, c / published.friction_pole
    assert from_gain / from_pole == pytest.approx(ratio, abs=0.5)
    _, derived = gains.derived(getattr(models, model)(RECONCILED))
    assert derived == pytest.approx(c / from_gain, rel=1e-4)


def test_the_upper_pole_is_not_even_its_own_formula():
    c = PRINTED["c_friction_upperleg"].value
    published = BY_MODEL["upperleg_flight"].friction_pole
    assert round(c / 0.0593, 2) == published  # the upper leg alone, section 3.3.3
    assert round(c / PRINTED["I_upperleg"].value, 3) == 0.117  # what eq. 4.12 writes


@pytest.fixture(scope="module")
def rows():
    return gains.table()


def test_stance_needs_a_length_that_is_not_printed(rows):
    for row in (row for row in rows if row.parameters == "PRINTED"):
        stance = row.model.endswith("stance")
        assert (row.agreement is Agreement.NOT_COMPUTABLE) == stance
        assert ("L is not printed" in row.reason) == stance


def test_the_table_says_what_reproduces(rows):
    assert len(rows) == 16
    reproduced = {(r.model, r.quantity, r.parameters) for r in rows if not r.reason}
    assert reproduced == {(model, "gain", "RECONCILED") for model in BY_MODEL}
    text = gains.as_text(rows)
    assert len(text.splitlines()) == 17
    assert "+2.03 %" in text


# -- parameters ---------------------------------------------------------------------


def test_every_printed_value_has_a_place_in_the_thesis():
    assert [p.name for p in PRINTED.members if isinstance(p.source, Assumed)] == ["g"]
    for parameter in PRINTED.members:
        if parameter.name == "g":
            continue
        assert isinstance(parameter.source, Published)
        assert parameter.source.reference.startswith("FlegX thesis, ")
        assert parameter.value is None or parameter.rounding is not None
    assert [p.name for p in PRINTED.members if p.value is None] == ["L"]


def test_what_is_exact_and_what_is_rounded():
    exact = {p.name for p in PRINTED.members if p.exact}
    assert exact == {"K_gearbox", "K_worm_gear", "theta_0", "theta_knee", "g"}
    for parameter in PRINTED.members:
        if parameter.rounding:
            assert parameter.std == pytest.approx(parameter.rounding / math.sqrt(3))


def test_reconciled_says_which_four_numbers_it_changed():
    changed = {p.name for p in RECONCILED.members if p != PRINTED[p.name]}
    assert changed == {"I_motor", "I_upperleg", "m_lowerleg", "L"}
    for name in changed:
        assert isinstance(RECONCILED[name].source, Reconciled)
        assert RECONCILED[name].source.reason


PACKAGE = Path(models.__file__).parent
# The printed results are numbers; the concealed machine shares nothing with the rest.
NUMBER_FILES = ("published.py", "concealed_drive.py")
DRAWINGS = ("models", "nonlinear_stance", "planar_leg", "equation_of_motion", "demo")
MATHEMATICS = {
    1.8751040687119611,  # first root of 1 + cos x cosh x, of every cantilever
    *(0.5, 1.5),  # halves in formulas
}


def literals(path):
    """Return the numbers written in a file."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    numbers = (n.value for n in ast.walk(tree) if isinstance(n, ast.Constant))
    return {n for n in numbers if isinstance(n, int | float) and n is not True}


def digits(number):
    return len(Decimal(repr(float(number))).normalize().as_tuple().digits)


def code():
    return [
        path
        for path in PACKAGE.rglob("*.py")
        if not path.name.startswith("parameters") and path.name not in NUMBER_FILES
    ]


def printed_numbers():
    """Return the value of every parameter in the package that is no small integer."""
    sets = (
        value
        for path in PACKAGE.glob("parameters*.py")
        for value in vars(import_module(f"flegx_models.{path.stem}")).values()
        if isinstance(value, ParameterSet)
    )
    values = {p.value for s in sets for p in s.members if p.value is not None}
    return {abs(value) for value in values if digits(value) > 1}


def test_the_drawings_contain_no_number_but_those_of_their_formulas():
    for name in DRAWINGS:
        assert literals(PACKAGE / f"{name}.py") <= {0, 1, 2}, name


def test_numbers_stand_in_the_parameter_files_alone():
    """Elsewhere are small counts, tolerances and the constants of mathematics."""
    values = printed_numbers()
    assert len(values) > 100
    found = [
        f"{path.relative_to(PACKAGE)} holds the number {number}"
        for path in code()
        for number in literals(path) - MATHEMATICS
        if digits(number) > 2 or (isinstance(number, float) and number in values)
    ]
    assert not found


def test_what_is_printed_twice_is_the_same_twice():
    for name in set(DATASHEETS) & set(PRINTED):
        assert DATASHEETS[name].value == pytest.approx(PRINTED[name].value, rel=1e-12)
        assert DATASHEETS[name].unit == PRINTED[name].unit


def test_the_data_sheets_agree_with_themselves():
    """Each pair is related by physics; the data sheet rounds both."""
    v = DATASHEETS.values_by_name()
    K_m, R = v["K_m"], v["motor_resistance"]
    pairs = {
        "stall torque": (K_m * v["motor_stall_current"], v["motor_stall_torque"]),
        "stall current": (v["motor_nominal_voltage"] / R, v["motor_stall_current"]),
        "speed constant": (1 / K_m, v["motor_speed_constant"]),
        "gradient": (R / K_m**2, v["motor_speed_torque_gradient"]),
        "time constant": (v["I_motor"] * R / K_m**2, v["motor_time_constant"]),
        "worm ratio": (v["gear_teeth"] / v["worm_threads"], v["K_worm_gear"]),
        "lead angle": (
            math.asin(v["worm_threads"] * v["worm_module"] / v["worm_pitch_diameter"]),
            v["worm_lead_angle"],
        ),
        "gear": (
            v["gear_teeth"] * v["worm_module"] / math.cos(v["worm_lead_angle"]),
            v["gear_pitch_diameter"],
        ),
    }
    for name, (derived, printed) in pairs.items():
        assert derived == pytest.approx(printed, rel=2.5e-3), name


# -- the stance models before linearising ---------------------------------------------


@pytest.mark.parametrize("model", ["lowerleg_stance", "upperleg_stance"])
def test_the_moving_lever_linearised_is_the_printed_form(model):
    printed = linearise(derive(getattr(models, model)().finish()))
    moving = linearise(
        derive(getattr(nonlinear_stance, model)().finish()),
        nonlinear_stance.printed_point(model),
    )
    assert moving.transfer_function() == printed.transfer_function()


@pytest.mark.parametrize("model", ["lowerleg_stance", "upperleg_stance"])
@pytest.mark.parametrize("angle", [0.3, -0.9])
def test_the_moving_lever_by_hand(model, angle):
    """(J + m l²) θ'' + m l l' θ'² + c θ' = N T with l = 2 L sin θ, from energy."""
    graph = getattr(nonlinear_stance, model)().finish()
    v = graph.parameters.values_by_name()
    speed, torque = 1.7, 0.2
    at = {"q_joint": angle, "T_motor": torque}
    at["p_I_motor"] = v["I_motor"] * v["K_gearbox"] * v["K_worm_gear"] * speed
    seen = observed(graph, v | at)
    N, J, c = reflected(model.replace("stance", "flight"), RECONCILED)
    mass = LOWER[3] if model.startswith("lower") else UPPER[3]
    lever, slope = 2 * v["L"] * math.sin(angle), 2 * v["L"] * math.cos(angle)
    m = v["m_motors_support"] + v[mass]
    force = N * torque - c * speed - m * lever * slope * speed**2
    wanted = N * v["I_motor"] * force / (J + m * lever**2)
    assert seen.rates["p_I_motor"] == pytest.approx(wanted, rel=1e-9)


# -- the reconciliation: what its docstring claims ------------------------------------

INERTIAS = ("I_motor", "I_gearbox", "I_worm", *LOWER[:2], *UPPER[:2])


def interval(model):
    """Return the interval of gains that print as the published one."""
    published = BY_MODEL[model]
    half = 0.5 * 10**-published.gain_decimals
    return published.gain - half, published.gain + half


def explains(free, worm_ratio=None, pinned=None):
    """Return the ranges of the inertias in `free` that explain both flight gains.

    All other inertias stay in their rounding intervals; None if there is no way.
    """
    K_worm = PRINTED["K_worm_gear"].value if worm_ratio is None else worm_ratio
    N = PRINTED["K_gearbox"].value * K_worm
    printed = np.array([PRINTED[name].value for name in INERTIAS])
    half = np.array([PRINTED[name].rounding for name in INERTIAS])
    weights = {"I_motor": N**2, "I_gearbox": N**2, "I_worm": K_worm**2}
    rows, limits = [], []
    for model, other in (("lowerleg_flight", UPPER), ("upperleg_flight", LOWER)):
        row = [0 if n in other else weights.get(n, 1) for n in INERTIAS] * printed
        low, high = (N / gain for gain in reversed(interval(model)))
        rows += [row, -row]
        limits += [high, -low]
    bounds = list(zip(1 - half / printed, 1 + half / printed, strict=True))
    for name in free:
        bounds[INERTIAS.index(name)] = (0, None)
    for name, value in (pinned or {}).items():
        k = INERTIAS.index(name)
        bounds[k] = (value / printed[k],) * 2
    ranges = {}
    for name in free or INERTIAS[:1]:
        k = INERTIAS.index(name)
        cost = np.eye(len(INERTIAS))[k]
        ends = [linprog(s * cost, rows, limits, bounds=bounds) for s in (1, -1)]
        if any(end.status != 0 for end in ends):
            return None
        ranges[name] = tuple(end.x[k] * printed[k] for end in ends)
    return ranges


def total_change(pair):
    """Return the least |ln(new/printed)| summed over the two, on a fine grid."""
    first, second = pair
    least = math.inf
    for value in np.linspace(*explains(pair)[first], 40):
        rest = explains((second,), pinned={first: value})
        if rest is None:
            continue
        printed = PRINTED[second].value
        other = min(max(printed, rest[second][0]), rest[second][1])
        change = abs(math.log(value / PRINTED[first].value))
        least = min(least, change + abs(math.log(other / printed)))
    return least


def test_no_rounding_and_no_single_inertia_explains_the_flight_gains():
    assert explains(()) is None
    for name in INERTIAS:
        assert explains((name,)) is None


def test_the_chosen_pair_is_the_smallest_of_thirteen():
    pairs = [p for p in itertools.combinations(INERTIAS, 2) if explains(p)]
    assert len(pairs) == 13
    changes = sorted((total_change(pair), pair) for pair in pairs)
    assert [pair for _, pair in changes[:4]] == [
        ("I_motor", "I_upperleg"),
        ("I_motor", "I_lowerleg"),
        ("I_gearbox", "I_upperleg"),
        ("I_gearbox", "I_lowerleg"),
    ]
    sizes = [change for change, _ in changes]
    assert sizes[:4] == pytest.approx([0.036, 0.155, 0.376, 0.476], abs=0.01)
    assert min(sizes[4:]) > math.log(2)


def test_a_slip_in_the_worm_ratio_alone_would_do():
    slips = [k for k in np.arange(9.80, 9.94, 0.002) if explains((), worm_ratio=k)]
    assert (min(slips), max(slips)) == pytest.approx((9.844, 9.896), abs=0.002)


def length_interval(model, mass, support, spread):
    """Return the range of L that the stance gain needs; `spread` widens the mass."""
    N, J, _ = reflected(model.replace("stance", "flight"), RECONCILED)
    low, high = (N / gain - J for gain in reversed(interval(model)))
    return (
        math.sqrt(low / (mass + support + spread)),
        math.sqrt(high / (mass + support - spread)),
    )


def test_one_length_needs_the_tendons_on_the_lower_branch():
    support = PRINTED["m_motors_support"].value
    lower, upper = PRINTED["m_lowerleg"], PRINTED["m_upperleg"]
    spread = PRINTED["m_motors_support"].rounding + lower.rounding
    printed = length_interval("lowerleg_stance", lower.value, support, spread)
    other = length_interval("upperleg_stance", upper.value, support, spread)
    assert printed[0] > other[1]
    with_tendons = RECONCILED["m_lowerleg"].value
    both = [
        length_interval("lowerleg_stance", with_tendons, support, 0.0),
        length_interval("upperleg_stance", upper.value, support, 0.0),
    ]
    common = max(low for low, _ in both), min(high for _, high in both)
    assert common[0] < RECONCILED["L"].value < common[1]


def test_a_stance_model_moves_the_support_by_2_l_sin_theta():
    """Small angles: the support rises by -2 L sin θ0 per joint angle (eq. 4.21)."""
    graph = lowerleg_stance()
    graph.measure("height", displacement="support")
    system = linearise(derive(graph.finish()))
    values = graph.finish().parameters.values_by_name()
    height, theta = (
        system.transfer_function(name, "T_motor").gain_at(values)
        for name in ("height", "theta")
    )
    L, theta_0 = values["L"], values["theta_0"]
    assert height / theta == pytest.approx(-2 * L * math.sin(theta_0))


# -- the figures ----------------------------------------------------------------------


def test_the_example_draws_the_figures_of_chapter_4(tmp_path):
    """Every element by name, and the bonds numbered as the thesis numbers them."""
    path = Path(__file__).parent.parent / "examples" / "chapter4_models.py"
    example = runpy.run_path(str(path))
    bonds = {"flight": 11, "stance": 15}
    for name, factory in {**example["FIGURES"], **example["BEYOND"]}.items():
        look = {"labels": "numbers"} if name in example["FIGURES"] else {}
        example["draw"](factory(), tmp_path / f"{name}.svg", **look)
        svg = (tmp_path / f"{name}.svg").read_text(encoding="utf-8")
        graph = factory().finish()
        assert all(node.name in svg for node in graph.nodes)
        if name in example["FIGURES"]:
            assert len(graph.bonds) == bonds[name.rpartition("_")[2]]
    for name in ("lowerleg_stance", "upperleg_stance"):
        assert example["same"](name)
