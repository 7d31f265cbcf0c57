"""One machine tried: equations that its raw ones confirm, or a refusal by name."""

import time
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np
import sympy

from benchmarks.fuzzing.machines import LARGEST, random_machine
from benchmarks.fuzzing.oracle import FREQUENCY, Array, Complex, RawSystem
from bondgraph import FinishedGraph, derive
from bondgraph.equations.state_equations import Output, StateEquations
from bondgraph.errors import BondGraphError
from bondgraph.numeric.jacobian import Point, point, settled
from bondgraph.numeric.model import NumericModel, compile_model, evaluate
from bondgraph.structure import elements as kinds
from bondgraph.structure.graph import Measurement
from bondgraph.structure.signals import t

AGREE = 1e-7
"""Of the largest effort, flow and stored quantity of a machine."""

ILL_CONDITIONED = 1e-12
"""Below this reciprocal condition double precision says nothing."""

DRIFT = 1e-4
"""The same for rates, which are told by finite differences."""


class End(StrEnum):
    """How a trial ended."""

    AGREES = "equations that conserve power and agree with the raw ones"
    REFUSED = "refused by name"
    REFUSED_SOLVABLE = "refused by name, though the raw equations have a solution"
    NO_POINT = "equations whose implicit laws were not solved at the point drawn"
    ILL_CONDITIONED = "raw equations too ill-conditioned to judge"
    NAMELESS = "refused without a name"
    DISAGREES = "equations that the raw ones contradict"
    ACCEPTED_SINGULAR = "equations of a machine whose raw ones are singular"
    CRASHED = "an error that is no refusal"
    HUNG = "no answer in time"


FAILURES = (
    End.NAMELESS,
    End.DISAGREES,
    End.ACCEPTED_SINGULAR,
    End.CRASHED,
    End.HUNG,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One machine and how it ended; ``error`` is the largest relative difference."""

    seed: int
    end: End
    name: str = ""
    elements: int = 0
    dependent: int = 0
    unknowns: int = 0
    linear: bool = True
    error: float = 0.0
    seconds: float = 0.0
    said: str = ""


def try_machine(seed: int, *, largest: int = LARGEST) -> Trial:
    """Draw the machine of a seed, derive it, and hold it to its raw equations."""
    begin = time.perf_counter()
    trial = _tried(seed, largest)
    return replace(trial, seed=seed, seconds=time.perf_counter() - begin)


def _tried(seed: int, largest: int) -> Trial:
    drawn = random_machine(seed, largest=largest)
    try:
        graph = drawn.finish()
    except BondGraphError as refusal:
        return _refused(Trial(seed=seed, end=End.REFUSED, name=drawn.name), refusal)
    draw = np.random.default_rng(seed)
    values = {name: float(draw.uniform(0.4, 1.6)) for name in graph.parameters}
    system = RawSystem(graph, values)
    graph = _probed(graph, system)
    trial = Trial(
        seed=seed,
        end=End.AGREES,
        name=graph.name,
        elements=len(graph.elements),
        linear=system.linear,
    )
    try:
        equations = derive(graph)
    except BondGraphError as refusal:
        return _refused(trial, refusal, system, draw)
    trial = replace(
        trial,
        dependent=len(system.labels) - len(equations.states),
        unknowns=len(equations.unknowns),
    )
    seen = Seen(graph, equations, values, system.labels)
    judge = _judge_linear if system.linear else _judge_curved
    return judge(trial, seen, system, draw)


def _probed(graph: FinishedGraph, system: RawSystem) -> FinishedGraph:
    """Return the graph with every integral that a law reads measured."""
    probes = tuple(
        Measurement(label, signal, "1")
        for label, signal in system.raw.integrated.items()
    )
    return replace(graph, measurements=(*graph.measurements, *probes))


def _refused(
    trial: Trial,
    refusal: BondGraphError,
    system: RawSystem | None = None,
    draw: np.random.Generator | None = None,
) -> Trial:
    said = f"{type(refusal).__name__}: {refusal}"
    named = any(name in str(refusal) for name in refusal.about)
    end = End.REFUSED if named else End.NAMELESS
    if named and system is not None and draw is not None and system.linear:
        _, condition = system.solved_at(_amplitudes(system, draw))
        if condition > ILL_CONDITIONED:
            end = End.REFUSED_SOLVABLE
    return replace(trial, end=end, said=said)


def _amplitudes(system: RawSystem, draw: np.random.Generator) -> Complex:
    count = len(system.inputs)
    return draw.uniform(0.5, 1.5, count) + 1j * draw.uniform(0.5, 1.5, count)


class Seen:
    """What the library says of every effort, flow and stored quantity at a point."""

    def __init__(
        self,
        graph: FinishedGraph,
        equations: StateEquations,
        values: dict[str, float],
        labels: list[str],
    ) -> None:
        self.graph, self.equations = graph, equations
        efforts, flows = (
            [equations.signal(q, b.name) for b in graph.bonds]
            for q in ("effort", "flow")
        )
        stored = [_stored(equations, label) for label in labels]
        everything = replace(
            equations,
            assignments=(*equations.assignments, *equations.further),
            further=(),
            outputs=tuple(
                Output(str(i), x, "1")
                for i, x in enumerate([*efforts, *flows, *stored])
            ),
        )
        self.model: NumericModel = compile_model(everything)
        self.p = np.array([values[name] for name in self.model.parameter_names])
        self.state_labels = [_label(equations, label) for label in labels]

    def at(
        self, x: Array, u: Array, input_rates: Array, time: float = 0.0
    ) -> tuple[Array, Array]:
        """Return the rates, and every effort, flow and stored quantity."""
        start = replace(
            point(self.model, x, u, self.p, t=time), input_rates=input_rates
        )
        here: Point = settled(self.model, start)
        outputs, _ = evaluate(
            self.model.output, here.variables, np.zeros((len(here.variables), 0))
        )
        return here.rates, outputs


def _stored(equations: StateEquations, label: str) -> sympy.Expr:
    """Return what a storage, field port or integrated signal holds."""
    for output in equations.outputs:
        if output.name == label:
            return output.expression
    for quantity in ("momentum", "displacement"):
        if (quantity, label) in equations.signals:
            return equations.signal(quantity, label)
    raise AssertionError(f"{label} stores nothing")


def _label(equations: StateEquations, label: str) -> int:
    """Return the number of the state that a stored quantity is, -1 if it is none."""
    expression = _stored(equations, label)
    symbols = [state.symbol for state in equations.states]
    return symbols.index(expression) if expression in symbols else -1


def _judge_linear(
    trial: Trial, seen: Seen, system: RawSystem, draw: np.random.Generator
) -> Trial:
    """Hold a linear machine to the dense solution at one complex frequency."""
    u = _amplitudes(system, draw)
    if not system.inputs:
        return _judge_curved(trial, seen, system, draw)
    w, condition = system.solved_at(u)
    if condition <= ILL_CONDITIONED:
        singular = condition < np.finfo(float).eps
        end = End.ACCEPTED_SINGULAR if singular else End.ILL_CONDITIONED
        return replace(trial, end=end, said=f"condition {condition:.1e}")
    stored = w[len(w) - len(system.labels) :]
    x = np.zeros(len(seen.equations.states), complex)
    for k, number in enumerate(seen.state_labels):
        if number >= 0:
            x[number] = stored[k]
    parts = [
        seen.at(part(x), part(u), part(FREQUENCY * u)) for part in (np.real, np.imag)
    ]
    rates, outputs = (a + 1j * b for a, b in zip(*parts, strict=True))
    scale = max(float(np.max(np.abs(w))), 1e-300)
    error = float(np.max(np.abs(outputs - w), initial=0.0)) / scale
    error = max(
        error, float(np.max(np.abs(rates - FREQUENCY * x), initial=0.0)) / scale
    )
    power = _power_error(seen.graph, parts[0][1])
    allowed = max(AGREE, 1e-14 / condition)
    end = End.AGREES if max(error, power) < allowed else End.DISAGREES
    return replace(trial, end=end, error=max(error, power))


def _judge_curved(
    trial: Trial, seen: Seen, system: RawSystem, draw: np.random.Generator
) -> Trial:
    """Hold any machine to its balances and laws at a point, and to their rates."""
    count = len(system.inputs)
    x = draw.uniform(0.1, 0.9, len(seen.equations.states))
    u, du = draw.uniform(-1, 1, count), draw.uniform(-1, 1, count)
    time = 0.37
    try:
        rates, outputs = seen.at(x, u, du, time)
    except BondGraphError as refusal:
        return replace(trial, end=End.NO_POINT, said=str(refusal))
    if not np.isfinite(outputs).all():
        return replace(trial, end=End.NO_POINT, said="not finite")
    known = dict(zip(system.columns, map(float, outputs), strict=True))
    known |= dict(zip(system.inputs, map(float, u), strict=True)) | {t: time}
    input_rates = dict(zip(system.inputs, map(float, du), strict=True))
    scale = max(1.0, float(np.max(np.abs(outputs), initial=0.0)))
    error = float(np.max(np.abs(system.residuals(known)), initial=0.0)) / scale
    for k, number in enumerate(seen.state_labels):
        if number >= 0:
            rate = float(system.raw.stored_rates[system.labels[k]].xreplace(known))
            error = max(error, abs(rates[number] - rate) / scale)
    error = max(error, _power_error(seen.graph, outputs))
    end = End.AGREES if error < AGREE else End.DISAGREES
    if end is End.AGREES and trial.dependent and not system.sticks(known):
        slopes, drift = system.slopes(known), system.drift(known, input_rates)
        follow = np.linalg.lstsq(slopes, -drift, rcond=1e-10)[0]
        left = slopes @ follow + drift
        size = max(1.0, float(np.max(np.abs(drift))), float(np.max(np.abs(follow))))
        drifting = float(np.max(np.abs(left))) / size
        error = max(error, drifting)
        end = End.AGREES if drifting < DRIFT else End.DISAGREES
    return replace(trial, end=end, error=error)


def _power_error(graph: FinishedGraph, outputs: Array) -> float:
    """Return the largest power lost in a junction or two-port, of what flows there."""
    count = len(graph.bonds)
    power = outputs[:count] * outputs[count : 2 * count]
    worst = 0.0
    for node in graph.nodes:
        if not isinstance(
            node,
            kinds.ZeroJunction | kinds.OneJunction | kinds.Transformer | kinds.Gyrator,
        ):
            continue
        signed = [
            power[i] * (1.0 if bond.head == node.name else -1.0)
            for i, bond in enumerate(graph.bonds)
            if node.name in (bond.tail, bond.head)
        ]
        size = max(1.0, float(np.sum(np.abs(signed))))
        worst = max(worst, abs(float(np.sum(signed))) / size)
    return worst


def graph_line(seed: int) -> dict[str, Any]:
    """Try the machine of a seed; return its trial as a record for a JSON line."""
    trial = try_machine(seed)
    return {**asdict(trial), "end": trial.end.name}
