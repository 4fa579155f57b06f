"""Tests that certified motions satisfy all limits and stay near the file."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.bench.blocks import find_corpus
from kinesic.body.arrays import sealed
from kinesic.capture.certification import HINGE_COSTS, certify_clip, correlate, largest_limit_ratio, measure_distance
from kinesic.capture.clear_path import bridge_contacts, clear_path
from kinesic.capture.clip import ArmPath, BodyClip, JointClip
from kinesic.capture.derivatives import compute_time_stretch, differentiate
from kinesic.capture.nearest import Course
from kinesic.capture.read import read_clip
from kinesic.capture.retarget import retarget
from kinesic.capture.robot_motion import arm_paths
from kinesic.capture.violations import find_violations
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

from ..performances import CALM_BML
from .clips import reach
from .independent_limits import assert_within_limits
from .test_retarget import clip_of

CORPUS = find_corpus()
FOLDER = CORPUS / "capture" if CORPUS is not None else None
BOTH_SIDES = {"r": np.array([1.0, 1.0, 1.0]), "l": np.array([1.0, -1.0, 1.0])}  # mirror factors
HAS_CLIPS = FOLDER is not None and FOLDER.is_dir()


def own_clip(known, *, speed=1.0, names=None) -> JointClip:
    """Return the joint angles of a planned gesture, faster by a factor."""
    trajectory = plan(CALM_BML, known).trajectory
    times = np.arange(0.0, trajectory.duration + 0.005, 0.01)
    return JointClip(sealed(times / speed), names or known.robot.skeleton.names, sealed(trajectory.angles(times)))


def test_certified_motion_of_a_feasible_clip_differs_by_less_than_half_a_degree(known):
    clip = own_clip(known)
    result = certify_clip(clip, known, "own.csv")
    assert result.violations == ()
    assert result.is_certified
    assert result.nearest.total_stretch == pytest.approx(1.0, abs=1e-3)
    assert np.degrees(np.abs(result.nearest.angles - result.desired.angles).max()) < 0.5
    assert result.distance.wrist_max < 0.005
    assert result.distance.correlation > 0.9999


def test_too_fast_clip_reports_violated_limits_and_is_stretched_in_time(known):
    result = certify_clip(own_clip(known, speed=2.5), known, "own.csv")
    assert {violation.limit for violation in result.violations} >= {"velocity", "acceleration", "jerk"}
    assert result.is_certified
    assert result.nearest.total_stretch > 1.2
    assert result.distance.wrist_max < 0.08
    assert result.distance.correlation > 0.99
    assert_within_limits(result.trajectory, known.limits)


def test_certified_motion_of_a_captured_reach_begins_and_ends_at_rest(known):
    result = certify_clip(clip_of(reach(60)), known, "a.bvh")
    assert result.is_certified
    assert_within_limits(result.trajectory, known.limits)
    ends = result.trajectory.angles(np.array([0.0, result.trajectory.duration]))
    assert ends == pytest.approx(np.tile(known.robot.skeleton.rest, (2, 1)), abs=2e-3)
    assert result.distance.correlation > 0.99


def test_clip_that_begins_and_ends_in_one_posture_keeps_over_80_percent_of_its_motion_range(known):
    result = certify_clip(clip_of(reach(60)), known, "a.bvh")
    extent = np.ptp(result.nearest.angles, axis=0).max()
    assert extent > 0.8 * np.ptp(result.desired.angles, axis=0).max()


def test_clip_is_stretched_in_time_only_around_its_fast_part(known):
    """Use a clip with a fast swing between two slow halves."""
    times = np.linspace(0.0, 6.0, 601)
    swing = 0.6 * np.exp(-(((times - 3.0) / 0.06) ** 2))
    column = known.robot.skeleton.names.index("r_shoulder_flexion")
    lower, upper = known.robot.skeleton.lower[column], known.robot.skeleton.upper[column]
    rest = known.robot.skeleton.rest[column]
    sign = 1.0 if upper - rest > rest - lower else -1.0
    clip = JointClip(sealed(times), ("r_shoulder_flexion",), sealed((rest + sign * swing)[:, None]))
    result = certify_clip(clip, known, "a.csv")
    stretch = result.nearest.stretch
    assert result.is_certified
    assert stretch[280:320].max() > 1.2
    assert stretch[:200].max() == pytest.approx(1.0)
    assert stretch[400:].max() == pytest.approx(1.0)


def reach_towards(wrist, elbow) -> BodyClip:
    """Return a clip whose hanging right arm goes to the given places [arm lengths] and back."""
    blend = np.sin(np.pi * np.linspace(0.0, 1.0, 120)[:, None]) ** 2
    wrists = (1.0 - blend) * [0.1, -0.1, -0.95] + blend * wrist
    elbows = (1.0 - blend) * [0.0, 0.0, -0.52] + blend * elbow
    return BodyClip(
        sealed(np.arange(120) / 30), {"r": ArmPath(sealed(elbows), sealed(wrists))}, sealed(np.zeros((120, 3)))
    )


def test_hand_path_through_the_body_is_moved_around_it(known):
    """Move the right wrist from the side through the belly and back."""
    clip = reach_towards([0.05, 0.45, -0.5], [0.0, -0.1, -0.5])
    result = certify_clip(clip, known, "a.bvh")
    before = known.distances.clearance(result.desired.requested).distances.min()
    assert before < 0.0
    assert any(violation.limit == "clearance" and violation.ratio > 2.0 for violation in result.violations)
    assert result.clearance >= known.robot.min_clearance
    assert result.distance.correlation > 0.8
    times = np.arange(0.0, result.trajectory.duration, 0.005)
    assert known.distances.clearance(result.trajectory.angles(times)).distances.min() > known.robot.min_clearance - 1e-3


def test_detour_with_cheap_hinge_rotations_displaces_the_wrist_less(known):
    """Use a clip in which the right hand enters the hip."""
    angles = retarget(reach_towards([0.0, 0.15, -0.9], [0.0, 0.0, -0.5]), known, "a.bvh").angles
    wrist = arm_paths(known.robot, angles)["r"].wrist
    displacements = []
    for hinge_cost in HINGE_COSTS:
        cleared = clear_path(angles, known, min_clearance=0.012, hinge_cost=hinge_cost)
        assert known.distances.clearance(cleared).distances.min() >= 0.012
        displacements.append(np.linalg.norm(arm_paths(known.robot, cleared)["r"].wrist - wrist, axis=1).max())
    assert displacements[0] < 0.7 * displacements[1]


def test_collision_free_motion_gets_no_detour(known):
    angles = retarget(clip_of(reach(60)), known, "a").angles
    assert known.distances.clearance(angles).distances.min() > 0.012
    np.testing.assert_array_equal(clear_path(angles, known, min_clearance=0.012, hinge_cost=0.1), angles)


def test_contact_of_one_arm_is_left_out_with_its_margin_and_the_other_arm_is_unchanged(known):
    """Bridge a clip in which the right hand enters the belly and the left arm moves freely."""
    angles = retarget(reach_towards([0.05, 0.45, -0.5], [0.0, -0.1, -0.5]), known, "a.bvh").angles.copy()
    left, right = (list(known.robot.arm(side).joints) for side in "lr")
    angles[:, left[-1]] += 0.1 * np.sin(np.arange(len(angles)) / 20.0)
    is_near = known.distances.clearance(angles).distances < 0.012
    first, last = np.flatnonzero(is_near)[[0, -1]]
    bridged = bridge_contacts(angles, known, min_clearance=0.012, margin=0.1)
    assert known.distances.clearance(bridged).distances.min() >= 0.012
    kept = np.r_[: first - 10, last + 11 : len(angles)]
    np.testing.assert_array_equal(bridged[kept], angles[kept])
    np.testing.assert_array_equal(bridged[:, left], angles[:, left])
    assert np.abs(np.diff(bridged[:, right], axis=0)).max() < 0.1
    assert (np.abs(bridged - angles)[[first - 10, last + 10]].max(axis=1) > 0.0).all()


def test_captured_motion_that_overloads_a_drive_by_coupled_loads_is_slowed(known):
    """Triple the motion-dependent torques of the robot's dynamics."""

    class Heavier:
        load = known.dynamics.load

        def torques(self, angles, velocities, accelerations):
            still = known.dynamics.torques(angles, 0.0 * velocities, 0.0 * accelerations)
            return still + 3.0 * (known.dynamics.torques(angles, velocities, accelerations) - still)

    heavier = replace(known, dynamics=Heavier(), shared_limits=known.limits)
    light = certify_clip(own_clip(known, speed=1.5), known, "a")
    result = certify_clip(own_clip(known, speed=1.5), heavier, "a")
    assert result.torque_ratio <= 1.001
    peak = np.abs(result.trajectory.sample(np.arange(0, 3, 0.01))[2]).max()
    assert peak < np.abs(light.trajectory.sample(np.arange(0, 3, 0.01))[2]).max()


def test_clip_gets_an_approach_unless_it_begins_at_rest_and_a_return_unless_it_ends_at_rest(known):
    rest = known.robot.skeleton.rest
    angles = np.tile(rest, (50, 1))
    assert (Course.of(angles, known).first, Course.of(angles, known).last) == (0, 49)
    angles[-1, 3] += 0.1
    course = Course.of(angles, known)
    assert course.first == 0
    assert len(course.angles) > 50 + 25
    np.testing.assert_array_equal(course.angles[-1], rest)
    np.testing.assert_array_equal(course.clip, angles)


def test_approach_from_rest_keeps_clearance_to_the_body(known):
    """Use a clip with hands at the belly from start to end."""
    wrist, elbow = np.tile([0.45, 0.35, -0.55], (60, 1)), np.tile([-0.05, -0.12, -0.5], (60, 1))
    paths = {side: ArmPath(sealed(elbow * sign), sealed(wrist * sign)) for side, sign in BOTH_SIDES.items()}
    clip = BodyClip(sealed(np.arange(60) / 30), paths, sealed(np.zeros((60, 3))))
    result = certify_clip(clip, known, "a.bvh")
    assert result.clearance >= known.robot.min_clearance
    assert result.distance.wrist_max < 0.5


def test_finite_differences_give_the_derivatives_of_a_cubic_captured_motion():
    times = np.arange(50) / 100.0
    velocity, acceleration, jerk = differentiate((times**3)[:, None])
    assert jerk[5:45, 0] == pytest.approx(6.0)
    assert acceleration[20, 0] == pytest.approx(6.0 * times[20], rel=1e-6)
    assert velocity[20, 0] == pytest.approx(3 * times[20] ** 2, abs=0.02)


def test_time_stretch_is_at_least_two_for_a_joint_at_twice_its_velocity_limit(known):
    limits = known.limits
    times = np.arange(100) / 100.0
    angles = np.outer(times, 2.0 * limits.speed * (np.arange(len(limits.speed)) == 4))
    assert compute_time_stretch(angles, limits)[50] >= 2.0


def test_reported_limit_violations_of_a_clip_name_joint_time_and_ratio(known):
    names, limits = known.robot.skeleton.names, known.limits
    angles = np.tile(known.robot.skeleton.rest, (200, 1))
    angles[100:110, 5] += 3.0 * limits.speed[5] / 100.0 * np.arange(1, 11)
    angles[110:, 5] = angles[109, 5]
    found = find_violations(angles, known)
    velocity = next(violation for violation in found if violation.limit == "velocity")
    assert velocity.part == names[5]
    assert velocity.ratio == pytest.approx(3.0, rel=1e-6)
    assert velocity.time == pytest.approx(1.0, abs=0.12)
    assert velocity.fraction == pytest.approx(10 / 200, abs=0.01)
    assert list(found) == sorted(found, key=lambda violation: -violation.ratio)


def test_correlation_of_a_wrist_path_with_its_opposite_is_minus_one():
    path = np.random.default_rng(3).normal(size=(50, 3))
    assert correlate(path, path + 1.0) == pytest.approx(1.0)
    assert correlate(path, -path) == pytest.approx(-1.0)


def hostile_clips(known):
    """Yield names and clips that no robot can follow."""
    rng = np.random.default_rng(5)
    names, lower, upper = known.robot.skeleton.names, known.robot.skeleton.lower, known.robot.skeleton.upper
    for rate in (1.0, 30.0, 1000.0):
        count = min(max(4, int(rate)), 300)
        times = np.arange(count) / rate
        yield (
            f"noise at {rate:g} Hz",
            JointClip(sealed(times), names, sealed(rng.uniform(lower, upper, (count, len(names))))),
        )
    jumps = np.where(np.arange(100)[:, None] % 20 < 10, lower, upper)
    yield "jumps", JointClip(sealed(np.arange(100) / 50), names, sealed(jumps))
    far = {
        side: type(path)(sealed(5.0 * path.elbow), sealed(5.0 * path.wrist))
        for side, path in clip_of(reach(40)).arms.items()
    }
    yield "out of reach", BodyClip(sealed(np.arange(40) / 30), far, sealed(np.zeros((40, 3))))


@pytest.mark.parametrize("kind", [0, 2, 4, *(pytest.param(kind, marks=pytest.mark.soak) for kind in (1, 3))])
def test_extreme_captured_motion_is_certified_within_limits(known, kind):
    _, clip = list(hostile_clips(known))[kind]
    result = certify_clip(clip, known, "hostile")
    assert_within_limits(result.trajectory, known.limits)
    assert largest_limit_ratio(result.trajectory, known) <= 1.001


@pytest.mark.skipif(not HAS_CLIPS, reason="no captured clips (KINESIC_CORPUS)")
@pytest.mark.parametrize("robot", ["upper22", pytest.param("upper36", marks=pytest.mark.soak), "human"])
@pytest.mark.parametrize("step", [192, pytest.param(1, marks=pytest.mark.soak)])
def test_captured_clips_of_the_corpus_are_certified_within_limits(robot, step):
    setup = set_up(robot)
    for path in sorted([*FOLDER.rglob("*.skm"), *FOLDER.rglob("*.bvh")])[::step]:
        result = certify_clip(read_clip(path), setup, path.name)
        assert result.is_certified, (path.name, result.clearance, result.torque_ratio)
        assert_within_limits(result.trajectory, setup.limits)
        assert robot == "human" or result.distance.correlation > 0.9, path.name


def test_reported_wrist_and_elbow_distances_are_those_between_captured_and_robot_paths(known):
    angles = np.repeat(known.robot.skeleton.rest[None], 50, axis=0)
    angles[:, known.robot.skeleton.names.index("r_elbow_flexion")] += np.linspace(0.0, 1.0, 50)
    path = arm_paths(known.robot, angles)["r"]
    wrist, elbow = np.array(path.wrist), np.array(path.elbow)
    wrist[:, 1] += 0.02
    wrist[7, 1] += 0.10
    elbow[:, 2] *= 1.0 - 1e-9
    elbow[:25, 2] -= 0.03
    file = {"r": ArmPath(sealed(elbow), sealed(wrist))}
    result = measure_distance(file, SimpleNamespace(angles=angles), known)
    assert result.wrist_max == pytest.approx(0.12)
    assert result.wrist_rms == pytest.approx(np.sqrt((49 * 0.02**2 + 0.12**2) / 50))
    assert result.elbow_max == pytest.approx(0.03, abs=1e-6)
    assert result.elbow_rms == pytest.approx(0.03 * np.sqrt(0.5), abs=1e-6)
    lengths = np.linalg.norm(path.elbow[0]), np.linalg.norm(elbow[0])
    turned = np.degrees(np.arccos(path.elbow[0] @ elbow[0] / lengths[0] / lengths[1]))
    assert result.elbow_direction == pytest.approx(turned, abs=1e-4)
    assert 0.9 < result.correlation < 1.0
    still = {"r": ArmPath(path.elbow, sealed(np.repeat(wrist[:1], 50, axis=0)))}
    assert measure_distance(still, SimpleNamespace(angles=angles), known).correlation == 1.0
