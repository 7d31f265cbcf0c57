"""The place of what is missing is found where signals alone could not tell it."""

import numpy as np
import pytest
from two_inertia_drive import PLACES, drive, recorded

from bondgraph import FitSettings, Sdirk2, Windows
from bondgraph.diagnosis.location.locate import locate
from bondgraph.diagnosis.location.records import LocationStatus
from bondgraph.diagnosis.location.smoothing import Priors, smooth
from bondgraph.diagnosis.virtual.chain import linear_chain
from bondgraph.diagnosis.virtual.sources import chosen_sources
from bondgraph.errors import FitError
from bondgraph.fitting.estimate import fit_model

SETTINGS = FitSettings(horizon=Windows(83), solver=Sdirk2(substeps=2))


def fitted(truth, *, load_encoder, seed=0, samples=1000):
    graph = drive(load_encoder=load_encoder)
    recording = recorded(graph, truth, seed, samples=samples)
    return fit_model(graph, [recording], SETTINGS), [recording]


@pytest.mark.parametrize(
    ("truth", "load_encoder"),
    [
        ("coulomb_load", True),
        pytest.param("coulomb_load", False, marks=pytest.mark.long),
        pytest.param("brush", False, marks=pytest.mark.long),
    ],
)
def test_the_true_place_leads(truth, load_encoder):
    location = locate(*fitted(truth, load_encoder=load_encoder))
    assert location.places[0].place in PLACES[truth], location.reasons
    assert set(PLACES[truth]) & set(location.leading)
    assert location.status in (
        LocationStatus.ONE_PLACE,
        LocationStatus.SEVERAL_PLACES,
    )
    assert location.places[0].best.share > 0.9


def test_friction_is_recovered_with_its_size_sign_and_parity():
    model, recordings = fitted("coulomb_load", load_encoder=True)
    place = locate(model, recordings, places=["load"]).at("load")
    # It opposes the motion: it takes power out, and is odd in the flow.
    assert place.power < -0.2
    own = next(r for r in place.relations if r.variable == "flow(load)")
    assert own.odd > 0.9
    curve = np.interp([-20.0, 20.0], own.argument, own.curve)
    viscous = (
        place.theta["disc_friction"] - model.graph.parameters["disc_friction"].value
    )
    assert curve[1] - curve[0] + 40 * viscous == pytest.approx(-0.024, rel=0.35)
    assert place.signal.shape == place.std.shape == (1000,)
    assert (place.std >= 0.0).all()


def test_where_nothing_is_missing_no_place_is_named():
    location = locate(*fitted("none", load_encoder=True))
    assert location.status is LocationStatus.NOTHING
    assert location.leading == ()


def test_linear_steps_give_the_simulation_and_its_sensitivities():
    model, _ = fitted("none", load_encoder=True)
    chain = linear_chain(model)
    simulated = model.problem.shots.outputs - model.residuals()
    np.testing.assert_allclose(chain.outputs, simulated, rtol=0, atol=1e-9)
    # Within a window every step arrives where the next one starts.
    assert np.abs(chain.jump[chain.inside]).max() < 1e-9
    # A virtual voltage at the armature is one at its source.
    places = [source.place for source in chain.sources]
    armature, voltage = places.index("armature"), places.index("voltage")
    np.testing.assert_allclose(
        chain.gamma[:, :, armature], chain.gamma[:, :, voltage], rtol=1e-9, atol=1e-15
    )


def test_the_smoother_agrees_with_least_squares_on_the_whole_record():
    model, _ = fitted("coulomb_load", load_encoder=True, samples=200)
    (source,) = chosen_sources(model.graph, ["load"])
    chain = linear_chain(model, (source,))
    noise = np.array([5e-4, 0.02, 5e-4])
    nq = chain.gamma_theta.shape[2]
    theta = np.full(nq, 1e-9)
    priors = Priors(noise=noise, theta=theta, offset=np.zeros(nq))
    smoothed = smooth(chain, priors)
    signal = _by_least_squares(chain, noise, smoothed)
    size = np.abs(signal).max()
    np.testing.assert_allclose(smoothed.signal, signal, rtol=0, atol=1e-4 * size)


def _by_least_squares(chain, noise, smoothed):
    """Solve for all values of the signal and the initial state at once."""
    n, ny, nx = chain.read.shape
    sigma = smoothed.size / smoothed.level
    scale = np.sqrt(np.mean(chain.states**2, axis=0))
    gains, offsets = np.zeros((n, nx, n + nx)), np.zeros((n, nx))
    gains[0, :, n:] = np.diag(10.0 * scale)
    for k in range(1, n):
        gains[k] = chain.phi[k] @ gains[k - 1]
        gains[k, :, k - 1] += chain.gamma[k, :, 0]
        offsets[k] = chain.phi[k] @ offsets[k - 1] + chain.jump[k]
    rows = np.einsum("noi,nim->nom", chain.read, gains)
    rows[np.arange(n), :, np.arange(n)] += chain.direct[:, :, 0]
    left = chain.residuals - np.einsum("noi,ni->no", chain.read, offsets)
    rows = (rows / noise[:, None]).reshape(n * ny, -1)
    time = chain.shots.time
    lags = np.abs(time[:, None] - time[None])
    covariance = sigma**2 * np.exp(-lags / smoothed.correlation_time)
    prior = np.zeros((n + nx, n + nx))
    prior[:n, :n] = np.linalg.inv(covariance)
    prior[n:, n:] = np.eye(nx)
    found = np.linalg.solve(rows.T @ rows + prior, rows.T @ (left / noise).ravel())
    return found[:n]


def test_an_unknown_place_is_refused_with_the_nearest():
    graph = drive(load_encoder=False)
    with pytest.raises(FitError, match="Did you mean load"):
        chosen_sources(graph, ["laod"])
