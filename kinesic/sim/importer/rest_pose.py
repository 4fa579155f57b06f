"""How an imported robot rests, arms hanging as near to its body as their shapes allow, and what is then too near."""

from math import degrees
from pathlib import Path

import msgspec
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import CollisionTable, ExclusionTable, RobotFile
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.importer.hanging_pose import HangingPose
from kinesic.sim.importer.hinges import MappedHinge
from kinesic.sim.importer.zero_pose import HumanoidGeometry, hang_arm, mirror_angles
from kinesic.sim.worst_postures import random_postures

TILTS = (10.0, 15.0, 20.0, 27.0, 35.0)  # [deg] away from the body, tried in turn
BENT = 25.0  # [deg] of the elbow
ARM_FORWARD = 5.0  # [deg] of the upper arm, forward
AIR = 0.025  # [m] between forearms or hands and everything else
POSTURES = 300
NEARLY_ALWAYS = 0.9  # of random postures
REST_ROOM = 0.008  # [m] beyond the clearance that a pair must have at rest


def nearest_to_zero(hinges: tuple[MappedHinge, ...]) -> dict[str, float]:
    """Finds the angle [deg] nearest to zero of each hinge whose range does not hold zero."""
    return {h.name: _inside(h, 0.0) for h in hinges if not h.lower <= 0.0 <= h.upper}


def rest_pose(
    figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...], file: RobotFile, path: Path
) -> dict[str, float]:
    """Lets the arms hang, a little ahead, elbows a little bent, as near to the body as their shapes allow."""
    rest: dict[str, float] = {}
    for tilt in TILTS:
        rest = nearest_to_zero(hinges) | _resting_arms(figure, hinges, np.radians(tilt))
        robot = Robot.of(robot_from_tables(msgspec.structs.replace(file, rest=rest), path))
        if _arm_air(robot) >= AIR:
            break
    return {name: angle for name, angle in rest.items() if angle}


def _resting_arms(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...], tilt: float) -> dict[str, float]:
    turns: dict[int, float] = {}
    left = figure.arms["l"].joints
    for side in SIDES:
        row = figure.arms[side].joints
        first = (
            mirror_angles(figure.tree, left, row, np.array([turns[k] for k in left])) if turns else np.zeros(len(row))
        )
        wish = _wish(tilt if side == "l" else -tilt)
        angles = hang_arm(figure.tree, row, figure.split, wish, strict=True, first=first).angles
        turns |= dict(zip(row, angles.tolist(), strict=True))
    found = {}
    for hinge in hinges:
        if hinge.joint in turns:
            foreign = figure.tree.joints[hinge.joint].zero + turns[hinge.joint]
            turned = hinge.sign * (foreign - hinge.zero)
            found[hinge.name] = _inside(hinge, float(np.arctan2(np.sin(turned), np.cos(turned))))
    return found


def _wish(tilt: float) -> HangingPose:
    def down(ahead: float) -> Floats:
        line = np.array([np.sin(ahead), np.sin(tilt) * np.cos(ahead), -np.cos(ahead) * np.cos(tilt)])
        return sealed(line / np.linalg.norm(line))

    upper, fore = down(np.radians(ARM_FORWARD)), down(np.radians(ARM_FORWARD + BENT))
    bend = np.cross(upper, fore)
    return HangingPose(upper, fore, sealed(bend / np.linalg.norm(bend)))


def _arm_air(robot: Robot) -> float:
    """Least distance of forearms and hands from everything at rest [m]."""
    ends = {f"{side}_{part}" for side in SIDES for part in ("elbow", "wrist")}
    gaps = CapsuleDistances(robot).gaps(robot.skeleton.rest[None])[0]
    return min(float(gap) for gap, pair in zip(gaps, robot.counted_pairs, strict=True) if ends & set(pair))


def _inside(hinge: MappedHinge, angle: float) -> float:
    """[deg] of an angle [rad] as a file holds it, inside the range as that file holds it."""
    low, high = round(degrees(hinge.lower), 3), round(degrees(hinge.upper), 3)
    return min(max(round(degrees(angle), 2), low), high)


def with_exclusions(file: RobotFile, path: Path) -> RobotFile:
    """Lists the pairs of segments that are too near at rest, or overlap in nearly all postures.

    Their distance says nothing: their shapes are rough.
    """
    robot = Robot.of(robot_from_tables(file, path))
    gaps = CapsuleDistances(robot).gaps(random_postures(robot.skeleton, POSTURES))
    least = file.collision.clearance + REST_ROOM
    overlaps = np.mean(gaps < 0.0, axis=0)
    listed = [*file.collision.exclude]
    for pair, rest, share in zip(robot.counted_pairs, gaps[0], overlaps, strict=True):
        if rest < least:
            listed.append(ExclusionTable(pair, f"{1000 * rest:.0f} mm apart at rest: their shapes are rough"))
        elif share > NEARLY_ALWAYS:
            listed.append(ExclusionTable(pair, f"overlap in {100 * share:.0f} % of random postures"))
    return msgspec.structs.replace(file, collision=CollisionTable(file.collision.clearance, listed))
