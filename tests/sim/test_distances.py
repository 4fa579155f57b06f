from dataclasses import replace

import mujoco
import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from kinesic.body.arrays import sealed
from kinesic.body.description import Exclusion
from kinesic.body.robot import Robot
from kinesic.sim.distances import POSTURES_PER_BATCH, CapsuleDistances
from kinesic.sim.kinematics import compute_motion_frames
from kinesic.sim.model import build_model, capsule_name
from kinesic.sim.reaches import compute_capsule_reach
from kinesic.sim.worst_postures import random_postures

from ..reference.sim.distances import ReferenceDistances
from ..reference.sim.segment_distances import segment_distances

ROBOT = Robot.load()
DISTANCES = CapsuleDistances(ROBOT)


def find_closest_with_mujoco(postures):
    """Return the smallest distance [m] and its pair from MuJoCo's collision code."""
    model = build_model(ROBOT)
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


def test_segment_distances_equal_those_of_mujoco():
    postures = random_postures(ROBOT.skeleton, 150, seed=2)
    result = DISTANCES.clearance(postures)
    for k, (distance, pair) in enumerate(find_closest_with_mujoco(postures)):
        assert result.distances[k] == pytest.approx(distance, abs=1e-6)
        assert k < 2 or result.pairs[k] == pair  # rest and zero are symmetric, so both sides have equal pairs


def test_distances_of_each_segment_pair_equal_those_of_mujoco():
    model = build_model(ROBOT)
    data = mujoco.MjData(model)
    postures = random_postures(ROBOT.skeleton, 40, seed=7)
    gaps = DISTANCES.gaps(postures)
    assert gaps.min(axis=1) == pytest.approx(DISTANCES.clearance(postures).distances, abs=1e-12)
    count = {segment.name: range(len(segment.capsules)) for segment in ROBOT.skeleton.segments}
    for posture, result in zip(postures, gaps, strict=True):
        data.qpos[:] = posture
        mujoco.mj_kinematics(model, data)
        for gap, (a, b) in zip(result, ROBOT.counted_pairs, strict=True):
            geoms = [
                (model.geom(capsule_name(a, i)).id, model.geom(capsule_name(b, j)).id)
                for i in count[a]
                for j in count[b]
            ]
            assert gap == pytest.approx(
                min(mujoco.mj_geomDistance(model, data, i, j, 10.0, None) for i, j in geoms), abs=1e-6
            )


def side_free(name):
    return name.removeprefix("l_").removeprefix("r_")


def test_clearances_of_rest_and_zero_posture_have_the_recorded_values():
    result = DISTANCES.clearance(np.array([ROBOT.skeleton.rest, np.zeros(22)]))
    assert result.distances == pytest.approx([0.0279, 0.0280], abs=1e-4)
    assert [{side_free(n) for n in pair} for pair in result.pairs] == [{"vt1", "shoulder"}, {"vt1", "shoulder"}]


def test_long_motion_gives_the_same_clearances_as_short_ones():
    postures = random_postures(ROBOT.skeleton, POSTURES_PER_BATCH + 70, seed=3)
    whole = DISTANCES.clearance(postures)
    part = DISTANCES.clearance(postures[POSTURES_PER_BATCH - 5 : POSTURES_PER_BATCH + 5])
    assert whole.distances[POSTURES_PER_BATCH - 5 : POSTURES_PER_BATCH + 5] == pytest.approx(part.distances, abs=1e-15)
    assert list(whole.pairs[POSTURES_PER_BATCH - 5 : POSTURES_PER_BATCH + 5]) == list(part.pairs)
    assert len(whole.pairs) == len(whole.distances) == POSTURES_PER_BATCH + 70


def test_motion_without_postures_has_no_distances():
    result = DISTANCES.clearance(np.empty((0, 22)))
    assert result.distances.shape == (0,)
    assert list(result.pairs) == []


def test_robot_without_checked_pairs_has_infinite_clearance():
    names = [segment.name for segment in ROBOT.skeleton.segments]
    everything = tuple(Exclusion(frozenset((a, b)), "test") for a in names for b in names)
    alone = CapsuleDistances(replace(ROBOT, exclusions=everything))
    result = alone.clearance(np.zeros((3, 22)))
    assert np.isinf(result.distances).all()
    assert len(result.pairs) == 3
    assert alone.gaps(np.zeros((3, 22))).shape == (3, 0)


def make_smooth_motion(count, seed):
    """Return a smooth motion of `count` postures through random postures."""
    keys = random_postures(ROBOT.skeleton, 8, seed=seed)[2:]
    path = make_interp_spline(np.linspace(0.0, 1.0, len(keys)), keys, k=3)
    return ROBOT.skeleton.clamp(path(np.linspace(0.0, 1.0, count)))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("near", [-1.0, 0.01, 0.05])
def test_closest_approach_finds_all_near_postures_and_the_minimum(seed, near):
    angles, ends = make_smooth_motion(301, seed), np.arange(0, 301, 3)
    every = DISTANCES.clearance(angles)
    solution = DISTANCES.approach(angles, ends, near=near)
    smallest = np.minimum.reduceat(every.distances, np.concatenate([[0], ends[:-1] + 1]))
    limit = max(near, every.distances[ends].min())
    close = smallest < limit
    assert solution.distances.min() == pytest.approx(every.distances.min(), abs=1e-14)
    assert solution.distances[close] == pytest.approx(smallest[close], abs=1e-14)
    assert solution.pairs[solution.worst] == every.pairs[every.worst]
    assert solution.worst == np.searchsorted(ends, every.worst)
    assert (solution.distances >= smallest - 1e-14).all()
    assert (solution.distances <= every.distances[ends] + 1e-14).all()


def test_closest_approach_search_measures_under_60_percent_of_the_postures_of_a_slow_motion(monkeypatch):
    slow, ends = make_smooth_motion(3001, 0), np.arange(0, 3001, 3)  # steps of ten seconds
    measured = []
    nearest = CapsuleDistances._find_nearest
    monkeypatch.setattr(
        CapsuleDistances,
        "_find_nearest",
        lambda self, angles, chosen: measured.append(len(chosen)) or nearest(self, angles, chosen),
    )
    DISTANCES.approach(slow, ends, near=0.01)
    assert sum(measured) < 0.6 * len(slow)


def test_closest_approach_accepts_intervals_of_one_or_no_posture():
    angles = make_smooth_motion(30, 1)
    ends = np.array([0, 0, 5, 6, 6, 29])
    solution = DISTANCES.approach(angles, ends, near=1.0)
    every = DISTANCES.clearance(angles).distances
    expected = [every[0], every[0], every[1:6].min(), every[6], every[6], every[7:30].min()]
    assert solution.distances == pytest.approx(expected, abs=1e-14)
    assert len(DISTANCES.approach(angles, ends[:0], near=0.0).distances) == 0


def measure_all_pairs(postures):
    """Return the exact distances (p, m) [m] of all pairs."""
    starts, ends = ReferenceDistances(ROBOT).capsule_axes(compute_motion_frames(ROBOT.skeleton, postures))
    i, j = DISTANCES._first, DISTANCES._second
    axes = [np.moveaxis(points, 2, 1).reshape(-1, 3) for points in (starts[i], ends[i], starts[j], ends[j])]
    return segment_distances(*axes).reshape(len(i), -1) - DISTANCES._radii[:, None]


def test_distance_shrinks_by_at_most_hinge_reaches_times_rotation_angles():
    random = np.random.default_rng(4)
    before = random_postures(ROBOT.skeleton, 300, seed=4)
    after = ROBOT.skeleton.clamp(before + random.normal(0.0, 0.1, before.shape) * (random.random(before.shape) < 0.3))
    nearer = measure_all_pairs(before) - measure_all_pairs(after)
    assert (nearer <= DISTANCES._reaches @ np.abs(after - before).T + 1e-12).all()
    assert nearer.max() > 0.01


def test_hinge_reach_is_the_link_length_up_to_the_capsule_end_and_zero_for_unmoved_capsules():
    names = [segment.name for segment in ROBOT.skeleton.segments]
    owner = names.index("l_wrist")
    capsule = ROBOT.skeleton.segments[owner].capsules[0]
    reach = dict(zip(ROBOT.skeleton.names, compute_capsule_reach(ROBOT.skeleton, owner, capsule), strict=True))
    hand = max(np.linalg.norm(capsule.start), np.linalg.norm(capsule.end))
    assert reach["l_wrist_pivot"] == pytest.approx(hand)
    assert reach["l_shoulder_flexion"] == pytest.approx(0.42 + hand)
    assert reach["r_shoulder_flexion"] == reach["skullbase_tilt"] == 0.0


def row(*points):
    return tuple(sealed([point]) for point in points)


@pytest.mark.parametrize(
    ("ends", "distance"),
    [
        (((0, 0, 0), (1, 0, 0), (0.5, 1, 0), (0.5, 2, 0)), 1.0),  # end point against midpoint
        (((0, 0, 0), (1, 0, 0), (0, 0, 1), (0, 1, 1)), 1.0),  # skew lines
        (((0, 0, 0), (1, 0, 0), (0.5, -1, 0), (0.5, 1, 0)), 0.0),  # crossing
        (((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)), 1.0),  # collinear
        (((0, 0, 0), (1, 0, 0), (-5, 2, 0), (5, 2, 0)), 2.0),  # parallel
        (((0, 0, 0), (0, 0, 0), (3, 4, 0), (3, 4, 0)), 5.0),  # two points
        (((0, 0, 0), (0, 0, 0), (-1, 1, 0), (1, 1, 0)), 1.0),  # a point and a segment
        (((-1, 1, 0), (1, 1, 0), (0, 0, 0), (0, 0, 0)), 1.0),
    ],
)
def test_segment_distance_equals_analytic_values(ends, distance):
    assert segment_distances(*row(*ends)) == pytest.approx([distance], abs=1e-12)


def test_clearance_of_repeated_postures_is_computed_once_per_posture_change(monkeypatch):
    measured: list[int] = []
    nearest = CapsuleDistances._find_nearest
    monkeypatch.setattr(
        CapsuleDistances,
        "_find_nearest",
        lambda self, angles, chosen: measured.append(len(chosen)) or nearest(self, angles, chosen),
    )
    first, second = random_postures(ROBOT.skeleton, 2, seed=4)
    lasting = np.repeat([first, second, first], 500, axis=0)
    result = DISTANCES.clearance(lasting)
    assert measured == [3]
    expected = DISTANCES.clearance(np.stack([first, second]))
    assert result.distances[[0, 499, 500, 999, 1000]] == pytest.approx(expected.distances[[0, 0, 1, 1, 0]], abs=1e-14)
    assert [result.pairs[k] for k in (499, 500)] == list(expected.pairs)


@pytest.mark.parametrize("robot", [ROBOT, Robot.load("upper36")], ids=["upper22", "upper36"])
def test_distance_bounds_hold_and_are_tight_for_small_rotations(robot):
    rng, distances = np.random.default_rng(5), CapsuleDistances(robot)
    postures = random_postures(robot.skeleton, 30, seed=6)
    for widest in (0.002, 0.05, 0.4):
        turns = rng.uniform(0.0, widest, postures.shape)
        bounds = distances.bounds(postures, turns)
        for _ in range(8):
            turned = postures + rng.choice([-1.0, 1.0], postures.shape) * turns
            assert np.all(distances.clearance(turned).distances >= bounds - 1e-12)
    assert np.all(distances.clearance(postures).distances - distances.bounds(postures, 0 * postures) < 1e-12)
