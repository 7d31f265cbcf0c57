"""The closed loop's answer to a unit step of the reference, and its figures.

Without delay the state moves by matrix exponentials, exact at every instant shown, in
stretches that double in length: fine where the answer is quick, and long enough for a
slow tail that a controller zero leaves beside a friction pole. With a delay the loop is
open for as long as the delay lasts, so each delay's stretch follows from the one before
(the method of steps), exactly but for a straight line between the instants shown.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from bondgraph.errors import LoopShapingError
from bondgraph.loopshaping.loop import Loop
from bondgraph.loopshaping.realisation import Matrices, realise
from bondgraph.loopshaping.zero_pole_gain import FloatArray

_POINTS = 400  # instants in a stretch, more where it oscillates
_MOST_POINTS = 20_000
_STRETCHES = 60
_SETTLED = 1e-4  # of the final value, over a whole stretch: the answer has ended
BAND = 0.02  # of the final value, for the settling time


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepResponse:
    """The output after a unit step of the reference at time zero.

    Parameters
    ----------
    final
        The value that the output tends to, from the gains at rest.
    """

    time: FloatArray
    output: FloatArray
    final: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StepFigures:
    """What a step response is usually judged by; times in seconds.

    Parameters
    ----------
    rise_time
        From 10 to 90 % of the final value.
    settling_time
        After which the output stays within 2 % of the final value.
    overshoot
        Percent of the final value.
    steady_state_error
        One minus the final value.
    """

    rise_time: float
    settling_time: float
    overshoot: float
    peak_time: float
    steady_state_error: float


def value_at_rest(loop: Loop) -> float:
    """Return the closed loop's gain from reference to output at zero frequency."""
    forward, around = loop.forward.dc_gain, loop.open_loop.dc_gain
    if math.isinf(around) and math.isfinite(forward):
        return 0.0  # an integrator in the feedback branch only
    if math.isinf(around):
        return 1 / loop.feedback.dc_gain if loop.feedback.dc_gain else math.inf
    return forward / (1 + around) if around != -1 else math.inf


def step_response(loop: Loop, *, scale: float) -> StepResponse:
    """Return the step response of a stable loop until it has settled.

    Parameters
    ----------
    scale
        A typical frequency of the loop in rad/s, such as its crossover.

    Raises
    ------
    LoopShapingError
        If the forward or the feedback branch has more zeros than poles.
    """
    for name, part in (("forward", loop.forward), ("feedback", loop.feedback)):
        if part.relative_degree < 0:
            raise LoopShapingError(
                f"The {name} branch has more zeros than poles and no step response.",
                (name,),
                "Give the controller a pole.",
            )
    final = value_at_rest(loop)
    if loop.period is not None:
        time, output = _sampled(loop, loop.period, final)
    elif loop.open_loop.delay:
        time, output = _delayed(loop, scale, final)
    else:
        time, output = _smooth(loop, scale, final)
    return StepResponse(time=time, output=output, final=final)


@dataclass(frozen=True, slots=True, eq=False)
class _Around:
    """Forward and feedback branch in one: from the error e to y and v."""

    A: FloatArray
    B: FloatArray
    Cy: FloatArray
    Cv: FloatArray
    dy: float
    dv: float


def _around(loop: Loop) -> _Around:
    """Return the loop cut open at the error."""
    ahead, back = realise(loop.forward), realise(loop.feedback)
    n, m = len(ahead.A), len(back.A)
    A = np.zeros((n + m, n + m))
    A[:n, :n], A[n:, n:] = ahead.A, back.A
    A[n:, :n] = back.B @ ahead.C
    B = np.concatenate([ahead.B, back.B @ ahead.D])[:, 0]
    Cy = np.concatenate([ahead.C[0], np.zeros(m)])
    Cv = np.concatenate([(back.D @ ahead.C)[0], back.C[0]])
    dy = float(ahead.D[0, 0])
    return _Around(A, B, Cy, Cv, dy, dy * float(back.D[0, 0]))


def _closed(cut: _Around) -> Matrices:
    """Return the loop closed: e = (r - Cv x) / (1 + dv)."""
    share = 1 / (1 + cut.dv)
    return Matrices(
        cut.A - share * np.outer(cut.B, cut.Cv),
        share * cut.B[:, None],
        (cut.Cy - share * cut.dy * cut.Cv)[None],
        np.array([[share * cut.dy]]),
    )


def _smooth(loop: Loop, scale: float, final: float) -> tuple[FloatArray, FloatArray]:
    """Return the response of a continuous loop without delay."""
    A, B, C, D = _closed(_around(loop))
    n = len(A)
    modes = np.linalg.eigvals(A) if n else np.zeros(0, dtype=complex)
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n:] = A, B
    state = np.zeros(n + 1)
    state[n] = 1.0
    row = np.append(C[0], D[0, 0])
    begin, end = 0.0, 0.05 / scale
    times, outputs = [np.zeros(1)], [np.array([row @ state])]
    largest = abs(float(row @ state))
    for _ in range(_STRETCHES):
        alive = modes[np.abs(modes.real) * begin < 14] if begin else modes
        quick = float(np.abs(alive.imag).max(initial=0.0))
        count = int(np.clip((end - begin) * quick / 0.3, _POINTS, _MOST_POINTS))
        propagate = expm(whole * ((end - begin) / count))
        values = np.empty(count)
        for k in range(count):
            state = propagate @ state
            values[k] = row @ state
        times.append(begin + (end - begin) * np.arange(1, count + 1) / count)
        outputs.append(values)
        begin, end = end, 2 * end
        largest = max(largest, float(np.abs(values).max()))
        left = float(np.ptp(np.append(values, final)))
        if begin * scale > 3 and left <= _SETTLED * max(abs(final), 1e-2 * largest):
            break
    return np.concatenate(times), np.concatenate(outputs)


def _delayed(loop: Loop, scale: float, final: float) -> tuple[FloatArray, FloatArray]:
    """Return the response of a continuous loop with a delay, by the method of steps."""
    cut = _around(loop)
    late, wait = loop.open_loop.delay, loop.forward.delay
    horizon = max(40 / scale, 10 * late)
    while True:
        per_delay = max(8, math.ceil(late * 2000 / horizon))
        time, output = _steps(cut, late, per_delay, horizon)
        tail = output[3 * len(output) // 4 :]
        spread = float(np.abs(tail - final).max())
        if spread <= 10 * _SETTLED * max(1e-12, abs(final)):
            break
        if len(time) > 2 * _MOST_POINTS:
            break
        horizon *= 2
    keep = time + wait
    before = np.zeros(1) if wait else np.zeros(0)
    return np.concatenate([before, keep]), np.concatenate([before, output])


def _steps(
    cut: _Around, late: float, per_delay: int, horizon: float
) -> tuple[FloatArray, FloatArray]:
    """Step over a grid that divides the delay; e is a straight line in between.

    Values just before and just after a grid point are kept apart, so that the jumps
    which a direct feedthrough sends around the loop stay jumps.
    """
    h = late / per_delay
    count = math.ceil(horizon / h)
    n = len(cut.A)
    whole = np.zeros((n + 2, n + 2))
    whole[:n, :n], whole[:n, n] = cut.A, cut.B
    whole[n, n + 1] = 1.0  # the slope of e
    step = expm(whole * h)[:n]
    move, level, slope = step[:, :n], step[:, n], step[:, n + 1] / h
    # e before and after t_k, and one grid point on; ones until a delay has passed.
    before, after = np.ones(count + 2 + per_delay), np.ones(count + 2 + per_delay)
    before[0] = 0.0
    states = np.zeros((count + 2, n))
    output = np.empty(count + 1)
    # What comes back was sent a delay ago: so long a stretch is known beforehand.
    for first in range(0, count + 1, per_delay - 1):
        known = slice(first, min(first + per_delay - 1, count + 1))
        sent = slice(known.start + per_delay, known.stop + per_delay)
        now = after[known]
        rise = before[known.start + 1 : known.stop + 1] - now
        forced = np.outer(now, level) + np.outer(rise, slope)
        x = states[first]
        for k, force in enumerate(forced, first + 1):
            x = move @ x + force
            states[k] = x
        measured = states[known] @ cut.Cv
        before[sent] = 1.0 - measured - cut.dv * before[known]
        after[sent] = 1.0 - measured - cut.dv * now
        output[known] = states[known] @ cut.Cy + cut.dy * now
    return np.linspace(0.0, h * count, count + 1), output


def _sampled(loop: Loop, period: float, final: float) -> tuple[FloatArray, FloatArray]:
    A, B, C, D = _closed(_around(loop))
    x = np.zeros(len(A))
    outputs: list[float] = []
    check = 256
    while len(outputs) < 20 * _MOST_POINTS:
        outputs.append(float(C[0] @ x + D[0, 0]))
        x = A @ x + B[:, 0]
        if len(outputs) == check:
            tail = np.array(outputs[check // 2 :])
            if np.abs(tail - final).max() <= _SETTLED * max(1e-12, abs(final)):
                break
            check *= 2
    return np.asarray(period * np.arange(float(len(outputs)))), np.array(outputs)


def step_figures(response: StepResponse) -> StepFigures | None:
    """Return the figures of a step response; None where it tends to zero or not at all.

    Times are read between the instants of the response by straight lines, its peak by
    a parabola; both are good to about a thousandth.
    """
    final, time = response.final, response.time
    if not math.isfinite(final) or abs(final) < 1e-9:
        return None
    share = response.output / final
    low, high = (_first_time(time, share, level) for level in (0.1, 0.9))
    outside = np.flatnonzero(np.abs(share - 1) > BAND)
    settling = 0.0
    if len(outside) and outside[-1] + 1 < len(time):
        k = int(outside[-1])
        edge = 1 + math.copysign(BAND, share[k] - 1)
        settling = _between(time, share, k, edge)
    elif len(outside):
        settling = math.inf
    peak_time, peak = _highest(time, share)
    return StepFigures(
        rise_time=high - low,
        settling_time=settling,
        overshoot=100 * max(0.0, peak - 1),
        peak_time=peak_time,
        steady_state_error=1 - final,
    )


def _first_time(time: FloatArray, share: FloatArray, level: float) -> float:
    above = np.flatnonzero(share >= level)
    if not len(above):
        return math.inf
    k = int(above[0])
    return float(time[0]) if k == 0 else _between(time, share, k - 1, level)


def _between(time: FloatArray, share: FloatArray, k: int, level: float) -> float:
    rise = share[k + 1] - share[k]
    part = 0.0 if rise == 0 else (level - share[k]) / rise
    return float(time[k] + min(max(part, 0.0), 1.0) * (time[k + 1] - time[k]))


def _highest(time: FloatArray, share: FloatArray) -> tuple[float, float]:
    k = int(share.argmax())
    if not 0 < k < len(share) - 1:
        return float(time[k]), float(share[k])
    t, y = time[k - 1 : k + 2], share[k - 1 : k + 2]
    a, b, c = np.polyfit(t - t[1], y, 2)
    if a >= 0:
        return float(time[k]), float(share[k])
    return float(t[1] - b / (2 * a)), float(c - b * b / (4 * a))
