from math import degrees, radians

import numpy as np
import pytest

from kinesic.bench.naturalness.body import LEAST_TURN, BodyMeasures, body_figures, measure_body
from kinesic.body.robot import Robot

ROBOT = Robot.load()


def turned(**hinges: float) -> BodyMeasures:
    """The body of a motion that goes from rest to some angles [deg] and back."""
    angles = np.repeat(ROBOT.skeleton.rest[None], 3, axis=0)
    for name, angle in hinges.items():
        angles[1, ROBOT.skeleton.names.index(name)] += radians(angle)
    return measure_body(ROBOT, angles)


def test_parts_are_measured_apart_and_the_head_in_the_room():
    assert degrees(turned(skullbase_tilt=5).head) == pytest.approx(5, abs=1e-3)
    level = turned(vl5_tilt=6, skullbase_tilt=-6)
    assert degrees(level.head) == pytest.approx(0, abs=1e-3)
    assert degrees(level.trunk) == pytest.approx(6, abs=1e-3)
    assert degrees(turned(r_sternoclavicular_abduct=12).shoulders) == pytest.approx(12)
    assert turned(l_shoulder_flexion=50, r_elbow_flexion=20) == pytest.approx(BodyMeasures(), abs=1e-6)


def test_what_turns_by_more_than_a_degree_moves():
    assert BodyMeasures(shoulders=1.1 * LEAST_TURN).moves
    assert not BodyMeasures(0.9 * LEAST_TURN, 0.9 * LEAST_TURN, 0.9 * LEAST_TURN).moves


def test_shares_and_medians_stand_beside_what_people_do():
    bodies = [("beat", "beat", BodyMeasures(head=radians(3))), ("stop", "emblem", BodyMeasures())]
    found = {figure.name.removeprefix("naturalness."): figure for figure in body_figures("naturalness", bodies)}
    assert (found["whole_body"].value, found["whole_body"].ok) == (0.5, False)
    assert (found["whole_body_head"].value, found["whole_body_trunk"].value) == (0.5, 0.0)
    assert found["body.beat.head"].value == pytest.approx(3)
    assert found["body.beat.head"].why == "people about 2 to 4"
    assert found["body.emblem.head"].value == 0.0
