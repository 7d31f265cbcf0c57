"""What sensors cannot tell apart is known before anything is claimed."""

import numpy as np
import pytest
from two_inertia_drive import drive, recorded

from bondgraph.diagnosis.separability.records import SeparabilityStatus
from bondgraph.diagnosis.separability.redundancy import overdetermined
from bondgraph.diagnosis.separability.separability import separability

MECHANICAL = ("motor", "shaft", "twist", "load")


def separated(*, load_encoder):
    graph = drive(load_encoder=load_encoder)
    return separability(graph, [recorded(graph, "none", 0, samples=500)])


def test_with_sensors_at_the_motor_all_mechanical_places_look_alike():
    answer = separated(load_encoder=False)
    assert answer.status is SeparabilityStatus.CLASSES
    assert answer.class_of("load") == MECHANICAL
    assert answer.class_of("voltage") == ("armature", "voltage")
    assert answer.angle("motor", "load") < 0.05
    assert answer.angle("motor", "armature") > 20.0
    # Structure alone says the same.
    assert set(answer.structural_classes) == set(answer.classes)
    assert answer.undetectable == ()


def test_a_sensor_is_proposed_that_splits_the_class():
    answer = separated(load_encoder=False)
    best = answer.proposals[0]
    assert best.splits == MECHANICAL
    assert best.quantity == "angular velocity"
    assert best.place in ("twist", "load")
    assert len(best.into) == 4


def test_an_encoder_at_the_load_tells_motor_from_load():
    answer = separated(load_encoder=True)
    assert answer.angle("motor", "load") > 60.0
    assert answer.class_of("motor") == ("motor",)


def test_overdetermined_part_of_a_known_system():
    # x + y, x, y: three equations in two unknowns; z stands alone in the fourth.
    incidence = np.array([[1, 1, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=bool)
    assert overdetermined(incidence).tolist() == [True, True, True, False]


@pytest.mark.parametrize("load_encoder", [True, False])
def test_a_place_is_never_apart_from_itself(load_encoder):
    answer = separated(load_encoder=load_encoder)
    assert np.diag(answer.angles).max() < 1e-3
    np.testing.assert_allclose(answer.angles, answer.angles.T, atol=1e-4)
