"""A hypothesis: one piece of physics at one place, as an edit that can be undone."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

import sympy

from bondgraph.physics.places.base import Coefficient, Place
from bondgraph.structure.domains import EnergyDomain
from bondgraph.structure.edits import (
    ConnectJunctions,
    CoupleJunctions,
    GraphEdit,
    InsertElement,
    ReplaceMeasurement,
    ReplaceRelation,
    WrapInput,
)
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.signals import e, f, p, q, signals_in


class Passivity(StrEnum):
    """What a piece of physics may do with power; the value is the sentence."""

    DISSIPATIVE = "It only takes power out."
    STORING = "It stores power and gives it back."
    SOURCE = "It may give power."
    SIGNAL = "It carries no power: it changes what is commanded or read."


@dataclass(frozen=True, slots=True)
class Shape:
    """What to draw of a curve that changes a law: a value over an argument.

    Both are expressions in signals and parameters, with what they are called and their
    units. A value that `multiplies` the law of a loss may not turn negative.
    """

    argument: sympy.Expr
    argument_name: str
    argument_unit: str
    value: sympy.Expr
    value_name: str
    value_unit: str
    multiplies: bool = False


@dataclass(frozen=True, slots=True)
class Limit:
    """Where a law is another, plainer one, by whose word it is told then.

    Parameters
    ----------
    parameter, least
        The number of it whose size has come down to no more than this.
    physics, words
        Of the plainer law.
    """

    parameter: str
    least: float
    physics: str
    words: str


@dataclass(frozen=True, slots=True)
class Memory:
    """A state of its own that a law keeps within a size, whatever has happened.

    Parameters
    ----------
    state
        Its name in the graph; its symbol is ``q_`` and that.
    most
        The size that it comes to at most.
    """

    state: str
    most: float


SMOOTHED = InsertElement | ReplaceRelation | WrapInput | ReplaceMeasurement
"""Edits whose laws may have edges that are smoothed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """One (physics, place) with everything needed to insert, fit and tell it.

    Parameters
    ----------
    physics
        The word for it, from the vocabulary.
    place
        The junction, element, input or output it sits at, by its name.
    element
        The name of what the edit adds or changes.
    edit
        What it does to the graph.
    law
        The relation, readable.
    words
        A sentence without its numbers, for reports.
    depends_on
        The local variables the law reads, for data clouds and for advice.
    starts
        Start values of its new parameters; the first is that of weakest effect.
    extends
        Physics words of which this law is a superset at the same place.
    strengths
        The parameters at whose 0 it has no effect, whatever the others are.
    also
        Other names of the same place in the user's model.
    smoothing
        The parameters, not fitted, over which it smooths what is sharp in truth.
    factor
        What of the law multiplies a curve without a name.
    shape
        That curve, where it changes a law and nothing can be taken out again.
    limit
        Where it is told as a plainer law; None where it never is.
    memory
        A state of its own that its law keeps within a size; None where it does not.
    visited
        The range of its variable that a curve is drawn over; None of any other law.
    """

    physics: str
    place: str
    element: str
    edit: GraphEdit
    law: sympy.Expr
    words: str
    depends_on: tuple[str, ...]
    starts: tuple[Mapping[str, float], ...]
    extends: tuple[str, ...] = ()
    strengths: tuple[str, ...] = ()
    also: tuple[str, ...] = ()
    smoothing: tuple[str, ...] = ()
    factor: sympy.Expr = sympy.S.One
    shape: Shape | None = None
    limit: Limit | None = None
    memory: Memory | None = None
    visited: tuple[float, float] | None = None

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters it adds and that are fitted."""
        return tuple(p.name for p in self.edit.parameters if not p.exact)

    @property
    def other_end(self) -> str:
        """The second junction of what joins two; empty for what sits at one place."""
        if isinstance(self.edit, ConnectJunctions | CoupleJunctions):
            return self.edit.second
        return ""

    @property
    def repeats(self) -> bool:
        """Whether it is the same again and again along a displacement."""
        return bool(self.law.has(sympy.sin, sympy.cos))

    @property
    def is_slip(self) -> bool:
        """Whether it rights how something was recorded, with no number to be fitted."""
        return not self.parameters

    @property
    def waits(self) -> bool:
        """Whether it acts only beyond what has to be reached first: a stop, a brim."""
        reached = {"displacement", "effort"} & set(self.depends_on)
        return bool(reached) and bool(self.law.has(sympy.Max))

    @property
    def is_never_none(self) -> bool:
        """Whether its weakest start has some effect still: a storage, however small."""
        return not self.strengths or any(
            all(start[name] != 0.0 for start in self.starts) for name in self.strengths
        )

    @property
    def silent_starts(self) -> tuple[Mapping[str, float], ...]:
        """The starts that leave the base model as it is, whose slopes tell promise."""
        if not self.strengths:
            return self.starts[:1] if self.edit.nested else ()
        # An inertia of zero has no equations: its least start is as good as none.
        least = {
            name: min(abs(s[name]) for s in self.starts) for name in self.strengths
        }
        return tuple(
            start
            for start in self.starts
            if all(abs(start[name]) == least[name] for name in self.strengths)
        )

    def contains(self, narrower: "Hypothesis") -> bool:
        """Return whether this law is the other one, at the same place, and more.

        Of two forms of one law the one with more parameters contains the other.
        """
        if self.place != narrower.place or narrower.physics not in self.extends:
            return False
        more = len(self.parameters) > len(narrower.parameters)
        return more or self.physics != narrower.physics

    def is_elsewhere(self, other: "Hypothesis") -> bool:
        """Return whether this law is the other one, in the same form, elsewhere."""
        same = self.physics == other.physics and self.place != other.place
        return same and len(self.parameters) == len(other.parameters)

    @property
    def told_by(self) -> tuple[str, ...]:
        """What tells it from others: physics, place, sentence and what is fitted."""
        return self.physics, self.place, self.words, *self.parameters

    def told_with(self, values: Mapping[str, float]) -> "Hypothesis":
        """Return how it is told with the numbers of a fit: at its limit as another."""
        limit = self.limit
        if limit is None or abs(values[limit.parameter]) > limit.least:
            return self
        return replace(self, physics=limit.physics, words=limit.words)

    def sharper(self, times: float) -> "Hypothesis":
        """Return it with its smoothed edges so many times narrower."""
        if not self.smoothing or not isinstance(self.edit, SMOOTHED):
            return self
        narrowed = tuple(
            replace(p, value=p.value / times)
            if p.name in self.smoothing and p.value is not None
            else p
            for p in self.edit.parameters
        )
        return replace(self, edit=replace(self.edit, parameters=narrowed))

    def apply(self, graph: FinishedGraph) -> FinishedGraph:
        """Return the graph with the physics inserted."""
        return self.edit.apply(graph)


Make = Callable[..., Hypothesis]
"""What makes a hypothesis of some physics: `AbstractPhysics.hypothesis`."""

Form = Callable[[], Hypothesis]
"""What makes one of its forms; a curve drawn finely is long to write."""


class AbstractPhysics(ABC):
    """One entry of the library; subclass it to add your own.

    ``word`` is the name in results, ``reference`` where the law comes from,
    ``passivity`` what it may do with power, ``signature`` what it looks like in
    recordings and what it is easily taken for, and ``domains`` the energy domains where
    the word is the right one (all where empty).
    """

    word: str
    reference: str
    passivity: Passivity = Passivity.SOURCE
    signature: str = ""
    domains: frozenset[EnergyDomain] = frozenset()

    @abstractmethod
    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield the hypotheses of this physics at `place`; none where it cannot sit."""

    def suits(self, place: Place) -> bool:
        """Return whether the word is right in the domain of `place`."""
        return not self.domains or place.domain in self.domains

    def hypothesis(
        self,
        place: Place,
        edit: GraphEdit,
        law: sympy.Expr,
        coefficients: tuple[Coefficient, ...],
        words: str,
        *,
        extends: tuple[str, ...] = (),
        also: tuple[str, ...] = (),
    ) -> Hypothesis:
        """Return the hypothesis that this physics is missing at `place`.

        Parameters
        ----------
        edit, law, words
            What it does to the graph, the relation, and a sentence without numbers.
        coefficients
            Those that the law uses, with the values their fits start from.
        extends, also
            Words of narrower laws; further names of the place.
        """
        return Hypothesis(
            physics=self.word,
            place=place.name,
            element=edit.subject,
            edit=edit,
            law=law,
            words=words,
            depends_on=_arguments(law, edit.subject),
            starts=_starts(coefficients),
            extends=extends,
            strengths=tuple(c.name for c in coefficients if c.strength),
            also=(*place.also, *also),
            smoothing=tuple(c.name for c in coefficients if c.smooths),
        )


_WORDS = {f: "flow", e: "effort", q: "displacement", p: "momentum"}


def _arguments(law: sympy.Expr, own: str) -> tuple[str, ...]:
    """Return the local variables of a law, and the signals it reads elsewhere."""
    here = (word for symbol, word in _WORDS.items() if symbol in law.free_symbols)
    there = (signal.name for signal in signals_in(law) if signal.place != own)
    return (*here, *there)


def _starts(coefficients: tuple[Coefficient, ...]) -> tuple[Mapping[str, float], ...]:
    """Return the first values of all coefficients, the second, and so on."""
    fitted = [c for c in coefficients if c.starts]
    count = max((len(c.starts) for c in fitted), default=1)
    return tuple(
        {c.name: c.starts[min(i, len(c.starts) - 1)] for c in fitted}
        for i in range(count)
    )
