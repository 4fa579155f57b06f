"""Pairs of segments whose distance says nothing: their shapes are rough, and overlap whatever the robot does."""

from pathlib import Path

import msgspec
import numpy as np

from kinesic.body.robot_schema import CollisionTable, ExclusionTable, RobotFile
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.importer.draft import robot_of
from kinesic.sim.worst_postures import random_postures

POSTURES = 300
NEARLY_ALWAYS = 0.9  # of random postures
ROOM = 0.008  # [m] beyond the clearance that a pair must have at rest


def with_exclusions(file: RobotFile, path: Path) -> RobotFile:
    """The same robot with the pairs listed that are too near at rest, or overlap in nearly all postures."""
    robot = robot_of(file, path)
    gaps = CapsuleDistances(robot).gaps(random_postures(robot.skeleton, POSTURES))
    least = file.collision.clearance + ROOM
    overlaps = np.mean(gaps < 0.0, axis=0)
    listed = []
    for pair, rest, share in zip(robot.counted_pairs, gaps[0], overlaps, strict=True):
        if rest < least:
            listed.append(ExclusionTable(pair, f"{1000 * rest:.0f} mm apart at rest: their shapes are rough"))
        elif share > NEARLY_ALWAYS:
            listed.append(ExclusionTable(pair, f"overlap in {100 * share:.0f} % of random postures"))
    return msgspec.structs.replace(file, collision=CollisionTable(file.collision.clearance, listed))
