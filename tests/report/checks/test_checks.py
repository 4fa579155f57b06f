"""Statuses of every check, as measured and with one wrong value."""

import json
from dataclasses import replace
from importlib import import_module
from inspect import getmembers, isfunction
from pkgutil import iter_modules

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.command import Power
from kinesic.body.description import Supply
from kinesic.body.dynamics import Clearance
from kinesic.controller.dry_run import dry_run
from kinesic.metrics.dry_run import DryRun
from kinesic.report import checks as package
from kinesic.report.checks import Check, checks, grade
from kinesic.report.checks.twin import INVISIBLE_JERK
from kinesic.report.report import report
from kinesic.session.plan import plan
from kinesic.sim.servo_factors import PESSIMISTIC_FACTORS
from tests.performances import bearing

BML = """
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="2.0"/>
  <head id="h" lexeme="NOD" start="1.5"/>
</bml>
"""
NAMES = {
    *(f"limits.{name}" for name in ("margin", "position", "speed", "acceleration", "jerk", "reserve")),
    *("limits.duty", "limits.holding", "collision.plan", "collision.twin", "collision.penetrations"),
    *("collision.foreseen", "collision.pace", "collision.performed"),
    *(f"timing.{name}" for name in ("shift", "twin", "arrival", "stroke_median", "stroke_p95")),
    *(f"tracking.{name}" for name in ("rmse", "p95", "max", "lateness")),
    *("meaning.performed", "amplitude.path"),
    *("servo.saturation", "servo.load", "power.peak", "power.mean", "smoothness.hands"),
}


@pytest.fixture(scope="module")
def done(known) -> DryRun:
    return dry_run(plan(BML, known))


def found(performance):
    return {check.name: check for check in checks(performance)}


def with_measured(performance, **changes):
    return replace(performance, measured=replace(performance.measured, **changes))


def with_setup(performance, **changes):
    plan = replace(performance.plan, setup=replace(performance.plan.setup, **changes))
    return replace(performance, reference=replace(performance.reference, plan=plan))


def test_report_calls_every_check_function_of_the_package():
    modules = [import_module(f"{package.__name__}.{module.name}") for module in iter_modules(package.__path__)]
    for module in modules:
        for name, function in getmembers(module, isfunction):
            if name.endswith("_checks") and function.__module__ == module.__name__:
                assert function in package.CHECK_FUNCTIONS, f"add {name} to kinesic/report/checks/__init__.py"


def test_unhurried_gesture_passes_every_check(done):
    verdicts = found(done)
    assert NAMES - set(verdicts) == set()
    assert {check.name: check for check in verdicts.values() if check.status != "pass"} == {}
    for check in verdicts.values():
        assert np.isfinite(check.value), check
        assert check.value >= check.limit if check.at_least else check.value <= 1.001 * check.limit, check


@pytest.mark.parametrize("name", ["limits.speed", "limits.acceleration", "limits.jerk", "limits.duty"])
def test_limit_checks_name_joint_and_time_of_the_peak(done, name):
    check = found(done)[name]
    hinge, _, time = check.where.partition(" at ")
    assert hinge in done.plan.setup.robot.skeleton.names
    assert 0.0 <= float(time.removesuffix(" s")) <= done.plan.trajectory.duration


@pytest.mark.parametrize("quantity", ["speed", "acceleration", "jerk"])
def test_exceeded_motion_limit_fails_its_check(done, quantity):
    limits = done.plan.setup.limits
    peak = done.reference.peaks.by_quantity[quantity]
    for share, status in ((1.0, "pass"), (0.9985, "fail")):
        tight = replace(limits, **{quantity: sealed(getattr(limits, quantity) * peak.ratios.max() * share)})
        narrow = with_setup(done)
        narrow.plan.setup.__dict__["limits"] = tight  # what the cached property would work out
        check = found(narrow)[f"limits.{quantity}"]
        assert (check.status, check.value) == (status, pytest.approx(1 / share))


def test_joint_angle_2_degrees_beyond_its_limit_fails_position_and_margin_checks(done):
    angles = done.plan.trajectory.sample(np.linspace(0.0, done.plan.trajectory.duration, 5000))[0]
    limits = done.plan.setup.limits
    highest = angles[:, 5].max()
    upper = limits.upper.copy()
    upper[5] = highest - np.radians(2.0)
    skeleton = done.plan.setup.robot.skeleton
    hinges = tuple(replace(h, upper=float(upper[k])) if k == 5 else h for k, h in enumerate(skeleton.hinges))
    narrow = with_setup(done, robot=replace(done.plan.setup.robot, skeleton=replace(skeleton, hinges=hinges)))
    verdicts = found(narrow)
    assert verdicts["limits.margin"].status == "fail"
    assert verdicts["limits.margin"].value == pytest.approx(-2.0, abs=0.01)
    assert verdicts["limits.margin"].where == skeleton.names[5]
    assert verdicts["limits.position"].status == "fail"


def test_duty_above_one_fails_and_names_joint_and_time(done):
    duties = done.reference.duties.copy()
    duties[120, 7] = -1.2
    check = found(replace(done, reference=replace(done.reference, duties=duties)))["limits.duty"]
    assert (check.status, check.value) == ("fail", 1.2)
    assert check.where == f"{done.plan.setup.robot.skeleton.names[7]} at 1.20 s"


def test_nan_servo_duty_fails_its_check(done):
    duties = done.reference.duties.copy()
    duties[130, 7] = np.nan
    check = found(replace(done, reference=replace(done.reference, duties=duties)))["limits.duty"]
    assert check.status == "fail"
    assert check.where == f"{done.plan.setup.robot.skeleton.names[7]} at 1.30 s"


@pytest.mark.parametrize(("share", "status", "limit"), [(0.39, "pass", 0.4), (0.5, "warn", 0.4), (0.81, "fail", 0.8)])
def test_holding_torque_above_its_limits_warns_or_fails(done, known, share, status, limit):
    class Loaded:
        """Dynamics of a robot with a given holding torque in one hinge."""

        load = known.dynamics.load

        def torques(self, angles, speeds, accelerations):
            assert not speeds.any()
            assert not accelerations.any()
            torques = np.zeros(angles.shape)
            torques[40, 3] = -share * known.robot.drives[3].stall
            return torques

    check = found(with_setup(done, dynamics=Loaded()))["limits.holding"]
    assert (check.status, check.limit) == (status, limit)
    assert check.value == pytest.approx(share)
    assert check.where == f"{known.robot.skeleton.names[3]} at 2.00 s"


@pytest.mark.parametrize(
    ("distance", "near", "through"), [(0.011, "pass", "pass"), (0.009, "fail", "pass"), (-0.001, "fail", "fail")]
)
def test_clearance_checks_name_the_body_pair_and_the_time(done, distance, near, through):
    distances = done.measured.clearance.distances.copy()
    distances[150] = distance
    pairs = list(done.measured.clearance.pairs)
    pairs[150] = ("l_wrist", "vl5")
    verdicts = found(with_measured(done, clearance=Clearance(sealed(distances), pairs)))
    assert verdicts["collision.twin"].status == near
    assert verdicts["collision.twin"].where == "l_wrist and vl5 at 1.50 s"
    assert verdicts["collision.penetrations"].status == through
    assert verdicts["collision.penetrations"].value == (through == "fail")
    assert verdicts["collision.plan"].status == "pass"


@pytest.mark.parametrize(("ticks", "status"), [(5, "warn"), (25, "poor")])
def test_tracking_delay_of_the_twin_is_measured_and_graded_warn_or_poor(done, ticks, status):
    angles = np.concatenate([np.repeat(done.measured.angles[:1], ticks, axis=0), done.measured.angles[:-ticks]])
    speeds = np.concatenate([np.zeros((ticks, angles.shape[1])), done.measured.velocities[:-ticks]])
    hands = {
        side: np.concatenate([np.repeat(path[:1], ticks, axis=0), path[:-ticks]])
        for side, path in done.measured.hands.items()
    }
    late = with_measured(done, angles=angles, velocities=speeds, hands=hands)
    verdicts = found(late)
    moving = np.isfinite(late.tracking_delays)
    assert late.tracking_delays[moving] == pytest.approx(done.tracking_delays[moving] + 0.01 * ticks, abs=0.002)
    for name in ("timing.twin", "timing.stroke_median", "tracking.lateness"):
        assert verdicts[name].status == status, name
    for name in ("tracking.rmse", "tracking.p95"):
        assert verdicts[name].status != "pass", name
    assert verdicts["timing.twin"].value == pytest.approx(0.01 * ticks, abs=0.005)
    assert verdicts["timing.twin"].where.split(" at ")[0] in ("stroke of offer (g)", "stroke of NOD (h)")


def test_passed_tracking_checks_have_the_limits_of_the_reference_page(done):
    verdicts = [found(done)[f"tracking.{name}"] for name in ("rmse", "p95", "max", "lateness")]
    assert {check.status for check in verdicts} == {"pass"}
    assert [check.limit for check in verdicts] == [0.2, 2.5, 5.0, 0.030]


def test_stroke_that_the_hand_never_reaches_is_counted_and_named_as_poor(done):
    still = {side: np.repeat(path[:1], len(path), axis=0) for side, path in done.measured.hands.items()}
    check = found(with_measured(done, hands=still))["timing.arrival"]
    assert (check.status, check.value, check.where) == ("poor", 1.0, "stroke of offer (g)")


def test_servo_saturation_and_overload_get_the_status_warn(done):
    duties = np.zeros_like(done.measured.duties)
    duties[50:60, 4], duties[:, 9] = 1.5, 0.31
    names = done.plan.setup.robot.skeleton.names
    verdicts = found(replace(done, measured=bearing(done.measured, duties)))
    assert verdicts["servo.saturation"].status == "warn"
    assert verdicts["servo.saturation"].value == pytest.approx(0.1)
    assert verdicts["servo.saturation"].where == f"{names[4]} from 0.50 s"
    assert verdicts["servo.load"].status == "warn"
    assert verdicts["servo.load"].value == pytest.approx(0.31)
    assert verdicts["servo.load"].where == names[9]


def test_current_is_checked_only_if_the_robot_has_a_supply(done):
    count = len(done.measured.times)
    peak = np.full(count, 2.0)
    peak[30] = 6.0
    power = Power(
        sealed(np.full(count, 1.5)), sealed(peak), 90.0, 12.0, {"l_elbow_flexion": sealed(np.linspace(0, 50, count))}
    )
    robot = done.plan.setup.robot
    fed = with_measured(with_setup(done, robot=replace(robot, supply=Supply(12.0, 5.0))), power=power)
    verdicts = found(fed)
    assert (verdicts["power.peak"].status, verdicts["power.peak"].value) == ("warn", 6.0)
    assert verdicts["power.peak"].where == "at 0.30 s"
    assert (verdicts["power.mean"].status, verdicts["power.mean"].value) == ("pass", 1.5)
    assert verdicts["power.warming"].status == "warn"
    assert verdicts["power.warming"].where.startswith("l_elbow_flexion at ")
    without = found(with_setup(done, robot=replace(robot, supply=None)))
    assert set(found(done)) - set(without) == {"power.peak", "power.mean"}


@pytest.mark.parametrize(("reach", "status"), [(0.002, "warn"), (0.01, "poor")])
def test_hands_of_the_twin_that_tremble_at_5_hz_get_the_status_warn_or_poor(done, reach, status):
    times = done.measured.times
    tremble = reach * np.sin(2 * np.pi * 5 * times)
    hands = {side: path + tremble[:, None] for side, path in done.measured.hands.items()}
    check = found(with_measured(done, hands=hands))["smoothness.hands"]
    assert check.status == status
    assert check.where == "r_hand"


def test_empty_block_is_checked_only_for_limits_collision_servos_power_and_shifts(known):
    verdicts = found(dry_run(plan('<bml id="b"/>', known)))
    groups = ("limits", "collision", "servo", "power")
    expected = {name for name in NAMES if name.split(".")[0] in groups} | {"timing.shift"}
    assert NAMES & set(verdicts) == expected, "NAMES above lists the checks of every performance"
    assert all(check.status == "pass" for check in verdicts.values())


def test_metrics_of_two_twins_are_reported(done):
    other = dry_run(done.plan, twin=PESSIMISTIC_FACTORS)
    data = report(done, source="x", other_runs=(other,))
    assert list(data["twins"]) == ["nominal", "pessimistic"]
    alone = report(other, source="x")
    assert data["twins"]["pessimistic"] == alone["twins"]["pessimistic"]
    assert data["checks"] == report(done, source="x")["checks"]
    assert found(done)["tracking.rmse"].limit == 0.2
    assert found(other)["tracking.rmse"].limit == 1.0


def test_report_metrics_equal_the_values_of_the_checks(done):
    data = json.loads(json.dumps(report(done, source="x"), allow_nan=False))
    verdicts = found(done)
    assert data["ok"]
    assert data["limits"]["violations"] == 0
    assert data["tracking"]["rmse_deg"] == verdicts["tracking.rmse"].value
    assert data["power"]["peak_a"] == verdicts["power.peak"].value
    assert data["collision"]["min_distance_m"] == min(
        verdicts["collision.plan"].value, verdicts["collision.twin"].value
    )
    assert max(abs(late) for late in data["tracking"]["lateness_s"].values()) == verdicts["tracking.lateness"].value
    assert data["smoothness"]["rms_jerk_rad_s3"] > 0
    assert data["smoothness"]["hands"]["r"]["sparc_planned"] < 0
    assert data["timing"]["dry_run_ms"] > 1000 * done.dry_run_seconds


def test_most_severe_check_is_the_grade_of_the_report():
    judged = {value: Check.of("timing.shift", value, 0.01) for value in (0.0, 0.4, 0.6)}
    assert [(check.status, check.limit) for check in judged.values()] == [("pass", 0.01), ("warn", 0.01), ("poor", 0.5)]
    failed = Check.of("collision.twin", 0.001, 0.01)
    assert grade([judged[0.0], judged[0.4]]) == "ok"
    assert grade([judged[0.6], judged[0.0]]) == "poor"
    assert grade([judged[0.6], failed]) == "fail"
    assert grade([]) == "ok"


@pytest.mark.parametrize(("share", "status"), [(1.0, "pass"), (0.95, "warn"), (0.9, "warn"), (0.8, "poor")])
def test_fraction_of_performed_behaviours_below_one_warns_and_a_small_fraction_is_poor(share, status):
    assert Check.of("meaning.performed", share, 1.0).status == status


def test_report_names_dropped_behaviours_and_shortened_strokes(hurried, known):
    verdicts = found(hurried)
    assert verdicts["meaning.performed"].value == 0.75
    assert verdicts["meaning.performed"].where == "dropped: xyzzy (odd)"
    assert verdicts["timing.shift"].where.startswith("3 moved, most ")
    assert verdicts["timing.shift"].where.endswith(" of offer (rushed)")
    circle = '<gesture id="round" lexeme="circle" mode="RIGHT_HAND" start="0" strokeStart="0.6" strokeEnd="{}"/>'
    hasty, leisurely = (
        found(dry_run(plan(f'<bml id="b">{circle.format(end)}</bml>', known)))["amplitude.path"] for end in (0.9, 1.2)
    )
    assert hasty.value > 0.25
    assert (hasty.status, hasty.where) == ("poor", "r_hand in circle (round), smaller for lack of time")
    assert (leisurely.status, leisurely.where) == ("pass", "")


def test_invisible_jerk_is_that_of_a_shake_of_half_a_millimetre_at_5_hz():
    times = np.linspace(0.0, 1.0, 5000, endpoint=False)
    jerk = 0.0005 * (2 * np.pi * 5.0) ** 3 * np.sin(2 * np.pi * 5.0 * times)
    assert pytest.approx(np.mean(jerk**2)) == INVISIBLE_JERK
