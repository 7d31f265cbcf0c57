"""Good files of every kind that the program reads: what damage starts from."""

import io
import json
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

MODEL = b'''"""A cart."""
from bondgraph import BondGraph, I, R, Se


def cart() -> BondGraph:
    graph = BondGraph("cart", domain="translation")
    graph.one("carriage", Se("force"), I("mass"), R("viscous"))
    graph.measure("velocity", flow="carriage")
    graph.parameter("mass", 1.0, "kg", bounds=(0.01, 100))
    graph.parameter("viscous", 0.5, "N*s/m", bounds=(0, 100))
    return graph
'''

CHECKS = b"""[[check]]
name = "gain"
model = "model.py:cart"
input = "force"
output = "velocity"
quantity = "dc_gain"
value = 2.0
digits = 2
parameters = {mass = 1.0}

[[check]]
name = "pole"
model = "model.py:cart"
input = "force"
output = "velocity"
quantity = "pole"
value = -0.5
tolerance = 0.005

[[check]]
name = "loop"
model = "model.py:cart"
input = "force"
output = "velocity"
quantity = "phase_margin"
value = 90.0
relative_tolerance = 0.9
controller = {gain = 70.0, zeros = [-0.18], poles = [-50.0]}
"""

SHAPING = b"""input = "force"
output = "velocity"
delay = 0.001

[[controller]]
kind = "lead"
zero = 3.0
pole = 50

[require]
phase_margin = 45
noise_gain = {limit = 0.1, omega = 838}
"""

HEADERS = ("time [s]", "force [N]", "velocity [m/s]")
MATLAB_HEADER = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116)
MATLAB_HEADER += bytes(8) + b"\x00\x02IM"


def columns(rows: int = 60) -> list[np.ndarray]:
    """Return time, a force and the velocity that a cart answers with."""
    time = 0.02 * np.arange(rows)
    force = np.sign(np.sin(9.0 * time))
    velocity = np.zeros(rows)
    for k in range(rows - 1):
        velocity[k + 1] = 0.99 * velocity[k] + 0.02 * force[k]
    return [time, force, velocity]


def csv() -> bytes:
    """Return a CSV file."""
    file = io.StringIO()
    table = np.column_stack(columns())
    header = ",".join(HEADERS)
    np.savetxt(file, table, delimiter=",", header=header, comments="", fmt="%.6g")
    return file.getvalue().encode()


def mat() -> bytes:
    """Return a MAT file of version 5, compressed."""
    from scipy.io import savemat  # noqa: PLC0415

    file = io.BytesIO()
    time, force, velocity = columns()
    savemat(
        file,
        {"t": time, "x": np.column_stack([force, velocity]), "note": "a cart"},
        do_compression=True,
    )
    return file.getvalue()


def parquet() -> bytes:
    """Return a Parquet file."""
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.parquet as pq  # noqa: PLC0415

    file = io.BytesIO()
    pq.write_table(pa.table(dict(zip(HEADERS, columns(), strict=True))), file)
    return file.getvalue()


def hdf5(*, matlab: bool = False) -> bytes:
    """Return an HDF5 file, behind the header of a MAT file of version 7.3 if asked."""
    import h5py  # noqa: PLC0415

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.h5"
        with h5py.File(path, "w", userblock_size=512 if matlab else 0) as file:
            for header, values in zip(HEADERS, columns(), strict=True):
                name, unit = header.removesuffix("]").split(" [")
                shown = values.reshape(1, -1) if matlab else values
                item = file.create_dataset(name, data=shown, compression="gzip")
                if not matlab:
                    item.attrs["units"] = unit
        content = path.read_bytes()
    return MATLAB_HEADER + content[len(MATLAB_HEADER) :] if matlab else content


def blame() -> bytes:
    """Return the part of a diagnosis' JSON that a picture is coloured by."""
    answer = {"schema": 1, "verdict": "adequate", "blame": {"carriage": 0.42}}
    return json.dumps(answer).encode()


MATRIX = "--map time=t[s] --map force=x(:,1)[N] --map velocity=x(:,2)[m/s]".split()
VECTORS = "--map time=time[s] --map force=force[N] --map velocity=velocity[m/s]".split()
KINDS: dict[str, tuple[str, Callable[[], bytes], tuple[tuple[str, ...], ...]]] = {
    "model": (
        "model.py",
        lambda: MODEL,
        (
            ("derive", "model.py"),
            ("derive", "model.py:cart", "--json", "-"),
            ("draw", "model.py:cart", "-o", "out.svg"),
            ("export", "model.py:cart", "--to", "python", "-o", "out.py"),
            ("diff", "good.py:cart", "model.py:cart"),
            ("simulate", "model.py:cart", "good.csv"),
        ),
    ),
    "checks": ("checks.toml", lambda: CHECKS, (("check", "checks.toml"),)),
    "shaping": (
        "shape.toml",
        lambda: SHAPING,
        (("shape", "model.py", "--spec", "shape.toml"),),
    ),
    "csv": (
        "run.csv",
        csv,
        (
            ("simulate", "model.py:cart", "run.csv"),
            ("simulate", "model.py:cart", "run.csv", "--gaps", "drop"),
            ("simulate", "model.py:cart", "run.csv", "--order", "sort"),
            ("simulate", "model.py:cart", "run.csv", "--steady"),
            ("fit", "model.py:cart", "run.csv"),
            ("diagnose", "model.py:cart", "run.csv"),
        ),
    ),
    "mat": ("run.mat", mat, (("simulate", "model.py:cart", "run.mat", *MATRIX),)),
    "mat73": (
        "run.mat",
        lambda: hdf5(matlab=True),
        (("simulate", "model.py:cart", "run.mat", *VECTORS),),
    ),
    "hdf5": (
        "run.h5",
        hdf5,
        (
            ("simulate", "model.py:cart", "run.h5"),
            ("diagnose", "model.py:cart", "run.h5"),
        ),
    ),
    "parquet": (
        "run.parquet",
        parquet,
        (
            ("simulate", "model.py:cart", "run.parquet"),
            ("diagnose", "model.py:cart", "run.parquet", "--held-out", "good.csv"),
        ),
    ),
    "json": (
        "answer.json",
        blame,
        (
            ("draw", "model.py:cart", "-o", "out.svg", "--blame", "answer.json"),
            ("draw", "model.py:cart", "-o", "out.svg", "--colour-by", "answer.json"),
        ),
    ),
}
"""By kind: the file's name, its good content, and the command lines that read it."""
