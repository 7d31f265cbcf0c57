"""The operating point that ``--at`` gives: states, inputs, or what a state stands for.

Who thinks in speeds and pressures gives those: the speed of a body stands for its
momentum, the pressure of a vessel for what it holds.
"""

from collections.abc import Mapping, Sequence

from bondgraph.equations.insertion import Insertion
from bondgraph.equations.state_equations import StateEquations
from bondgraph.errors import EquationError, ParameterError
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import Junction, OneJunction
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import parameter_symbol


def operating_point(
    words: Sequence[str],
    graph: FinishedGraph,
    equations: StateEquations,
    numbers: Mapping[str, float],
) -> dict[str, float]:
    """Return the values of states and inputs that ``NAME=VALUE`` words give.

    Raises
    ------
    ParameterError
        If a word gives no number.
    EquationError
        If the flow or effort of a junction does not stand for one state.
    """
    own = {s.symbol.name for s in equations.states} | {u.name for u in equations.inputs}
    point = {}
    for word in words:
        name, _, text = (part.strip() for part in word.partition("="))
        value = _number(word, name, text)
        node = graph.by_name.get(name)
        if name not in own and isinstance(node, Junction):
            name, value = _of_state(node, equations, numbers, value)
        point[name] = value
    return point


def _number(word: str, name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ParameterError(
            f"--at {word} does not give a state or input a number.",
            (name,),
            "Write --at name=value.",
        ) from None


def _of_state(
    junction: Junction,
    equations: StateEquations,
    numbers: Mapping[str, float],
    value: float,
) -> tuple[str, float]:
    """Return the state that the common variable of a junction is in proportion to."""
    quantity = Quantity.FLOW if isinstance(junction, OneJunction) else Quantity.EFFORT
    told = Insertion(equations)(equations.signal(quantity, junction.name))
    states = told.free_symbols & {state.symbol for state in equations.states}
    others = told.free_symbols - states - set(equations.parameters)
    if len(states) == 1 and not others:
        (state,) = states
        known = {parameter_symbol(name): x for name, x in numbers.items()}
        share = (told / state).xreplace(known)
        if share.is_Number and share != 0:
            return str(state), value / float(share)
    raise EquationError(
        f"The {quantity} at {junction.name!r} is {told}, which does not stand for one "
        "state alone.",
        (junction.name,),
        f"Give states: {', '.join(str(s.symbol) for s in equations.states)}.",
    )
