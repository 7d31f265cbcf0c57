"""Machines drawn at random, of 3 to 200 elements, in every domain.

Each is drawn in one of several manners. Careful ones resemble what people draw:
storages where they can be independent, few sources. Careless ones put anything
anywhere, so that most are causal conflicts or algebraically singular. Both have rings,
transformers and gyrators between domains, parts that nothing joins, storages that
depend on one another, curved and set-valued laws, moduli that move and fields.
"""

import random
from collections.abc import Callable
from dataclasses import dataclass

import sympy

from bondgraph import (
    GY,
    TF,
    BondGraph,
    C,
    CField,
    I,
    IField,
    R,
    RField,
    Se,
    Sf,
    displacement,
    e,
    f,
    momentum,
    p,
    q,
    t,
)
from bondgraph.structure.signals import parameter_symbol

LARGEST = 200
DOMAINS = ("translation", "rotation", "electrical", "hydraulic", "thermal", "analogue")


@dataclass(frozen=True, slots=True, kw_only=True)
class Manner:
    """How a machine is drawn: shares between 0 and 1.

    ``careful`` is the share of junctions that get the storage and resistance that suit
    them, ``curved`` and ``dry`` that of smooth and of set-valued nonlinear laws,
    ``moving`` of moduli that follow a displacement, momentum or time, ``fields`` of
    fields per junction, ``rings`` of further joins per junction, ``torn`` of joins left
    out, ``sources`` of sources per junction.
    """

    name: str
    careful: float
    sources: float
    rings: float
    torn: float
    curved: float = 0.0
    dry: float = 0.0
    moving: float = 0.0
    fields: float = 0.0


MANNERS = (
    Manner(name="careful", careful=1.0, sources=0.05, rings=0.1, torn=0.0),
    Manner(name="ordinary", careful=0.9, sources=0.1, rings=0.1, torn=0.02),
    Manner(name="careless", careful=0.3, sources=0.3, rings=0.2, torn=0.05),
    Manner(name="torn", careful=0.95, sources=0.1, rings=0.05, torn=0.3),
    Manner(name="fields", careful=0.9, sources=0.05, rings=0.05, torn=0.0, fields=0.2),
    Manner(
        name="curved",
        careful=0.95,
        sources=0.05,
        rings=0.05,
        torn=0.02,
        curved=0.4,
        moving=0.2,
    ),
    Manner(
        name="dry",
        careful=1.0,
        sources=0.05,
        rings=0.03,
        torn=0.0,
        curved=0.1,
        dry=0.3,
        moving=0.05,
        fields=0.03,
    ),
)


def random_machine(seed: int, *, largest: int = LARGEST) -> BondGraph:
    """Return the machine of a seed, of at most `largest` elements.

    Small ones, in which every pair of kinds meets soon, are drawn more often than large
    ones. Manners come in turn.
    """
    draw = random.Random(seed)
    manner = MANNERS[seed % len(MANNERS)]
    wanted = 3.0 * (largest / 3.0) ** (draw.random() ** 2)
    return _Drawing(draw, manner, round(wanted), seed).machine()


@dataclass(frozen=True, slots=True)
class _Place:
    name: str
    is_one: bool
    domain: str


class _Drawing:
    """One machine while it is being drawn."""

    def __init__(
        self, draw: random.Random, manner: Manner, wanted: int, seed: int
    ) -> None:
        self.draw, self.manner = draw, manner
        self.graph = BondGraph(f"{manner.name} {seed}", domain="analogue")
        self.left = wanted
        self.fields = 0
        self.wide = draw.choice([1, 1, 3, 1000])
        self.places: list[_Place] = []
        self.elements: list[str] = []
        self.joined: set[frozenset[str]] = set()

    def machine(self) -> BondGraph:
        """Draw junctions until the elements are used up, then rings and channels."""
        while self.left > 0:
            self._add_place()
        rings = self._how_many(self.manner.rings * len(self.places))
        for _ in range(rings if len(self.places) > 2 else 0):
            self._join(*self.draw.sample(self.places, 2))
        for _ in range(self._how_many(self.manner.fields * len(self.places))):
            self._add_field()
        for name in self.draw.sample(self.elements, min(2, len(self.elements))):
            self.graph.measure(f"effort_{name}", effort=name)
            self.graph.measure(f"flow_{name}", flow=name)
        return self.graph

    def _chance(self, share: float) -> bool:
        return self.draw.random() < share

    def _how_many(self, mean: float) -> int:
        return int(mean) + self._chance(mean % 1.0)

    def _add_place(self) -> None:
        number = len(self.places)
        near = self.draw.choice(self.places[-self.wide :]) if self.places else None
        turn = self._chance(0.5) if near is None else not near.is_one
        if near is not None and not self._chance(0.8):
            turn = not turn
        new_domain = near is None or self._chance(0.15)
        domain = self.draw.choice(DOMAINS) if new_domain else near.domain
        place = _Place(f"j{number}", turn, domain)
        write = self.graph.one if place.is_one else self.graph.zero
        write(place.name, *self._one_ports(place), domain=domain)
        self.places.append(place)
        if near is not None and not self._chance(self.manner.torn):
            self._join(near, place)

    def _one_ports(self, place: _Place) -> list[I | C | R | Se | Sf]:
        kinds: list[type] = []
        suits = I if place.is_one else C
        if self._chance(self.manner.careful):
            kinds += [suits] * self._chance(0.85) + [R] * self._chance(0.7)
            kinds += [C if suits is I else I] * self._chance(0.2)
        else:
            kinds += self.draw.choices([I, C, R, R], k=self.draw.randint(0, 3))
        if self._chance(self.manner.sources) or not self.places:
            # A source that does not hold what a storage there wants to give.
            fitting = Se if place.is_one else Sf
            other = Sf if place.is_one else Se
            kinds.append(fitting if self._chance(self.manner.careful) else other)
        if not kinds:
            kinds = [R]
        self.left -= len(kinds)
        names = [f"{kind_letter(k)}{place.name}_{i}" for i, k in enumerate(kinds)]
        self.elements += names
        return [
            self._one_port(kind, name, is_one=place.is_one)
            for kind, name in zip(kinds, names, strict=True)
        ]

    def _one_port(self, kind: type, name: str, *, is_one: bool) -> I | C | R | Se | Sf:
        if kind in (Se, Sf):
            return kind(name)
        if kind is R and self._chance(self.manner.dry):
            a, b = (parameter_symbol(f"{x}_{name}") for x in "ab")
            return R(name, law=self.draw.choice(DRY)(a, b, f if is_one else e))
        if not self._chance(self.manner.curved):
            return kind(name)
        a, b = (parameter_symbol(f"{x}_{name}") for x in "ab")
        usual, other = {I: (p, f), C: (q, e), R: (f, e)}[kind]
        x = usual if self._chance(0.85) else other
        return kind(name, law=self.draw.choice(CURVED)(a, b, x))

    def _join(self, one: _Place, other: _Place) -> None:
        tail, head = self.draw.sample([one, other], 2)
        pair = frozenset((tail.name, head.name))
        same = one.domain == other.domain
        if pair in self.joined or len(pair) == 1:
            return
        kind = self.draw.choice([None, None, TF, GY] if same else [TF, TF, GY])
        number = len(self.joined)
        self.joined.add(pair)
        if kind is None:
            self.graph.join(tail.name, head.name)
            return
        self.left -= 1
        law = self._modulus(f"k{number}", one)
        self.graph.join(tail.name, kind(f"x{number}", law=law), head.name)

    def _modulus(self, name: str, place: _Place) -> sympy.Expr | None:
        if not self._chance(self.manner.moving):
            return parameter_symbol(name)
        read = (displacement if place.is_one else momentum)(place.name)
        moved = self.draw.choice([read, read, t])
        return parameter_symbol(name) * (1 + sympy.sin(moved) / 3)

    def _add_field(self) -> None:
        kinds: dict[Callable[..., IField | CField | RField], bool | None]
        kinds = {IField.from_matrix: True, CField.from_matrix: False}
        kinds[RField.from_matrix] = None
        make, on_ones = self.draw.choice(list(kinds.items()))
        fitting = [x for x in self.places if on_ones is None or x.is_one == on_ones]
        ports = min(self.draw.randint(2, 3), len(fitting))
        if ports < 2:
            return
        chosen = self.draw.sample(fitting, ports)
        self.fields += 1
        name = f"field{self.fields}"
        entries = {
            (i, j): parameter_symbol(f"{name}_{i}{j}")
            for i in range(ports)
            for j in range(i, ports)
        }
        # More on the diagonal than beside it: a matrix that stores or dissipates.
        matrix = [
            [
                4 * entries[i, j] if i == j else entries[min(i, j), max(i, j)] / 2
                for j in range(ports)
            ]
            for i in range(ports)
        ]
        self.left -= 1
        self.graph.put(make(name, matrix), on=tuple(x.name for x in chosen))


CURVED: tuple[Callable[[sympy.Symbol, sympy.Symbol, sympy.Symbol], sympy.Expr], ...] = (
    lambda a, b, x: a * x + b * x**3,
    lambda a, b, x: a * sympy.sinh(x),
    lambda a, b, x: a * x + b * sympy.tanh(x),
    lambda a, b, x: a * x + b * x * sympy.Abs(x),
)
DRY: tuple[Callable[[sympy.Symbol, sympy.Symbol, sympy.Symbol], sympy.Expr], ...] = (
    lambda a, b, x: a * x + b * sympy.sign(x),
    lambda a, b, x: b * sympy.sign(x),
    lambda a, b, x: a * x + b * sympy.sign(x) * (1 + sympy.exp(-sympy.Abs(x))),
)


def kind_letter(kind: type) -> str:
    """Return the first letters of an element's name."""
    return {I: "i", C: "c", R: "r", Se: "e", Sf: "f"}[kind]
