"""Port-Hamiltonian form ``ẋ = (J - R) ∇H + (G - P) u``, ``y = (G + P)ᵀ ∇H + D u``.

J is skew and passes power on, R is symmetric and dissipates, H is the energy, and
``uᵀ y`` is the power supplied; P and D appear where an input acts on a resistance
directly. How the matrices are found: `bondgraph.equations.power.hamiltonian_form`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TypeAlias

import sympy

from bondgraph.causality.assignment import assign_causality
from bondgraph.causality.records import CausalAssignment
from bondgraph.equations.algebra.sparse_matrices import Sparse
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.deriving.inversion import Laws
from bondgraph.equations.power.energy import is_power_domain
from bondgraph.equations.power.hamiltonian_form import HamiltonianForm, NoForm
from bondgraph.equations.power.port_laws import port_law
from bondgraph.equations.power.stored_energy import energy_function
from bondgraph.equations.rendering import SHORT
from bondgraph.errors import EquationError
from bondgraph.structure.elements import Node, Resistance, Storage, letter
from bondgraph.structure.fields import ResistanceField, StorageField
from bondgraph.structure.graph import FinishedGraph, used_parameters
from bondgraph.structure.parameters import Parameter
from bondgraph.structure.relations import Relation
from bondgraph.structure.signals import parameter_symbol

Matrix: TypeAlias = sympy.ImmutableSparseMatrix


class FormStatus(StrEnum):
    """Whether the form exists; the value is the sentence."""

    EXISTS = "the port-Hamiltonian form exists"
    DOES_NOT_EXIST = "there is no port-Hamiltonian form of this kind"


@dataclass(frozen=True, slots=True, kw_only=True)
class PortHamiltonian:
    """The form at the module's head, or the reasons why there is none.

    Parameters
    ----------
    states, inputs
        Names of the rows of J, and of the columns of G.
    H, gradient
        The energy (J) and its derivatives by the states.
    J, R, G, P, D
        The matrices, in terms of states, inputs of moduli, and parameters.
    input_values
        What drives the inputs that are not free: modulated and constant sources.
    left_out
        States of the model that only measurements read; they store no energy.
    dissipation
        The coefficient of each resistance (the symmetric matrix of a field); R is
        positive semidefinite where they all are.
    not_shown
        The resistances for which that does not follow from the parameters' values.
    """

    name: str
    status: FormStatus
    reasons: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    inputs: tuple[str, ...] = ()
    H: sympy.Expr = sympy.S.Zero
    gradient: tuple[sympy.Expr, ...] = ()
    J: Matrix = field(default_factory=lambda: Matrix(0, 0, []))
    R: Matrix = field(default_factory=lambda: Matrix(0, 0, []))
    G: Matrix = field(default_factory=lambda: Matrix(0, 0, []))
    P: Matrix = field(default_factory=lambda: Matrix(0, 0, []))
    D: Matrix = field(default_factory=lambda: Matrix(0, 0, []))
    input_values: Mapping[str, sympy.Expr] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()
    dissipation: Mapping[str, sympy.Basic] = field(default_factory=dict)
    not_shown: tuple[str, ...] = ()

    @property
    def exists(self) -> bool:
        """Whether there is such a form."""
        return self.status is FormStatus.EXISTS

    @property
    def is_passive(self) -> bool:
        """Whether R is shown to be positive semidefinite."""
        return self.exists and not self.not_shown

    @property
    def rates(self) -> tuple[sympy.Expr, ...]:
        """The rates ``(J - R) ∇H + (G - P) u``."""
        u = sympy.Matrix([parameter_symbol(name) for name in self.inputs])
        gradient = sympy.Matrix(self.gradient)
        drift = (self.J - self.R) * gradient
        return tuple(drift + (self.G - self.P) * u) if self.inputs else tuple(drift)

    @property
    def outputs(self) -> tuple[sympy.Expr, ...]:
        """The flows (efforts) of the sources, ``(G + P)ᵀ ∇H + D u``."""
        if not self.inputs:
            return ()
        u = sympy.Matrix([parameter_symbol(name) for name in self.inputs])
        gradient = sympy.Matrix(self.gradient)
        return tuple((self.G + self.P).T * gradient + self.D * u)

    def as_text(self) -> str:
        """Return the form, or why there is none, as plain text."""
        lines = [f"port-Hamiltonian form: {self.status.value}"]
        lines += [f"  {reason}" for reason in self.reasons]
        if not self.exists:
            return "\n".join(lines) + "\n"
        lines += [
            f"  x = ({', '.join(self.states)})",
            f"  u = ({', '.join(self.inputs)})",
            f"  H = {self.H}",
        ]
        lines += [f"  {name} is {value}" for name, value in self.input_values.items()]
        for title, matrix in self._matrices():
            lines += [f"  {title}[{i + 1},{j + 1}] = {x}" for i, j, x in matrix]
        lines.append(f"  {self._dissipation_in_words()}")
        if self.left_out:
            lines.append(f"  left out, only measured: {', '.join(self.left_out)}")
        return "\n".join(lines) + "\n"

    def _matrices(self) -> list[tuple[str, list[tuple[int, int, sympy.Expr]]]]:
        named = (("J", self.J), ("R", self.R), ("G", self.G), ("P", self.P))
        return [
            (title, [(i, j, x) for (i, j), x in sorted(matrix.todok().items())])
            for title, matrix in (*named, ("D", self.D))
        ]

    def _dissipation_in_words(self) -> str:
        if not self.dissipation:
            return "nothing dissipates: R = 0"
        if not self.not_shown:
            return "R is positive semidefinite"
        conditions = ", ".join(str(self.dissipation[name]) for name in self.not_shown)
        return (
            f"R is positive semidefinite where none of these is negative: {conditions}"
        )

    def as_latex(self) -> str:
        r"""Return the form as a LaTeX ``aligned`` block, or the reasons as text."""
        if not self.exists:
            return rf"\text{{{' '.join([self.status.value, *self.reasons])}}}"
        if len(self.states) > SHORT:
            return (
                rf"\text{{{len(self.states)} states: too large to write as a matrix}}"
            )
        x = sympy.latex(sympy.Matrix([sympy.Symbol(name) for name in self.states]))
        u = sympy.latex(sympy.Matrix([sympy.Symbol(name) for name in self.inputs]))
        J, R, G, P = (
            sympy.latex(m.as_mutable()) for m in (self.J, self.R, self.G, self.P)
        )
        gain = f"{G}" if not self.P.todok() else rf"\left({G} - {P}\right)"
        driven = f" + {gain} u" if self.inputs else ""
        lines = [f"x &= {x}", f"H &= {sympy.latex(self.H)}"]
        lines += [f"u &= {u}"] if self.inputs else []
        lines.append(rf"\dot{{x}} &= \left({J} - {R}\right) \nabla H{driven}")
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.as_latex()}$"


def port_hamiltonian(graph: FinishedGraph) -> PortHamiltonian:
    """Return the port-Hamiltonian form of `graph`, or the reasons why it has none.

    Every source is an input port, also one whose value is an expression; see
    ``input_values``. The form exists where storages have an energy function and each
    resistance is proportional to its own flow or effort (with a coefficient that may
    move).

    Raises
    ------
    CausalConflictError, EquationError
        If the graph has no state equations.
    """
    causality = assign_causality(graph)
    states = [s.symbol.name for s in derive(graph, causality=causality).states]
    bare = _without_measurements(graph)
    reasons = _refusals(bare, causality)
    if not reasons:
        try:
            return _record(graph, HamiltonianForm(bare, causality), states)
        except NoForm as no:
            reasons = [str(no)]
    return PortHamiltonian(
        name=graph.name, status=FormStatus.DOES_NOT_EXIST, reasons=tuple(reasons)
    )


def _record(
    graph: FinishedGraph, form: HamiltonianForm, states: list[str]
) -> PortHamiltonian:
    n, m = len(form.states), len(form.inputs)

    def matrix(entries: Sparse, rows: int, columns: int) -> Matrix:
        return Matrix(rows, columns, entries)

    return PortHamiltonian(
        name=graph.name,
        status=FormStatus.EXISTS,
        states=form.states,
        inputs=form.inputs,
        H=form.H,
        gradient=form.gradient,
        J=matrix(form.J, n, n),
        R=matrix(form.R, n, n),
        G=matrix(form.G, n, m),
        P=matrix(form.P, n, m),
        D=matrix(form.D, m, m),
        input_values=form.input_values,
        left_out=tuple(name for name in states if name not in form.states),
        dissipation=form.dissipation,
        not_shown=tuple(
            name
            for name, coefficient in form.dissipation.items()
            if not _is_nonnegative(coefficient, graph)
        ),
    )


def _is_nonnegative(coefficient: sympy.Basic, graph: FinishedGraph) -> bool:
    """Return whether the parameters' values and bounds show that it is never < 0."""
    known = {
        parameter_symbol(name): sympy.Dummy(nonnegative=True)
        for name, parameter in graph.parameters.items()
        if _never_negative(parameter)
    }
    signed = coefficient.xreplace(known)
    if isinstance(signed, sympy.MatrixBase):
        return signed.is_positive_semidefinite is True
    return bool(signed.is_nonnegative)


def _never_negative(parameter: Parameter) -> bool:
    low, _ = parameter.bounds
    return low >= 0 or (parameter.value is not None and parameter.value >= 0)


def _without_measurements(graph: FinishedGraph) -> FinishedGraph:
    """Return the graph without measurements, so that no state is there for them."""
    used = used_parameters(graph.nodes, ())
    parameters = graph.parameters.restricted(used)
    return replace(graph, measurements=(), parameters=parameters)


def _refusals(graph: FinishedGraph, causality: CausalAssignment) -> list[str]:
    """Return why the elements themselves exclude the form."""
    found = []
    laws = Laws(graph)
    for domain in {d.name: d for d in graph.domains}.values():
        if not is_power_domain(domain):
            found.append(f"Effort times flow is no power in the {domain.name} domain.")
    if not causality.integral:
        found.append("No storage is independent: there is no energy as a state.")
    for node in graph.nodes:
        if isinstance(node, Resistance):
            found += _refused_resistance(node, [node.relation])
        elif isinstance(node, ResistanceField):
            found += _refused_resistance(node, node.relations)
        elif isinstance(node, Storage | StorageField):
            found += _refused_storage(node, graph, causality, laws)
    return found


def _refused_resistance(node: Node, relations: Sequence[Relation]) -> list[str]:
    """Return why a resistance is not proportional to its own flows or efforts."""
    arguments = [relation.argument for relation in relations]
    for relation in relations:
        law = relation.expression
        slopes = {s for x in arguments for s in law.diff(x).free_symbols}
        at_zero = law.subs(dict.fromkeys(arguments, 0))
        if slopes & set(arguments) or at_zero != 0:
            return [
                f"R {node.name!r} is not proportional to its own "
                f"{' and '.join(map(str, arguments))}: {relation.output} = {law}."
            ]
    return []


def _refused_storage(
    node: Storage | StorageField,
    graph: FinishedGraph,
    causality: CausalAssignment,
    laws: Laws,
) -> list[str]:
    """Return why the energy of a storage is no function of the states."""
    places = [node.name]
    if isinstance(node, StorageField):
        places = [node.port(i + 1) for i in range(node.size)]
    integral = [place in causality.integral for place in places]
    if any(integral) and not all(integral):
        return [
            f"Some ports of {letter(node)} {node.name!r} are states and some follow."
        ]
    if energy_function(node, laws).is_modulated:
        return [
            f"The energy in {letter(node)} {node.name!r} depends on more than a state."
        ]
    for place, is_state in zip(places, integral, strict=True):
        try:
            port_law(graph, laws, place, wants_stored=not is_state)
        except EquationError as error:
            return [error.problem]
    return []
