from dataclasses import replace

import mujoco
import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.description import Exclusion
from kinesic.body.robot import Robot
from kinesic.sim.distances import BLOCK, CapsuleDistances, segment_distances
from kinesic.sim.model import build, capsule_name
from kinesic.sim.sampling import random_postures

ROBOT = Robot.load()
DISTANCES = CapsuleDistances(ROBOT)


def by_mujoco(postures):
    """Smallest distance [m] and pair over counted pairs, by MuJoCo's own collision code."""
    model = build(ROBOT)
    data = mujoco.MjData(model)
    capsules = {segment.name: len(segment.capsules) for segment in ROBOT.skeleton.segments}
    pairs = [
        (model.geom(capsule_name(a, i)).id, model.geom(capsule_name(b, j)).id, (a, b))
        for a, b in ROBOT.counted_pairs
        for i in range(capsules[a])
        for j in range(capsules[b])
    ]
    for posture in postures:
        data.qpos[:] = posture
        mujoco.mj_kinematics(model, data)
        yield min((mujoco.mj_geomDistance(model, data, i, j, 10.0, None), pair) for i, j, pair in pairs)


def test_mujoco_measures_the_same():
    postures = random_postures(ROBOT.skeleton, 150, seed=2)
    found = DISTANCES.clearance(postures)
    for k, (distance, pair) in enumerate(by_mujoco(postures)):
        assert found.distances[k] == pytest.approx(distance, abs=1e-6)
        assert k < 2 or found.pairs[k] == pair  # rest and zero have two equal sides


def side_free(name):
    return name.removeprefix("l_").removeprefix("r_")


def test_rest_and_zero_are_as_far_as_computed_once():
    found = DISTANCES.clearance(np.array([ROBOT.skeleton.rest, np.zeros(22)]))
    assert found.distances == pytest.approx([0.0271, 0.0230], abs=1e-4)
    assert [{side_free(n) for n in pair} for pair in found.pairs] == [{"vt1", "shoulder"}, {"vl5", "shoulder"}]


def test_long_motions_are_measured_like_short_ones():
    postures = random_postures(ROBOT.skeleton, BLOCK + 70, seed=3)
    whole = DISTANCES.clearance(postures)
    part = DISTANCES.clearance(postures[BLOCK - 5 : BLOCK + 5])
    assert np.array_equal(whole.distances[BLOCK - 5 : BLOCK + 5], part.distances)
    assert list(whole.pairs[BLOCK - 5 : BLOCK + 5]) == list(part.pairs)
    assert len(whole.pairs) == len(whole.distances) == BLOCK + 70


def test_no_posture_has_no_distance():
    found = DISTANCES.clearance(np.empty((0, 22)))
    assert found.distances.shape == (0,)
    assert list(found.pairs) == []


def test_a_robot_that_counts_no_pair_is_never_near_itself():
    names = [segment.name for segment in ROBOT.skeleton.segments]
    everything = tuple(Exclusion(frozenset((a, b)), "test") for a in names for b in names)
    alone = CapsuleDistances(replace(ROBOT, exclusions=everything))
    found = alone.clearance(np.zeros((3, 22)))
    assert np.isinf(found.distances).all()
    assert len(found.pairs) == 3


def row(*points):
    return tuple(sealed([point]) for point in points)


@pytest.mark.parametrize(
    ("ends", "distance"),
    [
        (((0, 0, 0), (1, 0, 0), (0.5, 1, 0), (0.5, 2, 0)), 1.0),  # end against middle
        (((0, 0, 0), (1, 0, 0), (0, 0, 1), (0, 1, 1)), 1.0),  # skew lines
        (((0, 0, 0), (1, 0, 0), (0.5, -1, 0), (0.5, 1, 0)), 0.0),  # they cross
        (((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)), 1.0),  # one line
        (((0, 0, 0), (1, 0, 0), (-5, 2, 0), (5, 2, 0)), 2.0),  # parallel
        (((0, 0, 0), (0, 0, 0), (3, 4, 0), (3, 4, 0)), 5.0),  # two points
        (((0, 0, 0), (0, 0, 0), (-1, 1, 0), (1, 1, 0)), 1.0),  # a point and a segment
        (((-1, 1, 0), (1, 1, 0), (0, 0, 0), (0, 0, 0)), 1.0),
    ],
)
def test_segments_of_every_kind(ends, distance):
    assert segment_distances(*row(*ends)) == pytest.approx([distance], abs=1e-12)
