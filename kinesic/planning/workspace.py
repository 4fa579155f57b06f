"""Gesture sectors (McNeill) that a hand reaches with the torso upright."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.space import SECTOR_CENTRES, position, to_world
from kinesic.ik.arm.refine import refine_posture
from kinesic.ik.solve import solve

SECTOR_TOLERANCE = 0.02  # [m] largest distance from a sector's centre at which the sector counts as reached


@dataclass(frozen=True)
class Workspace:
    """Gesture sectors within reach of the left hand (right is mirrored)."""

    reached: tuple[tuple[str, str, str], ...]
    missed: tuple[tuple[str, str, str], ...]


def find_workspace(robot: Robot) -> Workspace:
    """Find the gesture sectors that a hand reaches from rest.

    It is the left hand, or the only one.
    """
    side = robot.sides[0]
    chain, rest = robot.arms[side], robot.skeleton.rest
    hand = robot.skeleton.segment(chain.joints[-1].name)
    frames = robot.skeleton.frames(rest)
    base = robot.skeleton.segment(chain.base)
    rotation, origin = frames.rotations[base], frames.origins[base]
    reached: list[tuple[str, str, str]] = []
    missed: list[tuple[str, str, str]] = []
    for name in [(x, y, z) for x in SECTOR_CENTRES["x"] for y in SECTOR_CENTRES["y"] for z in SECTOR_CENTRES["z"]]:
        target = to_world(robot, side, position(*name))
        posture = np.array(rest)
        reach = Reach(np.asarray(rotation.T @ (target - origin)))
        posture[list(chain.indices)] = solve(chain, reach, start=chain.rest).angles
        posture = refine_posture(robot, side, Reach(target), posture, near=rest)
        residual = float(np.linalg.norm(robot.skeleton.frames(posture).origins[hand] - target))
        (reached if residual <= SECTOR_TOLERANCE else missed).append(name)
    return Workspace(tuple(reached), tuple(missed))
