"""Recording a drive: its base model and three files in a folder, as a user has them.

Two train: a multisine on the motor's torque about one posture, and random steps of the
wanted angle. Splines are held out. The recorded torque is the commanded one, held
between samples; the encoder has its steps and its noise.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.concealed.excitation import excitation
from benchmarks.concealed.machine import Machine, Sensor
from benchmarks.concealed.recording import Plan, Run, simulate
from benchmarks.flegx_story.leg import SCALES, Concealed, Joint, effects, machine

TORQUE, ANGLE = 0.12, 0.3  # N·m at the motor, rad
SLOW_BAND = (0.3, 2.5)  # Hz
TRAINING = {"train_1": "multisine", "train_2": "random_steps"}
HELD_OUT = {"held_out": "splines"}

MODEL = '''"""{title}, as printed; motor inertia and bearing friction are fitted."""

from dataclasses import replace

from bondgraph import BondGraph, ParameterSet
from flegx_models import models
from flegx_models.parameters import RECONCILED

FREE = ("I_motor", "c_friction_{limb}")


def leg() -> BondGraph:
    known = tuple(
        replace(one, std=None if one.name in FREE else 0.0)
        for one in RECONCILED.members
    )
    return models.{model}(ParameterSet(known))
'''
GAUGED = """    drive = models.{model}(ParameterSet(known))
    drive.measure("torque", effort="K_worm_gear>joint")
{link}    return drive
"""
LINK = """    drive.measure("link", effort="K_support>joint")
"""


def record(
    joint: Joint,
    concealed: Concealed,
    kind: str,
    seed: int,
    samples: int = 1500,
    *,
    gauged: bool = False,
) -> Run:
    """Return one recording of a joint's drive."""
    drive = replace(machine(joint, concealed, gauged=gauged), samples=samples)
    return simulate(drive, _plan(drive, kind, seed), effects(concealed), scales=SCALES)


def write_case(
    folder: Path,
    joint: Joint,
    concealed: Concealed,
    seed: int,
    samples: int = 1500,
    *,
    gauged: bool = False,
) -> Path:
    """Write model and recordings of a joint into a folder of their own.

    The seeds of the three recordings are `seed` and the two after it.
    """
    sensors = "_gauged" if gauged else ""
    place = folder / f"{joint.model}_{concealed.name}{sensors}"
    place.mkdir(parents=True, exist_ok=True)
    drive = machine(joint, concealed, gauged=gauged)
    for i, (name, kind) in enumerate({**TRAINING, **HELD_OUT}.items()):
        run = record(joint, concealed, kind, seed + i, samples, gauged=gauged)
        _write(place / f"{name}.csv", run, drive.sensors)
    limb, _, phase = joint.model.partition("_")
    title = f"The {limb} in {phase}"
    plain = "    return models.{model}(ParameterSet(known))\n"
    model = MODEL.replace(plain, GAUGED) if gauged else MODEL
    link = LINK if joint.strained else ""
    text = model.format(title=title, limb=limb, model=joint.model, link=link)
    (place / "model.py").write_text(text, "utf-8")
    told = {
        "model": "model.py",
        "train": [f"{name}.csv" for name in TRAINING],
        "held_out": [f"{name}.csv" for name in HELD_OUT],
        "options": ["--hold", "zero"],
    }
    (place / "case.json").write_text(json.dumps(told, indent=1) + "\n", "utf-8")
    return place


def _plan(drive: Machine, kind: str, seed: int) -> Plan:
    random = np.random.default_rng(seed)
    time = np.arange(drive.samples) / drive.rate
    feed, reference = np.zeros((len(time), 1)), np.zeros((len(time), 1))
    shape = (len(time), len(drive.sensors))
    if kind == "multisine":
        feed[:, 0] = TORQUE * excitation(kind, time, drive.drive.band, random)
    else:
        reference[:, 0] = ANGLE * excitation(kind, time, SLOW_BAND, random)
    return Plan(
        time=time,
        feed=feed,
        reference=reference,
        noise=random.normal(size=shape) * [sensor.noise for sensor in drive.sensors],
        early=np.zeros(shape, np.int64),
        closed=True,
    )


def _write(path: Path, run: Run, sensors: tuple[Sensor, ...]) -> None:
    columns = np.column_stack((run.time, run.commands, run.readings))
    read = (f"{sensor.name} [{sensor.unit}]" for sensor in sensors)
    header = ",".join(("time [s]", "T_motor [N*m]", *read))
    np.savetxt(path, columns, "%.9g", delimiter=",", header=header, comments="")
