"""Certification of captured motion: limit violations and the nearest feasible motion."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Side
from kinesic.capture.clear_path import bridge_contacts, clear_path
from kinesic.capture.clip import ArmPath, Clip
from kinesic.capture.nearest import Course, NearestMotion, find_nearest
from kinesic.capture.retarget import retarget
from kinesic.capture.robot_motion import RobotMotion, arm_paths
from kinesic.capture.violations import MAX_RATIO, Violation, find_violations
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.certify import compute_peak_duties
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.files.motion_files import save_motion
from kinesic.planning.setup import Setup

MAX_DETOURS = 3  # largest number of self-collision avoidance rounds for one cost, with increasing clearance
HINGE_COSTS = (0.1, 10.0)  # [arm lengths/rad] costs of hinge rotation, tried in turn: 0.1 keeps the wrist's path
DETOUR_MARGIN = 0.002  # [m] clearance that the next round requires beyond the missing clearance
BRIDGE_MARGINS = (0.1, 0.2, 0.4, 0.8, 1.6)  # [s] time left out around contacts that no detour avoids, tried in turn
MIN_PATH = 0.1  # [arm lengths] extent of the wrist's path up to which a hand counts as still


@dataclass(frozen=True)
class PathDistance:
    """Differences of arm paths between a certified motion and its file."""

    wrist_rms: float  # [arm lengths] RMS distance of the wrists
    wrist_max: float  # [arm lengths] largest distance of a wrist
    elbow_rms: float  # [arm lengths] RMS distance of the elbows
    elbow_max: float  # [arm lengths] largest distance of an elbow
    elbow_direction: float  # [deg] 95th percentile of the angle between upper arms
    correlation: float  # smallest correlation of the wrist paths of moving hands; 1 if no hand moves


@dataclass(frozen=True, eq=False)
class Certification:
    """Result of certifying a motion file for one robot."""

    source: str  # name of the file
    setup: Setup  # robot with its limits
    desired: RobotMotion  # motion of the file, retargeted
    violations: tuple[Violation, ...]  # limits that the retargeted motion violates
    nearest: NearestMotion  # motion within the limits
    limit_ratio: float  # largest value / limit of the nearest motion
    torque_ratio: float  # largest drive duty of the nearest motion by inverse dynamics
    clearance: float  # [m] smallest self-clearance of the nearest motion
    distance: PathDistance

    @property
    def is_certified(self) -> bool:
        """Whether the nearest motion satisfies all limits."""
        is_within = self.limit_ratio <= MAX_RATIO and self.torque_ratio <= MAX_RATIO
        return is_within and self.clearance >= self.setup.robot.min_clearance

    @property
    def trajectory(self) -> Trajectory:
        """Nearest motion within the limits, from rest to rest."""
        return self.nearest.motion.trajectory

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the nearest motion to a file of the path's suffix.

        Args:
            path: ending in .npz, .csv, .bap, .bvh, .json or .mcap.
            force: whether to replace an existing file.

        Raises:
            ConfigError: unknown suffix, or an existing file without `force`.
        """
        return save_motion(self.trajectory, self.setup.robot, Path(path), force=force)


@dataclass(frozen=True, eq=False)
class _Attempt:
    """Nearest motion to angles that avoid contacts, with its clearance."""

    angles: Floats  # (m, n) [rad] of the changed course
    nearest: NearestMotion
    clearance: float  # [m] smallest self-clearance of the nearest motion


def judge_clip(clip: Clip, setup: Setup, source: str) -> tuple[RobotMotion, tuple[Violation, ...]]:
    """Retarget a clip, and find the limits that its motion violates.

    Args:
        clip: of a body or of the robot's own joints.
        setup: robot, limits, dynamics and distances.
        source: name of the file.

    Raises:
        CaptureError: the clip is too long, or has no joint of the robot.
    """
    desired = retarget(clip, setup, source)
    return desired, find_violations(desired.requested, setup)


def certify_clip(clip: Clip, setup: Setup, source: str) -> Certification:
    """Find a clip's limit violations and the nearest feasible motion.

    Where none is found, `Certification.is_certified` is False.

    Args:
        clip: of a body or of the robot's own joints.
        setup: robot, limits, dynamics and distances.
        source: name of the file.

    Raises:
        CaptureError: the clip is too long, or has no joint of the robot.
    """
    desired, violations = judge_clip(clip, setup, source)
    nearest, clearance = _find_clear(desired, setup)
    return Certification(
        source=source,
        setup=setup,
        desired=desired,
        violations=violations,
        nearest=nearest,
        limit_ratio=largest_limit_ratio(nearest.motion.trajectory, setup),
        torque_ratio=float(compute_peak_duties(nearest.motion.trajectory, setup).max()),
        clearance=clearance,
        distance=measure_distance(desired.arms or arm_paths(setup.robot, desired.angles), nearest, setup),
    )


def _find_clear(desired: RobotMotion, setup: Setup) -> tuple[NearestMotion, float]:
    """Return a nearest motion with enough self-clearance, and the clearance [m].

    If no round reaches the required clearance, it is the motion with the largest one.
    """
    course, goal = Course.of(desired.angles, setup), setup.robot.min_clearance
    best: _Attempt | None = None
    for hinge_cost in HINGE_COSTS:
        required = goal + LAG_RESERVE
        for _ in range(MAX_DETOURS):
            angles = clear_path(course.angles, setup, min_clearance=required, hinge_cost=hinge_cost)
            attempt = _try_angles(angles, course, setup, best)
            if attempt.clearance >= goal:
                return attempt.nearest, attempt.clearance
            best = attempt if best is None or attempt.clearance > best.clearance else best
            required += goal - attempt.clearance + DETOUR_MARGIN
    assert best is not None
    detour = best.angles
    for margin in BRIDGE_MARGINS:
        angles = bridge_contacts(detour, setup, min_clearance=goal + LAG_RESERVE, margin=margin)
        attempt = _try_angles(angles, course, setup, best)
        if attempt.clearance >= goal:
            return attempt.nearest, attempt.clearance
        best = attempt if attempt.clearance > best.clearance else best
    return best.nearest, best.clearance


def _try_angles(angles: Floats, course: Course, setup: Setup, best: _Attempt | None) -> _Attempt:
    """Find the nearest motion to changed angles.

    It keeps the time stretch of the best attempt.
    """
    nearest = find_nearest(replace(course, angles=angles), setup, best.nearest.stretch if best else None)
    clearance = float(scan_clearance(nearest.motion.trajectory, setup.distances)[1].distances.min())
    return _Attempt(angles, nearest, clearance)


def largest_limit_ratio(trajectory: Trajectory, setup: Setup) -> float:
    """Return a trajectory's largest value / limit, except torque and clearance.

    It is sampled four times per knot interval.
    """
    limits = setup.limits
    times = trajectory.start + np.arange(0.0, trajectory.duration, KNOT_INTERVAL / 4.0)
    angles, velocities, accelerations = trajectory.sample(times)
    middle, half = (limits.upper + limits.lower) / 2.0, (limits.upper - limits.lower) / 2.0
    ratios = (
        np.abs(angles - middle) / np.maximum(half, 1e-9),
        np.abs(velocities) / limits.speed,
        np.abs(accelerations) / limits.acceleration,
        np.abs(trajectory.jerks(times)) / limits.jerk,
        np.abs(limits.inertial * accelerations + limits.viscous * velocities) / limits.duty,
    )
    return max(float(values.max()) for values in ratios)


def measure_distance(arms: Mapping[Side, ArmPath], nearest: NearestMotion, setup: Setup) -> PathDistance:
    """Measure arm path differences between a nearest motion and its file."""
    reached = arm_paths(setup.robot, nearest.angles)
    wrists = np.concatenate([np.linalg.norm(reached[side].wrist - arm.wrist, axis=1) for side, arm in arms.items()])
    elbows = np.concatenate([np.linalg.norm(reached[side].elbow - arm.elbow, axis=1) for side, arm in arms.items()])
    directions = np.concatenate([angles_between(reached[side].elbow, arm.elbow) for side, arm in arms.items()])
    correlations = [
        correlate(arm.wrist, reached[side].wrist)
        for side, arm in arms.items()
        if float(np.ptp(arm.wrist, axis=0).max()) > MIN_PATH
    ]
    return PathDistance(
        wrist_rms=float(np.sqrt(np.mean(wrists**2))),
        wrist_max=float(wrists.max()),
        elbow_rms=float(np.sqrt(np.mean(elbows**2))),
        elbow_max=float(elbows.max()),
        elbow_direction=float(np.degrees(np.percentile(directions, 95.0))),
        correlation=min(correlations, default=1.0),
    )


def correlate(first: Floats, second: Floats) -> float:
    """Return the correlation of two paths (m, 3) about their means."""
    a, b = first - first.mean(axis=0), second - second.mean(axis=0)
    return float(np.sum(a * b) / np.sqrt(np.sum(a * a) * np.sum(b * b)))


def angles_between(first: Floats, second: Floats) -> Floats:
    """Return the angles (m,) [rad] between pairs of vectors (m, 3)."""
    sines = np.linalg.norm(np.cross(first, second), axis=1)
    angles: Floats = np.arctan2(sines, np.sum(first * second, axis=1))
    return angles
