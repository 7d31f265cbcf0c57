"""Graphs drawn at random, most of them machines that nobody would build."""

import random

import sympy

from bondgraph import (
    GY,
    TF,
    BondGraph,
    C,
    I,
    R,
    Se,
    Sf,
    displacement,
    e,
    f,
    momentum,
    p,
    q,
    t,
)
from bondgraph.structure.signals import parameter_symbol


def random_graph(seed: int) -> BondGraph:
    """Return a linear graph drawn at random: a tree of junctions, rings added.

    Nothing makes it well posed: many such graphs are causal conflicts.
    """
    draw = random.Random(seed)
    graph = BondGraph(f"random {seed}")
    size = draw.randint(1, 6)
    elements: list[str] = []
    for j in range(size):
        kinds = draw.choices([I, C, R, R, Se, Sf], k=draw.randint(0, 3))
        ports = [kind(f"x{j}_{k}") for k, kind in enumerate(kinds)]
        elements += [port.name for port in ports]
        (graph.one if draw.random() < 0.5 else graph.zero)(f"j{j}", *ports)
    pairs = [(draw.randrange(j), j) for j in range(1, size)]
    if size > 2:
        pairs += [tuple(draw.sample(range(size), 2)) for _ in range(draw.randint(0, 2))]
    for n, pair in enumerate(pairs):
        tail, head = (f"j{j}" for j in draw.sample(pair, 2))
        two_port = draw.choice([None, None, TF(f"k{n}"), GY(f"k{n}")])
        graph.join(tail, *(() if two_port is None else (two_port,)), head)
    for name in draw.sample(elements, min(2, len(elements))):
        graph.measure(f"effort_{name}", effort=name)
        graph.measure(f"flow_{name}", flow=name)
    return graph


def random_nonlinear_graph(seed: int) -> BondGraph:
    """Return a graph drawn at random, with curved laws and moduli that move.

    Laws rise everywhere, so that both directions exist; moduli read displacements of
    1-junctions, momenta of 0-junctions, inputs or time.
    """
    draw = random.Random(10_000 + seed)
    graph = BondGraph(f"random nonlinear {seed}")
    size = draw.randint(1, 5)
    ones = [draw.random() < 0.6 for _ in range(size)]
    elements: list[str] = []
    for j, one in enumerate(ones):
        ports = [
            _curved(draw, f"x{j}_{k}") for k in range(draw.choice([1, 1, 2, 2, 3]))
        ]
        elements += [port.name for port in ports]
        (graph.one if one else graph.zero)(f"j{j}", *ports)
    reads = [displacement if one else momentum for one in ones]
    readable = [read(f"j{j}") for j, read in enumerate(reads)]
    for j in range(1, size):
        pair = draw.sample((draw.randrange(j), j), 2)
        moving = 1 + draw.choice([0.3, 0.5]) * sympy.sin(draw.choice([*readable, t]))
        law = parameter_symbol(f"k{j}") * draw.choice([1, moving])
        two_port = draw.choice([None, TF(f"n{j}", law=law), GY(f"n{j}", law=law)])
        tail, head = (f"j{i}" for i in pair)
        graph.join(tail, *(() if two_port is None else (two_port,)), head)
    for name in draw.sample(elements, min(2, len(elements))):
        graph.measure(f"effort_{name}", effort=name)
        graph.measure(f"flow_{name}", flow=name)
    return graph


def _curved(draw: random.Random, name: str) -> I | C | R | Se | Sf:
    """Return a one-port, often with a law that is not linear."""
    kind = draw.choices([I, C, R, Se, Sf], weights=[4, 4, 5, 2, 1])[0]
    if kind in (Se, Sf) or draw.random() < 0.4:
        return kind(name)
    a, b = parameter_symbol(f"a_{name}"), parameter_symbol(f"b_{name}")
    usual = {I: p, C: q, R: f}[kind]
    other = {I: f, C: e, R: e}[kind]
    x = draw.choice([usual, usual, other])
    curves = (a * x + b * x**3, a * sympy.sinh(x), a * x + b * sympy.tanh(x))
    return kind(name, law=draw.choice(curves))
