"""Finds which of McNeill's sectors a robot's hand reaches with the torso upright."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.space import SECTORS, position, to_world
from kinesic.ik.arm.refine import refine_posture
from kinesic.ik.solve import solve

NEAR_SECTOR = 0.02  # [m] from a sector's centre


@dataclass(frozen=True)
class Workspace:
    """Sectors reached by the left hand; the right is its mirror image."""

    reached: tuple[tuple[str, str, str], ...]
    missed: tuple[tuple[str, str, str], ...]


def workspace(robot: Robot) -> Workspace:
    """Tries every sector from the rest posture."""
    chain, rest = robot.arms["l"], robot.skeleton.rest
    hand = robot.skeleton.segment(chain.joints[-1].name)
    frames = robot.skeleton.frames(rest)
    base = robot.skeleton.segment(chain.base)
    rotation, origin = frames.rotations[base], frames.origins[base]
    reached: list[tuple[str, str, str]] = []
    missed: list[tuple[str, str, str]] = []
    for name in [(x, y, z) for x in SECTORS["x"] for y in SECTORS["y"] for z in SECTORS["z"]]:
        target = to_world(robot, "l", position(*name))
        posture = np.array(rest)
        reach = Reach(np.asarray(rotation.T @ (target - origin)))
        posture[list(chain.indices)] = solve(chain, reach, start=chain.rest).angles
        posture = refine_posture(robot, "l", Reach(target), posture, near=rest)
        residual = float(np.linalg.norm(robot.skeleton.frames(posture).origins[hand] - target))
        (reached if residual <= NEAR_SECTOR else missed).append(name)
    return Workspace(tuple(reached), tuple(missed))
