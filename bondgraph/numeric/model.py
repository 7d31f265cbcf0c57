"""`NumericModel`: what lies below the gate; arrays only, names as strings.

Made by `compile_model` from `StateEquations` in milliseconds. It answers with arrays:
residuals, outputs and their exact Jacobians, and it holds what the kernel needs.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondgraph.equations.hard_contact import held_contacts, opened
from bondgraph.equations.state_equations import StateEquations
from bondgraph.numeric.set_valued import SetValuedForm, set_valued_form
from bondgraph.numeric.tape import Tape, degrees, part, record_tape
from bondgraph.structure.signals import t as time_symbol

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactForm:
    """A model whose hard contacts are held open or shut by parameters.

    Parameters
    ----------
    places
        For each contact the elements whose law it is, in words.
    held
        An ordinary model; its last parameters and outputs are those of
        `bondgraph.equations.hard_contact.HeldContacts`.
    """

    places: tuple[str, ...]
    held: "NumericModel"


@dataclass(frozen=True, slots=True, kw_only=True)
class NumericModel:
    """A semi-explicit model ``ẋ = rate(…)``, ``0 = residual(…)``, ``y = read(…)``.

    Every function of it takes the variables x, ẋ, z, u, u̇, p, t in this order.

    Parameters
    ----------
    dynamics
        Tape whose results are the rates and the residuals.
    output
        Tape whose results are the outputs.
    linear
        Whether rates and residuals are affine in (x, ẋ, z).
    instantaneous
        Whether an output depends on ẋ or z.
    set_valued
        The same model with its dry friction set-valued, for solvers that can stick;
        None where nothing is dry. The functions above read ``sign(0) = 0``.
    contacts
        The same model with its hard contacts, for runs that follow impacts; None
        without any. The functions above, and `set_valued`, have every gap open.
    """

    name: str
    state_names: tuple[str, ...]
    input_names: tuple[str, ...]
    parameter_names: tuple[str, ...]
    output_names: tuple[str, ...]
    output_units: tuple[str, ...]
    n_unknowns: int
    dynamics: Tape
    output: Tape
    linear: bool
    instantaneous: bool
    needs_input_rates: bool
    set_valued: SetValuedForm | None = None
    unknown_names: tuple[str, ...] = ()
    contacts: ContactForm | None = None

    @property
    def needs_time(self) -> bool:
        """Whether anything depends on t itself."""
        active = [False] * (self.dynamics.n_variables - 1) + [True]
        return any(degrees(tape, active).any() for tape in (self.dynamics, self.output))

    @property
    def n_states(self) -> int:
        """Number of states."""
        return len(self.state_names)


def compile_model(equations: StateEquations) -> NumericModel:
    """Turn symbolic state equations into array functions.

    Raises
    ------
    EquationError
        If an expression uses a function without a number form, or a hard contact
        presses on no mass.
    """
    contacts = None
    held = held_contacts(equations)
    if held is not None:
        contacts = ContactForm(places=held.places, held=compile_model(held.equations))
        equations = opened(equations)
    states = [s.symbol for s in equations.states]
    rates = [s.rate for s in equations.states]
    unknowns = list(equations.unknowns)
    variables = [
        *states,
        *rates,
        *unknowns,
        *equations.inputs,
        *equations.input_rates,
        *equations.parameters,
        time_symbol,
    ]
    n_dynamics, n_outputs = len(states) + len(unknowns), len(equations.outputs)
    solved, instant = {*states, *rates, *unknowns}, {*rates, *unknowns}
    input_rates = set(equations.input_rates)
    # One recording: the two parts share most of it, and writing it is what costs.
    whole = record_tape(
        variables,
        [(a.symbol, a.expression) for a in equations.assignments],
        [
            *equations.rates,
            *equations.residuals,
            *(output.expression for output in equations.outputs),
        ],
        input_rates.__contains__,
    )
    dynamics = part(whole, 0, n_dynamics, [v in solved for v in variables])
    output = part(
        whole, n_dynamics, n_dynamics + n_outputs, [v in instant for v in variables]
    )
    return NumericModel(
        name=equations.name,
        state_names=tuple(s.symbol.name for s in equations.states),
        input_names=tuple(u.name for u in equations.inputs),
        parameter_names=tuple(p.name for p in equations.parameters),
        output_names=tuple(o.name for o in equations.outputs),
        output_units=tuple(o.unit for o in equations.outputs),
        n_unknowns=len(unknowns),
        dynamics=dynamics,
        output=output,
        linear=bool(np.all(dynamics.degree < 2)),
        instantaneous=bool(np.any(output.degree > 0)),
        needs_input_rates=bool(np.any(whole.degree > 0)),
        set_valued=set_valued_form(equations),
        unknown_names=tuple(z.name for z in unknowns),
        contacts=contacts,
    )


def evaluate(tape: Tape, variables: Array, directions: Array) -> tuple[Array, Array]:
    """Run one tape at one point.

    Parameters
    ----------
    variables
        Values of x, ẋ, z, u, u̇, p, t, concatenated.
    directions
        Tangent directions, shape (len(variables), n).

    Returns
    -------
    values, tangents
        Of the tape's results, shapes (m,) and (m, n).
    """
    from bondgraph.numeric.kernel.machine import run  # noqa: PLC0415  (loads numba)

    n = directions.shape[1]
    first = tape.n_variables + len(tape.constants)
    v = np.zeros(tape.n_slots)
    d = np.zeros((tape.n_slots, max(n, 1)))
    v[: tape.n_variables] = variables
    v[tape.n_variables : first] = tape.constants
    d[: tape.n_variables, :n] = directions
    run(tape.code, first, v, d, n)
    return v[tape.outputs], d[tape.outputs, :n]
