"""Make recordings from files that lack a channel or hold more than the experiment.

    python examples/recordings/prepare.py servos|seals|damper|draining_tank FROM TO

It needs pandas, which the extra `data` brings (`pip install '.[data]'`).
`servos` writes the conditions of each run (gain, mass, arm) as channels beside it;
`seals` makes a velocity from the position; `damper` filters force and velocity and
thins them out, as its README does; `draining_tank` keeps the time in which it drains.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

try:
    import pandas as pd
except ImportError:
    raise SystemExit(
        "Preparing recordings needs pandas: install the extra, "
        "pip install -c constraints.txt '.[data]'"
    ) from None

Array = NDArray[np.float64]


def servos(source: Path, target: Path) -> None:
    """Write every run of both servos with its conditions as channels."""
    for folder, prefix in (("xl330", "xl330"), ("sts3215", "sts")):
        runs = pd.read_csv(source / folder / "logs.csv")
        for run in runs.to_dict("records"):
            table = pd.read_csv(source / folder / run["file"])
            for name in ("kp [1]", "mass [kg]", "arm_length [m]", "arm_mass [kg]"):
                table[name] = run.get(name, 0.0)
            table.to_csv(target / f"{prefix}_{run['file']}", index=False)


def seals(source: Path, target: Path) -> None:
    """Write velocity (5 Hz, zero phase), pressure and force of the O-ring runs."""
    for path in sorted((source / "seals").glob("o_ring_*bar.csv")):
        table = pd.read_csv(path)
        time = np.arange(table["time [s]"].iloc[0], table["time [s]"].iloc[-1], 0.01)
        even = {c: np.interp(time, table["time [s]"], table[c]) for c in table.columns}
        velocity = np.gradient(_smooth(even["position [m]"], 5.0, 100.0), time)
        kept = slice(None, None, 10)
        pd.DataFrame(
            {
                "time [s]": time[kept],
                "velocity [m/s]": velocity[kept],
                "pressure [Pa]": _smooth(even["pressure [Pa]"], 5.0, 100.0)[kept],
                "force [N]": _smooth(even["force [N]"], 5.0, 100.0)[kept],
            }
        ).to_csv(target / path.name, index=False)


def damper(source: Path, target: Path) -> None:
    """Write force and velocity (20 Hz, zero phase), every 8th sample after 0.5 s."""
    for path in sorted((source / "damper").glob("*.csv")):
        table = pd.read_csv(path)
        rate = 1024.0
        table["friction_force [N]"] = _smooth(table["friction_force [N]"], 20.0, rate)
        position = _smooth(table["displacement [m]"], 20.0, rate)
        table["velocity [m/s]"] = np.gradient(position, table["time [s]"])
        table[table["time [s]"] >= 0.5][::8].to_csv(target / path.name, index=False)


def draining_tank(source: Path, target: Path) -> None:
    """Write the level from 26 cm down to 4 cm, every 20th sample."""
    for path in sorted((source / "draining_tank").glob("empty_*.csv")):
        table = pd.read_csv(path)
        reading, level = table["sensor_reading [count]"], table["level [m]"]
        draining = table.index >= reading.idxmax()
        kept = table[draining & (level <= 0.26) & (level >= 0.04)][::20]
        kept.to_csv(target / path.name, index=False)


def _smooth(values: object, cutoff: float, rate: float) -> Array:
    sections = butter(2, cutoff, fs=rate, output="sos")
    smooth: Array = sosfiltfilt(sections, np.asarray(values, dtype=float))
    return smooth


def main() -> None:
    """Prepare what the command line names."""
    known = {f.__name__: f for f in (servos, seals, damper, draining_tank)}
    if len(sys.argv) != 4 or sys.argv[1] not in known:
        raise SystemExit(__doc__)
    target = Path(sys.argv[3])
    target.mkdir(parents=True, exist_ok=True)
    known[sys.argv[1]](Path(sys.argv[2]), target)


if __name__ == "__main__":
    main()
