"""Rest pose and collision exclusions of an imported robot."""

from collections.abc import Mapping
from math import degrees
from pathlib import Path
from types import MappingProxyType

import msgspec
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import CollisionTable, ExclusionTable, RobotFile
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.importer.hanging_pose import HangingPose
from kinesic.sim.importer.hinges import MappedHinge
from kinesic.sim.importer.zero_pose import HumanoidGeometry, first_arm, hang_arm, mirror_angles
from kinesic.sim.worst_postures import random_postures

NO_ANGLES: Mapping[str, float] = MappingProxyType({})  # default: no rest angles, empty
REST_TILTS = (6.0, 10.0, 15.0, 20.0, 27.0, 35.0)  # [deg] angles of the arms away from the body, tried in turn
REST_ELBOW_ANGLE = 18.0  # [deg] flexion of the elbow at rest
REST_FORWARD_ANGLE = 0.0  # [deg] forward angle of the resting upper arm from the vertical
MIN_ARM_GAP = 0.025  # [m] smallest distance of resting forearms and hands from other segments
SAMPLED_POSTURES = 300  # number of random postures in which overlaps are counted
MAX_OVERLAP_FRACTION = 0.9  # fraction of random postures with overlap, above which a pair is excluded
EXTRA_REST_CLEARANCE = 0.008  # [m] a pair is excluded if its clearance at rest exceeds the required one by less


def find_limits_nearest_to_zero(hinges: tuple[MappedHinge, ...]) -> dict[str, float]:
    """Return the limit [deg] nearest zero of hinges whose range excludes zero."""
    return {h.name: _round_into_range(h, 0.0) for h in hinges if not h.lower <= 0.0 <= h.upper}


def rest_pose(
    figure: HumanoidGeometry,
    hinges: tuple[MappedHinge, ...],
    file: RobotFile,
    path: Path,
    fingers: Mapping[str, float] = NO_ANGLES,
) -> dict[str, float]:
    """Return rest angles [deg] of arms that hang close to the body.

    Elbows are slightly bent. The arms are as close to the body as their shapes allow.

    Args:
        figure: Robot with hanging arms.
        hinges: Named hinges without fingers.
        file: Tables of the robot.
        path: File of the robot, for messages.
        fingers: Rest angles [deg] of finger hinges.
    """
    rest: dict[str, float] = {}
    for tilt in REST_TILTS:
        rest = find_limits_nearest_to_zero(hinges) | _rest_arms(figure, hinges, np.radians(tilt))
        robot = Robot.of(robot_from_tables(msgspec.structs.replace(file, rest=rest | dict(fingers)), path))
        if _measure_arm_gap(robot) >= MIN_ARM_GAP:
            break
    return {name: angle for name, angle in rest.items() if angle}


def _rest_arms(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...], tilt: float) -> dict[str, float]:
    turns: dict[int, float] = {}
    first = first_arm(figure).joints
    for side, arm in figure.arms.items():
        row = arm.joints
        start_angles = (
            mirror_angles(figure.tree, first, row, np.array([turns[k] for k in first])) if turns else np.zeros(len(row))
        )
        target = _make_hanging_target(tilt if side == "l" else -tilt)
        angles = hang_arm(figure.tree, row, figure.split, target, strict=True, first=start_angles).angles
        turns |= dict(zip(row, angles.tolist(), strict=True))
    rest_angles = {}
    for hinge in hinges:
        if hinge.joint in turns:
            foreign = figure.tree.joints[hinge.joint].zero + turns[hinge.joint]
            turned = hinge.sign * (foreign - hinge.zero)
            rest_angles[hinge.name] = _round_into_range(hinge, float(np.arctan2(np.sin(turned), np.cos(turned))))
    return rest_angles


def _make_hanging_target(tilt: float) -> HangingPose:
    def down(forward_angle: float) -> Floats:
        line = np.array(
            [np.sin(forward_angle), np.sin(tilt) * np.cos(forward_angle), -np.cos(forward_angle) * np.cos(tilt)]
        )
        return sealed(line / np.linalg.norm(line))

    upper, fore = down(np.radians(REST_FORWARD_ANGLE)), down(np.radians(REST_FORWARD_ANGLE + REST_ELBOW_ANGLE))
    bend = np.cross(upper, fore)
    return HangingPose(upper, fore, sealed(bend / np.linalg.norm(bend)))


def _measure_arm_gap(robot: Robot) -> float:
    """Return the resting forearms' and hands' smallest distance [m] to other segments."""
    ends = {f"{side}_{part}" for side in SIDES for part in ("elbow", "wrist")}
    gaps = CapsuleDistances(robot).gaps(robot.skeleton.rest[None])[0]
    return min(float(gap) for gap, pair in zip(gaps, robot.counted_pairs, strict=True) if ends & set(pair))


def _round_into_range(hinge: MappedHinge, angle: float) -> float:
    """Convert an angle [rad] to degrees, rounded and within the rounded range."""
    lower, upper = round(degrees(hinge.lower), 3), round(degrees(hinge.upper), 3)
    return min(max(round(degrees(angle), 2), lower), upper)


def with_exclusions(file: RobotFile, path: Path) -> RobotFile:
    """Exclude pairs of segments that are close at rest or overlap.

    Pairs that overlap in most random postures are excluded. The distance of excluded pairs is meaningless, because
    their shapes are approximate.
    """
    robot = Robot.of(robot_from_tables(file, path))
    gaps = CapsuleDistances(robot).gaps(random_postures(robot.skeleton, SAMPLED_POSTURES))
    min_gap = file.collision.clearance + EXTRA_REST_CLEARANCE
    overlaps = np.mean(gaps < 0.0, axis=0)
    exclusions = [*file.collision.exclude]
    for pair, rest, overlap_fraction in zip(robot.counted_pairs, gaps[0], overlaps, strict=True):
        if rest < min_gap:
            exclusions.append(ExclusionTable(pair, f"{1000 * rest:.0f} mm apart at rest: their shapes are rough"))
        elif overlap_fraction > MAX_OVERLAP_FRACTION:
            exclusions.append(ExclusionTable(pair, f"overlap in {100 * overlap_fraction:.0f} % of random postures"))
    return msgspec.structs.replace(file, collision=CollisionTable(file.collision.clearance, exclusions))
