"""From an answer to the zero of its controller, and the zeros to hold it against."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.flegx_story.leg import LENGTH
from benchmarks.flegx_story.shaping import (
    designed,
    friction_pole,
    plant_of,
    real_poles,
    rubbed,
    speed_of_the_test,
)
from benchmarks.flegx_story.telling import model_and_concealed
from benchmarks.flegx_story.train import RATIO, WORM
from bondgraph import Design, load_model
from flegx_models import models
from flegx_models.tuned_zeros import tuning_tests

RATIOS = {"motor": RATIO, "worm": WORM, "joint": 1.0, "support": LENGTH}
"""Speed of a place per speed of the joint."""

DRY = ("coulomb_friction", "direction_dependent_friction", "load_dependent_friction")
"""Frictions with a constant size. To first harmonic an asymmetry beside it takes no
part, and no more does what a load adds that changes its sign with the acceleration."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundZero:
    """The friction that was found, in N·m at the joint, and the lead for it."""

    friction: float
    design: Design

    @property
    def zero(self) -> float:
        """The lead's zero in rad/s."""
        return float(self.design.controller.value("zero"))


def found_zero(answer: Path) -> FoundZero | None:
    """Return the controller for the model that an answer gives; None without friction.

    The formula needs one dry friction of which a part is constant, and a real pole:
    beside a hysteresis, which is a spring at last, there may be none. And it needs a
    plant that answers at rest, which behind a dead zone it does not.
    """
    told: dict[str, Any] = json.loads(answer.read_text("utf-8"))
    dry = [one for one in told["findings"] if one["physics"] in DRY]
    sizes = [
        it["value"]
        for one in dry
        for it in one["parameters"].values()
        if it["unit"] != "1"
    ]
    if len(dry) != 1 or len(sizes) != 1 or dry[0]["place"] not in RATIOS:
        return None
    (one,), (size,) = dry, sizes
    ratio = RATIOS[one["place"]]
    text = answer.with_suffix(".py")
    text.write_text(told["model"], "utf-8")
    model, concealed = model_and_concealed(answer.stem)
    speed = ratio * speed_of_the_test(model)
    plant = plant_of(rubbed(load_model(f"{text}:model"), one["element"], size, speed))
    if not real_poles(plant) or plant.gain == 0.0:
        return None
    behind_the_filter = concealed in ("all", "filter")
    design = designed(model, plant, filtered=not behind_the_filter)
    return FoundZero(friction=ratio * size, design=design)


def printed_zero(model: str) -> float:
    """Return the zero for a model as printed."""
    return friction_pole(plant_of(getattr(models, model)().finish()))


def tuned_zero(model: str) -> float:
    """Return the zero that chapter 6 came to by trying."""
    return next(t.tuned_zero for t in tuning_tests() if t.model == model)
