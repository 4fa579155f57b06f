import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from kinesic.body.reach import Reach
from kinesic.expressivity.hands.keys import HandKey, Turning, along, facing_rotations
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.paths import shape_path
from kinesic.motion.keys import PLAIN_PASSAGE, KeyPassage

TIMES = (0.0, 0.4, 1.1, 1.5, 2.3)
KEYS = Rotation.random(5, random_state=7)
STEP = 1e-6


def turning(passed: KeyPassage = PLAIN_PASSAGE, keys: Rotation = KEYS) -> Turning:
    return Turning.through(TIMES, keys, (passed,) * len(TIMES))


def speed(motion: Turning, time: float) -> np.ndarray:
    before, after = motion.at(np.array([time - STEP / 2, time + STEP / 2]))
    return (before.inv() * after).as_rotvec() / STEP


def test_keys_are_met():
    np.testing.assert_allclose((KEYS.inv() * turning().at(np.array(TIMES))).magnitude(), 0.0, atol=1e-12)


@pytest.mark.parametrize("passed", [PLAIN_PASSAGE, KeyPassage(-1.0, 0.0, 1.0), KeyPassage(0.4, -0.3, -0.7)])
def test_the_turning_speed_does_not_jump_at_keys(passed):
    motion = turning(passed)
    for time in TIMES[1:-1]:
        before, after = speed(motion, time - STEP), speed(motion, time + STEP)
        assert np.linalg.norm(before) > 0.1
        np.testing.assert_allclose(before, after, atol=1e-3)


def test_plain_slerp_jumps_there():
    slerp = Slerp(TIMES, KEYS)
    jumps = [
        np.linalg.norm(
            (slerp(time).inv() * slerp(time + STEP)).as_rotvec() - (slerp(time - STEP).inv() * slerp(time)).as_rotvec()
        )
        / STEP
        for time in TIMES[1:-1]
    ]
    assert min(jumps) > 1.0


def test_about_one_axis_it_is_the_spline_of_the_angle():
    angles = np.array([0.0, 0.7, 1.1, 0.2, 0.5])
    motion = turning(keys=Rotation.from_rotvec(angles[:, None] * np.array([0.0, 0.6, 0.8])))
    slopes = np.zeros(5)
    slopes[1:-1] = np.gradient(angles, TIMES)[1:-1]
    at = np.linspace(0.0, 2.3, 40)
    expected = CubicHermiteSpline(TIMES, angles, slopes)(at)
    np.testing.assert_allclose(motion.at(at).as_rotvec() @ [0.0, 0.6, 0.8], expected, atol=1e-12)


def test_tension_stops_at_each_key():
    for time in TIMES:
        assert np.linalg.norm(speed(turning(KeyPassage(tension=1.0)), time)) < 1e-4


def test_it_rests_before_and_after():
    motion = turning()
    np.testing.assert_allclose((KEYS[[0, -1]].inv() * motion.at(np.array([-3.0, 9.0]))).magnitude(), 0.0, atol=1e-12)


def test_holds_do_not_turn():
    motion = turning(keys=KEYS[[0, 1, 1, 2, 3]])
    during = motion.at(np.linspace(TIMES[1], TIMES[2], 9))
    np.testing.assert_allclose((KEYS[1].inv() * during).magnitude(), 0.0, atol=1e-12)


def test_it_goes_the_short_way():
    there = Rotation.from_rotvec([[0.0, 0.0, 0.1], [0.0, 0.0, 2 * np.pi - 0.1]])
    motion = Turning.through((0.0, 1.0), there, (PLAIN_PASSAGE, PLAIN_PASSAGE))
    assert motion.at(np.array([0.5])).magnitude()[0] == pytest.approx(0.0, abs=1e-12)


def test_what_faces_somewhere_points_and_faces_there():
    pointing, palm = np.array([0.0, 0.6, 0.8]), np.array([1.0, 0.0, 0.0])
    matrix = facing_rotations(pointing, palm).as_matrix()
    np.testing.assert_allclose(matrix[:, 0], pointing, atol=1e-12)
    np.testing.assert_allclose(matrix[:, 2], palm, atol=1e-12)


@pytest.mark.parametrize("turns", [1, 3])
def test_who_is_late_is_fastest_in_the_last_swing_of_a_path_and_still_brakes(turns):
    ends = [HandKey(time, Hand(Reach(np.array([0.3, -0.2, 1.0 + time / 10])))) for time in (0.0, 2.0)]
    path = shape_path("circle", amplitude=(0.1, 0.0, 0.1), frequency=(turns, turns, turns))
    fastest = []
    for late in (False, True):
        keys = [ends[0], *along(ends, 1, path, unit=0.42, power=0.0, late=late), ends[1]]
        places = np.array([key.hand.reach.position for key in keys])
        times = np.array([key.time for key in keys])
        speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(times)
        fastest.append((times[:-1] + times[1:])[speeds.argmax()] / 2)
        assert speeds[-1] < speeds.max()
    assert fastest[1] > 2.0 - 1.0 / turns
    assert fastest[1] > fastest[0]
