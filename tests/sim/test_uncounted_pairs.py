"""Segment pairs excluded from collision checks, in random postures."""

from collections.abc import Iterator
from itertools import product

import numpy as np
import pytest
from mujoco import MjData, mj_geomDistance, mj_kinematics

from kinesic.body.arrays import Floats
from kinesic.body.config import names_of
from kinesic.body.robot import Robot
from kinesic.sim.model import build_model, find_joint_indices
from kinesic.sim.worst_postures import random_postures

POSTURE_COUNTS = {"a few": 150, "many": pytest.param(6000, marks=pytest.mark.soak)}
MAX_MEASURED_DISTANCE = 1.0  # [m] largest distance that MuJoCo measures

each_robot = pytest.mark.parametrize("name", names_of("robot"))
few_and_many = pytest.mark.parametrize("postures", POSTURE_COUNTS.values(), ids=POSTURE_COUNTS)


class PairDistances:
    """Distances of a robot's MuJoCo shapes in random postures."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.model = robot, build_model(robot)
        self.data, self.order = MjData(self.model), find_joint_indices(robot, self.model)
        owners = [self.model.body(self.model.geom_bodyid[k]).name for k in range(self.model.ngeom)]
        self.geoms = {
            segment.name: [k for k, owner in enumerate(owners) if owner == segment.name]
            for segment in robot.skeleton.segments
        }

    def nearest(self, pairs: list[tuple[str, str]], postures: int) -> Iterator[tuple[tuple[str, str], float, Floats]]:
        """Yield each pair, its distance [m] and the gap's midpoint per posture."""
        way = np.zeros(6)
        for angles in random_postures(self.robot.skeleton, postures, seed=3):
            self.data.qpos[self.order] = angles
            mj_kinematics(self.model, self.data)
            for a, b in pairs:
                for i, j in product(self.geoms[a], self.geoms[b]):
                    yield (
                        (a, b),
                        mj_geomDistance(self.model, self.data, i, j, MAX_MEASURED_DISTANCE, way),
                        (way[:3] + way[3:]) / 2,
                    )


@each_robot
@few_and_many
def test_excluded_segment_pairs_do_not_collide_in_random_postures(name: str, postures: int) -> None:
    robot = Robot.load(name)
    reasons = {
        (a, b): exclusion.why
        for exclusion in robot.exclusions
        for a, b in [sorted(exclusion.pair)]
        if {"l_fingers", "r_fingers"}.isdisjoint(
            exclusion.pair
        )  # fingers have no MuJoCo contacts: see test_finger_distances
        and not exclusion.why.startswith("soft:")  # flesh and cloth give way
    }
    gaps = dict.fromkeys(reasons, MAX_MEASURED_DISTANCE)
    for pair, gap, _ in PairDistances(robot).nearest(list(gaps), postures):
        gaps[pair] = min(gaps[pair], gap)
    assert {pair: gap for pair, gap in gaps.items() if gap <= 0.0} == {}
    assert all(gap > 0.045 for pair, gap in gaps.items() if reasons[pair].startswith("more than 45 mm apart"))


@each_robot
@few_and_many
def test_parent_and_child_segments_overlap_only_at_their_joint(name: str, postures: int) -> None:
    robot = Robot.load(name)
    hinged = {hinge.segment for hinge in robot.skeleton.hinges}
    thick = {segment.name: max(c.radius for c in segment.capsules) for segment in robot.skeleton.segments}
    pairs = [(s.parent, s.name) for s in robot.skeleton.segments if s.parent is not None and s.name in hinged]
    meetings, met = PairDistances(robot), 0
    for (parent, child), gap, place in meetings.nearest(pairs, postures):
        if gap <= 0.0:
            met += 1
            off = np.linalg.norm(place - meetings.data.body(child).xpos)
            assert off <= max(thick[parent], thick[child]), (parent, child)
    assert met
