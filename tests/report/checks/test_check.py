"""How a value is judged: a goal that is missed warns, by far it is poor, and a danger fails."""

from math import nan

import numpy as np
import pytest

from kinesic.controller.performance import Performance
from kinesic.report.checks.check import GRAVITY, LIMITS, Check, format_time, grade
from kinesic.report.checks.content import content_checks
from kinesic.report.checks.servos import draw_load, loads, power_checks
from kinesic.report.checks.twin import measure_tracking, stroke_errors

POOR = {  # what an audience sees
    "collision.foreseen": 0.0,
    "collision.pace": 0.5,
    "meaning.performed": 0.9,
    "amplitude.path": 0.25,
    "timing.shift": 0.5,
    "timing.twin": 0.1,
    "timing.arrival": 0.0,
    "timing.stroke_median": 0.08,
    "timing.stroke_p95": 0.2,
    "tracking.rmse": 3.0,
    "tracking.p95": 7.5,
    "tracking.max": 15.0,
    "tracking.lateness": 0.1,
    "servo.saturation": 0.5,
    "smoothness.hands": 10.0,
    "measured.pace": 0.5,
    "measured.rmse": 3.0,
    "measured.p95": 7.5,
    "measured.max": 15.0,
}
FATAL = {
    "limits.margin",
    *(f"limits.{each}" for each in ("position", "speed", "acceleration", "jerk", "reserve", "duty")),
    *("collision.plan", "collision.twin", "collision.penetrations", "collision.performed", "measured.performed"),
}
LOW = {  # of which less is worse
    *("limits.margin", "collision.plan", "collision.twin", "collision.foreseen", "collision.pace"),
    *("collision.performed", "meaning.performed", "tracking.restoring", "measured.performed", "measured.pace"),
}


@pytest.mark.parametrize("name", LIMITS)
def test_value_at_its_limit_passes_and_one_beyond_warns_or_fails(name: str):
    worse = -1.0 if name in LOW else 1.0
    bound = POOR.get(name, 0.0)
    limit = 0.5 if name == "limits.holding" else bound - 0.1 * worse  # well inside of what is poor
    assert Check.of(name, limit, limit).status == "pass"
    assert Check.of(name, limit + 0.01 * worse, limit).status == ("fail" if name in FATAL else "warn")
    assert Check.of(name, limit + 0.01 * worse, limit, slack=0.02).status == "pass"
    assert Check.of(name, nan, limit).status == ("fail" if name in FATAL else "poor" if name in POOR else "warn")


@pytest.mark.parametrize(("name", "bound"), POOR.items())
def test_goal_missed_by_far_is_poor(name: str, bound: float):
    worse = -1.0 if name in LOW else 1.0
    limit = bound - 0.1 * worse
    assert Check.of(name, bound, limit).status == "warn"
    found = Check.of(name, bound + 0.001 * worse, limit, "somewhere")
    assert (found.status, found.limit, found.at_least) == ("poor", bound, name in LOW)
    assert (found.value, found.unit, found.where) == (bound + 0.001 * worse, LIMITS[name].unit, "somewhere")


def test_load_beyond_what_a_servo_bears_for_long_fails():
    assert Check.of("limits.holding", 0.8, 0.5).status == "warn"
    found = Check.of("limits.holding", 0.81, 0.5, "l_elbow")
    assert (found.status, found.limit, found.where) == ("fail", 0.8, "l_elbow")


def test_gravest_check_grades_a_performance():
    def graded(*names: str) -> str:
        return grade(Check("x", each, 0.0, 0.0, "m") for each in names)

    assert (graded(), graded("pass", "warn")) == ("ok", "ok")
    assert graded("warn", "poor", "pass") == "poor"
    assert graded("poor", "fail", "pass") == "fail"
    assert list(GRAVITY) == sorted(GRAVITY, key=lambda each: GRAVITY[each]) == ["fail", "poor", "warn", "pass"]


def test_time_of_a_place_has_hundredths_and_no_negative_zero():
    assert [format_time(time) for time in (1.234, -0.001, 12.0)] == ["at 1.23 s", "at 0.00 s", "at 12.00 s"]


def test_share_that_is_performed_names_what_is_dropped(calm: Performance, hurried: Performance):
    whole, part = (content_checks(each)[0] for each in (calm, hurried))
    assert (whole.name, whole.value, whole.status, whole.where) == ("meaning.performed", 1.0, "pass", "")
    assert (part.value, part.status) == (0.75, "poor")
    assert part.where.startswith("dropped: xyzzy")


def test_tracking_figures_are_those_of_the_strokes(hurried: Performance):
    found = measure_tracking(hurried)
    errors = [abs(error) for error, _ in stroke_errors(hurried) if error is not None]
    assert errors
    assert found.strokes == len(stroke_errors(hurried))
    assert found.strokes_lost == found.strokes - len(errors)
    assert found.stroke_median_s == pytest.approx(np.median(errors))
    assert found.stroke_p95_s == pytest.approx(np.percentile(errors, 95))
    assert found.min_distance_m == hurried.measured.clearance.distances.min()
    assert (found.rmse_deg, found.p95_deg, found.max_deg) == (
        hurried.tracking.rmse,
        hurried.tracking.p95,
        hurried.tracking.max,
    )


def test_planned_duty_is_the_largest_of_each_hinge(hurried: Performance):
    names = hurried.plan.setup.robot.skeleton.names
    largest = np.abs(hurried.reference.duties).max(axis=0)
    assert {load.hinge: load.planned for load in loads(hurried)} == pytest.approx(
        dict(zip(names, largest.tolist(), strict=True))
    )


def test_draw_is_held_against_the_supply(hurried: Performance):
    supply, power = hurried.plan.setup.robot.supply, hurried.measured.power
    found = draw_load(hurried)
    assert found.allowed == supply.amps
    assert found.peak_at == hurried.measured.times[power.peak.argmax()]
    assert found.mean == pytest.approx(power.mean.mean())
    checks = {check.name: check for check in power_checks(hurried)}
    assert checks["power.peak"].value == power.peak.max()
    assert checks["power.mean"].value == pytest.approx(power.mean.mean())
    assert checks["power.peak"].limit == checks["power.mean"].limit == supply.amps
    assert checks["power.peak"].where == format_time(found.peak_at)
    if power.warming:
        assert checks["power.warming"].value == found.warming == max(rise.max() for rise in power.warming.values())
        assert checks["power.warming"].where.startswith(f"{found.warmest} at ")
