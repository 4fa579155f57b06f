"""Pairs of segments that self-collision does not count: they never meet, but for parent and child at their joint."""

from collections.abc import Iterator
from itertools import product

import numpy as np
import pytest
from mujoco import MjData, mj_geomDistance, mj_kinematics

from kinesic.body.arrays import Floats
from kinesic.body.config import names_of
from kinesic.body.robot import Robot
from kinesic.sim.model import build_model, joint_order
from kinesic.sim.worst_postures import random_postures

POSTURES = {"a few": 150, "many": pytest.param(6000, marks=pytest.mark.soak)}
FAR = 1.0  # [m] beyond which MuJoCo need not measure

each_robot = pytest.mark.parametrize("name", names_of("robot"))
few_and_many = pytest.mark.parametrize("postures", POSTURES.values(), ids=POSTURES)


class Meetings:
    """A robot in MuJoCo, whose shapes are measured against one another in random postures."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.model = robot, build_model(robot)
        self.data, self.order = MjData(self.model), joint_order(robot, self.model)
        owners = [self.model.body(self.model.geom_bodyid[k]).name for k in range(self.model.ngeom)]
        self.geoms = {
            segment.name: [k for k, owner in enumerate(owners) if owner == segment.name]
            for segment in robot.skeleton.segments
        }

    def nearest(self, pairs: list[tuple[str, str]], postures: int) -> Iterator[tuple[tuple[str, str], float, Floats]]:
        """Each pair of segments in each posture: their distance and the middle of the shortest way, both [m]."""
        way = np.zeros(6)
        for angles in random_postures(self.robot.skeleton, postures, seed=3):
            self.data.qpos[self.order] = angles
            mj_kinematics(self.model, self.data)
            for a, b in pairs:
                for i, j in product(self.geoms[a], self.geoms[b]):
                    yield (a, b), mj_geomDistance(self.model, self.data, i, j, FAR, way), (way[:3] + way[3:]) / 2


@each_robot
@few_and_many
def test_pairs_that_do_not_count_never_meet(name: str, postures: int) -> None:
    robot = Robot.load(name)
    reasons = {
        (a, b): exclusion.why
        for exclusion in robot.exclusions
        for a, b in [sorted(exclusion.pair)]
        if {"l_fingers", "r_fingers"}.isdisjoint(exclusion.pair)  # physics has none: see test_finger_distances
    }
    gaps = dict.fromkeys(reasons, FAR)
    for pair, gap, _ in Meetings(robot).nearest(list(gaps), postures):
        gaps[pair] = min(gaps[pair], gap)
    assert {pair: gap for pair, gap in gaps.items() if gap <= 0.0} == {}
    assert all(gap > 0.045 for pair, gap in gaps.items() if reasons[pair].startswith("more than 45 mm apart"))


@each_robot
@few_and_many
def test_parent_and_child_meet_at_their_joint_alone(name: str, postures: int) -> None:
    robot = Robot.load(name)
    hinged = {hinge.segment for hinge in robot.skeleton.hinges}
    thick = {segment.name: max(c.radius for c in segment.capsules) for segment in robot.skeleton.segments}
    pairs = [(s.parent, s.name) for s in robot.skeleton.segments if s.parent is not None and s.name in hinged]
    meetings, met = Meetings(robot), 0
    for (parent, child), gap, place in meetings.nearest(pairs, postures):
        if gap <= 0.0:
            met += 1
            off = np.linalg.norm(place - meetings.data.body(child).xpos)
            assert off <= max(thick[parent], thick[child]), (parent, child)
    assert met
