"""Multiport fields: storages and resistances whose ports belong to one law.

The ports of a field are its bonds, numbered from 1 in the author's order. Law i is
written in port variables ``ports("q", n)`` and gives the other variable of port i: in
p, flows; in q, efforts; in e, displacements (C) or flows (R); in f, momenta (I) or
efforts (R). An energy function gives the laws of a storage by differentiation, which
makes them reciprocal; laws that are not reciprocal would create energy, and are
refused.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import ClassVar, Self

import sympy

from bondgraph.errors import StructureError
from bondgraph.structure.elements import Named
from bondgraph.structure.relations import Relation
from bondgraph.structure.signals import PortVariable, as_expression, canonical

_STORED_OF = {"f": "p", "p": "p", "e": "q", "q": "q"}
_CO = {"p": "f", "q": "e"}


@dataclass(frozen=True, slots=True)
class _Field(Named):
    laws: tuple[sympy.Expr, ...]

    def __post_init__(self) -> None:
        Named.__post_init__(self)
        laws = tuple(canonical(law) for law in self.laws)
        object.__setattr__(self, "laws", laws)
        if not laws:
            raise StructureError(
                f"The field {self.name!r} has no port.",
                (self.name,),
                "Give one law per port.",
            )
        for variable in self._variables():
            if not 1 <= variable.number <= self.size:
                raise StructureError(
                    f"The laws of {self.name!r} use {variable}, and it has "
                    f"{self.size} ports.",
                    (self.name,),
                    "Number the ports from 1, and give one law per port.",
                )
        assert self.relations

    def _variables(self) -> list[PortVariable]:
        symbols = set().union(*(law.free_symbols for law in self.laws))
        found = (s for s in symbols if isinstance(s, PortVariable))
        return sorted(found, key=lambda s: (s.letter, s.number))

    def _letters(self) -> str:
        return "".join(sorted({v.letter for v in self._variables()}))

    @property
    def size(self) -> int:
        """The number of ports."""
        return len(self.laws)

    @property
    def relations(self) -> tuple[Relation, ...]:
        """One relation per port: what its law gives, and its own argument."""
        raise NotImplementedError

    def _refuse_letters(self, letters: str, right: str) -> StructureError:
        used = ", ".join(letters) or "no port variable"
        return StructureError(
            f"The laws of {self.name!r} use {used}.",
            (self.name,),
            f"Write all of them in {right}, such as ports({right[0]!r}, n).",
        )

    def port(self, number: int) -> str:
        """Return what port `number` (from 1) is called: ``name[number]``."""
        return f"{self.name}[{number}]"


@dataclass(frozen=True, slots=True)
class _StorageField(_Field):
    """What I, C and IC fields share: every port stores a p or a q."""

    @property
    def stored(self) -> tuple[PortVariable, ...]:
        """The stored variable, p[i] or q[i], of each port."""
        raise NotImplementedError

    @property
    def relations(self) -> tuple[Relation, ...]:
        """One relation per port, between its stored and its co-energy variable."""
        stored = self.stored
        co = tuple(PortVariable(_CO[s.letter], s.number) for s in stored)
        used = set(self._letters())
        if used and used <= {s.letter for s in stored}:
            pairs = tuple(zip(co, stored, strict=True))
        elif used and used <= {c.letter for c in co}:
            pairs = tuple(zip(stored, co, strict=True))
        else:
            right = " or ".join({s.letter: None for s in (*stored, *co)})
            raise self._refuse_letters(self._letters(), right)
        self._check_reciprocal([argument for _, argument in pairs])
        return tuple(
            Relation(output, argument, law)
            for (output, argument), law in zip(pairs, self.laws, strict=True)
        )

    def _check_reciprocal(self, arguments: list[PortVariable]) -> None:
        for i, j in combinations(range(self.size), 2):
            difference = self.laws[i].diff(arguments[j]) - self.laws[j].diff(
                arguments[i]
            )
            if difference != 0 and sympy.simplify(difference) != 0:
                raise StructureError(
                    f"The laws of ports {i + 1} and {j + 1} of {self.name!r} are not "
                    f"reciprocal: they follow from no energy.",
                    (self.name,),
                    "Derive them from one: from_energy(name, energy).",
                )

    @classmethod
    def from_energy(cls, name: str, energy: sympy.Expr) -> Self:
        """Return the field that stores `energy`, a function of p[i] and q[i].

        The flow (effort) of port i is the derivative by p[i] (q[i]).
        """
        energy = canonical(energy)
        variables = sorted(
            (s for s in energy.free_symbols if isinstance(s, PortVariable)),
            key=lambda s: s.number,
        )
        numbers = [v.number for v in variables]
        if numbers != list(range(1, len(numbers) + 1)):
            raise StructureError(
                f"The energy of {name!r} depends on the ports {numbers}.",
                (name,),
                "Use one stored variable per port, numbered from 1.",
            )
        return cls(name, tuple(energy.diff(v) for v in variables))


def _linear(
    letter: str, matrix: Sequence[Sequence[object]], name: str
) -> tuple[sympy.Expr, ...]:
    """Return ``matrix · [letter[1], letter[2], …]``."""
    rows = _rows(matrix, name)
    widths = sorted({len(row) for row in rows})
    if widths != [len(rows)]:
        raise StructureError(
            f"The matrix of {name!r} is {len(rows)} x {' or '.join(map(str, widths))}.",
            (name,),
            "Give a square one.",
        )
    variables = [PortVariable(letter, i + 1) for i in range(len(rows))]
    return tuple(
        sympy.Add(*(x * v for x, v in zip(row, variables, strict=True))) for row in rows
    )


def _rows(matrix: Sequence[Sequence[object]], name: str) -> list[list[sympy.Expr]]:
    try:
        rows = [list(row) for row in getattr(matrix, "tolist", lambda: matrix)()]
    except TypeError:
        raise StructureError(
            f"{matrix!r} is no matrix for {name!r}.",
            (name,),
            "Give a list of rows, such as [[a, b], [b, c]].",
        ) from None
    return [[as_expression(entry) for entry in row] for row in rows]


@dataclass(frozen=True, slots=True)
class InertanceField(_StorageField):
    """I field: every port stores a momentum; a mass matrix, coupled coils."""

    letter: ClassVar[str] = "I"
    _kind: ClassVar[str] = "an I field"

    @property
    def stored(self) -> tuple[PortVariable, ...]:
        """The momenta p[i]."""
        return tuple(PortVariable("p", i + 1) for i in range(self.size))

    @classmethod
    def from_matrix(cls, name: str, matrix: Sequence[Sequence[object]]) -> Self:
        """Return the field with ``p = matrix · f``."""
        return cls(name, _linear("f", matrix, name))


@dataclass(frozen=True, slots=True)
class ComplianceField(_StorageField):
    """C field: every port stores a displacement; an elastic body, a movable plate."""

    letter: ClassVar[str] = "C"
    _kind: ClassVar[str] = "a C field"

    @property
    def stored(self) -> tuple[PortVariable, ...]:
        """The displacements q[i]."""
        return tuple(PortVariable("q", i + 1) for i in range(self.size))

    @classmethod
    def from_matrix(cls, name: str, matrix: Sequence[Sequence[object]]) -> Self:
        """Return the field with ``q = matrix · e``."""
        return cls(name, _linear("e", matrix, name))

    @classmethod
    def from_stiffness(cls, name: str, matrix: Sequence[Sequence[object]]) -> Self:
        """Return the field with ``e = matrix · q``."""
        return cls(name, _linear("q", matrix, name))


@dataclass(frozen=True, slots=True)
class MixedField(_StorageField):
    """IC field: some ports store momentum, others displacement; a solenoid.

    Its laws are written in p[i] and q[i]; ``from_energy`` is the way to make one.
    """

    kinds: str = ""

    letter: ClassVar[str] = "IC"
    _kind: ClassVar[str] = "an IC field"

    def __post_init__(self) -> None:
        if not self.kinds:
            by_number = {v.number: v.letter for v in self._variables()}
            kinds = "".join(by_number.get(i + 1, "?") for i in range(len(self.laws)))
            object.__setattr__(self, "kinds", kinds)
        if len(self.kinds) != len(self.laws) or set(self.kinds) - set("pq"):
            raise StructureError(
                f"The kinds of the ports of {self.name!r} are {self.kinds!r}.",
                (self.name,),
                'Give p or q for each port, such as kinds="pq".',
            )
        _Field.__post_init__(self)

    @property
    def stored(self) -> tuple[PortVariable, ...]:
        """The stored variable of each port."""
        return tuple(PortVariable(k, i + 1) for i, k in enumerate(self.kinds))


@dataclass(frozen=True, slots=True)
class ResistanceField(_Field):
    """R field: its ports dissipate together; laws all in f (or e) give e (or f)."""

    letter: ClassVar[str] = "R"
    _kind: ClassVar[str] = "an R field"

    @property
    def relations(self) -> tuple[Relation, ...]:
        """One relation per port."""
        letters = self._letters()
        if letters not in {"e", "f"}:
            raise self._refuse_letters(letters, "f or e")
        given = "e" if letters == "f" else "f"
        return tuple(
            Relation(PortVariable(given, i + 1), PortVariable(letters, i + 1), law)
            for i, law in enumerate(self.laws)
        )

    @classmethod
    def from_matrix(cls, name: str, matrix: Sequence[Sequence[object]]) -> Self:
        """Return the field with ``e = matrix · f``."""
        return cls(name, _linear("f", matrix, name))


StorageField = InertanceField | ComplianceField | MixedField
MultiPort = InertanceField | ComplianceField | MixedField | ResistanceField

# The field's letters, for authors.
IField, CField, ICField, RField = (
    InertanceField,
    ComplianceField,
    MixedField,
    ResistanceField,
)
