"""What must not matter, or only in a known way, for every graph of the catalogue.

Turned half arrows, other names, another order, another domain; 0 and 1 exchanged with
effort and flow; other units. And energy: what goes in is stored or dissipated.
"""

import math
import random
from collections.abc import Callable, Mapping
from dataclasses import replace
from operator import attrgetter
from typing import Any

import numpy as np
import pint
import pytest
import sympy
from catalogue import CASES, FIELDS, Case, somewhere
from catalogue.evaluation import evaluated, leaves, number, observed
from scipy.integrate import quad

from bondgraph import FinishedGraph, assign_causality, derive
from bondgraph.structure import elements as kinds
from bondgraph.structure import fields
from bondgraph.structure.domains import DOMAINS, Quantity
from bondgraph.structure.fields import MultiPort, ResistanceField
from bondgraph.structure.graph import Bond
from bondgraph.structure.parameters import Parameter, ParameterSet
from bondgraph.structure.signals import (
    PortVariable,
    Signal,
    parameter_symbol,
    t,
)

EVERY = CASES + FIELDS
every_case = pytest.mark.parametrize("case", EVERY, ids=attrgetter("name"))
Symbols = Mapping[sympy.Symbol, sympy.Symbol]


def rebuilt(
    graph: FinishedGraph,
    *,
    place: Callable[[str], str] = lambda name: name,
    symbols: Callable[[sympy.Expr], sympy.Expr] = lambda law: law,
    moduli: Callable[[sympy.Expr], sympy.Expr] = lambda law: law,
    kinds_become: Mapping[type, Any] | None = None,
    **changes: Any,
) -> FinishedGraph:
    """Return the graph with places, the symbols of laws and kinds replaced."""
    kinds_become = kinds_become or {}

    def law(expression: sympy.Expr) -> sympy.Expr:
        moved = {
            x: Signal(x.quantity, place(x.place))
            for x in expression.free_symbols
            if isinstance(x, Signal)
        }
        return symbols(expression.xreplace(moved))

    def rewritten(old: Any) -> Any:
        kind, name = kinds_become.get(type(old), type(old)), place(old.name)
        match old:
            case kinds.EffortSource() | kinds.FlowSource():
                return kind(name, None if old.value is None else law(old.value))
            case kinds.Inertance() | kinds.Compliance() | kinds.Resistance():
                return kind(name, law(old.relation.expression))
            case kinds.Transformer() | kinds.Gyrator():
                return kind(name, moduli(law(old.modulus)))
            case _ if isinstance(old, MultiPort):
                return kind(name, tuple(law(x) for x in old.laws))
        return kind(name)

    given = {
        "nodes": tuple(rewritten(n) for n in graph.nodes),
        "bonds": tuple(Bond(place(b.tail), place(b.head)) for b in graph.bonds),
        "measurements": tuple(
            replace(m, expression=law(m.expression)) for m in graph.measurements
        ),
        "preferences": tuple(
            replace(p, element=place(p.element)) for p in graph.preferences
        ),
    }
    return replace(graph, **(given | changes))


# Half arrows ----------------------------------------------------------------------


def turnable(graph: FinishedGraph) -> list[int]:
    """Return bonds whose half arrow is a mere sign.

    Between a 0- and a 1-junction the arrow says whether flows (efforts) add or
    subtract; a two-port's two arrows together say which side is a. One of a two-port's
    arrows, those of elements and those between equal junctions are conventions.
    """
    by_name = graph.by_name
    found, taken = [], set()
    for i, bond in enumerate(graph.bonds):
        ends = (by_name[bond.tail], by_name[bond.head])
        two_ports = {
            n.name for n in ends if isinstance(n, kinds.Transformer | kinds.Gyrator)
        }
        junctions = [
            n for n in ends if isinstance(n, kinds.ZeroJunction | kinds.OneJunction)
        ]
        if two_ports & taken or (
            len(junctions) == 2 and type(junctions[0]) is not type(junctions[1])
        ):
            continue
        taken |= two_ports
        found.append(i)
    return found


@every_case
@pytest.mark.parametrize("seed", [1, 2])
def test_half_arrows_are_signs(case: Case, seed: int) -> None:
    graph = case.graph()
    draw = random.Random(f"{case.name} {seed}")
    turned = {i for i in turnable(graph) if draw.random() < 0.6}
    bonds = tuple(
        Bond(b.head, b.tail) if i in turned else b for i, b in enumerate(graph.bonds)
    )
    one, other = observed(graph), observed(replace(graph, bonds=bonds))
    assert other.rates == pytest.approx(one.rates, rel=1e-8, abs=1e-9)
    assert other.outputs == pytest.approx(one.outputs, rel=1e-8, abs=1e-9)
    for i, (straight, there) in enumerate(zip(graph.bonds, bonds, strict=True)):
        sign = -1 if i in turned else 1
        assert other.power(there.name) == pytest.approx(
            sign * one.power(straight.name), rel=1e-7, abs=1e-9
        )


# Names and order ------------------------------------------------------------------


@every_case
def test_names_do_not_matter(case: Case) -> None:
    graph = case.graph()
    draw = random.Random(case.name)
    names = [*{n.name: None for n in graph.nodes} | dict.fromkeys(graph.parameters)]
    fresh = draw.sample(range(1000), len(names))
    new = {n: f"zz{k}" if k % 2 else f"a{k}" for n, k in zip(names, fresh, strict=True)}
    renaming = {parameter_symbol(n): parameter_symbol(new[n]) for n in graph.parameters}
    other = rebuilt(
        graph,
        place=lambda name: ">".join(new[part] for part in name.split(">")),
        symbols=lambda law: law.xreplace(renaming),
        parameters=ParameterSet(
            tuple(replace(p, name=new[p.name]) for p in graph.parameters.members)
        ),
    )
    one = observed(graph)
    back = {f"{k}_{new[n]}": f"{k}_{n}" for n in names for k in "pq"}
    back |= {f"d{new[n]}": f"d{n}" for n in names}
    back |= {new[n]: n for n in names}
    values = {symbol.name: value for symbol, value in one.at.items()}
    theirs = derive(other)
    put = {x: values[_stem(x.name, back)] for x in leaves(theirs)}
    at = evaluated(theirs, put)
    rates = {_stem(s.symbol.name, back): at[s.rate] for s in theirs.states}
    assert rates == pytest.approx(one.rates, rel=1e-7, abs=1e-9)


def _stem(name: str, back: Mapping[str, str]) -> str:
    """Return the old name of a symbol, also of one like ``q_a12_1``."""
    if name in back:
        return back[name]
    stem, _, port = name.rpartition("_")
    return f"{back[stem]}_{port}" if stem in back else name


@every_case
def test_order_does_not_matter(case: Case) -> None:
    graph = case.graph()
    draw = random.Random(case.name)
    # The first of two equal storages becomes the state, so these keep their order;
    # a field's ports and a two-port's sides are numbered by their bonds.
    junctions = list(graph.junctions)
    draw.shuffle(junctions)
    stores = (*_STORING, *_FIELDS)
    others = [n for n in graph.elements if not isinstance(n, stores)]
    draw.shuffle(others)
    nodes = (
        *others,
        *junctions,
        *(n for n in graph.elements if isinstance(n, stores)),
    )
    order = sorted(range(len(graph.bonds)), key=lambda _: draw.random())
    order = _with_ports_in_order(graph, order)
    mixed = replace(
        graph,
        nodes=nodes,
        bonds=tuple(graph.bonds[i] for i in order),
        domains=tuple(graph.domains[i] for i in order),
    )
    one, other = observed(graph), observed(mixed)
    assert other.rates == pytest.approx(one.rates, rel=1e-7, abs=1e-9)
    assert other.outputs == pytest.approx(one.outputs, rel=1e-7, abs=1e-9)


_STORING = (kinds.Inertance, kinds.Compliance)
_FIELDS = (fields.InertanceField, fields.ComplianceField, fields.MixedField)


def _with_ports_in_order(graph: FinishedGraph, order: list[int]) -> list[int]:
    """Return `order` with the bonds of each field in the author's order."""
    new = list(order)
    for node in graph.nodes:
        if isinstance(node, MultiPort):
            own = [
                i for i, b in enumerate(graph.bonds) if node.name in (b.tail, b.head)
            ]
            places = sorted(new.index(i) for i in own)
            for place, i in zip(places, own, strict=True):
                new[place] = i
    return new


# Duality --------------------------------------------------------------------------

_DUAL_QUANTITY = {"effort": "flow", "flow": "effort"}
_DUAL_QUANTITY |= {"momentum": "displacement", "displacement": "momentum"}
_DUAL_LETTER = {"e": "f", "f": "e", "p": "q", "q": "p"}
_DUAL_KIND = {
    kinds.ZeroJunction: kinds.OneJunction,
    kinds.OneJunction: kinds.ZeroJunction,
    kinds.EffortSource: kinds.FlowSource,
    kinds.FlowSource: kinds.EffortSource,
    kinds.Inertance: kinds.Compliance,
    kinds.Compliance: kinds.Inertance,
    fields.InertanceField: fields.ComplianceField,
    fields.ComplianceField: fields.InertanceField,
}


def _dual_law(law: sympy.Expr) -> sympy.Expr:
    new: dict[sympy.Symbol, sympy.Symbol] = {}
    for x in law.free_symbols:
        if isinstance(x, Signal):
            new[x] = Signal(_DUAL_QUANTITY[x.quantity], x.place)
        elif isinstance(x, PortVariable):
            new[x] = PortVariable(_DUAL_LETTER[x.letter], x.number)
        elif x.name in _DUAL_LETTER:
            new[x] = sympy.Symbol(_DUAL_LETTER[x.name], real=True)
    return law.xreplace(new)


@every_case
def test_efforts_and_flows_may_change_places(case: Case) -> None:
    # 0 for 1, I for C, Se for Sf, e for f, p for q, moduli upside down: an electrical
    # network and its mechanical twin of the other analogy.
    graph = case.graph()
    analogue = (DOMAINS["analogue"],) * len(graph.bonds)
    twin = rebuilt(
        graph,
        symbols=_dual_law,
        moduli=lambda modulus: 1 / modulus,
        kinds_become=_DUAL_KIND,
        domains=analogue,
    )
    one = observed(graph)
    theirs = derive(twin)
    mirrored = {"p": "q", "q": "p"}
    swap = {
        s.symbol.name: mirrored[s.symbol.name[0]] + s.symbol.name[1:]
        for s in theirs.states
    }
    values = {symbol.name: value for symbol, value in one.at.items()}
    put = {x: values[swap.get(x.name, x.name)] for x in leaves(theirs)}
    at = evaluated(theirs, put)
    rates = {swap[s.symbol.name]: at[s.rate] for s in theirs.states}
    assert rates == pytest.approx(one.rates, rel=1e-7, abs=1e-9)
    outputs = {o.name: number(o.expression, at) for o in theirs.outputs}
    assert outputs == pytest.approx(one.outputs, rel=1e-7, abs=1e-9)


# Units ----------------------------------------------------------------------------


def _plain(case: Case) -> bool:
    """Whether every parameter belongs to one linear element."""
    graph = case.graph()
    return all(
        getattr(n, "law", None) is None and getattr(n, "value", None) is None
        for n in graph.elements
        if not isinstance(n, MultiPort)
    ) and not any(isinstance(n, MultiPort) for n in graph.elements)


@pytest.mark.parametrize(
    "case", [c for c in EVERY if _plain(c)], ids=attrgetter("name")
)
def test_other_units_give_the_same_physics(case: Case) -> None:
    # Efforts in another unit, flows in another, time in another: if every term of
    # every equation has the same dimension, all answers scale by their own unit.
    graph = case.graph()
    effort, flow, time = 3.0, 0.7, 1.9
    per = {
        Quantity.EFFORT: effort,
        Quantity.FLOW: flow,
        Quantity.MOMENTUM: effort * time,
        Quantity.DISPLACEMENT: flow * time,
    }
    scale: dict[str, float] = {"t": time}
    for node in graph.elements:
        match node:
            case kinds.EffortSource() | kinds.FlowSource():
                own = effort if isinstance(node, kinds.EffortSource) else flow
                scale |= {node.name: own, f"d{node.name}": own / time}
            case kinds.Resistance() | kinds.Gyrator():
                scale[node.name] = effort / flow
            case kinds.Inertance():
                scale[node.name] = effort * time / flow
            case kinds.Compliance():
                scale[node.name] = flow * time / effort
    equations = derive(graph)
    stored = {
        s.symbol.name: per[
            Quantity.MOMENTUM if s.symbol.name[0] == "p" else Quantity.DISPLACEMENT
        ]
        for s in equations.states
    }
    scale |= stored
    put = somewhere(leaves(equations))
    at = evaluated(equations, put)
    scaled = evaluated(equations, {x: v * scale.get(x.name, 1) for x, v in put.items()})
    for state in equations.states:
        expected = at[state.rate] * stored[state.symbol.name] / time
        assert scaled[state.rate] == pytest.approx(expected, rel=1e-8, abs=1e-9)
    for output, measurement in zip(equations.outputs, graph.measurements, strict=True):
        assert isinstance(measurement.expression, Signal)
        own = per[measurement.expression.quantity]
        expected = number(output.expression, at) * own
        found = number(output.expression, scaled)
        assert found == pytest.approx(expected, rel=1e-8, abs=1e-9)


MEASURED = [c for c in EVERY if all(d.checked for d in c.graph().domains)]
BASE = {"mass": 2.1, "length": 1.3, "time": 0.7, "current": 1.9, "temperature": 1.1}


def _in_other_base_units(unit: str) -> float:
    """Return the factor of `unit` when kilogram, metre, second, … are others."""
    dimensions = pint.Unit(unit.replace("^", "**")).dimensionality
    return math.prod(BASE[name.strip("[]")] ** n for name, n in dimensions.items())


def test_many_machines_cross_domains_with_units() -> None:
    assert len(MEASURED) >= 10
    assert len({d.name for c in MEASURED for d in c.graph().domains}) == 5


@pytest.mark.parametrize("case", MEASURED, ids=attrgetter("name"))
def test_units_agree_across_domains(case: Case) -> None:
    # In other base units every number changes by its unit; no answer may notice.
    graph = case.graph()
    equations = derive(graph)
    scale = {"t": _in_other_base_units("s")}
    scale |= {p.name: _in_other_base_units(p.unit) for p in graph.parameters.values()}
    scale |= {s.symbol.name: _in_other_base_units(s.unit) for s in equations.states}
    units = dict(zip(equations.inputs, equations.input_units, strict=True))
    scale |= {u.name: _in_other_base_units(unit) for u, unit in units.items()}
    scale |= {f"d{u.name}": scale[u.name] / scale["t"] for u in units}
    put = somewhere(leaves(equations))
    at = evaluated(equations, put)
    scaled = evaluated(equations, {x: v * scale[x.name] for x, v in put.items()})
    for state in equations.states:
        expected = at[state.rate] * scale[state.symbol.name] / scale["t"]
        assert scaled[state.rate] == pytest.approx(expected, rel=1e-8, abs=1e-9)
    for output in equations.outputs:
        expected = number(output.expression, at) * _in_other_base_units(output.unit)
        found = number(output.expression, scaled)
        assert found == pytest.approx(expected, rel=1e-8, abs=1e-9)


@pytest.mark.parametrize(
    "case", [c for c in EVERY if _plain(c)], ids=attrgetter("name")
)
@pytest.mark.parametrize("domain", ["translation", "electrical", "hydraulic"])
def test_twins_in_other_domains_have_the_same_equations(
    case: Case, domain: str
) -> None:
    graph = case.graph()
    there = DOMAINS[domain]
    bare = tuple(Parameter(name=n) for n in graph.parameters)
    twin = replace(
        graph,
        domains=(there,) * len(graph.bonds),
        parameters=ParameterSet(bare),
        measurements=(),
    )
    one, other = derive(replace(graph, measurements=())), derive(twin)
    assert other.assignments == one.assignments
    assert other.rates == one.rates
    for state in other.states:
        momentum = state.symbol.name[0] == "p"
        assert state.unit == there.unit(
            Quantity.MOMENTUM if momentum else Quantity.DISPLACEMENT
        )


# Energy ---------------------------------------------------------------------------


def _stores_alone(case: Case) -> bool:
    """Whether no storage's law reads a signal, each with an energy of its own."""
    return not any(
        isinstance(x, Signal)
        for node in case.graph().elements
        if isinstance(node, _STORING)
        for x in node.relation.expression.free_symbols
    )


def test_most_cases_have_storages_with_an_energy_of_their_own() -> None:
    others = [case.name for case in EVERY if not _stores_alone(case)]
    assert others == ["electromagnet_by_modulation", "spring_pendulum"]


@pytest.mark.parametrize(
    "case", [c for c in EVERY if _stores_alone(c)], ids=attrgetter("name")
)
def test_what_sources_give_is_stored_or_dissipated(case: Case) -> None:
    graph = case.graph()
    equations = derive(graph)
    put = somewhere(leaves(equations))
    put |= {x: case.where[x.name] for x in put if x.name in case.where}
    now = evaluated(equations, put)

    def power(name: str) -> float:
        e, f = (equations.signal(q, name) for q in ("effort", "flow"))
        return number(e * f, now)

    supplied = sum(
        power(n.name)
        for n in graph.elements
        if isinstance(n, kinds.EffortSource | kinds.FlowSource)
    )
    dissipated = sum(
        power(n.name) for n in graph.elements if isinstance(n, kinds.Resistance)
    )
    for node in graph.elements:
        if isinstance(node, ResistanceField):
            dissipated += sum(power(node.port(i + 1)) for i in range(node.size))
    rates = {s.symbol: now[s.rate] for s in equations.states}
    rates |= dict(
        zip(
            equations.inputs,
            (put[r] for r in equations.input_rates),
            strict=True,
        )
    )
    rates[t] = 1.0
    step = 1e-5
    before, after = (
        _energy(
            graph,
            evaluated(
                equations,
                {x: v + side * step * rates.get(x, 0.0) for x, v in put.items()},
            ),
            equations,
        )
        for side in (-1, 1)
    )
    stored = (after - before) / (2 * step)
    assert supplied - dissipated == pytest.approx(stored, rel=1e-5, abs=1e-6)


def _energy(graph: FinishedGraph, at: Any, equations: Any) -> float:
    """Return the energy in all storages, from their laws by quadrature."""
    total = 0.0
    for node in graph.elements:
        if isinstance(node, kinds.Inertance | kinds.Compliance):
            momentum = isinstance(node, kinds.Inertance)
            x = "momentum" if momentum else "displacement"
            co = "flow" if momentum else "effort"
            stored = number(equations.signal(x, node.name), at)
            through = number(equations.signal(co, node.name), at)
            relation = node.relation
            law = sympy.lambdify(relation.argument, relation.expression.xreplace(at))
            written = relation.argument.name in "pq"
            area = quad(law, 0.5, stored if written else through)[0]
            # Written in the co-variable, the law gives the co-energy.
            total += area if written else stored * through - area
        elif isinstance(node, MultiPort) and not isinstance(node, ResistanceField):
            total += _energy_of_field(node, at, equations)
    return total


def _energy_of_field(node: Any, at: Any, equations: Any) -> float:
    """Return the energy of a field: its laws along a line from a base point."""
    stored, through = [], []
    for i, variable in enumerate(node.stored):
        momentum = variable.letter == "p"
        names = ("momentum", "flow") if momentum else ("displacement", "effort")
        a, b = (number(equations.signal(n, node.port(i + 1)), at) for n in names)
        stored.append(a)
        through.append(b)
    relations = node.relations
    arguments = [r.argument for r in relations]
    written = arguments[0] in node.stored
    end = np.array(stored if written else through)
    base = np.full(len(end), 0.5)
    laws = sympy.lambdify(
        [arguments], [r.expression.xreplace(at) for r in relations], "numpy"
    )

    def along(s: float) -> float:
        return float(np.dot(laws(base + s * (end - base)), end - base))

    area = quad(along, 0.0, 1.0)[0]
    return float(area if written else np.dot(stored, through) - area)


# Counting -------------------------------------------------------------------------


@every_case
def test_there_are_as_many_states_as_integral_storages_and_integrators(
    case: Case,
) -> None:
    graph = case.graph()
    equations = derive(graph)
    integral = assign_causality(graph).integral
    assert {s.place for s in equations.states} >= set(integral)
    integrators = [s for s in equations.states if s.place not in integral]
    reads = {
        (x.quantity, x.place)
        for node in graph.nodes
        for law in _laws(node)
        for x in law.free_symbols
        if isinstance(x, Signal)
    } | {
        (x.quantity, x.place)
        for m in graph.measurements
        for x in m.expression.free_symbols
        if isinstance(x, Signal)
    }
    integrated = [r for r in reads if r[0] in ("momentum", "displacement")]
    assert len(integrators) <= len(integrated)
    assert len(equations.states) == len(integral) + len(integrators)


def _laws(node: Any) -> tuple[sympy.Expr, ...]:
    if isinstance(node, MultiPort):
        return node.laws
    law = getattr(node, "law", None)
    law = getattr(node, "value", law) if law is None else law
    return () if law is None else (law,)


@every_case
def test_every_signal_is_made_of_states_inputs_parameters_and_time(case: Case) -> None:
    graph = case.graph()
    equations = derive(graph)
    known = leaves(equations) | set(equations.unknowns)
    known |= {s.rate for s in equations.states}
    known |= {a.symbol for a in (*equations.assignments, *equations.further)}
    for bond in graph.bonds:
        for quantity in ("effort", "flow"):
            assert equations.signal(quantity, bond.name).free_symbols <= known
