"""Reported violations of limits, and the verdict, compared with their definitions."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.capture.certification import Certification, certify_clip
from kinesic.capture.reading.text import CaptureError, check_numbers, parse_numbers
from kinesic.capture.violations import Violation, find_violations

from .clips import reach
from .test_retarget import clip_of

PERIOD = 0.01  # [s] time between samples


@pytest.fixture(scope="module")
def certification(known) -> Certification:
    return certify_clip(clip_of(reach(60)), known, "a.bvh")


def resting(known, count: int) -> np.ndarray:
    return np.repeat(known.robot.skeleton.rest[None], count, axis=0)


def violation(known, angles, limit: str, part: str) -> Violation:
    (result,) = [item for item in find_violations(angles, known) if (item.limit, item.part) == (limit, part)]
    return result


def test_resting_robot_violates_no_limit(known):
    assert find_violations(resting(known, 40), known) == ()


def test_constant_velocity_beyond_the_limit_is_reported_with_ratio_time_and_fraction(known):
    name = "r_elbow_flexion"
    column = known.robot.skeleton.names.index(name)
    angles, speed = resting(known, 100), known.limits.speed[column]
    angles[30:50, column] += np.arange(1, 21) * 1.5 * speed * PERIOD
    angles[50:, column] = angles[49, column]
    middle = (known.limits.lower[column] + known.limits.upper[column]) / 2
    angles[:, column] += middle - angles[:, column].mean()
    result = violation(known, angles, "velocity", name)
    assert result.ratio == pytest.approx(1.5)
    assert 0.28 < result.time < 0.51
    assert result.fraction == pytest.approx(0.20, abs=0.03)
    assert str(result).startswith(f"velocity of {name}: 1.50 times the limit at ")
    ratios = [item.ratio for item in find_violations(angles, known)]
    assert ratios == sorted(ratios, reverse=True)


def test_position_beyond_the_range_is_reported_relative_to_its_half_width(known):
    name = "l_elbow_flexion"
    column = known.robot.skeleton.names.index(name)
    half = (known.limits.upper[column] - known.limits.lower[column]) / 2
    angles = resting(known, 50)
    angles[:, column] = known.limits.upper[column] + 0.1 * half
    result = violation(known, angles, "position", name)
    assert (result.ratio, result.fraction) == (pytest.approx(1.1), 1.0)
    angles[:, column] = known.limits.upper[column] + 0.0005 * half
    assert not [item for item in find_violations(angles, known) if item.limit == "position"]


def test_torque_ratio_is_the_duty_of_inverse_dynamics_in_windows_of_any_length(known, monkeypatch):
    monkeypatch.setattr("kinesic.capture.violations.SAMPLES_PER_WINDOW", 7)
    dynamics = SimpleNamespace(
        torques=lambda angles, velocity, acceleration: 3.0 * known.robot.drives.stall + 0 * angles
    )
    results = find_violations(resting(known, 50), replace(known, dynamics=dynamics, shared_limits=known.limits))
    torques = [item for item in results if item.limit == "torque"]
    assert len(torques) == len(known.robot.skeleton.names)
    assert {round(item.ratio, 6) for item in torques} == {3.0}
    assert {item.fraction for item in torques} == {1.0}


def test_duty_ratio_of_a_captured_motion_includes_the_load_torque_and_velocity_of_the_joint(known):
    name = "r_elbow_flexion"
    column = known.robot.skeleton.names.index(name)
    limits = known.limits
    angles = resting(known, 60)
    angles[:, column] += 0.2 * np.sin(np.arange(60) * PERIOD * 25.0)
    velocity = np.diff(angles[:, column]) / PERIOD
    acceleration = np.diff(velocity) / PERIOD
    needed = np.abs(limits.inertial[column] * acceleration).max() / limits.duty[column]
    braked = np.abs(limits.viscous[column] * velocity).max() / limits.duty[column]
    result = violation(known, angles, "duty", name)
    assert needed - braked - 0.05 <= result.ratio <= needed + braked + 0.05
    assert result.ratio > 1.0


def test_clearance_violation_of_a_body_pair_is_reported_once_with_its_worst_time_and_fraction(known):
    required = known.robot.min_clearance
    distances = np.full(50, required)
    distances[[3, 4, 9]] = required - 0.002, required - 0.005, required - 0.001
    clearance = SimpleNamespace(distances=distances, pairs=[("hand", "hip")] * 50)
    near = replace(known, distances=SimpleNamespace(clearance=lambda angles: clearance))
    (result,) = find_violations(resting(known, 50), near)
    assert (result.limit, result.part, result.time) == ("clearance", "hand to hip", 0.04)
    assert (result.ratio, result.fraction) == (pytest.approx(1.5), pytest.approx(3 / 50))


@pytest.mark.parametrize(
    ("change", "is_certified"),
    [
        ({"limit_ratio": 1.001, "torque_ratio": 1.001}, True),
        ({"limit_ratio": 1.0011}, False),
        ({"torque_ratio": 1.0011}, False),
        ({"clearance": 0.0099}, False),
        ({"clearance": 0.010}, True),
    ],
)
def test_captured_motion_is_certified_only_within_limits_duty_and_clearance(certification, change, is_certified):
    fine = replace(certification, limit_ratio=0.9, torque_ratio=0.9, clearance=0.02)
    assert replace(fine, **change).is_certified == is_certified


def test_saved_certified_motion_replaces_a_file_only_if_forced(certification, tmp_path):
    path = tmp_path / "motion.csv"
    path.write_text("mine")
    with pytest.raises(ConfigError, match="exists already"):
        certification.save(path)
    assert path.read_text() == "mine"
    assert certification.save(path, force=True) == path
    assert path.read_text().startswith("time_s")


def test_numbers_of_motion_files_are_finite_and_at_most_a_trillion():
    assert parse_numbers([], "f:1").shape == (0,)
    assert parse_numbers(["-1", "2.5"], "f:1").tolist() == [-1.0, 2.5]
    for number in (1e12, -1e12):
        assert parse_numbers([str(number)], "f:1").tolist() == [number]
        with pytest.raises(CaptureError, match="f:1: a number has the size"):
            parse_numbers(["0", str(2 * number)], "f:1")
    for word, problem in (("nan", "not finite"), ("inf", "not finite"), ("-inf", "not finite"), ("x", "could not")):
        with pytest.raises(CaptureError, match=f"f:1: .*{problem}"):
            parse_numbers(["1", word], "f:1")
    with pytest.raises(CaptureError, match="f:2: a number is not finite"):
        check_numbers(np.array([1.0, np.nan]), "f:2")
