"""Recordings: what is read, what is refused and in which words, bound and cut."""

import math
import os
import pickle
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from bondgraph.errors import RecordingError, UnitError
from bondgraph.recordings.binding import bind, read_bound
from bondgraph.recordings.channel import Channel
from bondgraph.recordings.frames import from_pandas
from bondgraph.recordings.names import parse_mapping, split_header
from bondgraph.recordings.reading import read_recording
from bondgraph.recordings.recording import Recording
from bondgraph.recordings.windows import Window, blocks, split, stretches, windows
from bondgraph.structure.units import conversion

HERE = Path(__file__).parent
REAL = Path(
    os.environ.get("BONDGRAPH_RECORDINGS", HERE.parent.parent / "shared" / "recordings")
)
needs_real = pytest.mark.skipif(
    not REAL.is_dir(), reason=f"the real recordings are not at {REAL}"
)

TIME = np.arange(20) * 0.01
HEADER = "time [s],T_motor [N*m],theta [deg]"


def lines(header: str = HEADER, count: int = 20) -> list[str]:
    rows = (f"{0.01 * i:.2f},{0.5 * i:g},{180 - i:g}" for i in range(count))
    return [header, *rows]


@pytest.fixture
def write(tmp_path):
    def write(content, name="run.csv"):
        path = tmp_path / name
        if isinstance(content, list):
            content = "\n".join(content) + "\n"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


def refusal(call, *args, **kwargs) -> str:
    """Return the one line that `call` is refused with."""
    with pytest.raises(RecordingError) as caught:
        call(*args, **kwargs)
    text = str(caught.value)
    assert "\n" not in text
    assert caught.value.remedy
    assert str(pickle.loads(pickle.dumps(caught.value))) == text
    return text


def drive(count: int = 20, **channels) -> Recording:
    t = np.arange(count) * 0.01
    given = {"u": (np.sin(t), "N"), "y": (np.cos(t), "mm")}
    return Recording.from_arrays("drive", t, channels or given)


# --- reading -------------------------------------------------------------------------


def test_csv_gives_names_units_and_seconds(write):
    recording = read_recording(write(lines()))
    assert recording.name == "run"
    assert recording.names == ("T_motor", "theta")
    assert [c.unit for c in recording.channels] == ["N*m", "deg"]
    assert len(recording) == 20
    assert recording.step == pytest.approx(0.01)
    assert recording.duration == pytest.approx(0.19)
    assert recording.uniform
    np.testing.assert_array_equal(
        recording.channel("theta").values[:3], [180, 179, 178]
    )


def test_the_hash_is_the_files(write):
    path = write(lines())
    assert read_recording(path).sha256 == sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize(
    ("content", "choices"),
    [
        ("\ufeff" + "\n".join(lines()), {}),
        ("\r\n".join(lines()) + "\r\n\r\n", {}),
        ("\n".join(lines()).replace(",", ";"), {"delimiter": ";"}),
        (
            "\n".join(lines()).replace(",", ";").replace(".", ","),
            {"delimiter": ";", "decimal": ","},
        ),
        ("\n".join(lines()).encode("utf-16"), {"encoding": "utf-16"}),
        ("\n\n" + "\n\n".join(lines()), {}),
        (
            ",".join(f'"{h}"' for h in HEADER.split(","))
            + "\n"
            + "\n".join(lines()[1:]),
            {},
        ),
    ],
    ids=["bom", "crlf", "semicolon", "comma decimals", "utf-16", "blank", "quoted"],
)
def test_spellings_of_csv_give_the_same_numbers(write, content, choices):
    plain = read_recording(write(lines(), "plain.csv"))
    other = read_recording(write(content, "other.csv"), **choices)
    assert other.names == plain.names
    np.testing.assert_array_equal(other.time, plain.time)
    np.testing.assert_array_equal(other.values(), plain.values())


def test_tabs_in_a_tsv(write):
    path = write("\n".join(lines()).replace(",", "\t"), "run.tsv")
    assert read_recording(path).names == ("T_motor", "theta")


def test_time_in_milliseconds_becomes_seconds(write):
    text = ["time [ms],x [1]", *(f"{10 * i},{i}" for i in range(20))]
    np.testing.assert_allclose(read_recording(write(text)).time, TIME)


def test_mapping_units_and_channels_choose_and_rename(write):
    path = write(["t,a,b [V],label", *(f"{i},{i},{2 * i},x{i}" for i in range(9))])
    recording = read_recording(
        path,
        mapping={"time": "t [s]", "force": "a", "drive": "b"},
        units={"force": "kN"},
        channels=("force", "drive"),
    )
    assert recording.names == ("force", "drive")
    assert recording.channel("force").unit == "kN"
    assert recording.channel("drive").unit == "V"
    assert recording.unread == ("label",)


def test_a_known_step_stands_in_for_a_clock(write):
    path = write(["x [m]", *(f"{i}" for i in range(9)), "nan", "10"])
    recording = read_recording(path, step=0.5, gaps="drop")
    assert recording.time[-1] == 5.0  # the hole stays a hole
    assert len(recording) == 10


@pytest.mark.parametrize("choice", [{"steady": True}, {"time": None}])
def test_a_steady_table_is_read_only_when_asked_for(write, choice):
    path = write(["speed [rad/s],torque [N*m]", "1,2", "3,4", "-5,6"])
    assert "steady=True" in refusal(read_recording, path)
    table = read_recording(path, **choice)
    assert table.steady
    assert len(table) == 3
    assert math.isnan(table.duration)
    assert math.isnan(table.step)
    assert not table.uniform


def test_parquet_and_pandas_give_what_csv_gives(write, tmp_path):
    pytest.importorskip("pyarrow")
    plain = read_recording(write(lines()))
    frame = plain.to_pandas()
    assert list(frame.columns) == HEADER.split(",")
    frame.to_parquet(tmp_path / "run.parquet")
    for other in (read_recording(tmp_path / "run.parquet"), from_pandas(frame)):
        assert other.names == plain.names
        np.testing.assert_array_equal(other.time, plain.time)
        np.testing.assert_array_equal(other.values(), plain.values())


def mat(tmp_path, **variables):
    path = tmp_path / "run.mat"
    savemat(path, variables)
    return path


def test_mat_by_mapping_with_matrices_by_column_and_row(tmp_path):
    both = np.stack([TIME, TIME**2], axis=1)
    path = mat(tmp_path, t=TIME[:, None], q=both, w=both.T, gain=3.0)
    recording = read_recording(
        path,
        mapping={"time": "t[s]", "x": "q(:,2) [m]", "y": "w(1,:) [m]"},
    )
    assert recording.names == ("x", "y")
    np.testing.assert_array_equal(recording.channel("x").values, TIME**2)
    np.testing.assert_array_equal(recording.channel("y").values, TIME)
    assert "gain" in recording.unread


def test_good_rows_never_take_the_slow_pass(tmp_path, monkeypatch):
    monkeypatch.delattr("bondgraph.recordings.csv_table.CsvTable._slow")
    n = 200_000
    row = b"%d,0.123456789,-1.5e-3\n"
    path = tmp_path / "long.csv"
    path.write_bytes(b"time [s],u [N],y [m]\n" + b"".join(row % i for i in range(n)))
    assert len(read_recording(path)) == n


# --- refusals ------------------------------------------------------------------------


def replaced(line: int, text: str) -> list[str]:
    """Return good lines with the one numbered `line` (from 1) replaced."""
    result = lines()
    result[line - 1] = text
    return result


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", ["is empty"]),
        ("\n\n", ["is empty", "name the columns"]),
        ([HEADER], ["header and no samples"]),
        (lines(count=7), ["7 samples", "at least 8"]),
        (lines()[1:], ["numbers where its header", "line 1"]),
        (replaced(1, "time [s],T_motor,theta [rad]"), ["'T_motor'", "no unit", "[1]"]),
        (replaced(1, "time,a [1],b [1]"), ["'time'", "no unit"]),
        (replaced(1, "time [kg],a [1],b [1]"), ["'time'", "'kg'", "ms"]),
        (replaced(1, "tme [s],a [1],b [1]"), ["no column 'time'", "Did you mean tme"]),
        (replaced(1, "time [s],a [1],a [m]"), ["2 columns called 'a'", "2 and 3"]),
        (replaced(1, "time [s],,a [m]"), ["Column 2", "no name", "channels="]),
        (replaced(5, "0.03,nan,1"), ["'T_motor'", "1 of 20", "line 5", 'gaps="drop"']),
        (replaced(5, "0.03,1,"), ["'theta'", "1 of 20", "line 5"]),
        (replaced(5, "0.03,1,-inf"), ["'theta'", "-inf", "line 5"]),
        (replaced(5, "0.03,1,abc"), ["Line 5", "'abc'", "column 3", "theta"]),
        (replaced(5, "0.03,1_0,2"), ["Line 5", "'1_0'"]),
        (replaced(5, "0.03,1"), ["Line 5", "2 cells", "3"]),
        (replaced(5, "0.03,1,2,3"), ["Line 5", "4 cells"]),
        (replaced(5, "0.005,1,2"), ["backward", "line 5", 'order="sort"']),
        (replaced(5, "0.02,1,2"), ["repeats", "line 5", 'repeats="first"']),
        ("\n".join(lines()).replace(",", ";"), ["delimiter=';'"]),
        ("\n".join(lines()).encode("utf-16"), ["UTF-16", 'encoding="utf-16"']),
        (
            "\n".join(replaced(1, "time [s],a [1],T [°C]")).encode("latin-1"),
            ["Line 1", "0xb0", "UTF-8", 'encoding="latin-1"'],
        ),
        (b"x" * 200_000, ["header"]),
        (b"\x00\xff\x00,\n\x01,2", ["Line 1", "0xff"]),
    ],
)
def test_bad_csv_is_refused_naming_the_place(write, content, words):
    path = write(content)
    text = refusal(read_recording, path)
    for word in [str(path), *words]:
        assert word in text


def test_comma_decimals_are_recognised_in_the_refusal(write):
    path = write("\n".join(lines()).replace(",", ";").replace("0.03", "0,03"))
    assert 'decimal=","' in refusal(read_recording, path, delimiter=";")


def test_a_missing_file_names_its_neighbours(write, tmp_path):
    write(lines(), "run_01.csv")
    text = refusal(read_recording, tmp_path / "run_1.csv")
    assert "no file" in text
    assert "Did you mean run_01.csv" in text


def test_a_folder_and_an_unknown_suffix_are_refused(tmp_path, write):
    (tmp_path / "folder.csv").mkdir()
    assert "cannot be opened" in refusal(read_recording, tmp_path / "folder.csv")
    assert ".parquet" in refusal(read_recording, write("x", "run.xlsx"))
    assert "cannot be opened" in refusal(read_recording, "nul\0byte.csv")


def test_the_ways_out_of_gaps_order_and_repeats_work(write):
    content = ["time [s],x [m]", *(f"{i},{i}" for i in range(10))]
    content[5:5] = ["2,8", "20,nan", "30,"]
    path = write(content)
    for choices, words in (
        ({}, "not a finite number in 2 of 13"),
        ({"gaps": "drop"}, "backward"),
        ({"gaps": "drop", "order": "sort"}, "repeats"),
    ):
        assert words in refusal(read_recording, path, **choices)
    first = read_recording(path, gaps="drop", order="sort", repeats="first")
    mean = read_recording(path, gaps="drop", order="sort", repeats="mean")
    np.testing.assert_array_equal(first.time, np.arange(10.0))
    np.testing.assert_array_equal(first.channel("x").values, np.arange(10.0))
    assert mean.channel("x").values[2] == 5.0
    assert len(mean.notes) == 3


def test_rows_dropped_before_a_fault_do_not_move_its_line(write):
    content = lines()
    content[3] = "0.02,nan,1"
    content[8] = "0.01,1,1"
    assert "line 9" in refusal(read_recording, write(content), gaps="drop")


@pytest.mark.parametrize(
    ("choices", "words"),
    [
        ({"gaps": "fill"}, ["gaps='fill'", "refuse, drop"]),
        ({"order": "up"}, ["order='up'"]),
        ({"repeats": "last"}, ["repeats='last'"]),
        ({"step": 0.0}, ["step=0.0"]),
        ({"units": {"thet": "rad"}}, ["units", "'thet'", "Did you mean theta"]),
        ({"mapping": {"x": "thetta"}}, ["'thetta' (wanted as 'x')", "mean theta"]),
        ({"channels": ("torque",)}, ["no column 'torque'"]),
        ({"channels": ()}, ["no channel to read"]),
        ({"time": "clock"}, ["no column 'clock'"]),
        ({"delimiter": ",,"}, ["delimiter"]),
        ({"delimiter": ";"}, ["delimiter=','"]),
        ({"encoding": "klingon"}, ["encoding", "klingon"]),
    ],
)
def test_choices_that_do_not_fit_are_refused(write, choices, words):
    text = refusal(read_recording, write(lines()), **choices)
    for word in words:
        assert word in text


def test_damaged_mat_and_parquet_files_are_refused(tmp_path, write):
    whole = mat(tmp_path, t=TIME, x=TIME).read_bytes()
    choice = {"mapping": {"time": "t[s]", "x": "x[m]"}}
    for cut in (1, 60, 127, 140, len(whole) // 2, len(whole) - 9):
        text = refusal(read_recording, write(whole[:cut], "cut.mat"), **choice)
        assert "cut.mat" in text
    hdf5 = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM" + bytes(400)
    assert "MAT 7.3" in refusal(read_recording, write(hdf5, "new.mat"), **choice)
    pytest.importorskip("pyarrow")
    drive().to_pandas().to_parquet(tmp_path / "run.parquet")
    whole = (tmp_path / "run.parquet").read_bytes()
    for cut in (1, 4, 100, len(whole) - 1):
        text = refusal(read_recording, write(whole[:cut], "cut.parquet"))
        assert "cannot be read as Parquet" in text


def test_random_bytes_are_refused_whatever_the_suffix(write):
    rng = np.random.default_rng(3)
    for i in range(30):
        content = rng.bytes(int(rng.integers(1, 2000)))
        for suffix in ("csv", "mat", "parquet"):
            refusal(read_recording, write(content, f"{i}.{suffix}"))


@pytest.mark.parametrize(
    ("mapping", "words"),
    [
        (None, ["which of its variables", "mapping=", "t, x, "]),
        ({"time": "t[s]", "p": "position[m]"}, ["no column 'position'", "'p'"]),
        ({"p": "x[m]"}, ["no column 'time'"]),
        ({"time": "t[s]", "p": "x"}, ["'p'", "no unit"]),
        ({"time": "t[s]", "p": "short[m]"}, ["'short'", "5 values", "'t'", "20"]),
        ({"time": "t[s]", "p": "box[m]"}, ["20x3", "box(:,1)"]),
        ({"time": "t[s]", "p": "box(:,4)[m]"}, ["no column 'box(:,4)'"]),
        ({"time": "t[s]", "p": "word[m]"}, ["'word'", "not a column of numbers"]),
        ({"time": "t[s]", "p": "log[m]"}, ["'log'", "not a column of numbers"]),
        ({"time": "t[s]", "p": "wave[m]"}, ["'wave'", "complex"]),
    ],
)
def test_mat_variables_that_are_no_channels_are_refused(tmp_path, mapping, words):
    path = mat(
        tmp_path,
        t=TIME,
        x=TIME,
        short=TIME[:5],
        box=np.ones((20, 3)),
        word="hello",
        log={"a": TIME},
        wave=TIME + 1j,
    )
    text = refusal(read_recording, path, mapping=mapping)
    for word in words:
        assert word in text


def test_text_and_dates_in_frames_are_refused():
    pd = pytest.importorskip("pandas")
    frame = drive().to_pandas()
    frame["note [1]"] = "x"
    assert "'note [1]'" in refusal(from_pandas, frame)
    assert from_pandas(frame, channels=("u",)).names == ("u",)
    frame["time [s]"] = pd.date_range("2024-01-01", periods=len(frame))
    assert "datetime64" in refusal(from_pandas, frame, channels=("u",))


@pytest.mark.parametrize("word", ["theta", "=x", "theta=", "a[m]=b", "a=[m]", ""])
def test_words_that_map_nothing_are_refused(word):
    assert "does not map" in refusal(parse_mapping, [word])


def test_mapping_words():
    assert parse_mapping(["theta=joint angle", "x = q(:,2)[m]"]) == {
        "theta": "joint angle",
        "x": "q(:,2) [m]",
    }
    assert "twice" in refusal(parse_mapping, ["a=b", "a=c"])


@pytest.mark.parametrize(
    ("header", "parts"),
    [
        ("theta [rad]", ("theta", "rad")),
        ("theta[rad]", ("theta", "rad")),
        ("ratio []", ("ratio", "1")),
        ("F [raw] [N]", ("F [raw]", "N")),
        ("theta (rad)", ("theta (rad)", None)),
        ("", ("", None)),
    ],
)
def test_headers(header, parts):
    assert split_header(header) == parts


# --- the record ----------------------------------------------------------------------


def test_a_recording_cannot_be_changed():
    recording = drive()
    with pytest.raises(ValueError, match="read-only"):
        recording.channel("u").values[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        recording.time[0] = 1.0
    with pytest.raises(AttributeError):
        recording.name = "other"


def test_a_recording_does_not_share_the_callers_arrays():
    values = np.arange(10.0)
    recording = Recording.from_arrays("r", np.arange(10.0), {"x": (values, "m")})
    values[0] = 99.0
    assert recording.channel("x").values[0] == 0.0


@pytest.mark.parametrize(
    ("time", "channels", "words"),
    [
        (TIME, {"x": (TIME[:5], "m")}, "'x'"),
        (TIME[::-1], {"x": (TIME, "m")}, "does not increase"),
        (TIME, {"x": (np.where(TIME > 0.1, np.nan, 1), "m")}, "9 samples, first in s"),
        (TIME, {"x": (["a"] * 20, "m")}, "not an array of numbers"),
        (TIME, {"x": (np.ones((20, 2)), "m")}, "shape (20, 2)"),
        (TIME, {}, "no channels"),
        (TIME[:5], {"x": (TIME[:5], "m")}, "5 samples"),
        (None, {"x": ([1.0], "m")}, "1 sample;"),
    ],
)
def test_arrays_that_are_no_recording_are_refused(time, channels, words):
    assert words in refusal(Recording.from_arrays, "r", time, channels)


def test_two_channels_of_one_name_are_refused():
    pair = (Channel("x", "m", TIME), Channel("x", "m", TIME))
    text = refusal(Recording, name="r", time=TIME, channels=pair)
    assert "Two channels" in text


def test_parts_selections_names_and_units():
    recording = drive()
    part = recording.part(5, -5)
    assert part.name == "drive[5:15]"
    np.testing.assert_array_equal(part.time, recording.time[5:15])
    assert part.sha256 == recording.sha256
    assert len(recording.between(0.5, 1.0)) == 10
    chosen = recording.select("y")
    assert (chosen.names, chosen.unread) == (("y",), ("u",))
    assert recording.renamed({"u": "force"}).names == ("force", "y")
    metres = recording.converted("y", "m").channel("y")
    np.testing.assert_allclose(metres.values, recording.channel("y").values / 1000)
    for call in (
        lambda: recording.part(5, 5),
        lambda: recording.between(0.5, 0.5),
        lambda: recording.select("z"),
        lambda: recording.renamed({"z": "w"}),
        lambda: recording.renamed({"u": "y"}),
        lambda: recording.converted("y", "N"),
    ):
        refusal(call)


def test_equal_numbers_have_equal_hashes_and_others_not():
    assert drive().sha256 == drive().sha256
    assert drive().sha256 != drive(21).sha256


def test_the_notebook_table_escapes_what_a_file_says():
    recording = drive(**{"<script>": (TIME, "<b>")})
    page = recording._repr_html_()
    assert "&lt;script&gt;" in page
    assert "<script>" not in page
    assert "<b>" not in page


# --- binding -------------------------------------------------------------------------


def test_binding_orders_converts_and_reports_what_is_unused():
    t = np.arange(10.0)
    given = {"y2": (t, "mm"), "torque": (2 * t, "mN*m"), "extra": (t, "V")}
    recording = Recording.from_arrays("r", t, given)
    bound = bind(recording, {"T": "N*m"}, {"y2": "m"}, mapping={"T": "torque"})
    np.testing.assert_allclose(bound.input("T"), 2e-3 * t)
    np.testing.assert_allclose(bound.outputs[:, 0], 1e-3 * t)
    assert bound.unused == ("extra",)
    assert (bound.input_units, bound.output_units) == (("N*m",), ("m",))
    assert bound.sha256 == recording.sha256
    part = bound.part(2, 5)
    np.testing.assert_array_equal(part.time, [2, 3, 4])
    assert part.name == "r[2:5]"
    assert part.inputs.shape == (3, 1)


def test_free_motion_has_no_inputs():
    bound = bind(drive(), {}, {"y": "mm"})
    assert bound.inputs.shape == (20, 0)


def test_temperature_keeps_its_zero():
    recording = drive(T=(np.full(20, 25.0), "degC"))
    assert bind(recording, {}, {"T": "K"}).outputs[0, 0] == pytest.approx(298.15)


def test_an_unchecked_unit_is_taken_as_it_is():
    recording = drive(x=(TIME, "px"))
    assert "'px'" in refusal(bind, recording, {}, {"x": "1"})
    bound = bind(recording, {}, {"x": "1"}, unchecked={"x"})
    np.testing.assert_array_equal(bound.output("x"), TIME)
    assert bound.output_units == ("px",)
    assert bound.notes == ()


def test_a_unit_that_would_convert_and_does_not_is_told():
    bound = bind(drive(load=(TIME, "g")), {}, {"load": "1"}, unchecked={"load"})
    np.testing.assert_array_equal(bound.output("load"), TIME)
    (note,) = bound.notes
    assert "load" in note
    assert "[g]" in note
    for unit in ("kg", "px", "Hz*deg"):  # the last is no unit of anything
        taken = bind(drive(load=(TIME, unit)), {}, {"load": "1"}, unchecked={"load"})
        assert taken.notes == ()


@pytest.mark.parametrize(
    ("outputs", "mapping", "words"),
    [
        ({"theta": "rad"}, None, ["no 'theta'", "u [N], y [mm]", "theta=CHANNEL"]),
        ({"theta": "rad"}, {"theta": "z"}, ["no channel 'z' for 'theta'"]),
        ({"theta": "rad"}, {"theta": "y"}, ["'theta'", "'rad'", "'y'", "'mm'"]),
        ({"y": "m"}, {"x": "y"}, ["names 'x'", "neither an input"]),
    ],
)
def test_what_a_model_lacks_is_named(outputs, mapping, words):
    text = refusal(bind, drive(), {}, outputs, mapping=mapping)
    for word in words:
        assert word in text


def test_reading_for_a_model_ignores_what_it_does_not_use(write):
    content = ["time [s],x [cm],note,y [m]", *(f"{i},{i},hello,nan" for i in range(9))]
    bound = read_bound(write(content), {}, {"pos": "m"}, mapping={"pos": "x"})
    np.testing.assert_allclose(bound.output("pos"), np.arange(9) / 100)
    assert bound.unused == ("note", "y")
    text = refusal(read_bound, write(content), {}, {"x": "m"}, mapping={"z": "x"})
    assert "'z'" in text
    text = refusal(read_bound, write(content), {}, {"w": "m"})
    assert "no column 'w'" in text
    assert "w=COLUMN" in text


@pytest.mark.parametrize(
    ("source", "target"),
    [("px", "m"), ("count", "rad"), ("count", "1"), ("Hz", "rad/s"), ("rpm", "Hz")],
)
def test_units_that_only_look_alike_do_not_convert(source, target):
    with pytest.raises(UnitError):
        conversion(source, target)


# --- windows -------------------------------------------------------------------------


def test_a_gap_ends_a_stretch_and_jitter_does_not():
    rng = np.random.default_rng(0)
    t = np.cumsum(rng.uniform(0.5, 1.5, 100))
    t[40:] += 3.0
    t[70:] += 30.0
    assert stretches(t) == (Window(0, 40), Window(40, 70), Window(70, 100))


def test_a_logger_that_slows_down_at_rest_leaves_no_gap_and_a_pause_does():
    steps = np.full(200, 0.2)
    steps[60:100] = 8.0
    steps[150] = 8.0
    t = np.cumsum(steps)
    assert stretches(t) == (Window(0, 150), Window(150, 200))


def test_an_uneven_clock_leaves_no_gaps_unless_they_are_long():
    steps = np.full(400, 6e-3)
    steps[::12] = 25e-3
    steps[200] = 0.5
    t = np.cumsum(steps)
    assert stretches(t) == (Window(0, 200), Window(200, 400))


def test_a_sample_alone_between_two_gaps_is_left_out():
    steps = np.full(100, 0.1)
    steps[[50, 51]] = 20.0
    recording = Recording.from_arrays("r", t := np.cumsum(steps), {"x": (t, "m")})
    assert windows(recording) == (Window(0, 50), Window(51, 100))


def test_a_recording_without_a_long_enough_stretch_says_what_it_has():
    t = np.arange(12.0)
    t[6:] += 50.0
    recording = Recording.from_arrays("r", t, {"x": (t, "m")})
    assert "12 samples, 1 gap." in refusal(windows, recording)


@pytest.mark.parametrize("length", [{"samples": 10}, {"seconds": 0.1}])
def test_windows_are_contiguous_and_of_the_length_asked(length):
    cut = windows(drive(45), **length)
    assert cut == (Window(0, 10), Window(10, 20), Window(20, 30), Window(30, 45))
    assert windows(drive(45)) == (Window(0, 45),)


def test_windows_of_uneven_time_cover_everything_outside_gaps():
    rng = np.random.default_rng(1)
    t = np.cumsum(rng.uniform(0.2, 1.8, 1000))
    t[500:] += 20.0
    recording = Recording.from_arrays("r", t, {"x": (t, "m")})
    cut = windows(recording, seconds=8.0)
    assert [w.start for w in cut[1:]] == [w.stop for w in cut[:-1]]
    assert (cut[0].start, cut[-1].stop) == (0, 1000)
    assert 500 in {w.start for w in cut}
    assert min(map(len, cut)) >= 8
    spans = [t[w.stop - 1] - t[w.start] for w in cut]
    assert np.median(spans) < 8.0 < 1.5 * np.median(spans)


def test_windows_that_cannot_be_are_refused():
    recording = drive(45)
    assert "one length" in refusal(windows, recording, seconds=1.0, samples=9)
    assert "shorter than" in refusal(windows, recording, samples=3)
    assert "shorter than" in refusal(windows, recording, seconds=0.01)
    assert "45 samples, 0 gaps" in refusal(windows, recording, least=50)
    table = Recording.from_arrays("map", None, {"x": (TIME, "m")})
    assert "steady" in refusal(windows, table, samples=9)
    refusal(Window, 3, 3)


def test_split_by_time():
    t = np.concatenate([np.arange(50) * 0.01, 0.5 + np.arange(50) * 0.1])
    recording = Recording.from_arrays("r", t, {"x": (t, "m")})
    train, held_out = split(recording, 0.6)
    assert train.time[-1] < 0.6 * t[-1] <= held_out.time[0]
    assert len(train) + len(held_out) == 100
    bound_train, _ = split(bind(recording, {}, {"x": "m"}), 0.6)
    assert len(bound_train) == len(train)
    for fraction in (0.0, 1.0, -1.0, math.nan):
        refusal(split, recording, fraction)


@pytest.mark.parametrize("fraction", [0.3, 0.5, 0.6, 0.9])
def test_a_steady_table_is_split_over_its_whole_range(fraction):
    x = np.arange(40.0)
    table = Recording.from_arrays("map", None, {"x": (x, "m")})
    train, held_out = split(table, fraction)
    rows = sorted([*train.channel("x").values, *held_out.channel("x").values])
    assert rows == x.tolist()
    assert len(train) == round(40 * fraction)
    assert abs(train.channel("x").values.mean() - 19.5) < 2
    assert abs(held_out.channel("x").values.mean() - 19.5) < 3


def test_blocks_cover_a_recording_in_equal_times():
    cut = blocks(drive(100), 5)
    assert [len(w) for w in cut] == [20] * 5
    assert (cut[0].start, cut[-1].stop) == (0, 100)
    t = np.concatenate([np.arange(50.0), 1e4 + np.arange(50.0)])
    holed = Recording.from_arrays("r", t, {"x": (t, "m")})
    assert [len(w) for w in blocks(holed, 4)] == [25] * 4
    refusal(blocks, drive(30), 5)


# --- real files ----------------------------------------------------------------------


@needs_real
def test_emps_reads_the_same_from_csv_and_mat():
    folder = REAL / "emps"
    table = read_recording(folder / "train.csv")
    original = read_recording(
        folder / "DATA_EMPS.mat",
        mapping=parse_mapping(
            (
                *("time=t[s]", "position=qm[m]"),
                *("position_reference=qg[m]", "motor_command=vir[V]"),
            )
        ),
    )
    assert len(table) == len(original) == 24841
    # The CSV was written with nine digits.
    np.testing.assert_allclose(original.time, table.time, rtol=1e-8)
    for name in original.names:
        np.testing.assert_allclose(
            original.channel(name).values,
            table.channel(name).values,
            rtol=1e-8,
            atol=1e-12,
        )


@needs_real
def test_every_real_recording_is_read_or_asks_for_what_it_lacks():
    read = 0
    for path in sorted(REAL.glob("*/*.csv")):
        if not path.read_text().startswith("time [s],"):
            assert "no column 'time'" in refusal(read_recording, path)
            continue
        recording = read_recording(path)
        read += 1
        assert np.all(np.diff(recording.time) > 0)
        assert recording.duration > 1.0
    assert read >= 30


@needs_real
def test_the_worm_drives_steady_map_is_read_as_one():
    table = read_recording(REAL / "worm_drive" / "steady_map.csv", steady=True)
    assert len(table) == 46
    train, held_out = split(table, 0.5)
    assert len(train) == len(held_out) == 23


def test_a_logger_that_writes_in_bursts_is_told_to_keep_one_row_of_each():
    time = (0.5 * np.arange(40)[:, None] + 0.01 * np.arange(5)).ravel()
    bursts = Recording.from_arrays("bursts", time, {"angle": (np.cos(time), "rad")})
    with pytest.raises(RecordingError, match=r"bursts of about 5.*one row of each"):
        windows(bursts)
    one_of_each = bursts.rows(range(0, 200, 5))
    assert [window.samples for window in windows(one_of_each)] == [slice(0, 40)]
