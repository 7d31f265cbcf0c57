"""A model that keeps its accounts: what sources gave, what was dissipated and stored.

The energies are further states, integrated with the solver's own weights, and what each
storage holds is a further output. So the balance between them shows what the solver's
steps have made of it; nothing makes it close by construction.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy

from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.power.energy import BalanceStatus, EnergyBalance, Power, energy
from bondgraph.equations.state_equations import Output, State
from bondgraph.numeric.model import NumericModel, compile_model
from bondgraph.structure.domains import Quantity
from bondgraph.structure.elements import Compliance, Resistance
from bondgraph.structure.graph import FinishedGraph

POINTS = 32
"""Gauss points for a stored energy without a closed form."""

ACCOUNTS = ("supplied", "dissipated", "exchanged", "flowed")
_KINKED = (sympy.Max, sympy.Min, sympy.Piecewise, sympy.Heaviside, sympy.Abs)


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditedModel:
    """A numeric model with accounts.

    Parameters
    ----------
    model
        Its last states are the energies of `ACCOUNTS`, its last outputs the energies in
        `storages`, followed by the efforts of `contacts`.
    storages
        Names of the storages whose energy counts (those in pseudo domains do not).
    contacts
        Elements whose law is zero over a range, so that they may let go.
    closed
        Whether everything that exchanges power is counted.
    """

    model: NumericModel
    storages: tuple[str, ...]
    contacts: tuple[str, ...]
    closed: bool


def audited_model(graph: FinishedGraph) -> AuditedModel:
    """Return the numeric form of a graph with its energy accounts.

    Raises
    ------
    CausalConflictError, EquationError
        If the graph has no state equations.
    """
    equations = derive(graph)
    balance = energy(graph, equations)
    closed = balance.status is not BalanceStatus.OPEN
    rates = _rates(balance) if closed else (sympy.S.Zero,) * len(ACCOUNTS)
    stored = tuple(s for s in balance.stored if s.is_power)
    contacts = _contacts(graph)
    states = tuple(
        State(
            symbol=sympy.Dummy(f"energy_{name}", real=True),
            rate=sympy.Dummy(f"power_{name}", real=True),
            place=name,
            unit="J",
        )
        for name in ACCOUNTS
    )
    further = (
        *(Output(s.element, _numeric(s.energy), "J") for s in stored),
        *(
            Output(name, equations.signal(Quantity.EFFORT, name), "")
            for name in contacts
        ),
    )
    audited = replace(
        equations,
        states=(*equations.states, *states),
        rates=(*equations.rates, *rates),
        assignments=(*equations.assignments, *equations.further),
        outputs=(*equations.outputs, *further),
    )
    return AuditedModel(
        model=compile_model(audited),
        storages=tuple(s.element for s in stored),
        contacts=contacts,
        closed=closed,
    )


def _rates(balance: EnergyBalance) -> tuple[sympy.Expr, ...]:
    """Return the rates of the accounts, in their order."""

    def added(powers: Sequence[Power], *, sizes: bool = False) -> sympy.Expr:
        counted = (x.power for x in powers if x.is_power)
        return sympy.Add(*(sympy.Abs(x) if sizes else x for x in counted))

    kinds = (balance.supplied, balance.dissipated, balance.exchanged)
    flowed = sympy.Add(*(added(kind, sizes=True) for kind in kinds))
    return (*map(added, kinds), flowed)


def _numeric(expression: sympy.Expr) -> sympy.Expr:
    """Return a stored energy with integrals as Gauss sums and real logarithms."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    put = {}
    for integral in expression.atoms(sympy.Integral):
        ((variable, low, high),) = integral.limits
        half = (high - low) / 2
        put[integral] = half * sympy.Add(
            *(
                float(w) * integral.function.xreplace({variable: low + half * (1 + x)})
                for x, w in zip(map(float, nodes), weights, strict=True)
            )
        )
    # A closed form may hold log(-a) - log(x - a), whose imaginary parts cancel.
    return expression.xreplace(put).replace(sympy.log, lambda x: sympy.log(abs(x)))


def _contacts(graph: FinishedGraph) -> tuple[str, ...]:
    """Return the one-ports C and R with a law that is written in pieces."""
    return tuple(
        node.name
        for node in graph.nodes
        if isinstance(node, Compliance | Resistance)
        and node.law is not None
        and node.law.has(*_KINKED)
    )
