"""The picture of a graph: everything is on it, nothing overlaps, arrows are right."""

import json
import math
import random
import re
import runpy
import struct
import sys
import xml.etree.ElementTree as ET
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path

import pytest
import sympy
from catalogue import CASES
from click.testing import CliRunner

from benchmarks.drawing import tree
from bondgraph.causality.assignment import assign_causality
from bondgraph.cli.program import program
from bondgraph.errors import BondGraphError, CausalConflictError, StructureError
from bondgraph.notebook.pictures import finished_html as in_a_notebook
from bondgraph.reporting.drawing import (
    BondLabels,
    Colouring,
    Theme,
    draw_png,
    draw_svg,
)
from bondgraph.reporting.layout import placing
from bondgraph.reporting.layout.boxes import Layout, text_width
from bondgraph.reporting.layout.grid import Grid, grid_of
from bondgraph.reporting.layout.skeleton import Skeleton
from bondgraph.reporting.picture.canvas import Content, Picture
from bondgraph.reporting.picture.causal_marks import CausalMarks
from bondgraph.reporting.picture.numbering import bond_numbers
from bondgraph.reporting.picture.shapes import Shape, corners, rectangle, touch
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.elements import GY, TF, C, I, R, Se, Sf
from bondgraph.structure.fields import IField
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import displacement, effort, f, flow
from flegx_models import models

ROOT = Path(__file__).resolve().parents[1]
SVG = "{http://www.w3.org/2000/svg}"


def cylinder() -> FinishedGraph:
    graph = BondGraph("hydraulic cylinder", domain="hydraulic")
    one, other = sympy.symbols("A1 A2")
    graph.zero("supply", Sf("pump"), C("c_line"), R("leak"))
    graph.one("valve_a", R("valve_in"))
    graph.zero("chamber_a", C("c_a"))
    graph.zero("chamber_b", C("c_b"))
    graph.one("valve_b", R("valve_out"), Se("tank"))
    graph.one("leakage", R("seal"))
    graph.one("rod", I("m"), R("friction"), Se("load"), domain="translation")
    graph.join("supply", "valve_a")
    graph.join("valve_a", "chamber_a")
    graph.join("chamber_a", TF("piston_a", law=one), "rod")
    graph.join("rod", TF("piston_b", law=1 / other), "chamber_b")
    graph.join("chamber_b", "valve_b")
    graph.join("chamber_a", "leakage")
    graph.join("leakage", "chamber_b")
    graph.measure("x", displacement="rod")
    graph.measure("p_a", effort="chamber_a")
    return graph.finish()


def double_pendulum() -> FinishedGraph:
    graph = BondGraph("double pendulum", domain="rotation")
    graph.one("theta1", Se("torque"), R("b1"), I("J1"))
    graph.one("theta2", R("b2"), I("J2"))
    for axis, way in (("x", sympy.cos), ("y", sympy.sin)):
        first, second, between = f"{axis}1", f"{axis}2", f"sum_{axis}"
        graph.one(first, I(f"m_{first}"), domain="translation")
        graph.one(second, I(f"m_{second}"), domain="translation")
        graph.zero(between, domain="translation")
        for k, end in ((1, first), (2, between)):
            lever = sympy.Symbol(f"l{k}") * way(displacement(f"theta{k}"))
            graph.join(end, TF(f"T{k}{axis}", law=lever), f"theta{k}")
        graph.join(first, between)
        graph.join(between, second)
    graph.measure("theta_1", displacement="theta1")
    graph.measure("tip", displacement("x1") + displacement("y2"), unit="m")
    return graph.finish()


def gyrator_ring(size: int = 4) -> FinishedGraph:
    graph = BondGraph(f"ring of {size} gyrators")
    for k in range(size):
        graph.one(f"j{k}", I(f"l{k}"), R(f"r{k}"))
    graph.put(Se("u"), on="j0")
    for k in range(size):
        graph.join(f"j{k}", GY(f"g{k}"), f"j{(k + 1) % size}")
    return graph.finish()


def ladder(stages: int = 12) -> FinishedGraph:
    graph = BondGraph(f"ladder of {stages} stages", domain="electrical")
    for k in range(stages):
        graph.one(f"branch_{k}", I(f"L{k}"), R(f"R{k}"))
        graph.zero(f"node_{k}", C(f"C{k}"))
        graph.join(f"branch_{k}", f"node_{k}")
        if k:
            graph.join(f"node_{k - 1}", f"branch_{k}")
    graph.put(Se("u"), on="branch_0")
    return graph.finish()


def mesh(rows: int = 3, columns: int = 4) -> FinishedGraph:
    graph = BondGraph(f"mesh {rows} x {columns}", domain="electrical")
    cells = [(i, j) for i in range(rows) for j in range(columns)]
    for i, j in cells:
        graph.zero(f"v{i}_{j}", C(f"c{i}_{j}"))
    graph.put(Sf("i"), on="v0_0")
    for i, j in cells:
        for di, dj, name in ((0, 1, f"h{i}_{j}"), (1, 0, f"w{i}_{j}")):
            if (i + di, j + dj) in cells:
                graph.one(name, R(f"r{name}"))
                graph.join(f"v{i}_{j}", name)
                graph.join(name, f"v{i + di}_{j + dj}")
    return graph.finish()


def everybody_with_everybody(size: int, between: type | None) -> FinishedGraph:
    """Return a graph that cannot be drawn without crossings."""
    graph = BondGraph(f"complete {size}{' by gyrators' if between else ''}")
    for k in range(size):
        graph.zero(f"a{k}", C(f"c{k}"), R(f"r{k}"))
        for m in range(k):
            way = (between(f"g{k}_{m}"),) if between else ()
            graph.join(f"a{k}", *way, f"a{m}")
    return graph.finish()


def hub() -> FinishedGraph:
    graph = BondGraph("hub")
    graph.zero("hub", C("c_hub"), Se("u"))
    for k in range(7):
        graph.one(f"arm{k}", R(f"r{k}"), I(f"l{k}"))
        graph.join("hub", f"arm{k}")
    return graph.finish()


def crowd() -> FinishedGraph:
    graph = BondGraph("crowd")
    inertances = [I(f"inertance_{k}") for k in range(9)]
    graph.one("a", Se("u"), *inertances, *[Se(f"s{k}") for k in range(3)])
    graph.one("b", Se("w"), *[R(f"resistance_{k}") for k in range(7)])
    return graph.finish()


def side_by_side() -> FinishedGraph:
    graph = BondGraph("side by side")
    graph.one("a", Se("u"))
    graph.zero("b", R("load"))
    graph.join("a", "b")
    graph.join("b", "a")
    graph.join("a", TF("k"), "b")
    return graph.finish()


def pieces() -> FinishedGraph:
    graph = BondGraph("pieces")
    graph.one("electrical", Se("u"), R("r"))
    graph.one("hot", Se("v"), C("c"))
    graph.one("cold")
    graph.join("hot", "cold")
    graph.put(R("z", law=f * effort("electrical>r")), on="cold")
    graph.measure("y", effort("electrical>r") + flow("hot"))
    graph.measure("inner", effort("hot>cold"))
    return graph.finish()


def coupled_coils() -> FinishedGraph:
    graph = BondGraph("coupled coils", domain="electrical")
    graph.one("primary", Se("u"), R("r1"))
    graph.one("secondary", R("r2"))
    m, l1, l2 = sympy.symbols("m l1 l2")
    field = IField.from_matrix("coils", [[l1, m], [m, l2]])
    graph.put(field, on=("primary", "secondary"))
    return graph.finish()


def random_graph(seed: int) -> FinishedGraph:
    """Return a connected graph with branches, rings, pieces and crowded junctions."""
    dice = random.Random(seed)
    graph = BondGraph(f"random {seed}")
    names: list[str] = []
    for k in range(dice.randint(2, 12)):
        add = graph.one if dice.random() < 0.5 else graph.zero
        names.append(add(f"junction_{k}", R(f"R{k}")))
        for n in range(dice.randint(0, 4)):
            kind = dice.choice([I, C, Se, Sf])
            graph.put(kind(f"x{'long' * dice.randint(0, 4)}_{k}_{n}"), on=names[-1])
        if k and dice.random() < 0.9:
            partner = dice.choice(names[:-1])
            if dice.random() < 0.5:
                graph.join(partner, names[-1])
            else:
                two_port = dice.choice([TF, GY])(f"ratio_{k}")
                graph.join(names[-1], two_port, partner)
    if len(names) > 3:
        graph.join(names[0], GY("closing"), names[3])
    graph.measure("mixed", flow(f"{names[0]}>R0") * effort("R1"))
    return graph.finish()


LEGS = {
    name: getattr(models, name)().finish()
    for name in (
        *("lowerleg_flight", "upperleg_flight"),
        *("lowerleg_stance", "upperleg_stance"),
    )
}

DRAWN = [
    *LEGS.values(),
    *(cylinder(), double_pendulum(), gyrator_ring(), gyrator_ring(3), tree(40)),
    *(ladder(), mesh(), everybody_with_everybody(5, None)),
    *(everybody_with_everybody(6, GY), hub(), crowd(), side_by_side(), pieces()),
    coupled_coils(),
    *(random_graph(seed) for seed in range(12)),
]
EVERY = {graph.name: graph for graph in DRAWN}
EVERY.update({case.name: case.graph() for case in CASES})
every_graph = pytest.mark.parametrize("name", EVERY)


GRIDS: dict[FinishedGraph, Grid] = {}


def grid_made_once(graph: FinishedGraph, skeleton: Skeleton) -> Grid:
    if graph not in GRIDS:
        GRIDS[graph] = grid_of(graph, skeleton)
    return GRIDS[graph]


@pytest.fixture(autouse=True)
def one_grid_a_graph(monkeypatch: pytest.MonkeyPatch) -> None:
    """Put every graph on its grid once: no label or mark changes anything there."""
    monkeypatch.setattr(placing, "grid_of", grid_made_once)


def laid_out(name: str, labels: BondLabels = BondLabels.NUMBERS) -> Picture:
    """Return a picture with everything on it that can get into the way."""
    return _laid_out(name, labels)


@cache
def _laid_out(name: str, labels: BondLabels) -> Picture:
    content = Content(
        causality=CausalMarks(),
        colouring=None,
        inserted=frozenset(),
        labels=labels,
        signals=True,
    )
    return Picture(EVERY[name], content)


def svg_of(name: str, labels: BondLabels = BondLabels.NUMBERS) -> str:
    return _svg_of(name, labels)


@cache
def _svg_of(name: str, labels: BondLabels) -> str:
    return laid_out(name, labels).svg(Theme.AUTO)


def layout(name: str) -> Layout:
    return laid_out(name).layout


def groups(svg: str, kind: str) -> dict[str, ET.Element]:
    """Return the groups of class `kind` (node, bond, sensor) by name."""
    return {
        group.attrib["data-name"]: group
        for group in ET.fromstring(svg).iter(f"{SVG}g")
        if kind in group.attrib["class"].split()
    }


def written(group: ET.Element) -> list[str]:
    texts = [*group.iter(f"{SVG}text"), *group.iter(f"{SVG}tspan")]
    return [text.text for text in texts if text.text]


def points(path: ET.Element) -> list[tuple[float, float]]:
    return [
        (float(x), float(y))
        for x, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)", path.attrib["d"])
    ]


def path_of(group: ET.Element, css: str) -> list[tuple[float, float]]:
    (path,) = (p for p in group.iter(f"{SVG}path") if p.attrib["class"] == css)
    return points(path)


def room_of(text: ET.Element) -> Shape:
    """Return the rectangle that a text at a bond takes."""
    size = float(text.attrib["font-size"])
    width = text_width(text.text or "", size)
    for part in text.iter(f"{SVG}tspan"):
        width += text_width(part.text or "", float(part.attrib["font-size"]))
    turn = re.search(r"rotate\((\S+)", text.attrib.get("transform", ""))
    angle = math.radians(float(turn[1])) if turn else 0.0
    x, y = float(text.attrib["x"]), float(text.attrib["y"]) - 0.36 * size
    return rectangle((x, y), width, size, angle)


@every_graph
def test_every_node_bond_and_measurement_is_drawn(name: str) -> None:
    graph, svg = EVERY[name], svg_of(name)
    assert set(groups(svg, "node")) == set(graph.by_name)
    assert set(groups(svg, "bond")) == {b.name for b in graph.bonds}
    for node, group in groups(svg, "node").items():
        assert node in written(group)
        assert any(text.endswith(graph.node(node).letter) for text in written(group))
    reading = {m.name for m in graph.measurements if "(" in str(m.expression)}
    assert set(groups(svg, "sensor")) >= reading


@every_graph
def test_no_two_boxes_overlap_and_all_lie_on_the_sheet(name: str) -> None:
    boxes = layout(name).boxes
    clashes = [(a, b) for a, b in combinations(boxes, 2) if boxes[a].overlaps(boxes[b])]
    assert clashes == []
    left, top, width, height = map(
        float, ET.fromstring(svg_of(name)).attrib["viewBox"].split()
    )
    for box in boxes.values():
        assert left <= box.left <= box.right <= left + width
        assert top <= box.top <= box.bottom <= top + height


@every_graph
def test_no_bond_runs_over_a_node(name: str) -> None:
    drawn = layout(name)
    hit = [
        (bond.name, node)
        for bond, path in zip(EVERY[name].bonds, drawn.paths, strict=True)
        for piece in pairwise(path)
        for node, box in drawn.boxes.items()
        if box.meets(*piece)
    ]
    assert hit == []


def crossings(name: str) -> int:
    drawn = layout(name)
    pieces = [(k, p) for k, path in enumerate(drawn.paths) for p in pairwise(path)]
    return sum(touch(p, r) for (k, p), (m, r) in combinations(pieces, 2) if k != m)


@pytest.mark.parametrize(
    "name", [n for n in EVERY if not n.startswith(("complete", "random"))]
)
def test_bonds_of_planar_graphs_do_not_cross(name: str) -> None:
    assert crossings(name) == 0


def test_a_graph_that_needs_one_crossing_has_one() -> None:
    assert crossings("complete 5") == 1


@every_graph
@pytest.mark.parametrize("labels", [BondLabels.NUMBERS, BondLabels.NAMES])
def test_labels_of_bonds_touch_nothing(name: str, labels: BondLabels) -> None:
    picture, svg = laid_out(name, labels), svg_of(name, labels)
    texts = [
        (bond, room_of(text))
        for bond, group in groups(svg, "bond").items()
        for text in group.iter(f"{SVG}text")
    ]
    assert len(texts) == len(picture.graph.bonds)
    on_labels = [
        (a, b) for (a, one), (b, other) in combinations(texts, 2) if touch(one, other)
    ]
    assert on_labels == []
    on_nodes = [
        (bond, node)
        for bond, room in texts
        for node, box in picture.layout.boxes.items()
        if touch(room, corners(box))
    ]
    assert on_nodes == []
    lines = [p for path in picture.layout.paths for p in pairwise(path)]
    assert [bond for bond, room in texts for p in lines if touch(room, p)] == []


@every_graph
def test_half_arrows_point_from_tail_to_head_with_the_barb_on_the_flow_side(
    name: str,
) -> None:
    graph, drawn = EVERY[name], layout(name)
    bonds = groups(svg_of(name), "bond")
    for bond in graph.bonds:
        *line, barb = path_of(bonds[bond.name], "half-arrow")
        for point, node in ((line[0], bond.tail), (line[-1], bond.head)):
            box = drawn.boxes[node].grown(4.2)
            assert box.left <= point[0] <= box.right
            assert box.top <= point[1] <= box.bottom
        (x1, y1), (x2, y2) = line[-2:]
        assert math.dist(barb, (x2, y2)) == pytest.approx(11, abs=0.2)
        if abs(x2 - x1) < 0.15:
            assert barb[0] > x2
        else:  # below the line, whichever way it points
            level = y1 + (y2 - y1) * (barb[0] - x1) / (x2 - x1)
            assert barb[1] > level


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_strokes_are_at_the_end_that_receives_effort(case) -> None:
    graph = EVERY[case.name]
    assignment = assign_causality(graph)
    drawn = groups(draw_svg(graph, assignment=assignment), "bond")
    for stroke in assignment.strokes:
        group = drawn[stroke.bond.name]
        *line, _ = path_of(group, "half-arrow")
        (ax, ay), (bx, by) = path_of(group, "causal")
        at_head = stroke.at == stroke.bond.head
        end, inner = (line[-1], line[-2]) if at_head else (line[0], line[1])
        assert math.dist(((ax + bx) / 2, (ay + by) / 2), end) < 0.2
        along = (bx - ax) * (end[0] - inner[0]) + (by - ay) * (end[1] - inner[1])
        assert abs(along) < 0.1 * math.dist((ax, ay), (bx, by)) * math.dist(end, inner)


@pytest.mark.parametrize("leg", LEGS)
def test_the_legs_read_like_the_figures_of_the_thesis(leg: str) -> None:
    """Power runs left to right on one line; storages hang above and below it."""
    boxes = layout(LEGS[leg].name).boxes
    chain = ["T_motor", "motor", "K_gearbox", "worm", "K_worm_gear", "joint"]
    if leg.endswith("stance"):
        chain += ["K_support", "support"]
    row = [boxes[name] for name in chain]
    assert [box.x for box in row] == sorted(box.x for box in row)
    assert {round(box.y, 1) for box in row} == {round(row[0].y, 1)}
    motor = boxes["motor"]
    assert boxes["I_motor"].bottom < motor.top < motor.bottom < boxes["I_gearbox"].top
    assert boxes["I_motor"].x == boxes["I_gearbox"].x == motor.x


def test_the_bonds_of_the_legs_are_counted_as_in_the_thesis() -> None:
    """In equations 4.2 to 4.31 e1 is at the motor, e11 at the link, e15 at the mass."""
    graph = LEGS["lowerleg_stance"]
    numbers = dict(zip((b.name for b in graph.bonds), bond_numbers(graph), strict=True))
    assert numbers["T_motor>motor"] == 1
    assert (numbers["motor>I_motor"], numbers["motor>I_gearbox"]) == (2, 3)
    assert (numbers["motor>K_gearbox"], numbers["K_gearbox>worm"]) == (4, 5)
    assert (numbers["worm>I_worm"], numbers["worm>K_worm_gear"]) == (6, 7)
    assert numbers["joint>I_lowerleg"] == 11
    assert numbers["support>m_lowerleg"] == 15


@every_graph
def test_every_bond_has_a_number_of_its_own(name: str) -> None:
    graph = EVERY[name]
    assert sorted(bond_numbers(graph)) == list(range(1, len(graph.bonds) + 1))


def test_a_mesh_is_drawn_as_a_mesh() -> None:
    boxes = layout("mesh 3 x 4").boxes
    nodes = [[boxes[f"v{i}_{j}"] for j in range(4)] for i in range(3)]
    lines = [{round(box.y) for box in row} for row in nodes]
    columns = [{round(row[j].x) for row in nodes} for j in range(4)]
    transposed = [{round(box.x) for box in row} for row in nodes]
    straight = all(len(line) == 1 for line in (*lines, *columns))
    assert straight or all(len(line) == 1 for line in transposed)


def test_a_ring_is_a_rectangle_with_its_junctions_at_the_corners() -> None:
    boxes = layout("ring of 4 gyrators").boxes
    corners = {(round(boxes[f"j{k}"].x), round(boxes[f"j{k}"].y)) for k in range(4)}
    assert len({x for x, _ in corners}) == len({y for _, y in corners}) == 2


def test_bonds_side_by_side_do_not_hide_each_other() -> None:
    drawn = layout("side by side")
    first, second, *_ = (set(path) for path in drawn.paths[2:])
    assert not first & second
    assert crossings("side by side") == 0


@pytest.mark.parametrize("name", ["mesh 3 x 4", "hydraulic cylinder", "random 3"])
def test_the_same_graph_has_the_same_picture(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(placing, "grid_of", grid_of)
    again = draw_svg(EVERY[name], labels="numbers", signals=True)
    assert again == svg_of(name)


def test_no_stroke_without_an_assignment() -> None:
    assert 'class="causal"' not in draw_svg(LEGS["lowerleg_flight"])


def test_derivative_chosen_preferred_and_unmet_causality_are_marked() -> None:
    graph = BondGraph("wishes")
    graph.one("shaft", Se("torque"), I("fast"), I("slow"), R("r"))
    graph.one("loop", Se("u"), R("r1"), R("r2"))
    graph.prefer("slow", "integral")
    graph.prefer("r", "flow")
    finished = graph.finish()
    svg = draw_svg(finished, assignment=assign_causality(finished))
    css = {n: g.attrib["class"].split() for n, g in groups(svg, "node").items()}
    assert "derivative" in css["fast"]
    assert "preferred" in css["slow"]
    assert "unmet" in css["r"]
    assert ("chosen" in css["r1"]) != ("chosen" in css["r2"])
    assert "derivative" in groups(svg, "bond")["shaft>fast"].attrib["class"]
    for words in ("derivative causality", "causality chosen freely"):
        assert words in svg.split('<g class="legend">')[1]


def test_derivative_ports_of_a_field_are_marked_on_their_bonds() -> None:
    graph = BondGraph("driven coils", domain="electrical")
    graph.one("free", Se("u"), R("r"))
    graph.one("driven", Sf("i"))
    m, l1, l2 = sympy.symbols("m l1 l2")
    field = IField.from_matrix("coils", [[l1, m], [m, l2]])
    graph.put(field, on=("free", "driven"))
    finished = graph.finish()
    assignment = assign_causality(finished)
    assert assignment.derivative == ("coils[2]",)
    drawn = groups(draw_svg(finished, assignment=assignment), "bond")
    assert "derivative" in drawn["driven>coils"].attrib["class"]
    assert "derivative" not in drawn["free>coils"].attrib["class"]


def test_variables_stand_on_the_sides_of_effort_and_flow() -> None:
    graph = LEGS["lowerleg_flight"]
    drawn = groups(draw_svg(graph, labels="variables"), "bond")
    for bond, number in zip(graph.bonds, bond_numbers(graph), strict=True):
        e, f = drawn[bond.name].iter(f"{SVG}text")
        assert (e.text, f.text) == ("e", "f")
        assert {part.text for part in (e[0], f[0])} == {str(number)}
        left_or_above = (float(e.attrib["x"]), float(e.attrib["y"]))
        right_or_below = (float(f.attrib["x"]), float(f.attrib["y"]))
        assert sum(left_or_above) < sum(right_or_below)


def test_modulation_and_sensors_are_activated_bonds() -> None:
    svg = svg_of("double pendulum")
    arrows = {
        (g.attrib["data-from"], g.attrib["data-to"])
        for g in ET.fromstring(svg).iter(f"{SVG}g")
        if g.attrib["class"] == "signal" and "data-from" in g.attrib
    }
    levers = {(f"theta{k}", f"T{k}{axis}") for k in (1, 2) for axis in "xy"}
    assert arrows >= levers | {("theta1", "→theta_1"), ("x1", "→tip"), ("y2", "→tip")}
    letters = {name: written(g) for name, g in groups(svg, "node").items()}
    assert "MTF" in letters["T1x"]
    sensors = {name: written(g) for name, g in groups(svg, "sensor").items()}
    assert "Dq" in sensors["theta_1"]
    assert "y" in sensors["tip"]
    assert 'class="signal"' not in draw_svg(EVERY["double pendulum"])


@every_graph
def test_signals_lie_on_the_sheet_and_end_at_what_they_lead_to(name: str) -> None:
    root, boxes = ET.fromstring(svg_of(name)), layout(name).boxes
    left, top, width, height = map(float, root.attrib["viewBox"].split())
    for group in root.iter(f"{SVG}g"):
        if group.attrib["class"] != "signal" or "data-to" not in group.attrib:
            continue
        line = points(next(group.iter(f"{SVG}path")))
        assert all(left <= x <= left + width for x, _ in line)
        assert all(top <= y <= top + height for _, y in line)
        target = boxes[group.attrib["data-to"]].grown(3.2)
        assert target.left <= line[-1][0] <= target.right
        assert target.top <= line[-1][1] <= target.bottom


def test_blame_colours_in_proportion_and_says_it_in_words() -> None:
    graph = LEGS["lowerleg_flight"]
    svg = draw_svg(graph, blame={"worm": 1.0, "motor": 0.25})
    nodes = groups(svg, "node")

    def opacity(name: str) -> float:
        (rect,) = (r for r in nodes[name] if r.attrib.get("class") == "blame")
        return float(rect.attrib["fill-opacity"])

    assert opacity("motor") == pytest.approx(opacity("worm") / 4)
    assert "25%" in written(nodes["motor"])
    assert "of the error" in svg
    assert 'class="blame"' not in draw_svg(graph)


def test_any_value_per_place_is_a_colour_with_its_number() -> None:
    lost = Colouring({"worm": 6.0, "motor": 2.0, "joint": -2.0}, "power lost", "W")
    svg = draw_svg(LEGS["lowerleg_flight"], colour=lost)
    nodes = groups(svg, "node")
    assert "6 W" in written(nodes["worm"])
    shares = lost.shares()
    assert (shares["joint"], shares["motor"], shares["worm"]) == (0.0, 0.5, 1.0)
    assert "−2 to 6 W power lost" in svg


def test_inserted_elements_are_marked_with_their_bond() -> None:
    svg = draw_svg(LEGS["lowerleg_flight"], highlight=["c_friction_lowerleg"])
    css = groups(svg, "node")["c_friction_lowerleg"].attrib["class"]
    assert "inserted" in css
    bonds = groups(svg, "bond")
    assert "inserted" in bonds["joint>c_friction_lowerleg"].attrib["class"]
    assert "inserted" not in groups(svg, "node")["I_lowerleg"].attrib["class"]


def test_names_and_titles_are_escaped_and_said_to_who_does_not_see() -> None:
    graph = BondGraph('<script>alert("1 & 2")</script>')
    graph.one("näme", Se("u"), R("r", law=sympy.Symbol("f") * sympy.Symbol("a<b&c")))
    svg = draw_svg(graph.finish(), labels="names")
    assert "<script" not in svg
    root = ET.fromstring(svg)
    title, description = root[0], root[1]
    assert title.text == f"Bond graph of {graph.name}"
    assert "1-junction näme joins Se u, R r" in (description.text or "")
    ids = [element.attrib["id"] for element in root.iter() if "id" in element.attrib]
    assert len(ids) == len(set(ids))
    assert root.attrib["aria-label"] == title.text
    assert root.attrib["aria-describedby"] == description.attrib["id"]


@pytest.mark.parametrize("theme", Theme)
def test_a_theme_is_followed_or_fixed(theme: Theme) -> None:
    svg = draw_svg(LEGS["lowerleg_flight"], theme=theme)
    assert ("prefers-color-scheme" in svg) == (theme is Theme.AUTO)
    assert ("#171b21" in svg) == (theme is not Theme.LIGHT)
    assert not re.search(r"https?://(?!www\.w3\.org)", svg)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"blame": {"wurm": 0.5}}, "Did you mean worm"),
        ({"blame": {"worm": 1.5}}, "blame of 'worm' is 1.5"),
        ({"blame": {"worm": float("nan")}}, "blame of 'worm' is nan"),
        ({"colour": Colouring({"worm": math.inf})}, "value of 'worm' is inf"),
        (
            {"blame": {"worm": 0.5}, "colour": Colouring({"worm": 1.0})},
            "has one colour",
        ),
        ({"highlight": ["gear"]}, "no 'gear'"),
        ({"assignment": {"motor>worm": "worm"}}, "no bond 'motor>worm'"),
        ({"assignment": {"T_motor>motor": "worm"}}, "Put it at 'T_motor' or 'motor'"),
        ({"labels": "number"}, "Did you mean numbers"),
        ({"theme": "night"}, "no theme 'night'"),
    ],
)
def test_what_is_not_there_is_refused(arguments: dict, words: str) -> None:
    with pytest.raises(StructureError, match=re.escape(words)):
        draw_svg(LEGS["lowerleg_flight"], **arguments)


def test_a_png_has_the_size_of_the_picture_and_ink_on_it() -> None:
    pytest.importorskip("resvg_py", reason="PNG needs the extra [png]")
    graph = LEGS["lowerleg_flight"]
    root = ET.fromstring(draw_svg(graph, labels="numbers"))
    picture = draw_png(graph, labels="numbers", scale=1.5)
    assert picture.startswith(b"\x89PNG")
    width, height = struct.unpack(">II", picture[16:24])
    assert width == pytest.approx(1.5 * float(root.attrib["width"]), abs=1)
    assert height == pytest.approx(1.5 * float(root.attrib["height"]), abs=1)
    assert len(set(picture)) > 100
    assert picture != draw_png(graph, labels="numbers", scale=1.5, theme="dark")
    with pytest.raises(BondGraphError, match="pixels"):
        draw_png(graph, scale=1e4)


def test_without_resvg_a_png_is_refused_with_the_way_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "resvg_py", None)
    with pytest.raises(BondGraphError, match=r"Install bondgraph-workbench\[png\]"):
        draw_png(LEGS["lowerleg_flight"])


def test_the_pictures_of_the_documentation_are_drawn_by_the_example() -> None:
    example = runpy.run_path(str(ROOT / "examples" / "pictures.py"))
    drawn = example["pictures"]()
    assert set(drawn) > {"images/cylinder.svg", "images/double_pendulum.svg"}
    for path, svg in drawn.items():
        assert (ROOT / "docs" / path).read_text("utf-8") == svg, path


def test_the_code_of_the_page_on_pictures_runs() -> None:
    page = (ROOT / "docs" / "pictures.md").read_text("utf-8")
    (code,) = re.findall(r"^```python\n(.*?)^```", page, flags=re.M | re.S)
    names: dict[str, str] = {}
    exec(code, names)
    assert "speed" in groups(names["svg"], "sensor")


MODEL = """
from benchmarks.drawing import tree
from bondgraph import BondGraph, I, R, Se

def cart() -> BondGraph:
    graph = BondGraph("cart", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), R("viscous"))
    graph.measure("speed", flow="carriage")
    return graph
"""


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "cart.py"
    path.write_text(MODEL)
    return str(path)


def run(*words: object) -> tuple[int, str]:
    result = CliRunner().invoke(program, [str(word) for word in words])
    return result.exit_code, result.stdout + result.stderr


def test_draw_numbers_bonds_draws_signals_and_colours(model, tmp_path) -> None:
    values, picture = tmp_path / "values.json", tmp_path / "cart.svg"
    values.write_text('{"values": {"viscous": 3}, "caption": "lost", "unit": "W"}')
    status, _ = run(
        *("draw", model, "-o", picture, "--number", "bonds", "--signals"),
        *("--colour-by", values, "--theme", "dark", "--json", tmp_path / "answer"),
    )
    svg = picture.read_text()
    assert status == 0
    assert [written(g) for g in groups(svg, "bond").values()] == [["1"], ["2"], ["3"]]
    assert "speed" in groups(svg, "sensor")
    assert "3 W" in written(groups(svg, "node")["viscous"])
    answer = json.loads((tmp_path / "answer").read_text())
    assert answer["strokes"]["carriage>mass"] == "mass"


def test_draw_writes_a_png_by_its_name(model, tmp_path) -> None:
    pytest.importorskip("resvg_py", reason="PNG needs the extra [png]")
    picture = tmp_path / "cart.png"
    assert run("draw", model, "-o", picture, "--number", "names")[0] == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    status, said = run("draw", model, "-o", tmp_path / "none" / "cart.png")
    assert (status, "cannot be written" in said) == (2, True)


@pytest.mark.parametrize("content", ["no json", "[1]", '{"viscous": "much"}', "{}"])
def test_draw_refuses_a_file_that_gives_no_values(model, tmp_path, content) -> None:
    values = tmp_path / "values.json"
    values.write_text(content)
    status, said = run("draw", model, "--colour-by", values)
    assert (status, said.count("\n")) == (2, 1)
    assert "does not give numbers by place" in said


def test_a_notebook_shows_the_picture_also_where_causality_conflicts() -> None:
    graph = BondGraph("conflict")
    graph.one("a", Sf("x"), Sf("y"))
    finished = graph.finish()
    with pytest.raises(CausalConflictError) as refused:
        assign_causality(finished)
    html = in_a_notebook(finished)
    assert 'class="bondgraph"' in html
    assert refused.value.problem.split("'")[0] in html
    assert 'class="causal"' in in_a_notebook(LEGS["lowerleg_flight"])


@pytest.mark.parametrize("make", [ladder, tree])
def test_every_bond_of_a_large_graph_is_drawn(make) -> None:
    graph = make(100 if make is ladder else 200)
    assert len(groups(draw_svg(graph), "bond")) == len(graph.bonds)
