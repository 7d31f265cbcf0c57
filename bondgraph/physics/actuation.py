"""Inputs that do not do what they are asked: scale, limits, dead zone, a power."""

from collections.abc import Iterator
from dataclasses import replace

import sympy

from bondgraph.physics.gains import in_proportion
from bondgraph.physics.gap import beyond
from bondgraph.physics.hypothesis import AbstractPhysics, Hypothesis, Passivity
from bondgraph.physics.places.base import Coefficient, Place
from bondgraph.physics.places.channels import InputPlace
from bondgraph.physics.places.source import ActuatorPlace
from bondgraph.physics.powers import raised
from bondgraph.physics.slips import FACTORS, SLIPS, own_values
from bondgraph.structure.domains import ANALOGUE
from bondgraph.structure.edits import SignalState
from bondgraph.structure.signals import displacement

ALONE = (0.0, 0.2, 0.4, 0.6, 0.8, 0.95)
"""Of the furthest command: where a limit one way is looked for, first at nothing."""

ENDS = {
    "lower_limit": (0.0, 0.0, 0.0, 0.4, 0.7, 0.95),
    "upper_limit": (0.95, 0.7, 0.4, 0.0, 0.7, 0.95),
}
"""The same of a limit each way: most machines that have two go one way only."""

Driving = InputPlace | ActuatorPlace

SEVERAL = 4
"""An input that has been in fewer tenths of its size shows no characteristic."""


class InputScale(AbstractPhysics):
    """An input that acts in another proportion than the model says."""

    word = "input_scale"
    reference = "gain error of an amplifier"
    passivity = Passivity.SIGNAL
    signature = "everything in proportion; taken for a parameter of what is driven"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every input."""
        if not isinstance(place, InputPlace):
            return
        scale = place.shape("input_scale", "1", FACTORS)
        law, own = in_proportion(place, scale)
        words = f"{place.name} acts in another proportion than commanded"
        yield self.hypothesis(place, place.become(law, *own), law, own, words)
        # All else in proportion does the same, so a free factor is not determined; a
        # slip is, where the parameters cannot follow: there is no negative mass.
        for factor, slip in SLIPS.items():
            fixed = place.constant("input_scale", "1", factor)
            law = fixed.symbol * place.signal
            edit = place.become(law, fixed, nested=False)
            words = f"{place.name} is recorded {slip}"
            slipped = self.hypothesis(place, edit, law, (fixed,), words)
            yield replace(slipped, starts=(own_values(place),))
        if place.domain == ANALOGUE or place.is_constant:
            return
        for other in place.of_its_kind:
            if not other.is_constant:
                yield self._with_less_beside(place, other)

    def _with_less_beside(self, place: InputPlace, other: InputPlace) -> Hypothesis:
        """Return an input that does less the more another one does: a shared supply."""
        shares = (0.0, 0.2)
        name = f"share_lost_to_{other.name}"
        lost = place.strength(name, "1", shares, low=0.0, high=1.0)
        size = place.constant(f"peak_of_{other.name}", place.channel_unit, other.peak)
        beside = sympy.Abs(other.signal) / size.symbol
        law = place.signal * (1 - lost.symbol * beside)
        words = (
            f"{place.name} does less the more {other.name} does: they share a supply"
        )
        edit = place.become(law, lost, size)
        return self.hypothesis(place, edit, law, (lost, size), words)


class Saturation(AbstractPhysics):
    """An input that does not pass a limit, or change faster than one: supply, valve."""

    word = "saturation"
    reference = "actuator saturation: Åström and Hägglund 2006"
    passivity = Passivity.SIGNAL
    signature = "large commands do no more than smaller ones"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield a limit of size and one of rate for every input that changes.

        One that goes both ways may have a limit one way alone, or another each way: a
        pump that is asked to run backwards stands still. And limits of size for every
        source that is steered inside of a loop.
        """
        if isinstance(place, InputPlace):
            if place.is_constant:
                return
            yield self._of_size(place)
            yield self._of_rate(place)
        elif isinstance(place, ActuatorPlace):
            yield self._of_size(place)
        else:
            return
        low, high = place.range
        if low < 0.0 < high:
            yield self._at_ends(place, lower=True)
            yield self._at_ends(place, upper=True)
            yield self._at_ends(place, lower=True, upper=True)

    def _of_size(self, place: Driving) -> Hypothesis:
        limits = tuple(share * place.peak for share in (0.95, 0.8, 0.65, 0.5, 0.35))
        limit = place.shape("limit", place.channel_unit, limits, low=0.01 * place.peak)
        law = sympy.Max(sympy.Min(place.signal, limit.symbol), -limit.symbol)
        return self._limited(place, "a limit", law, limit)

    def _at_ends(
        self, place: Driving, *, lower: bool = False, upper: bool = False
    ) -> Hypothesis:
        """Return an input that does not pass a limit of its own at one end, or both."""
        law, own = place.signal, []
        for asked, end, name, within in (
            (lower, 0, "lower_limit", sympy.Max),
            (upper, 1, "upper_limit", sympy.Min),
        ):
            if asked:
                furthest = ENDS[name] if lower and upper else ALONE
                starts = tuple(share * place.range[end] for share in furthest)
                limit = place.shape(name, place.channel_unit, starts)
                law = within(law, limit.symbol)
                own.append(limit)
        ends = "a limit each way" if lower and upper else "a limit one way"
        return self._limited(place, ends, law, *own)

    def _limited(
        self, place: Driving, what: str, law: sympy.Expr, *own: Coefficient
    ) -> Hypothesis:
        edit = place.become(law, *own, nested=False)
        commanded = isinstance(place, InputPlace)
        asked = "is commanded" if commanded else "the loop asks of it"
        words = f"{place.name} does not pass {what}, whatever {asked}"
        return self.hypothesis(place, edit, law, own, words)

    def _of_rate(self, place: InputPlace) -> Hypothesis:
        """Return a state that follows the input within a sample, but no faster.

        In all of a recording it comes to the peak at least: one that hardly moves is
        whatever constant it begins from.
        """
        peak, step = place.peak, place.scales.step
        slowest = peak / place.scales.stretch
        times = (3.0, 10.0, 30.0, 100.0, 300.0)
        rates = tuple(max(peak / (n * step), 2.0 * slowest) for n in times)
        unit = f"({place.channel_unit})/(s)"
        rate = place.shape("rate_limit", unit, rates, low=slowest)
        within = place.constant("rate_settling", "s", 0.5 * step)
        name = place.name_of("slewed")
        behind = (place.signal - displacement(name)) / within.symbol
        slewing = sympy.Max(sympy.Min(behind, rate.symbol), -rate.symbol)
        state = SignalState(name, slewing)
        words = f"{place.name} does not change faster than a limit"
        edit = place.become(state.value, rate, within, states=(state,), nested=False)
        return self.hypothesis(place, edit, state.value, (rate, within), words)


class DeadZone(AbstractPhysics):
    """An input that does nothing while it is small: overlap of a valve, threshold."""

    word = "dead_zone"
    reference = "valve overlap: Merritt 1967"
    passivity = Passivity.SIGNAL
    signature = "small commands do nothing; taken for Coulomb friction"

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it, as wide either way, for an input that changes and within a loop."""
        if not isinstance(place, Driving) or place.is_constant:
            return
        widths = tuple(share * place.peak for share in (0.0, 0.05, 0.15, 0.4))
        half = place.strength("dead_zone", place.channel_unit, widths, low=0.0)
        law = beyond(place.signal, half.symbol)
        words = f"{place.name} does nothing while it is small"
        yield self.hypothesis(place, place.become(law, half), law, (half,), words)


class InputNonlinearity(AbstractPhysics):
    """An input that acts as a power of what is commanded: propellers, power stages."""

    word = "input_nonlinearity"
    reference = "static characteristic of an actuator; a propeller's square law"
    passivity = Passivity.SIGNAL
    signature = (
        "small commands do less than in proportion, or more; taken for an offset"
    )

    def propose(self, place: Place) -> Iterator[Hypothesis]:
        """Yield it for every input of several sizes; its sign is that of the command.

        Through two sizes goes a power, a dead zone and a bias alike.
        """
        if not isinstance(place, InputPlace) or place.is_constant:
            return
        if place.tenths < SEVERAL:
            return
        power = place.strength("input_power", "1", (0.0, 0.5, -0.3), low=-0.8, high=3.0)
        size = place.constant("input_size", place.channel_unit, place.peak)
        law = raised(place.signal, size.symbol, power.symbol)
        words = (
            f"{place.name} acts as a power of what is commanded, one higher than told"
        )
        edit = place.become(law, power, size)
        yield self.hypothesis(place, edit, law, (power, size), words)
