"""The nonlinear model as a python-control system with names and parameters.

python-control calls with time, states, inputs and parameters; each call is one run of
the tape, and a Newton solve where the model has algebraic unknowns. All numbers are in
SI units, which python-control does not record.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.hard_contact import refuse_hard_contact
from bondgraph.errors import EquationError
from bondgraph.numeric.jacobian import Array, Point, point, settled
from bondgraph.numeric.model import NumericModel, compile_model, evaluate
from bondgraph.structure.graph import FinishedGraph

if TYPE_CHECKING:
    import control


def to_nonlinear_io(graph: FinishedGraph) -> "control.NonlinearIOSystem":
    """Return `graph` as a python-control ``NonlinearIOSystem``.

    States, inputs and outputs keep their names (dots become underscores); ``params``
    holds the parameter values by name, so that
    ``control.input_output_response(system, time, u, params={"mass": 2})`` simulates
    another machine.

    Raises
    ------
    ParameterError
        If a parameter has no value.
    EquationError
        If the model needs the rate of an input, which python-control does not give, or
        has a hard contact.
    """
    import control  # noqa: PLC0415  (1 s; only its users wait for it)

    model = compile_model(derive(graph))
    if model.contacts is not None:
        refuse_hard_contact(
            graph.name, model.contacts.places, "which no solver outside follows"
        )
    if model.needs_input_rates:
        raise EquationError(
            f"{graph.name!r} needs the rate of an input, and python-control gives "
            f"inputs only.",
            (graph.name,),
            "Put an R or a storage between the source and the storage that it sets.",
        )

    def update(t: float, x: Array, u: Array, params: Mapping[str, float]) -> Array:
        return _at(model, t, x, u, params).rates

    def output(t: float, x: Array, u: Array, params: Mapping[str, float]) -> Array:
        here = _at(model, t, x, u, params)
        nothing = np.zeros((len(here.variables), 0))
        return evaluate(model.output, here.variables, nothing)[0]

    return control.NonlinearIOSystem(
        update if model.n_states else None,
        output,
        states=[_plain(name) for name in model.state_names] or None,
        inputs=[_plain(name) for name in model.input_names],
        outputs=[_plain(name) for name in model.output_names],
        params=graph.parameters.values_by_name(),
        name=_plain(graph.name),
    )


def _at(
    model: NumericModel, t: float, x: Array, u: Array, params: Mapping[str, float]
) -> Point:
    p = np.array([params[name] for name in model.parameter_names], dtype=float)
    return settled(model, point(model, np.atleast_1d(x), np.atleast_1d(u), p, t=t))


def _plain(name: str) -> str:
    """Return `name` without the dots that python-control does not allow."""
    return name.replace(".", "_")
