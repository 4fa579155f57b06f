from math import degrees, radians

import numpy as np
import pytest

from kinesic.bench.naturalness.body import MIN_VISIBLE_TURN, BodyMeasures, body_metrics, measure_body
from kinesic.body.robot import Robot

ROBOT = Robot.load()


def measure_turn(**hinges: float) -> BodyMeasures:
    """Measure a motion from rest to the given angles [deg] and back."""
    angles = np.repeat(ROBOT.skeleton.rest[None], 3, axis=0)
    for name, angle in hinges.items():
        angles[1, ROBOT.skeleton.names.index(name)] += radians(angle)
    return measure_body(ROBOT, angles)


def test_head_trunk_and_shoulder_rotations_are_measured_separately():
    assert degrees(measure_turn(skullbase_tilt=5).head) == pytest.approx(5, abs=1e-3)
    level = measure_turn(vl5_tilt=6, skullbase_tilt=-6)
    assert degrees(level.head) == pytest.approx(0, abs=1e-3)
    assert degrees(level.trunk) == pytest.approx(6, abs=1e-3)
    assert degrees(measure_turn(r_sternoclavicular_abduct=12).shoulders) == pytest.approx(12)
    assert measure_turn(l_shoulder_flexion=50, r_elbow_flexion=20) == pytest.approx(BodyMeasures(), abs=1e-6)


def test_rotations_over_one_degree_count_as_motion():
    assert BodyMeasures(shoulders=1.1 * MIN_VISIBLE_TURN).moves
    assert not BodyMeasures(0.9 * MIN_VISIBLE_TURN, 0.9 * MIN_VISIBLE_TURN, 0.9 * MIN_VISIBLE_TURN).moves


def test_body_rotation_metrics_state_the_human_reference_range():
    bodies = [("beat", "beat", BodyMeasures(head=radians(3))), ("stop", "emblem", BodyMeasures())]
    metrics = {metric.name.removeprefix("naturalness."): metric for metric in body_metrics("naturalness", bodies)}
    assert (metrics["whole_body"].value, metrics["whole_body"].ok) == (0.5, False)
    assert (metrics["whole_body_head"].value, metrics["whole_body_trunk"].value) == (0.5, 0.0)
    assert metrics["body.beat.head"].value == pytest.approx(3)
    assert metrics["body.beat.head"].why == "people about 2 to 4"
    assert metrics["body.emblem.head"].value == 0.0
