"""Clearance with the errors that were measured, on a twin that was slowed or stopped and on one that was not."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.controller.performance import Performance
from kinesic.controller.watch.clearance import EASY
from kinesic.report.checks.watch import watch_checks


def found(performance: Performance):
    return {check.name: check for check in watch_checks(performance)}


def with_rooms(performance: Performance, rooms) -> Performance:
    other = replace(performance)
    other.__dict__["rooms"] = sealed(rooms)
    return other


@pytest.mark.parametrize(
    ("room", "status"), [(EASY + 0.01, "pass"), (EASY - 0.01, "warn"), (0.01, "warn"), (-0.01, "poor")]
)
def test_little_clearance_warns_and_none_is_poor(calm, room, status):
    rooms = np.full_like(calm.rooms, 1.0)
    rooms[7] = room * calm.plan.setup.robot.least_clearance
    check = found(with_rooms(calm, rooms))["collision.foreseen"]
    assert (check.status, check.value) == (status, rooms[7])
    assert check.where == "at 0.70 s"


@pytest.mark.parametrize(("pace", "status"), [(1.0, "pass"), (0.9, "warn"), (0.3, "poor")])
def test_time_that_ran_slower_is_told(calm, pace, status):
    check = found(replace(calm, least_pace=pace))["collision.pace"]
    assert (check.status, check.value) == (status, pace)


def test_a_performance_that_was_stopped_fails(calm):
    half = len(calm.reference.times) // 2
    cut = replace(calm, reference=replace(calm.reference, times=calm.reference.times[:half]))
    cut.__dict__["rooms"] = calm.rooms
    check = found(cut)["collision.performed"]
    assert check.status == "fail"
    assert check.value == pytest.approx(0.5, abs=0.01)
    assert "stopped before contact" in check.where
    assert found(calm)["collision.performed"].status == "pass"


def test_the_errors_that_were_measured_are_what_is_checked(calm):
    """The same plan with a right arm that strays towards the body and away from it has less room."""
    hinge = calm.plan.setup.robot.skeleton.joint("r_shoulder_abduct")
    angles = np.array(calm.measured.angles)
    angles[:, hinge] += np.radians(25.0)
    strayed = replace(calm, measured=replace(calm.measured, angles=sealed(angles)))
    assert found(strayed)["collision.foreseen"].value < 0.0 < found(calm)["collision.foreseen"].value
