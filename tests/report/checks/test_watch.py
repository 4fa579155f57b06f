"""Checks of the clearance watch, for slowed, stopped and undisturbed twins."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.controller.watch.clearance import SLOWING_FRACTION
from kinesic.metrics.dry_run import COMMANDS_PER_LOOK, DryRun
from kinesic.report.checks.watch import watch_checks


def found(performance: DryRun):
    return {check.name: check for check in watch_checks(performance)}


def with_clearances(performance: DryRun, clearances) -> DryRun:
    other = replace(performance)
    other.__dict__["clearance_forecast"] = sealed(clearances)
    return other


@pytest.mark.parametrize(
    ("room", "status"),
    [(SLOWING_FRACTION + 0.01, "pass"), (SLOWING_FRACTION - 0.01, "warn"), (0.01, "warn"), (-0.01, "poor")],
)
def test_small_predicted_clearance_gets_the_status_warn_and_a_negative_one_poor(calm, room, status):
    clearances = np.full_like(calm.clearance_forecast, 1.0)
    clearances[7] = room * calm.plan.setup.robot.min_clearance
    check = found(with_clearances(calm, clearances))["collision.foreseen"]
    assert (check.status, check.value) == (status, clearances[7])
    assert check.where == "at 0.70 s"


@pytest.mark.parametrize(("pace", "status"), [(1.0, "pass"), (0.9, "warn"), (0.3, "poor")])
def test_performance_slowed_by_the_clearance_watch_is_reported(calm, pace, status):
    check = found(replace(calm, min_pace=pace))["collision.pace"]
    assert (check.status, check.value) == (status, pace)


def test_performance_stopped_before_contact_fails_the_collision_check(calm):
    half = len(calm.reference.times) // 2
    cut = replace(calm, reference=replace(calm.reference, times=calm.reference.times[:half]))
    cut.__dict__["clearance_forecast"] = calm.clearance_forecast[: half // COMMANDS_PER_LOOK]
    check = found(cut)["collision.performed"]
    assert check.status == "fail"
    assert check.value == pytest.approx(0.5, abs=0.01)
    assert "stopped before contact" in check.where
    assert found(calm)["collision.performed"].status == "pass"


def test_tracking_error_towards_the_body_makes_the_predicted_clearance_negative(calm):
    """Compare one plan with and without an arm error towards the body."""
    hinge = calm.plan.setup.robot.skeleton.joint("r_shoulder_abduct")
    angles = np.array(calm.measured.angles)
    angles[:, hinge] += np.radians(25.0)
    strayed = replace(calm, measured=replace(calm.measured, angles=sealed(angles)))
    assert found(strayed)["collision.foreseen"].value < 0.0 < found(calm)["collision.foreseen"].value
