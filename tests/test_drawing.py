"""The picture of a graph: everything is on it, nothing overlaps, arrows are right."""

import math
import random
import re
import time
import xml.etree.ElementTree as ET
from itertools import combinations

import pytest
import sympy

from bondgraph.errors import StructureError
from bondgraph.reporting.drawing import draw_svg
from bondgraph.reporting.layout import Box
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.elements import GY, TF, C, I, R, Se, Sf
from bondgraph.structure.graph import FinishedGraph
from flegx_models.models import lowerleg_stance, upperleg_stance

SVG = "{http://www.w3.org/2000/svg}"


def leg(load: str, *, stance: bool = False) -> FinishedGraph:
    """Return the structure of the thesis's figures 4.2 to 4.5."""
    graph = BondGraph(f"{load} drive", domain="rotation")
    graph.one("motor", Se("T_motor"), I("I_motor"), I("I_gearbox"))
    graph.one("worm", I("I_worm"))
    graph.one("joint", R("c_friction"), I("I_gear"), I(f"I_{load}"))
    graph.join("motor", TF("K_gearbox"), "worm")
    graph.join("worm", TF("K_worm_gear"), "joint")
    if stance:
        length, angle = sympy.symbols("L theta_0")
        graph.one("support", I("m_motors_support"), I(f"m_{load}"))
        lever = TF("lever", law=1 / (2 * length * sympy.sin(angle)))
        graph.join("joint", lever, "support")
    return graph.finish()


def ring() -> FinishedGraph:
    graph = BondGraph("ring")
    for name in ("a", "b", "c", "d"):
        graph.one(name, R(f"R_{name}"), C(f"C_{name}"), I(f"I_{name}"))
    graph.put(Se("u"), on="a")
    for tail, head in (("a", "b"), ("b", "c"), ("c", "d"), ("d", "a")):
        graph.join(tail, head)
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
    return graph.finish()


GRAPHS = [
    leg("lowerleg"),
    leg("upperleg"),
    leg("lowerleg", stance=True),
    leg("upperleg", stance=True),
    lowerleg_stance().finish(),
    upperleg_stance().finish(),
    ring(),
    *(random_graph(seed) for seed in range(12)),
]
every_graph = pytest.mark.parametrize("graph", GRAPHS, ids=lambda g: g.name)


def groups(svg: str, kind: str) -> dict[str, ET.Element]:
    """Return the groups of class `kind` (node or bond) by name."""
    return {
        group.attrib["data-name"]: group
        for group in ET.fromstring(svg).iter(f"{SVG}g")
        if kind in group.attrib["class"].split()
    }


def boxes(graph: FinishedGraph) -> dict[str, Box]:
    """Return the box of every node, by asking for all of them to be coloured."""
    svg = draw_svg(graph, blame=dict.fromkeys(graph.by_name, 0.5))
    result = {}
    for name, group in groups(svg, "node").items():
        (rect,) = (r for r in group.iter(f"{SVG}rect") if r.attrib["class"] == "blame")
        x, y, w, h = (float(rect.attrib[k]) for k in ("x", "y", "width", "height"))
        result[name] = Box(x + w / 2, y + h / 2, w, h)
    return result


def points(path: ET.Element) -> list[tuple[float, float]]:
    return [
        (float(x), float(y))
        for x, y in re.findall(r"[ML](-?[\d.]+) (-?[\d.]+)", path.attrib["d"])
    ]


def path_of(group: ET.Element, css: str) -> list[tuple[float, float]]:
    (path,) = (p for p in group.iter(f"{SVG}path") if p.attrib["class"] == css)
    return points(path)


@every_graph
def test_every_node_and_bond_is_drawn(graph: FinishedGraph) -> None:
    svg = draw_svg(graph)
    assert set(groups(svg, "node")) == set(graph.by_name)
    assert set(groups(svg, "bond")) == {b.name for b in graph.bonds}
    for name, group in groups(svg, "node").items():
        written = [text.text for text in group.iter(f"{SVG}text")]
        assert name in written


@every_graph
def test_boxes_do_not_overlap_and_lie_on_the_sheet(graph: FinishedGraph) -> None:
    places = boxes(graph)
    clashes = [
        (a, b) for a, b in combinations(places, 2) if places[a].overlaps(places[b])
    ]
    assert clashes == []
    root = ET.fromstring(draw_svg(graph, blame=dict.fromkeys(places, 0.5)))
    for box in places.values():
        assert box.width / 2 <= box.x <= float(root.attrib["width"]) - box.width / 2
        assert box.height / 2 <= box.y <= float(root.attrib["height"]) - box.height / 2


@every_graph
def test_half_arrows_point_from_tail_to_head(graph: FinishedGraph) -> None:
    places = boxes(graph)
    svg = draw_svg(graph, blame=dict.fromkeys(places, 0.5))
    for bond in graph.bonds:
        start, end, barb = path_of(groups(svg, "bond")[bond.name], "half-arrow")
        tail, head = places[bond.tail], places[bond.head]
        assert math.dist(start, (tail.x, tail.y)) < math.dist(end, (tail.x, tail.y))
        assert math.dist(end, (head.x, head.y)) < math.dist(start, (head.x, head.y))
        assert math.dist(start, barb) < math.dist(start, end)


@pytest.mark.parametrize("graph", GRAPHS[:4], ids=lambda g: g.name)
def test_barbs_are_on_the_flow_side(graph: FinishedGraph) -> None:
    for bond in groups(draw_svg(graph), "bond").values():
        (x1, y1), (x2, y2), barb = path_of(bond, "half-arrow")
        side = (barb[0] - x1) * (y2 - y1) - (barb[1] - y1) * (x2 - x1)
        if abs(x2 - x1) < 1:
            assert barb[0] > x2
        else:
            assert side * (x2 - x1) < 0  # below the line, whichever way it points


@every_graph
def test_strokes_are_at_the_end_that_receives_effort(graph: FinishedGraph) -> None:
    dice = random.Random(7)
    strokes = {b.name: dice.choice([b.tail, b.head]) for b in graph.bonds}
    drawn = groups(draw_svg(graph, assignment=strokes), "bond")
    for bond in graph.bonds:
        start, end, _ = path_of(drawn[bond.name], "half-arrow")
        (ax, ay), (bx, by) = path_of(drawn[bond.name], "causal")
        middle = ((ax + bx) / 2, (ay + by) / 2)
        where = end if strokes[bond.name] == bond.head else start
        assert math.dist(middle, where) < 0.2
        along = (bx - ax) * (end[0] - start[0]) + (by - ay) * (end[1] - start[1])
        assert abs(along) < 0.06 * math.dist((ax, ay), (bx, by)) * math.dist(start, end)


def test_no_stroke_without_an_assignment() -> None:
    assert 'class="causal"' not in draw_svg(leg("lowerleg"))


def test_the_leg_reads_like_the_figure() -> None:
    """Power runs left to right: source, motor, worm, joint, load on one line."""
    places = boxes(leg("lowerleg"))
    chain = ("T_motor", "motor", "K_gearbox", "worm", "K_worm_gear", "joint")
    row = [places[name] for name in (*chain, "I_lowerleg")]
    assert [box.x for box in row] == sorted(box.x for box in row)
    assert len({round(box.y, 1) for box in row}) == 1
    above, below = places["I_motor"], places["I_gearbox"]
    assert above.y < places["motor"].y < below.y


def test_parallel_bonds_are_drawn_side_by_side() -> None:
    graph = BondGraph("twice")
    graph.one("a", Se("u"))
    graph.zero("b", R("load"))
    graph.join("a", "b")
    graph.join("b", "a")
    drawn = groups(draw_svg(graph.finish()), "bond")
    first = path_of(drawn["a>b"], "half-arrow")
    second = path_of(drawn["b>a"], "half-arrow")
    assert abs(first[0][1] - second[0][1]) > 5


def test_blame_colours_in_proportion_and_says_it_in_words() -> None:
    graph = leg("lowerleg")
    svg = draw_svg(graph, blame={"worm": 1.0, "motor": 0.25})
    nodes = groups(svg, "node")

    def opacity(name: str) -> float:
        (rect,) = (r for r in nodes[name] if r.attrib.get("class") == "blame")
        return float(rect.attrib["fill-opacity"])

    assert opacity("motor") == pytest.approx(opacity("worm") / 4)
    assert "25%" in [text.text for text in nodes["motor"].iter(f"{SVG}text")]
    assert "of the error" in svg
    assert 'class="blame"' not in draw_svg(graph)


def test_inserted_elements_are_marked_with_their_bond() -> None:
    svg = draw_svg(leg("lowerleg"), highlight=["c_friction"])
    assert "inserted" in groups(svg, "node")["c_friction"].attrib["class"]
    assert "inserted" in groups(svg, "bond")["joint>c_friction"].attrib["class"]
    assert "inserted" not in groups(svg, "node")["I_gear"].attrib["class"]


def test_names_and_titles_are_escaped() -> None:
    graph = BondGraph('<script>alert("1 & 2")</script>')
    graph.one("näme", Se("u"), R("r", law=sympy.Symbol("f") * sympy.Symbol("a<b&c")))
    svg = draw_svg(graph.finish())
    assert "<script" not in svg
    root = ET.fromstring(svg)
    assert root.attrib["aria-label"] == f"Bond graph of {graph.name}"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"blame": {"wurm": 0.5}}, "Did you mean worm"),
        ({"blame": {"worm": 1.5}}, "blame of 'worm' is 1.5"),
        ({"blame": {"worm": float("nan")}}, "blame of 'worm' is nan"),
        ({"highlight": ["gear"]}, "no 'gear'"),
        ({"assignment": {"motor>worm": "worm"}}, "no bond 'motor>worm'"),
        ({"assignment": {"T_motor>motor": "worm"}}, "Put it at 'T_motor' or 'motor'"),
    ],
)
def test_what_is_not_there_is_refused(arguments: dict, words: str) -> None:
    with pytest.raises(StructureError, match=re.escape(words)):
        draw_svg(leg("lowerleg"), **arguments)


def test_a_thousand_junctions_are_drawn_in_a_second() -> None:
    graph = BondGraph("ladder")
    for k in range(1000):
        add = graph.one if k % 2 else graph.zero
        add(f"j{k}", I(f"m{k}") if k % 2 else C(f"k{k}"))
        if k:
            graph.join(f"j{k - 1}", f"j{k}")
    finished = graph.finish()
    started = time.process_time()
    svg = draw_svg(finished)
    assert time.process_time() - started < 1.0
    assert len(groups(svg, "bond")) == 1999
