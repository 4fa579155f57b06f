"""Elbow errors of retargeted arms, with and without different arm proportions."""

import numpy as np
import pytest

from kinesic.bench.capture.elbow_errors import measure_elbow_errors
from kinesic.body.rotation import rotation_about
from kinesic.capture.clip import ArmPath

TWIST = rotation_about(np.array([0.0, 0.0, 1.0]), 0.2)


def arm(upper: float, *, distance: float = 0.7) -> ArmPath:
    """Return a bent arm whose wrist is below its shoulder."""
    cosine = (upper**2 + distance**2 - (1.0 - upper) ** 2) / (2.0 * upper * distance)
    elbow = upper * np.array([np.sqrt(1.0 - cosine**2), 0.0, -cosine])
    return ArmPath(elbow[None], np.array([[0.0, 0.0, -distance]]))


def test_elbow_error_due_to_different_arm_proportions_equals_the_least_possible_error():
    errors, least = measure_elbow_errors(arm(0.44), arm(0.52))
    assert errors == pytest.approx(least)
    assert errors[0] > 5.0
    assert measure_elbow_errors(arm(0.5), arm(0.5))[1] == pytest.approx(0.0, abs=1e-6)


def test_elbow_rotated_about_the_line_from_shoulder_to_wrist_has_an_excess_error():
    actor, robot = arm(0.5), arm(0.5)
    errors, least = measure_elbow_errors(actor, ArmPath(robot.elbow @ TWIST.T, robot.wrist))
    assert least == pytest.approx(0.0, abs=1e-6)
    assert errors[0] == pytest.approx(np.degrees(2.0 * np.arcsin(np.sin(0.1) * robot.elbow[0, 0] / 0.5)))
