"""In words: which parameters are known only together, and how.

Directions along which nothing changes are collected over several parameter values. One
that is the same everywhere in relative steps leaves products of powers, "m and k only
as k/m"; one that is the same everywhere in absolute steps leaves sums, "b_1 and b_2
only as b_1 + b_2". The exponents come from the reduced row echelon form of the null
space, whose entries are then small fractions.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FLAT = 1e-9
"""Of the largest eigenvalue of a Hessian with unit diagonal."""

DEAD = 1e-18
"""Of the largest squared relative effect: one that rounding alone could make."""

PART = 0.05
"""A parameter takes part in a direction from this share of the largest on."""

DENOMINATOR = 4
ROUNDED = 0.02

NOTHING = 1e-9
"""A value that is so small beside its error is zero."""

BARELY, BETTER, EASIER = 1 / 3, 5.0, 1.0
"""A relative std that says little; how much better a combination must be; and how much
better one of three must be than one of two."""

AT_A_TIME = 10_000
"""Choices of parameters looked at together: some megabytes."""


@dataclass(frozen=True, slots=True, eq=False)
class Local:
    """Parameter values and the Hessian of the data there (states eliminated)."""

    theta: Array
    hessian: Array


def size_of(theta: Array) -> Array:
    """Return what a relative step is relative to: the value, or 1 for zero."""
    size: Array = np.where(theta == 0.0, 1.0, np.abs(theta))
    return size


def flat_directions(hessian: Array) -> Array:
    """Return a basis, row by row, of the steps that do not change the cost.

    Judged with the diagonal scaled to one, so that units do not matter.
    """
    n = len(hessian)
    if n == 0:
        return np.zeros((0, 0))
    diagonal = np.maximum(np.diag(hessian), 0.0)
    dead = diagonal <= DEAD * max(diagonal.max(), 1e-300)
    rows = [np.eye(n)[i] for i in np.flatnonzero(dead)]
    alive = np.flatnonzero(~dead)
    if len(alive):
        scale = np.sqrt(diagonal[alive])
        own = hessian[np.ix_(alive, alive)] / np.outer(scale, scale)
        values, vectors = np.linalg.eigh(own)
        for vector in vectors[:, values <= FLAT * values[-1]].T:
            row = np.zeros(n)
            row[alive] = vector / scale
            rows.append(row / np.linalg.norm(row))
    return np.array(rows).reshape(len(rows), n)


def taking_part(null: Array, hessian: Array) -> NDArray[np.bool_]:
    """Return which parameters take part in flat directions.

    By their steps, or by what these do: one that is far from zero makes small relative
    steps beside one that is near zero and stands for as much.
    """
    if not len(null):
        return np.zeros(len(hessian), bool)
    effect = np.abs(null) * np.sqrt(np.maximum(np.diag(hessian), 0.0))
    most = effect.max(axis=1, keepdims=True)
    shares = np.divide(effect, most, out=np.zeros_like(effect), where=most > 0.0)
    taking: NDArray[np.bool_] = np.maximum(np.abs(null), shares).max(axis=0) > PART
    return taking


def relative(local: Local) -> Array:
    """Return the Hessian in relative steps."""
    size = size_of(local.theta)
    hessian: Array = local.hessian * np.outer(size, size)
    return hessian


def combination_sentences(
    names: Sequence[str], points: Sequence[Local], where: str
) -> tuple[str, ...]:
    """Return one sentence for everything that `where` does not determine.

    Parameters
    ----------
    points
        The same problem at several parameter values, the estimate first.
    where
        What was looked at, as in "has no effect on *these recordings*".
    """
    at_all = [flat_directions(relative(point)) for point in points]
    fewest = min(len(null) for null in at_all)
    if fewest == 0:
        return ()
    in_powers = flat_directions(np.sum([_unit(relative(p)) for p in points], axis=0))
    in_sums = flat_directions(np.sum([_unit(p.hessian) for p in points], axis=0))
    dead = [i for i in range(len(names)) if _alone(i, in_powers) and _alone(i, in_sums)]
    sentences = [f"{names[i]} has no effect on {where}" for i in dead]
    powers = _without(in_powers, dead)
    told = _monomials(names, powers)
    sentences += told
    left = fewest - len(dead) - len(powers) if told or not len(powers) else 0
    sums = _without(in_sums, dead)
    if left > 0 and len(sums):
        found = _sums(names, sums)
        sentences += found
        left -= len(sums) if found else 0
    if left > 0 or (len(powers) and not told):
        null = _without(at_all[0], dead)
        sentences.append(_unnamed(names, null if len(null) else at_all[0], where))
    return tuple(sentences)


def _unit(hessian: Array) -> Array:
    return hessian / max(float(np.abs(hessian).max()), 1e-300)


def _alone(i: int, null: Array) -> bool:
    """Return whether parameter `i` may change alone."""
    if not len(null):
        return False
    unit = np.zeros(null.shape[1])
    unit[i] = 1.0
    basis = np.linalg.qr(null.T)[0]
    return float(np.linalg.norm(basis @ (basis.T @ unit) - unit)) < 1e-6


def _without(null: Array, dead: Sequence[int]) -> Array:
    """Return the flat directions with those of dead parameters taken out."""
    if not len(null):
        return null
    rest = null.copy()
    rest[:, list(dead)] = 0.0
    _, sizes, rows = np.linalg.svd(rest)
    kept: Array = rows[: len(sizes)][sizes > 1e-6]
    return kept


def echelon(null: Array) -> tuple[Array, list[int]]:
    """Return the reduced row echelon form and its pivots, later columns first.

    Later parameters are the ones expressed by earlier ones.
    """
    rows, pivots = null.copy(), list[int]()
    for column in range(null.shape[1]):
        at = len(pivots)
        if at == len(rows):
            break
        best = at + int(np.argmax(np.abs(rows[at:, column])))
        if abs(rows[best, column]) < 1e-4 * np.abs(rows[at:]).max():
            continue
        rows[[at, best]] = rows[[best, at]]
        rows[at] /= rows[at, column]
        others = np.arange(len(rows)) != at
        rows[others] -= np.outer(rows[others, column], rows[at])
        pivots.append(column)
    return rows, pivots


def _kept(names: Sequence[str], null: Array) -> list[dict[str, Fraction]] | None:
    """Return what stays the same along all directions, None where not in fractions.

    With the echelon rows moving pivot p by 1 and the others j by R_pj, each
    e_j - Σ_p R_pj e_p stays.
    """
    rows, pivots = echelon(null)
    found = []
    for j in range(len(names)):
        if j in pivots or np.abs(rows[:, j]).max() < ROUNDED:
            continue
        weights = {names[j]: Fraction(1)}
        for row, pivot in zip(rows, pivots, strict=True):
            share = Fraction(float(row[j])).limit_denominator(DENOMINATOR)
            if abs(float(share) - row[j]) > ROUNDED:
                return None
            if share:
                weights[names[pivot]] = -share
        common = math.lcm(*(weight.denominator for weight in weights.values()))
        ordered = [name for name in names if name in weights]
        found.append({name: weights[name] * common for name in ordered})
    return found


def _groups(kept: list[dict[str, Fraction]]) -> list[list[dict[str, Fraction]]]:
    """Return the combinations that share a parameter, together."""
    groups: list[list[dict[str, Fraction]]] = []
    for own in kept:
        touching = [g for g in groups if any(own.keys() & other for other in g)]
        merged = [item for g in touching for item in g] + [own]
        groups = [g for g in groups if g not in touching] + [merged]
    return groups


def _monomials(names: Sequence[str], null: Array) -> list[str]:
    kept = _kept(names, null) if len(null) else []
    return [_only_as(names, group, _monomial) for group in _groups(kept or [])]


def _sums(names: Sequence[str], null: Array) -> list[str]:
    kept = _kept(names, null) if len(null) else []
    return [_only_as(names, group, _sum) for group in _groups(kept or [])]


def _only_as(names, group, written) -> str:  # type: ignore[no-untyped-def]
    involved = [name for name in names if any(name in own for own in group)]
    return f"{listed(involved)} only as {listed([written(own) for own in group])}"


def listed(words: Sequence[str]) -> str:
    """Return "a", "a and b" or "a, b and c"."""
    if len(words) == 1:
        return words[0]
    return f"{', '.join(words[:-1])} and {words[-1]}"


def _monomial(weights: dict[str, Fraction]) -> str:
    """Return a product of powers such as ``k/m`` or ``k_m^2/(R*J)``."""
    above = [_power(name, w) for name, w in weights.items() if w > 0]
    below = [_power(name, -w) for name, w in weights.items() if w < 0]
    top = "*".join(above) or "1"
    if not below:
        return top
    return f"{top}/{below[0]}" if len(below) == 1 else f"{top}/({'*'.join(below)})"


def _power(name: str, exponent: Fraction) -> str:
    return name if exponent == 1 else f"{name}^{exponent}"


def _sum(weights: dict[str, Fraction]) -> str:
    """Return a sum such as ``b_1 + b_2`` or ``a - 2 c``."""
    text = ""
    if all(weight <= 0 for weight in list(weights.values())[:1]):
        weights = {name: -weight for name, weight in weights.items()}
    for name, weight in weights.items():
        size = "" if abs(weight) == 1 else f"{abs(weight)} "
        sign = "-" if weight < 0 else "+"
        text += f" {sign} {size}{name}" if text else f"{size}{name}"
    return text


def _unnamed(names: Sequence[str], null: Array, where: str) -> str:
    """Return the sentence for directions that are no product and no sum."""
    moving = [
        name
        for name, weight in zip(names, np.abs(null).max(axis=0), strict=True)
        if weight > 0.05 * np.abs(null).max()
    ]
    fewer = len(moving) - len(null)
    if fewer <= 0:
        have = "has" if len(moving) == 1 else "have"
        return f"{listed(moving)} {have} hardly any effect on {where}"
    several = f"{fewer} combination{'s' if fewer != 1 else ''}"
    stated = "one" if len(null) == 1 else len(null)
    return (
        f"{listed(moving)} only in {several}: state {stated} of them to know the rest"
    )


def barely_known(
    names: Sequence[str], theta: Array, covariance: Array, std: Array
) -> tuple[str, ...]:
    """Return what is known far better together than alone.

    Of parameters known to less than a third of their value, the product of small
    powers of two or three of them that is known best, if five times better.
    """
    size = np.abs(theta)
    # What is nothing beside its own error has no share of itself.
    some = size > NOTHING * np.maximum(std, 1e-300)
    share = np.divide(std, size, out=np.zeros(len(size)), where=some)
    weak = [i for i in range(len(names)) if share[i] > BARELY]
    scale = np.where(some, size, 1.0)
    inner = covariance / scale / scale[:, None]
    best: tuple[float, tuple[int, ...], Array] | None = None
    for count in range(2, min(3, len(weak)) + 1):
        choices = np.array(list(combinations(weak, count)))
        weights = np.array(list(_exponents(count)))
        # In parts, so that memory stays small among many parameters.
        parts = np.array_split(choices, 1 + len(choices) // AT_A_TIME)
        found = min(
            (_told_best(inner, part, weights) for part in parts), key=itemgetter(0)
        )
        if best is None or found[0] < best[0] / (1.0 + EASIER * (count > 2)):
            best = found
    if best is None or best[0] * BETTER > min(share[i] for i in best[1]):
        return ()
    told, members, weights = best
    chosen = [names[i] for i in members]
    alone = [
        f"{name} to ± {_percent(share[i])}"
        for name, i in zip(chosen, members, strict=True)
    ]
    powers = [Fraction(int(weight)) for weight in weights]
    together = _monomial(dict(zip(chosen, powers, strict=True)))
    sentence = f"known: {listed(alone)}, but {together} to ± {_percent(told)}"
    return (sentence,)


def _told_best(
    inner: Array, choices: NDArray[np.int64], weights: Array
) -> tuple[float, tuple[int, ...], Array]:
    """Return the least error of a weighted sum, with its members and weights.

    Parameters
    ----------
    choices, weights
        A row for each choice of parameters and of weights.
    """
    blocks = inner[choices[:, :, None], choices[:, None, :]]
    variance = ((blocks @ weights.T) * weights.T).sum(axis=1)
    told = np.sqrt(np.maximum(np.where(np.isnan(variance), np.inf, variance), 0.0))
    row, column = np.unravel_index(np.argmin(told), told.shape)
    members = tuple(int(i) for i in choices[row])
    return float(told[row, column]), members, weights[column]


def _exponents(count: int) -> Iterator[tuple[int, ...]]:
    """Yield small whole exponents, none zero, the first positive."""
    for powers in product((1, -1, 2, -2), repeat=count):
        if powers[0] > 0 and math.gcd(*powers) == 1:
            yield powers


def _percent(share: float) -> str:
    """Return it to two digits, as a number that a person would write."""
    return f"{float(f'{100 * share:.2g}'):g} %"
