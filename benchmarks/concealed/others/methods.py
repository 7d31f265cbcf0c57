"""Three methods without a graph: all terms by AIC, a Gaussian process, and SINDy."""

import warnings

import numpy as np
from scipy.signal import savgol_filter

from benchmarks.concealed.effects import Effect
from benchmarks.concealed.machine import Array, Machine, Site
from benchmarks.concealed.others.base import FittedBase, Played
from benchmarks.concealed.others.said import Said, rms
from benchmarks.concealed.recording import scales_of, simulate
from benchmarks.concealed.strength import noise_levels

SMALL = 0.01
COORDINATE_TERMS = (
    "coulomb_friction", "viscous_friction", "quadratic_drag", "spring",
    "hardening_spring", "gravity", "constant_bias",
)  # fmt: skip
STORE_TERMS = ("leak", "square_root_orifice", "constant_bias")
POINTS = 400


def every_term_by_aic(base: FittedBase) -> Said:
    """Add every term of a library everywhere, least squares, drop terms by AIC.

    A term enters by the change of the readings that a small amount of it makes.
    """
    machine = base.machine
    scales = scales_of(machine, [p.plan for p in base.train])
    sites = [
        Site(word=word, place=place.name)
        for place in machine.places
        for word in (COORDINATE_TERMS if place.cell < 0 else STORE_TERMS)
    ]

    def design(played: Played) -> Array:
        plain = base.simulated(played)
        columns = [
            (
                simulate(
                    machine, played.plan, [Effect(site, SMALL)],
                    values=base.values, scales=scales, exact=True,
                ).readings
                - plain
            ) / SMALL / noise_levels(machine)
            for site in sites
        ]  # fmt: skip
        return np.array([*columns, *base.tangents(played)])

    designs = [design(p) for p in base.train]
    A = np.concatenate([d.reshape(len(d), -1).T for d in designs])
    b = np.concatenate([base.residual(p).reshape(-1) for p in base.train])
    sizes = np.linalg.norm(A, axis=0)
    sizes[sizes == 0.0] = 1.0
    A = A / sizes
    kept, needed = _backward(A, b, list(range(len(sites))), len(sites))
    columns = [*kept, *range(len(sites), A.shape[1])]
    solution, *_ = np.linalg.lstsq(A[:, columns], b, rcond=1e-8)
    rest = base.residual(base.held_out)
    flat = design(base.held_out)[columns].reshape(len(columns), -1).T
    after = rest.reshape(-1) - flat / sizes[columns] @ solution
    finding = None
    if needed is not None:
        finding = sites[needed].word, sites[needed].place
    return Said(finding, rms(rest), rms(after), len(kept))


def _backward(
    A: Array, b: Array, kept: list[int], fixed: int
) -> tuple[list[int], int | None]:
    """Return the terms left when none can go without AIC growing, and the neediest.

    That is the one without which AIC grows most: terms that resemble each other share
    their coefficients in any way.
    """
    G, c, total = A.T @ A, A.T @ b, float(b @ b)

    def aic(terms: list[int]) -> float:
        columns = [*terms, *range(fixed, A.shape[1])]
        ridge = 1e-9 * np.eye(len(columns))
        x = np.linalg.solve(G[np.ix_(columns, columns)] + ridge, c[columns])
        left = max(total - float(x @ c[columns]), 1e-12 * total)
        return float(b.size * np.log(left / b.size) + 2 * len(columns))

    best = aic(kept)
    while kept:
        scores = [aic([k for k in kept if k != term]) for term in kept]
        if min(scores) >= best:
            return kept, kept[int(np.argmax(scores))]
        best = min(scores)
        kept = [k for k in kept if k != kept[int(np.argmin(scores))]]
    return kept, None


def gaussian_process(base: FittedBase) -> Said:
    """Learn the residual as a function of inputs, outputs and their rates.

    It has no places and no words.
    """
    from sklearn.gaussian_process import GaussianProcessRegressor  # noqa: PLC0415
    from sklearn.gaussian_process.kernels import RBF, WhiteKernel  # noqa: PLC0415

    def features(played: Played) -> Array:
        outputs = base.simulated(played)
        return np.column_stack(
            (played.plan.feed, outputs, np.gradient(outputs, axis=0))
        )

    X = np.concatenate([features(p) for p in base.train])
    r = np.concatenate([base.residual(p) for p in base.train])
    mean, spread = X.mean(axis=0), X.std(axis=0) + 1e-30
    chosen = np.random.default_rng(0).choice(len(X), POINTS, replace=False)
    kernel = 10.0 * RBF(np.ones(X.shape[1])) + WhiteKernel(1.0)
    model = GaussianProcessRegressor(kernel, normalize_y=True, random_state=0)
    with warnings.catch_warnings():
        # A length that runs to its bound is a feature that says nothing.
        warnings.simplefilter("ignore")
        model.fit((X[chosen] - mean) / spread, r[chosen])
    rest = base.residual(base.held_out)
    guess = model.predict((features(base.held_out) - mean) / spread)
    after = rest - guess.reshape(rest.shape)
    return Said(None, rms(rest), rms(after), 0, "has neither places nor words")


STATES = {
    "pendulum": ("q",),
    "cart": ("q",),
    "two_mass_drive": ("q", "q"),
    "flegx_drive": ("q",),
    "dc_motor": ("v", "v"),
    "two_tanks": ("z", "z"),
    "thermal_zones": ("z", "z"),
}
"""What each output is; a machine that is not listed has states that no sensor sees."""

WORDS = {
    "sign": "coulomb_friction",
    "quadratic": "quadratic_drag",
    "linear_flow": "viscous_friction",
    "linear": "spring",
    "cubic": "hardening_spring",
    "sine": "gravity",
    "one": "constant_bias",
}


def sindy(base: FittedBase) -> Said:
    """Fit sparse terms to the missing effort of every equation (Kaheman et al. 2019).

    Derivatives come from a Savitzky-Golay filter of the measured outputs.
    """
    import pysindy  # noqa: PLC0415

    machine = base.machine
    if machine.name not in STATES:
        rest = rms(base.residual(base.held_out))
        return Said(None, rest, rest, 0, "not applicable: a state is not measured")
    pieces = [_missing(base, p) for p in base.train]
    X, missing = (np.concatenate([p[i] for p in pieces]) for i in (0, 1))
    held_X, held = _missing(base, base.held_out)
    size = X.std(axis=0) + 1e-30
    best: tuple[float, int, str] = (0.0, 0, "")
    before, after, terms = 0.0, 0.0, 0
    for i in range(missing.shape[1]):
        scale = missing[:, i].std() + 1e-30
        columns, names = _library(X / size, machine, i)
        optimizer = pysindy.STLSQ(threshold=0.1, alpha=1e-6)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # no term is left: that is an answer
            optimizer.fit(columns, missing[:, [i]] / scale)
        found = np.asarray(optimizer.coef_)[0]
        explained = 1.0 - np.var(missing[:, i] / scale - columns @ found)
        strongest = int(np.argmax(np.abs(found) * columns.std(axis=0)))
        if np.any(found) and explained > best[0]:
            best = float(explained), i, names[strongest]
        guess = _library(held_X / size, machine, i)[0] @ found
        before += float(np.mean((held[:, i] / scale) ** 2))
        after += float(np.mean((held[:, i] / scale - guess) ** 2))
        terms += int(np.count_nonzero(found))
    note = "held-out errors are of the missing effort, not of a simulation"
    finding = (WORDS[best[2]], machine.places[best[1]].name) if best[2] else None
    return Said(finding, float(np.sqrt(before)), float(np.sqrt(after)), terms, note)


def _missing(base: FittedBase, played: Played) -> tuple[Array, Array]:
    """Return (q, v or z) per equation and the effort or flow its balance lacks."""
    machine, y = base.machine, played.readings
    dt, n = 1.0 / machine.rate, machine.coordinates
    rates = [savgol_filter(y, 21, 3, deriv=k, delta=dt, axis=0) for k in range(3)]
    kind = STATES[machine.name][0]
    p = np.array([base.values[number.name] for number in machine.numbers])
    count = n if kind != "z" else machine.stores
    if kind == "q":
        q, v, a = rates
    else:
        q, v, a = np.cumsum(y, axis=0) * dt, rates[0], rates[1]
    weights = np.array([base.values[c] for c in machine.free if c.startswith("C_")])
    F, g, load, stored = np.zeros(n), np.zeros(machine.stores), np.zeros(8), np.zeros(8)
    M, rest = np.zeros((n, n)), np.zeros((len(y), count))
    none = np.zeros(0)
    for k in range(len(y)):
        F[:], g[:] = 0.0, 0.0
        z = rates[0][k] * weights if kind == "z" else np.zeros(machine.stores)
        qk, vk = (none, none) if kind == "z" else (q[k].copy(), v[k].copy())
        machine.forces(qk, vk, z, played.plan.feed[k], p, np.zeros(n), F, g, load,
                       stored)  # fmt: skip
        if kind == "z":
            rest[k] = g - rates[1][k] * weights
        else:
            machine.masses(qk, vk, p, M)
            rest[k] = F - M @ a[k]
    X = np.column_stack((rates[0], rates[0]) if kind == "z" else (q, v))
    return X, rest


def _library(X: Array, machine: Machine, i: int) -> tuple[Array, list[str]]:
    """Return the terms of one equation in its own variables, and their names."""
    n = X.shape[1] // 2
    q, x = X[:, i], X[:, n + i]
    terms = {
        "one": np.ones(len(X)),
        "linear_flow": x,
        "quadratic": x * np.abs(x),
        "sign": np.sign(x),
    }
    if STATES[machine.name][0] == "q":
        terms |= {"linear": q, "cubic": q**3, "sine": np.sin(q)}
    return np.column_stack(list(terms.values())), list(terms)
