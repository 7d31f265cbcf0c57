"""Several clocks, gaps and longer steps: nothing invented, nothing aliased."""

import numpy as np
import pytest

from bondgraph import BondGraph, I, R, Se, bind_to, read_recording
from bondgraph.errors import RecordingError
from bondgraph.recordings.clocks import clock_offset, on_one_clock
from bondgraph.recordings.noise import estimate_noise
from bondgraph.recordings.recording import Recording
from bondgraph.recordings.resampling import resample


def recording(name, time, **channels):
    return Recording.from_arrays(
        name, time, {key: (values, "m") for key, values in channels.items()}
    )


def chirp(time):
    return np.sin(2 * np.pi * (0.3 + 0.2 * time) * time)


FAST, SLOW = np.arange(0, 10, 0.01), np.arange(0.003, 10, 0.05)


def test_two_rates_side_by_side_have_gaps_and_no_inventions():
    fast, slow = (
        recording("a", FAST, x=chirp(FAST)),
        recording("b", SLOW, y=chirp(SLOW)),
    )
    both = on_one_clock([fast, slow])
    x, y = both.values("x")[:, 0], both.values("y")[:, 0]
    assert np.isfinite(x).sum() == FAST.size
    np.testing.assert_array_equal(y[np.isfinite(y)], chirp(SLOW))
    np.testing.assert_allclose(both.time[np.isfinite(y)], SLOW)


def test_a_command_is_held_and_starts_where_it_is_known():
    fast = recording("a", FAST, x=chirp(FAST))
    command = recording("b", SLOW + 0.5, u=np.round(chirp(SLOW)))
    both = on_one_clock([fast, command], held=("u",))
    u = both.values("u")[:, 0]
    assert np.isfinite(u).all()
    assert both.time[0] == pytest.approx(0.503)
    later = both.time > 1.02
    row = np.searchsorted(SLOW + 0.5, both.time[later] + 1e-9, side="right") - 1
    np.testing.assert_array_equal(u[later], np.round(chirp(SLOW))[row])


def test_what_cannot_be_put_on_one_clock_is_refused():
    one = recording("one", FAST, x=chirp(FAST))
    with pytest.raises(RecordingError, match="have a channel 'x'"):
        on_one_clock([one, one])
    with pytest.raises(RecordingError, match="do not overlap"):
        on_one_clock([one, recording("two", FAST + 50, y=chirp(FAST))])
    with pytest.raises(RecordingError, match="held names 'u'"):
        on_one_clock([one], held=("u",))


@pytest.mark.parametrize("true", [0.0, 0.0437, -0.32])
def test_the_offset_of_a_clock_is_found_within_its_error(true):
    rng = np.random.default_rng(3)
    other = SLOW + true
    x = chirp(FAST) + 0.02 * rng.normal(size=FAST.size)
    y = 1.3 * chirp(SLOW) + 0.2 + 0.02 * rng.normal(size=SLOW.size)
    found = clock_offset(
        recording("a", FAST, x=x), recording("b", other, x=y), "x", most=1.0
    )
    assert abs(found.seconds - true) < 4 * found.std
    assert found.std < 2e-3
    assert found.correlation > 0.99


def test_clocks_that_saw_different_things_are_refused():
    rng = np.random.default_rng(0)
    a = recording("a", FAST, x=rng.normal(size=FAST.size))
    b = recording("b", FAST, x=rng.normal(size=FAST.size))
    with pytest.raises(RecordingError, match="do not show the same motion"):
        clock_offset(a, b, "x", most=0.5)


def test_a_longer_step_keeps_slow_motion_and_removes_what_would_alias():
    fast = np.sin(2 * np.pi * 0.5 * FAST)
    noise = np.sin(2 * np.pi * 9.3 * FAST)  # aliases to 0.7 Hz at a step of 0.1 s
    new = resample(recording("a", FAST, slow=fast, both=fast + noise), 0.1)
    np.testing.assert_allclose(
        new.values("slow")[:, 0], np.sin(2 * np.pi * 0.5 * new.time), atol=2e-3
    )
    np.testing.assert_allclose(
        new.values("both")[:, 0], np.sin(2 * np.pi * 0.5 * new.time), atol=5e-3
    )


def test_uneven_steps_and_gaps_survive_a_longer_step():
    rng = np.random.default_rng(1)
    time = np.cumsum(rng.uniform(0.005, 0.015, 1500))
    time[700:] += 3.0
    new = resample(recording("a", time, x=np.sin(time)), 0.1)
    np.testing.assert_allclose(new.values("x")[:, 0], np.sin(new.time), atol=5e-3)
    assert np.diff(new.time).max() > 3.0
    with pytest.raises(RecordingError, match="would invent data"):
        resample(new, 0.01)


def test_missing_cells_are_kept_as_gaps_of_their_channel(tmp_path):
    path = tmp_path / "r.csv"
    rows = [f"{t:.2f},{t:.2f},{'' if i % 3 else t:}" for i, t in enumerate(FAST[:60])]
    path.write_text("time [s],force [N],speed [m/s]\n" + "\n".join(rows))
    with pytest.raises(RecordingError, match='gaps="keep"'):
        read_recording(path)
    kept = read_recording(path, gaps="keep")
    assert len(kept) == 60
    assert kept.notes == ("40 samples of speed with missing values are kept as gaps.",)
    assert np.isfinite(kept.values("speed")).sum() == 20
    assert "nan" not in kept._repr_html_()
    bound = bind_to(cart(), kept)
    assert np.isfinite(bound.outputs).sum() == 20
    assert kept.converted("speed", "mm/s").channel("speed").gaps
    path.write_text(path.read_text().replace("[m/s]", "[N]").replace("[N]", "[m/s]", 1))
    swapped = read_recording(path, gaps="keep")
    with pytest.raises(RecordingError, match=r"Input 'force' .* not measured in 40"):
        bind_to(cart(), swapped, mapping={"force": "speed", "speed": "force"})


def cart():
    graph = BondGraph("cart", domain="translation")
    graph.one("cart", Se("force"), I("m"), R("b"))
    graph.measure("speed", flow="cart", unit="m/s")
    return graph.finish()


def test_noise_is_read_from_the_samples_that_were_measured():
    rng = np.random.default_rng(5)
    x = np.sin(FAST) + 0.01 * rng.normal(size=FAST.size)
    x[::2] = np.nan
    assert estimate_noise(FAST, x).std == pytest.approx(0.01, rel=0.1)
