"""Hard contact in the equations: each gap is held open or shut by a switch.

The force λ of each `hard_contact` becomes an unknown with one more residual::

    σ g̈ + (1 - σ) (λ - m),     g: the penetration

so with σ = 1 the gap stays shut (its acceleration vanishes, as its rate does when it
shuts), and with σ = 0 it is open and λ = m: zero, or what is tried to see what a push
does. Between events these are ordinary state equations (Brogliato, *Nonsmooth
Mechanics*, 2016, chapter 5).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NoReturn

import sympy

from bondgraph.equations.deriving.sorting import replaced
from bondgraph.equations.insertion import rate_of
from bondgraph.equations.state_equations import Assignment, Output, StateEquations
from bondgraph.errors import EquationError
from bondgraph.structure.hard_contact import hard_contact


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldContacts:
    """Equations with their contacts held by switches.

    Parameters
    ----------
    places
        For each contact the elements whose law it is, in words.
    equations
        Their last parameters are the σ of all contacts, then the m; their last outputs
        are the penetrations, their rates, their accelerations, the λ, the
        restitutions, the states and their rates.
    """

    places: tuple[str, ...]
    equations: StateEquations


def refuse_hard_contact(name: str, places: tuple[str, ...], why: str) -> NoReturn:
    """Refuse a model for its hard contacts, where they cannot be followed.

    Parameters
    ----------
    why
        Words that follow "the hard contact of …".
    """
    raise EquationError(
        f"{name!r} has the hard contact of {', '.join(places)}, {why}.",
        places,
        "Simulate it with Sdirk2() or Sdirk3(), or write a stiff stop: "
        "k*Max(penetration, 0).",
    )


def opened(equations: StateEquations) -> StateEquations:
    """Return the equations as they are while every gap is open."""
    return _with_forces(
        equations, dict.fromkeys(_contacts(equations), sympy.S.Zero), equations.unknowns
    )


def held_contacts(equations: StateEquations) -> HeldContacts | None:
    """Return the equations with switches for their contacts, or None without any.

    Raises
    ------
    EquationError
        If the second derivative of a penetration has no formula: no mass behind it.
    """
    found = _contacts(equations)
    if not found:
        return None
    forces = {c: sympy.Dummy("contact", real=True) for c in found}
    holds = [sympy.Dummy("hold", real=True) for _ in found]
    pushes = [sympy.Dummy("push", real=True) for _ in found]
    unknowns = (*equations.unknowns, *forces.values())
    freed = _with_forces(equations, forces, unknowns)
    expressions = [c.args[0].xreplace(forces) for c in found]
    places = tuple(found.values())
    rates = _rates(expressions, freed, places)
    bends = _rates(rates, freed, places)
    switched = tuple(
        hold * bend + (1 - hold) * (force - push)
        for hold, push, bend, force in zip(
            holds, pushes, bends, forces.values(), strict=True
        )
    )
    watched = [
        *expressions,
        *rates,
        *bends,
        *forces.values(),
        *(c.args[1].xreplace(forces) for c in found),
        *(s.symbol for s in equations.states),
        *(s.rate for s in equations.states),
    ]
    held = replace(
        freed,
        parameters=(*freed.parameters, *holds, *pushes),
        residuals=(*freed.residuals, *switched),
        outputs=(*freed.outputs, *(Output("", x, "") for x in watched)),
        reasons=(*freed.reasons, *(f"hard contact at {x}" for x in places)),
        causes=(*freed.causes, *((place,) for place in places)),
    )
    return HeldContacts(places=places, equations=held)


def _contacts(equations: StateEquations) -> dict[sympy.Expr, str]:
    """Return each contact with the elements whose law it is."""
    places: dict[sympy.Expr, list[str]] = {}
    listed = [
        *((a.expression, [a.origin]) for a in equations.assignments),
        *((a.expression, [a.origin]) for a in equations.further),
        *zip(equations.residuals, map(list, equations.causes), strict=True),
    ]
    for expression, origins in listed:
        for contact in sorted(expression.atoms(hard_contact), key=str):
            places.setdefault(contact, []).extend(origins)
    return {c: " and ".join(dict.fromkeys(named)) for c, named in places.items()}


def _with_forces(
    equations: StateEquations,
    forces: Mapping[sympy.Expr, sympy.Expr],
    unknowns: tuple[sympy.Symbol, ...],
) -> StateEquations:
    """Return the equations with `forces` for their contacts."""

    def put(listed: tuple[Assignment, ...]) -> tuple[Assignment, ...]:
        return tuple(
            replace(a, expression=a.expression.xreplace(forces)) for a in listed
        )

    return replace(
        equations,
        unknowns=unknowns,
        assignments=put(equations.assignments),
        further=put(equations.further),
        rates=tuple(x.xreplace(forces) for x in equations.rates),
        residuals=tuple(x.xreplace(forces) for x in equations.residuals),
        outputs=tuple(
            replace(o, expression=o.expression.xreplace(forces))
            for o in equations.outputs
        ),
    )


def _rates(
    expressions: Sequence[sympy.Expr],
    equations: StateEquations,
    places: tuple[str, ...],
) -> list[sympy.Expr]:
    """Return d(expression)/dt of each, with flows put in for the rates of states."""
    flows = dict(zip((s.rate for s in equations.states), equations.rates, strict=True))
    found = []
    for expression, place in zip(expressions, places, strict=True):
        try:
            found.append(rate_of(replaced(expression, flows), equations))
        except EquationError as error:
            raise EquationError(
                f"The hard contact of {place} presses on no mass: its own force, or an "
                f"algebraic unknown, decides at once how fast the gap closes.",
                (place,),
                "Put an I where it presses, or a stiff stop k*Max(penetration, 0).",
            ) from error
    return found
