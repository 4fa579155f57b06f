"""Tests of gesture sectors that a hand reaches."""

import numpy as np
import pytest

from kinesic.expressivity.lexicon.space import SECTOR_CENTRES, position, to_world
from kinesic.planning.workspace import find_workspace

from ..performances import ROBOT

ARM_REACH = sum(
    float(np.linalg.norm(ROBOT.skeleton.zero_frames.origins[i] - ROBOT.skeleton.zero_frames.origins[j]))
    for i, j in (
        (ROBOT.skeleton.segment("l_shoulder"), ROBOT.skeleton.segment("l_elbow")),
        (ROBOT.skeleton.segment("l_elbow"), ROBOT.skeleton.segment("l_wrist")),
    )
)

SHOULDER_TRAVEL = 0.06  # [m] by which the collar bone moves the shoulder, with the tolerance of a sector


@pytest.fixture(scope="module")
def workspace():
    return find_workspace(ROBOT)


def distance_from_shoulder(name: tuple[str, str, str]) -> float:
    shoulder = ROBOT.skeleton.frames(ROBOT.skeleton.rest).origins[ROBOT.skeleton.segment("l_shoulder")]
    return float(np.linalg.norm(to_world(ROBOT, "l", position(*name)) - shoulder))


def test_each_gesture_space_sector_is_listed_once_as_reached_or_missed(workspace):
    sectors = {(x, y, z) for x in SECTOR_CENTRES["x"] for y in SECTOR_CENTRES["y"] for z in SECTOR_CENTRES["z"]}
    assert set(workspace.reached) | set(workspace.missed) == sectors
    assert len(workspace.reached) + len(workspace.missed) == len(sectors)


def test_reachable_gesture_space_sectors_are_within_arm_length(workspace):
    assert max(map(distance_from_shoulder, workspace.reached)) <= ARM_REACH + SHOULDER_TRAVEL
    beyond = [name for name in workspace.missed if distance_from_shoulder(name) > ARM_REACH + SHOULDER_TRAVEL]
    assert len(beyond) > 20
    assert len(workspace.reached) > 60
