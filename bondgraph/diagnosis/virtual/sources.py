"""Where a virtual source can sit, and the model that carries one at every place.

At a 1-junction a missing effort, at a 0-junction a missing flow, both positive into the
junction; at an input what is added to the recorded signal, at an output what the sensor
adds to the truth. A source at a junction never changes causality (its common variable
is set by exactly one other bond), so one derivation serves all.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import sympy

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.deriving.sorting import replaced
from bondgraph.equations.state_equations import Output, StateEquations
from bondgraph.errors import FitError, did_you_mean
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.structure.edits import InsertElement
from bondgraph.structure.elements import EffortSource, FlowSource, OneJunction
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.signals import parameter_symbol

PREFIX = "virtual_"


class PlaceKind(StrEnum):
    """What a virtual source stands for; the value is the phrase to show."""

    EFFORT = "a missing effort"
    FLOW = "a missing flow"
    INPUT = "an addition to the input"
    OUTPUT = "an error of the sensor"


@dataclass(frozen=True, slots=True, kw_only=True)
class VirtualSource:
    """One place with the source that stands for what is missing there.

    Parameters
    ----------
    place
        Name of the junction, input or output.
    unit
        Of the source's signal.
    """

    place: str
    kind: PlaceKind
    unit: str

    @property
    def parameter(self) -> str:
        """The name of the parameter that is the source's value."""
        return f"{PREFIX}{self.place}"

    @property
    def at_junction(self) -> bool:
        """Whether it is a missing effort or flow."""
        return self.kind in (PlaceKind.EFFORT, PlaceKind.FLOW)


def virtual_sources(graph: FinishedGraph) -> tuple[VirtualSource, ...]:
    """Return one virtual source per junction, input and output, in this order."""
    sources = []
    for junction in graph.junctions:
        one = isinstance(junction, OneJunction)
        kind = PlaceKind.EFFORT if one else PlaceKind.FLOW
        domain = graph.domain_at(junction.name)
        unit = domain.effort_unit if one else domain.flow_unit
        sources.append(VirtualSource(place=junction.name, kind=kind, unit=unit))
    for source in graph.inputs:
        unit = graph.input_unit(source.name)
        sources.append(
            VirtualSource(place=source.name, kind=PlaceKind.INPUT, unit=unit)
        )
    for measurement in graph.measurements:
        sources.append(
            VirtualSource(
                place=measurement.name, kind=PlaceKind.OUTPUT, unit=measurement.unit
            )
        )
    return tuple(sources)


def chosen_sources(
    graph: FinishedGraph, places: Sequence[str] | None
) -> tuple[VirtualSource, ...]:
    """Return the virtual sources at `places`, all when None.

    Raises
    ------
    FitError
        If a place is no junction, input or output of the graph.
    """
    known = virtual_sources(graph)
    if places is None:
        return known
    names = [source.place for source in known]
    for place in places:
        if place not in names:
            raise FitError(
                f"{place!r} is no junction, input or output of {graph.name!r}.",
                (place,),
                did_you_mean(place, names),
            )
    return tuple(source for source in known if source.place in places)


def equations_with_sources(
    graph: FinishedGraph, sources: Sequence[VirtualSource]
) -> StateEquations:
    """Return the equations of `graph` with a parameter, zero, at every source."""
    edited = graph
    for source in sources:
        if source.at_junction:
            one = source.kind is PlaceKind.EFFORT
            kind = EffortSource if one else FlowSource
            # The element's name must not be that of the parameter: both are symbols.
            element = kind(
                f"{source.parameter}_source", value=parameter_symbol(source.parameter)
            )
            zero = Parameter(
                name=source.parameter, value=0.0, unit=source.unit, std=0.0
            )
            edited = InsertElement(source.place, element, (zero,)).apply(edited)
    return _at_channels(derive(edited), sources)


def _at_channels(
    equations: StateEquations, sources: Sequence[VirtualSource]
) -> StateEquations:
    """Return the equations with parameters added to inputs and outputs."""
    inputs: dict[sympy.Symbol, sympy.Expr] = {}
    outputs: dict[str, sympy.Symbol] = {}
    by_name = {symbol.name: symbol for symbol in equations.inputs}
    for source in sources:
        value = parameter_symbol(source.parameter)
        if source.kind is PlaceKind.INPUT:
            inputs[by_name[source.place]] = by_name[source.place] + value
        elif source.kind is PlaceKind.OUTPUT:
            outputs[source.place] = value
    added = (*(x - u for u, x in inputs.items()), *outputs.values())
    return replace(
        equations,
        assignments=tuple(
            replace(a, expression=replaced(a.expression, inputs))
            for a in equations.assignments
        ),
        rates=tuple(replaced(rate, inputs) for rate in equations.rates),
        residuals=tuple(replaced(r, inputs) for r in equations.residuals),
        outputs=tuple(
            replace(
                o,
                expression=replaced(o.expression, inputs)
                + outputs.get(o.name, sympy.Integer(0)),
            )
            for o in equations.outputs
        ),
        parameters=(*equations.parameters, *added),
    )


@dataclass(frozen=True, slots=True)
class VirtualModel:
    """A numeric model that reads its states too, with a parameter per source.

    The outputs are the ``n_outputs`` measurements, then the states.
    """

    model: NumericModel
    sources: tuple[VirtualSource, ...]
    n_outputs: int


def virtual_model(
    graph: FinishedGraph, sources: Sequence[VirtualSource]
) -> VirtualModel:
    """Return the numeric model of `graph` with virtual sources."""
    equations = equations_with_sources(graph, sources)
    states = tuple(Output(s.symbol.name, s.symbol, s.unit) for s in equations.states)
    read = replace(equations, outputs=(*equations.outputs, *states))
    return VirtualModel(
        model=compile_model(read),
        sources=tuple(sources),
        n_outputs=len(equations.outputs),
    )
