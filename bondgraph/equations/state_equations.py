"""State equations as a record: a sorted list of assignments, never one expression.

The model is semi-explicit. With states x, inputs u, algebraic unknowns z and the
rates ẋ appearing linearly in none of them by construction, the record means::

    s_1 = expr_1(x, ẋ, z, u, u̇, p, t)         (assignments, in evaluation order)
    …
    ẋ_i = s_(rate i)                           (one signal per state)
    0   = residual_k(s, x, ẋ, z, u, p, t)      (one per algebraic unknown)
    y_j = output_j(s, x, ẋ, z, u, p, t)

Algebraic unknowns are the efforts (flows) of dependent I (C), whose residual contains
ẋ, and the cut variables of algebraic loops. Assignments that contain ẋ come after all
others, and only residuals and outputs read them; so one evaluates the first part, then
the rates, then the rest.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy

from bondgraph.errors import EquationError, did_you_mean
from bondgraph.structure.domains import Quantity


@dataclass(frozen=True, slots=True)
class State:
    """One state: a momentum or displacement.

    ``symbol`` is x_i, ``rate`` the symbol of ẋ_i, ``place`` the storage or, for an
    integrated measurement, the junction or bond whose flow or effort it integrates.
    """

    symbol: sympy.Symbol
    rate: sympy.Symbol
    place: str
    unit: str
    quantity: Quantity = Quantity.DISPLACEMENT

    @property
    def is_momentum(self) -> bool:
        """Whether it is the integral of an effort."""
        return self.quantity is Quantity.MOMENTUM


@dataclass(frozen=True, slots=True)
class Assignment:
    """``symbol = expression`` of symbols assigned before it.

    ``reason`` says in words where it comes from, ``origin`` names the element or
    junction (nothing for the rate of another symbol).
    """

    symbol: sympy.Symbol
    expression: sympy.Expr
    reason: str = ""
    origin: str = ""


@dataclass(frozen=True, slots=True)
class Output:
    """One measurement: its name, expression and unit."""

    name: str
    expression: sympy.Expr
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class StateEquations:
    """The equations of one graph in one causality; see the module's head.

    Parameters
    ----------
    inputs, input_rates
        Input symbols u, and the symbols of u̇ (only those that occur matter).
    rates
        For each state the expression of ẋ_i in terms of assigned symbols.
    unknowns, residuals
        Algebraic unknowns z and, for each, an expression that must vanish.
    parameters
        Parameter symbols, in the order of the graph's parameter set.
    reasons, causes
        For each unknown, in words, why it is one, and the names of the elements that it
        is due to: those in its algebraic loop, or the dependent storage.
    further
        Assignments, evaluated after the others, that neither a rate nor a residual nor
        an output needs; they complete `signals`.
    signals
        The effort and flow of every bond, element and junction, and the momentum and
        displacement of storages, by (quantity, place); see `signal`.
    dry_friction
        For each assigned symbol or unknown that the law of a dry R gives, those
        ``sign(…)`` in its expression (residual) that are set-valued at zero.
    """

    name: str
    states: tuple[State, ...]
    inputs: tuple[sympy.Symbol, ...]
    input_rates: tuple[sympy.Symbol, ...]
    parameters: tuple[sympy.Symbol, ...]
    unknowns: tuple[sympy.Symbol, ...]
    assignments: tuple[Assignment, ...]
    rates: tuple[sympy.Expr, ...]
    residuals: tuple[sympy.Expr, ...]
    outputs: tuple[Output, ...]
    input_units: tuple[str, ...] = ()
    reasons: tuple[str, ...] = ()
    causes: tuple[tuple[str, ...], ...] = ()
    further: tuple[Assignment, ...] = ()
    signals: Mapping[tuple[Quantity, str], sympy.Expr] = field(default_factory=dict)
    dry_friction: Mapping[sympy.Symbol, tuple[sympy.Expr, ...]] = field(
        default_factory=dict
    )

    def __repr__(self) -> str:
        counts = (
            f"{len(self.states)} states, {len(self.inputs)} inputs, "
            f"{len(self.unknowns)} unknowns, {len(self.outputs)} outputs"
        )
        return f"<StateEquations {self.name!r}: {counts}>"

    def __str__(self) -> str:
        from bondgraph.equations.rendering import as_text  # noqa: PLC0415  (a cycle)

        return as_text(self)

    def around_rates(self) -> tuple[tuple[Assignment, ...], tuple[Assignment, ...]]:
        """Return the assignments evaluated before the rates, and those after."""
        rates = {state.rate for state in self.states}
        for i, assignment in enumerate(self.assignments):
            if not rates.isdisjoint(assignment.expression.free_symbols):
                return self.assignments[:i], self.assignments[i:]
        return self.assignments, ()

    def signal(self, quantity: Quantity | str, place: str) -> sympy.Expr:
        """Return a port variable in terms of states, inputs and assigned symbols.

        Parameters
        ----------
        quantity
            ``effort``, ``flow``, ``momentum`` or ``displacement``.
        place
            A bond, a one-port (power positive into an I, C or R and out of a source)
            or a junction (its common variable).

        Raises
        ------
        EquationError
            If there is no such variable there.
        """
        try:
            return self.signals[Quantity(quantity), place]
        except KeyError:
            known = {p for q, p in self.signals if q == quantity}
            raise EquationError(
                f"{self.name!r} has no {quantity} at {place!r}.",
                (place,),
                did_you_mean(place, known),
            ) from None
