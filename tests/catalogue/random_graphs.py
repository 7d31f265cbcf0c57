"""Graphs drawn at random, most of them machines that nobody would build."""

import random

from bondgraph import GY, TF, BondGraph, C, I, R, Se, Sf


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
