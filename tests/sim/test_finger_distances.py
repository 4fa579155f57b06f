"""Distances of fingers, which distant fingers approximate by a ball."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.robot import SIDES, Robot
from kinesic.sim.distances import FINGER_BALL_DISTANCE, MAX_EXACT_FINGER_GAP, CapsuleDistances
from kinesic.sim.fingers import compute_finger_hull
from kinesic.sim.worst_postures import random_postures

from ..reference.sim.segment_distances import segment_distances

ROBOT = Robot.load("upper36")
DISTANCES = CapsuleDistances(ROBOT)


def measure_all_pairs(posture):
    """Return the distance [m] of every counted pair from all capsules."""
    frames = ROBOT.skeleton.frames(posture)
    axes: dict[str, list[tuple]] = {}
    for body, parts in ROBOT.bodies.items():
        for name in parts:
            k = ROBOT.skeleton.segment(name)
            axes.setdefault(body, []).extend(
                (*(frames.origins[k] + frames.rotations[k] @ end for end in (c.start, c.end)), c.radius)
                for c in ROBOT.skeleton.segments[k].capsules
            )
    for a, b in ROBOT.counted_pairs:
        rows = [(*one, *other) for one in axes[a] for other in axes[b]]
        a0, a1, ra, b0, b1, rb = (np.array(column) for column in zip(*rows, strict=True))
        yield float((segment_distances(a0, a1, b0, b1) - ra - rb).min())


def test_distances_of_fingers_are_exact_when_near_and_lower_bounds_when_far():
    postures = random_postures(ROBOT.skeleton, 40, seed=5)
    gaps, nearest = DISTANCES.gaps(postures), DISTANCES.clearance(postures)
    coarse = DISTANCES.gaps(postures, exact_below=0.01)
    for posture, result, rough, least in zip(postures, gaps, coarse, nearest.distances, strict=True):
        expected = np.array(list(measure_all_pairs(posture)))
        for values, limit in ((result, MAX_EXACT_FINGER_GAP), (rough, 0.01)):
            near = expected < limit
            np.testing.assert_allclose(values[near], expected[near], atol=1e-9)
            assert np.all(values <= expected + 1e-9)
        if expected.min() < FINGER_BALL_DISTANCE:
            assert least == pytest.approx(expected.min(), abs=1e-9)
        else:
            assert FINGER_BALL_DISTANCE <= least <= expected.min() + 1e-9
    assert (coarse < gaps - 1e-9).any()


@pytest.mark.parametrize("side", SIDES)
def test_finger_ball_contains_the_fingers_in_300_random_postures(side):
    ball, hand = compute_finger_hull(ROBOT, side), ROBOT.skeleton.segment(f"{side}_wrist")
    frames = ROBOT.skeleton.frames(random_postures(ROBOT.skeleton, 300, seed=6))
    centre = frames.origins[:, hand] + frames.rotations[:, hand] @ ball.start
    for name in ROBOT.fingers(side):
        k = ROBOT.skeleton.segment(name)
        for capsule in ROBOT.skeleton.segments[k].capsules:
            ends = frames.origins[:, k] + frames.rotations[:, k] @ capsule.end
            assert (np.linalg.norm(ends - centre, axis=1) + capsule.radius).max() <= ball.radius + 1e-12


def test_closest_finger_approach_between_samples_is_found():
    postures = random_postures(ROBOT.skeleton, 12, seed=8)
    motion = np.concatenate([np.linspace(a, b, 40) for a, b in pairwise(postures)])
    ends = np.arange(0, len(motion), 4)
    solution = DISTANCES.approach(motion, ends, near=0.01)
    every = DISTANCES.clearance(motion).distances
    for k, end in enumerate(ends[1:], 1):
        true = every[ends[k - 1] + 1 : end + 1].min()
        assert (
            solution.distances[k] == pytest.approx(true, abs=1e-9)
            if true < 0.01
            else solution.distances[k] >= 0.01 - 1e-9
        )


@pytest.mark.parametrize("side", SIDES)
def test_fingers_stay_5_mm_from_their_own_forearm_in_1000_random_postures(side):
    everything = replace(ROBOT, exclusions=tuple(e for e in ROBOT.exclusions if f"{side}_elbow" not in e.pair))
    pair = everything.counted_pairs.index((f"{side}_elbow", f"{side}_fingers"))
    assert CapsuleDistances(everything).gaps(random_postures(ROBOT.skeleton, 1000, seed=9))[:, pair].min() > 0.005
