"""Gravity feed-forward from the bond graph: what an input must give to hold still.

The gravity sources are in the graph; so is the way from them to the actuated joints.
With all flows and rates zero, the rows of the storages' momenta say which efforts are
left over, once with the sources and once without: the difference is gravity's share. It
is linear in the inputs, which are solved for as expressions of the posture.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import sympy

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.reduction import reduce
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import LoopShapingError, ParameterError, did_you_mean
from bondgraph.structure.edits import InsertElement
from bondgraph.structure.elements import (
    EffortSource,
    OneJunction,
    Se,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import parameter_symbol

ZERO = sympy.S.Zero


@dataclass(frozen=True, slots=True, kw_only=True)
class GravityFeedforward:
    """The efforts that hold gravity, by actuated place.

    Parameters
    ----------
    efforts
        Of states (displacements) and parameters, in SI units.
    states
        The names of the displacements in them, in the order of the C arguments.
    sources
        The elements that count as gravity.
    """

    name: str
    efforts: Mapping[str, sympy.Expr]
    states: tuple[str, ...]
    sources: tuple[str, ...]

    def at(
        self, values: Mapping[str, float], posture: Mapping[str, float]
    ) -> dict[str, float]:
        """Return the efforts at parameter values and a posture, both by name."""
        put = {parameter_symbol(n): v for n, v in values.items()}
        put |= {sympy.Symbol(n): v for n, v in posture.items()}
        found = {n: e.subs(self._states(put)) for n, e in self.efforts.items()}
        for place, number in found.items():
            if number.free_symbols:
                missing = sorted(map(str, number.free_symbols))
                raise ParameterError(
                    f"The effort at {place} needs a value of {', '.join(missing)}.",
                    tuple(missing),
                    "Give all parameters and the whole posture.",
                )
        return {place: float(number) for place, number in found.items()}

    def _states(self, put: Mapping[sympy.Symbol, float]) -> dict[sympy.Symbol, float]:
        by_name = {str(symbol): value for symbol, value in put.items()}
        symbols = {s for e in self.efforts.values() for s in e.free_symbols}
        return {s: by_name[str(s)] for s in symbols if str(s) in by_name}

    def c99(self, values: Mapping[str, float]) -> str:
        """Return one C99 function per place, of the displacements, at these values.

        Raises
        ------
        ParameterError
            If a parameter has no value.
        """
        arguments = ", ".join(f"double {_word(s)}" for s in self.states)
        lines = [
            f"/* {self.name}: efforts that hold gravity, SI units. */",
            "#include <math.h>",
            "",
        ]
        for place, effort in self.efforts.items():
            put = {
                s: _word(str(s)) for s in effort.free_symbols if str(s) in self.states
            }
            numbers = self._states({sympy.Symbol(n): v for n, v in values.items()})
            body = effort.subs(numbers)
            known = {str(s) for s in put}
            missing = sorted(str(s) for s in body.free_symbols if str(s) not in known)
            if missing:
                raise ParameterError(
                    f"The effort at {place} needs a value of {', '.join(missing)}.",
                    tuple(missing),
                    "Give one for every parameter.",
                )
            named = sympy.N(body, 17).xreplace(
                {s: sympy.Symbol(w) for s, w in put.items()}
            )
            title = f"double gravity_{_word(place)}({arguments or 'void'})"
            lines += [f"{title};", title, "{"]
            lines += [f"    (void){_word(s)};" for s in self.states]
            lines += [f"    return {sympy.ccode(named, standard='C99')};", "}", ""]
        return "\n".join(lines)


def _word(name: str) -> str:
    return "".join(c if c.isalnum() else "_" for c in name)


def gravity_feedforward(
    graph: FinishedGraph,
    places: Sequence[str],
    *,
    sources: Sequence[str] | None = None,
) -> GravityFeedforward:
    """Return the efforts at some places that hold gravity at rest.

    Parameters
    ----------
    places
        Inputs of the graph (a motor's torque), or 1-junctions (the torque at a joint).
    sources
        The effort sources that count as gravity; all that are no inputs otherwise.

    Raises
    ------
    LoopShapingError
        If a name is unknown, there is no such source, or these places cannot hold it.
    """
    chosen = _gravity_sources(graph, sources)
    held: dict[str, str] = {}
    inputs = {node.name for node in graph.inputs}
    for place in places:
        held[place] = place
        if place not in inputs:
            if not graph.has_place(place) or not isinstance(
                graph.node(place), OneJunction
            ):
                raise LoopShapingError(
                    f"{place!r} is neither an input nor a 1-junction of "
                    f"{graph.name!r}.",
                    (place,),
                    did_you_mean(place, inputs | {j.name for j in graph.junctions}),
                )
            held[place] = f"hold_{place}"
            graph = InsertElement(place, Se(held[place])).apply(graph)
    equations = derive(graph)
    unknowns = [next(u for u in equations.inputs if u.name == n) for n in held.values()]
    loaded, free = _left_over(equations), _left_over(_without(equations, chosen))
    rest = dict.fromkeys(equations.inputs, ZERO)
    rows = []
    for with_, without in zip(loaded, free, strict=True):
        pull = with_.subs(rest) - without.subs(rest)
        by_input = [sympy.diff(without, u) for u in unknowns]
        rows.append((by_input, -pull))
    matrix = sympy.Matrix([row for row, _ in rows])
    right = sympy.Matrix([pull for _, pull in rows])
    found = _solved(matrix, right, unknowns, graph.name)
    efforts = {place: found[unknowns[k]] for k, place in enumerate(held)}
    symbols = {s for e in efforts.values() for s in e.free_symbols}
    return GravityFeedforward(
        name=graph.name,
        efforts=efforts,
        states=tuple(s.symbol.name for s in equations.states if s.symbol in symbols),
        sources=chosen,
    )


def _gravity_sources(
    graph: FinishedGraph, sources: Sequence[str] | None
) -> tuple[str, ...]:
    inputs = {node.name for node in graph.inputs}
    known = [
        n.name
        for n in graph.elements
        if isinstance(n, EffortSource) and n.name not in inputs
    ]
    unknown = [name for name in sources or () if name not in known]
    if unknown or not known:
        word = repr(unknown[0]) if unknown else "no constant effort source"
        raise LoopShapingError(
            f"{graph.name!r} has {'no source ' if unknown else ''}{word}.",
            tuple(unknown),
            did_you_mean(unknown[0], known)
            if unknown
            else 'Draw the weight as a source: Se("weight", value=-m*g).',
        )
    return tuple(sources) if sources is not None else tuple(known)


def _without(equations: StateEquations, sources: Sequence[str]) -> StateEquations:
    """Return the equations with the sources' efforts zero."""
    return replace(
        equations,
        assignments=tuple(
            replace(a, expression=ZERO) if a.origin in sources else a
            for a in equations.assignments
        ),
    )


def _left_over(equations: StateEquations) -> list[sympy.Expr]:
    """Return the efforts left over at each momentum, at rest."""
    reduced = reduce(equations)
    if reduced.unknowns:
        raise LoopShapingError(
            f"{equations.name!r} has an algebraic loop that is not linear.",
            tuple(str(u) for u in reduced.unknowns),
            "Find the static effort with steady_state(graph) instead.",
        )
    still = {s.symbol: ZERO for s in equations.states if s.is_momentum}
    pairs = zip(equations.states, reduced.forces, strict=True)
    return [force.subs(still) for state, force in pairs if state.is_momentum]


def _solved(
    matrix: sympy.Matrix,
    right: sympy.Matrix,
    unknowns: list[sympy.Symbol],
    name: str,
) -> dict[sympy.Symbol, sympy.Expr]:
    answers = list(sympy.linsolve((matrix, right), *unknowns))
    if not answers:
        raise LoopShapingError(
            f"Nothing that {', '.join(map(str, unknowns))} give holds gravity in "
            f"{name!r}.",
            tuple(map(str, unknowns)),
            "Name more places, or hold what falls freely.",
        )
    (values,) = answers
    if any(not v.free_symbols.isdisjoint(unknowns) for v in values):
        raise LoopShapingError(
            f"{', '.join(map(str, unknowns))} share gravity in {name!r} in many ways.",
            tuple(map(str, unknowns)),
            "Name fewer places.",
        )
    return {
        unknown: sympy.factor_terms(sympy.trigsimp(sympy.cancel(value)))
        for unknown, value in zip(unknowns, values, strict=True)
    }
