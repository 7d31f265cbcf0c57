"""`locate`: at which place is what is missing a law of what is local there.

1. Linearise the fitted model exactly, step by step, with a source at every place.
2. Smooth the recordings with each source in turn: what would it have to give?
3. Ask of what is local there (its own flow, displacement, effort, loads, time), by
   curves fitted to some chunks of the recordings and judged on the others, how much of
   the error a law removes. A free signal explains anything anywhere; a law only where
   it is true.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondgraph.diagnosis.location.laws import Form, LocalLaw, laws_of
from bondgraph.diagnosis.location.locals import Probes, local_variables
from bondgraph.diagnosis.location.ranking import conclude, plainest_first
from bondgraph.diagnosis.location.records import Location, PlaceEvidence, Relation
from bondgraph.diagnosis.location.references import (
    First,
    Reference,
    Settled,
    better_reference,
    moved,
    settled_at,
    unmoved_at,
)
from bondgraph.diagnosis.location.regression import (
    Baseline,
    Explained,
    baseline,
    explain,
    law_responses,
    law_states,
    projected,
)
from bondgraph.diagnosis.virtual.chain import Chain, linear_chain
from bondgraph.diagnosis.virtual.noise import noise_scale
from bondgraph.diagnosis.virtual.sources import (
    VirtualModel,
    VirtualSource,
    chosen_sources,
    virtual_model,
)
from bondgraph.errors import FitError
from bondgraph.fitting.estimate import FittedModel
from bondgraph.recordings.binding import BoundRecording
from bondgraph.recordings.model_channels import matched
from bondgraph.structure.domains import ROTATION

Array = NDArray[np.float64]
CURVE_POINTS = 200
PROMISING = 6.0
"""Laws that leave more than so many times what the best leaves are not repeated."""
REFINED, PASSES = 2, 2
"""So many laws per place are repeated so many times on the states they give."""


@dataclass(frozen=True, slots=True, eq=False)
class _Setting:
    """What all places share."""

    fitted: FittedModel
    virtual: VirtualModel
    probes: Probes
    noise: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Tried:
    """A law at a place with the parameters and states that go with it."""

    relation: Relation
    theta: Array
    states: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """One place; ``without`` is what parameters alone leave there."""

    source: VirtualSource
    settled: Settled
    own: Array | None
    tried: tuple[_Tried, ...]
    without: Array

    @property
    def least(self) -> float:
        """What the best law leaves."""
        return min((_left(t) for t in self.tried), default=np.inf)


def locate(
    fitted: FittedModel,
    recordings: Sequence[BoundRecording],
    *,
    places: Sequence[str] | None = None,
) -> Location:
    """Rank places by how simply the signal missing there depends on what is local.

    Parameters
    ----------
    fitted
        The model fitted to the recordings, as `fit_model` gives it.
    recordings
        Those it was fitted to; the measurement noise is estimated from them.
    places
        Names of junctions, inputs and outputs; all when None.

    Raises
    ------
    FitError
        If a place is not in the model, or the model, as it was fitted, cannot be
        simulated with a signal at any of them.
    """
    recordings = matched(fitted.graph, recordings)
    sources = chosen_sources(fitted.graph, places)
    setting = _Setting(
        fitted,
        virtual_model(fitted.graph, sources),
        Probes(fitted, sources),
        noise_scale(fitted, recordings),
    )
    reference, first = better_reference(fitted, setting.virtual, sources, setting.noise)
    tried = (
        _found(setting, source, reference, one)
        for source, one in zip(sources, first, strict=True)
    )
    found = [one for one in tried if one is not None]
    if not found:
        raise FitError(
            f"No missing signal can be recovered with {fitted.graph.name!r} as it was "
            "fitted: its steps overflow.",
            (fitted.graph.name,),
            "Give bounds that keep its parameters near what the machine can have.",
        )
    least = min(one.least for one in found)
    refined = [
        _refined(setting, one) if one.least <= PROMISING * least else one
        for one in found
    ]
    evidence = [(_evidence(setting, one), one.without) for one in refined]
    return conclude(evidence, fitted, setting.noise)


def _found(
    setting: _Setting, source: VirtualSource, reference: Reference, first: First
) -> _Found | None:
    """Smooth the signal at a place and try every law on what is local there.

    None where the model cannot be simulated with what the signal would make of it, nor
    as it is.
    """
    fitted, noise = setting.fitted, setting.noise
    for smoothed_at in (settled_at, unmoved_at):
        settled = smoothed_at(fitted, setting.virtual, source, reference, first, noise)
        base = baseline(
            settled.chain, noise, settled.std, settled.center - settled.theta
        )
        if np.isfinite(base.target).all():
            break
    else:
        return None
    chain, states = settled.chain, settled.smoothed.states
    laws, own = _laws(setting, source, chain, settled.theta, states)
    tried = tuple(_try(setting, settled, base, chain, settled.theta, x) for x in laws)
    without = explain(base, np.zeros((len(base.target), 0))).left / base.target.size
    return _Found(source, settled, own, tried, without)


def _refined(setting: _Setting, found: _Found) -> _Found:
    """Judge the best laws where they themselves take the machine.

    The smoothed states know the recordings, those that a law is judged on too; a law
    must also hold on the states that it gives itself, and with the parameters it needs.
    """
    best = sorted(found.tried, key=_left)
    kept = [t for t in best[:REFINED] if _left(t) <= PROMISING * found.least]
    refined = tuple(_repeated(setting, found, one) for one in kept)
    # What was not tried again cannot be better than its relatives that were.
    return replace(found, tried=refined)


def _repeated(setting: _Setting, found: _Found, tried: _Tried) -> _Tried:
    settled, source = found.settled, found.source
    for _ in range(PASSES):
        theta = moved(setting.fitted, settled.center, tried.theta)
        chain = linear_chain(
            setting.fitted,
            (source,),
            virtual=setting.virtual,
            theta=theta,
            states=tried.states,
        )
        base = baseline(chain, setting.noise, settled.std, settled.center - theta)
        laws, _ = _laws(setting, source, chain, theta, tried.states)
        told = tried.relation
        same = [
            x for x in laws if (x.form, x.variable.name) == (told.form, told.variable)
        ]
        if not same or not np.isfinite(base.target).all():
            return _failed(tried)
        tried = _try(setting, settled, base, chain, theta, same[0])
    return tried


def _failed(tried: _Tried) -> _Tried:
    """Return a law that does not survive on its own states."""
    left = np.full_like(tried.relation.left, np.inf)
    return replace(tried, relation=replace(tried.relation, left=left, share=0.0))


def _laws(
    setting: _Setting,
    source: VirtualSource,
    chain: Chain,
    theta: Array,
    states: Array,
) -> tuple[tuple[LocalLaw, ...], Array | None]:
    """Return the laws of what is local along given states, and the own variable."""
    signals = setting.probes.read(chain.shots, theta, states)
    variables = local_variables(setting.fitted, chain, source, signals)
    graph = setting.fitted.graph
    rotating = source.at_junction and graph.domain_at(source.place) == ROTATION
    own = next((v.values for v in variables.values() if v.role == "own"), None)
    laws = laws_of(variables, chain.shots.time, chain.follows, rotating=rotating)
    return laws, own


def _left(tried: _Tried) -> float:
    return float(tried.relation.left.sum())


def _try(
    setting: _Setting,
    settled: Settled,
    base: Baseline,
    chain: Chain,
    theta: Array,
    law: LocalLaw,
) -> _Tried:
    """Fit one family of laws and judge it on left-out chunks."""
    told = explain(base, projected(base, law_responses(chain, 0, law.columns)))
    signal = law.columns @ told.coefficients
    return _Tried(
        _relation(setting, base, law, told),
        theta + told.theta,
        law_states(chain, base, signal, told.theta),
    )


def _relation(
    setting: _Setting, base: Baseline, law: LocalLaw, told: Explained
) -> Relation:
    before = float(np.nansum((setting.fitted.residuals() / setting.noise) ** 2))
    values = law.variable.values
    drawn = np.abs(values) if law.form is Form.LOAD else values
    order = np.argsort(drawn)
    thin = order[:: max(len(order) // CURVE_POINTS, 1)]
    curve = law.curve @ told.coefficients
    return Relation(
        form=law.form,
        variable=law.variable.name,
        unit=law.variable.unit,
        share=1.0 - float(told.left.sum()) / before if before > 0.0 else 0.0,
        left=told.left / base.target.size,
        argument=drawn[thin],
        curve=curve[thin],
        odd=_odd_share(drawn[order], curve[order]),
        signal=law.columns @ told.coefficients,
    )


def _evidence(setting: _Setting, found: _Found) -> PlaceEvidence:
    smoothed, source = found.settled.smoothed, found.source
    names = setting.fitted.problem.model.parameter_names
    relations = plainest_first([tried.relation for tried in found.tried])
    best = [t for t in found.tried if relations and t.relation is relations[0]]
    theta = best[0].theta if best else found.settled.theta
    return PlaceEvidence(
        place=source.place,
        kind=source.kind,
        unit=source.unit,
        evidence=smoothed.evidence,
        signal=smoothed.signal,
        std=smoothed.std,
        power=None if found.own is None else _power(smoothed.signal, found.own),
        relations=relations,
        theta={
            names[i]: float(value)
            for i, value in zip(setting.fitted.problem.free, theta, strict=True)
        },
    )


def _power(signal: Array, own: Array) -> float:
    """Return the mean of s·f over the mean of |s·f|."""
    power = signal * own
    total = float(np.abs(power).mean())
    return float(power.mean()) / total if total > 0.0 else 0.0


def _odd_share(argument: Array, curve: Array) -> float | None:
    """Return how much of a curve is odd about zero; None where it is not visited."""
    reach = min(-argument[0], argument[-1])
    if not reach > 0.1 * max(-argument[0], argument[-1]):
        return None
    grid = np.linspace(0.0, reach, 41)[1:]
    there, mirrored = (
        np.interp(grid, argument, curve),
        np.interp(-grid, argument, curve),
    )
    odd = float(np.mean((there - mirrored) ** 2))
    even = float(np.mean((there + mirrored) ** 2))
    return odd / (odd + even) if odd + even > 0.0 else None
