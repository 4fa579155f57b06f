import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim.worst_postures import extremes, random_postures

SKELETON = Robot.load().skeleton


def test_random_postures_are_seeded_and_within_joint_ranges():
    postures = random_postures(SKELETON, 200, seed=4)
    assert np.array_equal(postures, random_postures(SKELETON, 200, seed=4))
    assert not np.array_equal(postures, random_postures(SKELETON, 200, seed=5))
    assert (postures >= SKELETON.lower).all()
    assert (postures <= SKELETON.upper).all()
    assert np.array_equal(postures[0], SKELETON.rest)
    assert not postures[1].any()


def test_every_second_random_posture_has_about_half_its_hinges_at_stops():
    postures = random_postures(SKELETON, 200)
    at_stop = (postures == SKELETON.lower) | (postures == SKELETON.upper)
    assert not at_stop[2::2].any()
    assert 0.4 < at_stop[3::2].mean() < 0.6


def test_coordinate_ascent_over_postures_finds_the_maximum():
    def measure(postures):
        return 1.0 - (postures - SKELETON.upper) ** 2 - np.abs(postures[:, ::-1] - SKELETON.lower[::-1])

    result = extremes(SKELETON, measure)
    for hinge, posture in enumerate(result.postures):
        best = measure(posture[None])[0, hinge]
        assert result.values[hinge] == pytest.approx(best)
        assert posture[hinge] == pytest.approx(SKELETON.upper[hinge])
        assert posture[21 - hinge] == pytest.approx(SKELETON.lower[21 - hinge])
