"""Large files in blocks, HDF5, MAT 7.3, xarray and dates: read right or refused."""

import resource

import numpy as np
import pytest
from scipy.io import savemat

from bondgraph import read_recording
from bondgraph.errors import RecordingError
from bondgraph.recordings import csv_table, files
from bondgraph.recordings.frames import from_pandas, from_xarray
from bondgraph.recordings.recording import Recording

h5py = pytest.importorskip("h5py")
pd = pytest.importorskip("pandas")
xr = pytest.importorskip("xarray")

TIME = np.arange(40) * 0.025
DRIVE = np.sin(TIME)


def drive() -> Recording:
    return Recording.from_arrays(
        "drive", TIME, {"u": (DRIVE, "N"), "y": (np.cos(TIME), "mm")}
    )


def hdf5(path, units=True, **datasets):
    with h5py.File(path, "w") as file:
        for name, (values, unit) in datasets.items():
            item = file.create_dataset(name.replace("__", "/"), data=values)
            if units:
                item.attrs["units"] = unit
    return path


def test_blocks_of_a_csv_give_what_the_whole_gives(tmp_path, monkeypatch):
    path = tmp_path / "r.csv"
    rows = [f"{t:.6f},{u:.9g},{-u:.9g}" for t, u in zip(TIME, DRIVE, strict=True)]
    path.write_text("time [s],u [N],y [m]\n" + "\n".join(rows))
    whole = read_recording(path)
    monkeypatch.setattr(csv_table, "BLOCK", 100)
    cut = read_recording(path)
    np.testing.assert_array_equal(whole.values(), cut.values())
    np.testing.assert_array_equal(whole.time, cut.time)
    assert whole.sha256 == cut.sha256


def test_a_fault_beyond_the_first_block_is_named_by_its_line(tmp_path, monkeypatch):
    monkeypatch.setattr(csv_table, "BLOCK", 60)
    path = tmp_path / "r.csv"
    rows = [f"{t:.3f},{u:.3f}" for t, u in zip(TIME, DRIVE, strict=True)]
    rows[30] = "0.750,oops"
    path.write_text("\n\ntime [s],u [N]\n\n" + "\n".join(rows) + "\n")
    with pytest.raises(RecordingError, match=r"Line 35 of .* has 'oops'"):
        read_recording(path)
    rows[30] = "0.750,"
    path.write_text("\n\ntime [s],u [N]\n\n" + "\n".join(rows) + "\n")
    with pytest.raises(RecordingError, match="first nan at line 35"):
        read_recording(path)


def test_a_byte_that_is_no_text_is_named_by_its_line(tmp_path):
    path = tmp_path / "r.csv"
    rows = [f"{t:.3f},1".encode() for t in TIME]
    rows[20] = b"0.5,\xb5"
    path.write_bytes(b"time [s],u [N]\n" + b"\n".join(rows))
    with pytest.raises(RecordingError, match=r"Line 22 .* 0xb5, which is not UTF-8"):
        read_recording(path)


def test_a_million_rows_are_read_in_little_more_than_their_numbers(tmp_path):
    path = tmp_path / "long.csv"
    n = 1_000_000
    time = np.arange(n) * 1e-3
    block = "\n".join(f"{t:.3f},{t % 7:.4f},{t % 3:.4f}" for t in time)
    path.write_text("time [s],u [N],y [m]\n" + block)
    del block
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    recording = read_recording(path, channels=("u",))
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert len(recording) == n
    assert recording.values("u")[7500, 0] == pytest.approx(0.5)
    assert after - before < 400_000  # KiB; the file and its text at once took more


def test_a_small_file_that_unpacks_to_gigabytes_is_refused_before_it_does(
    tmp_path, monkeypatch
):
    path = tmp_path / "r.h5"
    with h5py.File(path, "w") as file:
        for name, unit in (("time", "s"), ("x", "m")):
            # Chunks never written take no room and read as zeros.
            item = file.create_dataset(name, (4_000_000_000,), "f8", chunks=(4096,))
            item.attrs["units"] = unit
    with pytest.raises(RecordingError, match=r"MB and would unpack to 32 GB"):
        read_recording(path)
    monkeypatch.setattr(files, "MOST_UNPACKED", 1 << 20)
    zeros = pd.DataFrame({"time [s]": np.zeros(200_000), "x [m]": np.zeros(200_000)})
    zeros.to_parquet(tmp_path / "r.parquet")
    with pytest.raises(RecordingError, match=r"would unpack to 0\.0032 GB of numbers"):
        read_recording(tmp_path / "r.parquet")
    savemat(tmp_path / "r.mat", {"x": np.zeros(200_000)}, do_compression=True)
    mapping = {"time": "x [s]", "y": "x [m]"}
    with pytest.raises(RecordingError, match=r"would unpack to 0\.0016 GB of numbers"):
        read_recording(tmp_path / "r.mat", mapping=mapping)
    # As large, of numbers that differ as a sensor's do: only their size is told.
    rows = np.arange(200_000)
    noise = np.random.default_rng(1).standard_normal(200_000)
    full = pd.DataFrame({"time [s]": 0.1 * rows, "x [m]": noise})
    full.to_parquet(tmp_path / "full.parquet")
    found = read_recording(tmp_path / "full.parquet")
    np.testing.assert_array_equal(found.channel("x").values, noise)


def test_a_refusal_lists_as_many_names_as_a_line_holds(tmp_path):
    path = tmp_path / "wide.csv"
    names = ",".join(f"c{i:05d} [m]" for i in range(20_000))
    path.write_text(f"time [s],{names}\n" + "1," * 20_000 + "1\n")
    with pytest.raises(RecordingError, match=r"c00049 and 19951 more") as refused:
        read_recording(path, channels=["qqq"])
    assert len(str(refused.value)) < 1000


def test_hdf5_datasets_have_names_units_and_columns(tmp_path):
    path = hdf5(
        tmp_path / "r.h5",
        time=(TIME, "s"),
        drive__force=(DRIVE, "N"),
        two=(np.column_stack([DRIVE, 2 * DRIVE]), b"m"),
    )
    recording = read_recording(
        path,
        mapping={"F": "drive/force", "second": "two(:,2)"},
        channels=("F", "second"),
    )
    assert [(c.name, c.unit) for c in recording.channels] == [
        ("F", "N"),
        ("second", "m"),
    ]
    np.testing.assert_allclose(recording.values("second")[:, 0], 2 * DRIVE)
    with pytest.raises(RecordingError, match=r"'two' of .* is a 40x2 array"):
        read_recording(path, channels=("two",))


def test_hdf5_without_units_needs_a_mapping(tmp_path):
    path = hdf5(tmp_path / "r.h5", units=False, time=(TIME, ""), x=(DRIVE, ""))
    with pytest.raises(RecordingError, match="does not say which"):
        read_recording(path)
    mapped = read_recording(path, mapping={"time": "time [s]", "x": "x [m]"})
    np.testing.assert_allclose(mapped.values("x")[:, 0], DRIVE)


def test_links_out_of_an_hdf5_file_and_objects_are_not_followed(tmp_path):
    hdf5(tmp_path / "other.h5", secret=(DRIVE, "N"))
    path = hdf5(tmp_path / "r.h5", time=(TIME, "s"), u=(DRIVE, "N"))
    with h5py.File(path, "a") as file:
        file["secret"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "/secret")
        file["words"] = ["a", "b"]
    assert read_recording(path).names == ("u",)
    with pytest.raises(RecordingError, match="no column 'secret'"):
        read_recording(path, channels=("secret",))


def test_mat_73_is_read_as_matlab_shows_it(tmp_path):
    path = tmp_path / "new.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["t"] = TIME[None, :]  # MATLAB's column vectors lie on their side inside
        file["x"] = np.stack([DRIVE, -DRIVE])
        file["#refs#/a"] = TIME
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    recording = read_recording(path, mapping={"time": "t [s]", "b": "x(:,2) [m]"})
    np.testing.assert_allclose(recording.values("b")[:, 0], -DRIVE)
    with pytest.raises(RecordingError, match=r"'x' of .* is a 40x2 array"):
        read_recording(path, mapping={"time": "t [s]", "b": "x [m]"})


def test_a_damaged_hdf5_file_is_refused(tmp_path):
    whole = hdf5(tmp_path / "r.h5", time=(TIME, "s"), u=(DRIVE, "N")).read_bytes()
    for cut in (9, 300, len(whole) // 2):
        path = tmp_path / "cut.h5"
        path.write_bytes(whole[:cut])
        with pytest.raises(RecordingError, match=r"cut\.h5.* cannot be read as HDF5"):
            read_recording(path)


def test_xarray_goes_in_and_out():
    there = drive().to_xarray()
    assert there["y"].attrs["units"] == "mm"
    back = from_xarray(there)
    np.testing.assert_array_equal(back.values(), drive().values())
    assert [c.unit for c in back.channels] == ["N", "mm"]
    one = from_xarray(there["u"])
    assert one.names == ("u",)
    steady = Recording.from_arrays("map", None, {"u": (DRIVE, "N")})
    assert from_xarray(steady.to_xarray(), steady=True).steady


def test_dates_become_seconds():
    frame = pd.DataFrame(
        {"u [N]": DRIVE}, index=pd.Timestamp("2026-01-01") + pd.to_timedelta(TIME, "s")
    )
    np.testing.assert_allclose(from_pandas(frame).time, TIME, atol=1e-9)
    frame = frame.reset_index(names="time")
    np.testing.assert_allclose(from_pandas(frame).time, TIME, atol=1e-9)
    data = xr.Dataset(
        {"u": ("time", DRIVE, {"units": "N"})},
        coords={"time": frame["time"].to_numpy()},
    )
    np.testing.assert_allclose(from_xarray(data).time, TIME, atol=1e-9)


def test_a_clock_without_unit_is_refused_in_a_data_set():
    data = xr.Dataset({"u": ("time", DRIVE, {"units": "N"})}, coords={"time": TIME})
    with pytest.raises(RecordingError, match=r"'time' .* has no unit"):
        from_xarray(data)
    assert from_xarray(data, units={"time": "s"}).duration == pytest.approx(TIME[-1])


DATES = pd.to_datetime("2026-01-31T23:59:59.75") + pd.to_timedelta(TIME, unit="s")


@pytest.mark.parametrize(
    ("header", "zone"),
    [
        ("time,u [N]", ""),
        ("time [UTC],u [N]", "Z"),
        ("# time,u [N]", "+01:00"),
        ("time,u\nISO 8601,N", ""),
    ],
)
def test_a_csv_of_dates_is_read_as_seconds(header, zone, tmp_path):
    rows = zip(DATES, DRIVE, strict=True)
    lines = [f"{date.isoformat(sep=' ')}{zone},{u:.9g}" for date, u in rows]
    (tmp_path / "r.csv").write_text("\n".join([header, *lines]))
    found = read_recording(tmp_path / "r.csv")
    assert found.time == pytest.approx(TIME, abs=1e-9)
    assert found.channel("u").values == pytest.approx(DRIVE, abs=1e-8)


@pytest.mark.parametrize("cell", ["2026-02-01T00:00:00Z", "0.5", "yesterday"])
def test_a_cell_that_is_no_date_like_the_first_is_named(cell, tmp_path):
    lines = [
        f"{date.isoformat()},{u:.9g}" for date, u in zip(DATES, DRIVE, strict=True)
    ]
    lines[7] = f"{cell},0.1"
    (tmp_path / "r.csv").write_text("\n".join(["time,u [N]", *lines]))
    with pytest.raises(RecordingError, match=r"Line 9 .* no date like the first, 2026"):
        read_recording(tmp_path / "r.csv")


def test_what_a_choice_says_against_the_file_is_noted(tmp_path):
    lines = [f"{t:.3f},{u:.9g}" for t, u in zip(TIME, DRIVE, strict=True)]
    (tmp_path / "r.csv").write_text("\n".join(["time [s],u [N]", *lines]))
    path = tmp_path / "r.csv"
    assert read_recording(path, mapping={"u": "u [N]"}).notes == ()
    (note,) = read_recording(path, mapping={"u": "u [kN]"}).notes
    assert note == "u was read in kN, as asked; its header says N."
    (note,) = read_recording(path, step=0.2, channels=("u",)).notes
    assert "'time' was left aside: samples are 0.2 s apart" in note
