"""The machines that every size benchmark uses, written as an author would."""

import sympy

from bondgraph import BondGraph, C, I, R, Se, f, q

FAMILIES = ("msd", "lc", "rlc", "nonlinear")


def chain(stages: int, *, nonlinear: bool = False) -> BondGraph:
    """Return a mass-spring-damper chain, pulled at one end; 6 bonds a stage.

    The last spring and damper stand on the ground. Nonlinear, the springs are cubic
    and the dampers rub (tanh).
    """
    graph = BondGraph(f"chain of {stages}", domain="translation")
    for i in range(stages):
        spring, damper = C(f"c{i}"), R(f"b{i}")
        if nonlinear:
            k, k3, fc = (sympy.Symbol(f"{x}{i}", real=True) for x in ("k", "k3_", "fc"))
            spring = C(f"c{i}", law=k * q + k3 * q**3)
            damper = R(f"b{i}", law=fc * sympy.tanh(f / 0.1))
            graph.parameter(f"k{i}", 100.0, "N/m")
            graph.parameter(f"k3_{i}", 50.0, "N/m^3")
            graph.parameter(f"fc{i}", 0.3, "N")
        else:
            graph.parameter(f"c{i}", compliance(i), "m/N")
            graph.parameter(f"b{i}", damping(i), "N*s/m")
        graph.parameter(f"m{i}", mass(i), "kg")
        graph.one(f"v{i}", I(f"m{i}"))
        if i + 1 < stages:
            graph.zero(f"n{i}")
            graph.one(f"w{i}", spring, damper)
            graph.join(f"n{i}", f"w{i}")
            graph.join(f"v{i}", f"n{i}")
        else:
            graph.put(spring, on=f"v{i}")
            graph.put(damper, on=f"v{i}")
        if i:
            graph.join(f"n{i - 1}", f"v{i}")
    graph.put(Se("pull"), on="v0")
    graph.measure("speed", flow="v0")
    return graph


def ladder(stages: int, *, series_resistance: bool) -> BondGraph:
    """Return an LC (RLC) ladder with a load; 4 (5) bonds a stage."""
    graph = BondGraph(f"ladder of {stages}", domain="electrical")
    for i in range(stages):
        graph.one(f"s{i}", I(f"l{i}"))
        graph.parameter(f"l{i}", mass(i), "H")
        if series_resistance:
            graph.put(R(f"r{i}"), on=f"s{i}")
            graph.parameter(f"r{i}", damping(i), "ohm")
        graph.zero(f"n{i}", C(f"c{i}"))
        graph.parameter(f"c{i}", compliance(i), "F")
        graph.join(f"s{i}", f"n{i}")
        if i:
            graph.join(f"n{i - 1}", f"s{i}")
    graph.put(Se("pull"), on="s0")
    graph.put(R("load"), on=f"n{stages - 1}")
    graph.parameter("load", 1.5, "ohm")
    graph.measure("speed", flow="s0")
    return graph


def family(name: str, stages: int) -> BondGraph:
    """Return a machine of one of the `FAMILIES`."""
    if name in {"msd", "nonlinear"}:
        return chain(stages, nonlinear=name == "nonlinear")
    return ladder(stages, series_resistance=name == "rlc")


def mass(i: int) -> float:
    """Return the value of inertance i; no two neighbours are equal."""
    return 1.0 + 0.01 * (i % 17)


def compliance(i: int) -> float:
    """Return the value of compliance i."""
    return 0.01 + 0.0001 * (i % 13)


def damping(i: int) -> float:
    """Return the value of resistance i."""
    return 0.3 + 0.01 * (i % 11)
