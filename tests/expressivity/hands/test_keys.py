import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from kinesic.body.reach import Reach
from kinesic.expressivity.hands.keys import HandKey, Turning, along, facing_rotations, hand_at
from kinesic.expressivity.hands.poses import REST
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.paths import shape_path
from kinesic.expressivity.turns import MERGE
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


def facing(time: float, x: float, angle: float) -> HandKey:
    """A hand at a place, turned about the vertical."""
    pointing, palm = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([0.0, 0.0, 1.0])
    return HandKey(time, Hand(Reach(np.array([x, -0.2, 0.9]), pointing=pointing, palm=palm)))


def test_a_hand_is_constant_outside_its_keys_and_straight_between_them():
    rest = Reach(np.zeros(3))
    assert hand_at([], 1.0, rest) is REST
    keys = [facing(1.0, 0.1, 0.0), facing(2.0, 0.3, 1.0), facing(4.0, 0.2, 1.0)]
    assert [hand_at(keys, time, rest) for time in (0.0, 1.0, 2.0, 4.0, 9.0)] == [keys[k].hand for k in (0, 0, 1, 2, 2)]
    np.testing.assert_allclose(hand_at(keys, 1.25, rest).reach.position, [0.15, -0.2, 0.9])
    np.testing.assert_allclose(hand_at(keys, 3.5, rest).reach.position, [0.225, -0.2, 0.9])


@pytest.mark.parametrize("k", [1, 2, 3])
def test_on_a_path_a_hand_turns_as_the_spline_through_its_neighbours_does(k):
    keys = [facing(0.5 * j, 0.1 * j, angle) for j, angle in enumerate((0.0, 0.3, 1.2, 1.0, 0.8))]
    found = along(keys, k, shape_path("circle", amplitude=(0.05, 0.0, 0.05)), unit=0.42, power=0.0)
    near = keys[max(0, k - 2) : k + 2]
    motion = Turning.through(
        [key.time for key in near],
        facing_rotations(*(np.array([getattr(key.hand.reach, name) for key in near]) for name in ("pointing", "palm"))),
        [key.passage for key in near],
    )
    assert len(found) > 3
    for key in found:
        np.testing.assert_allclose(
            key.hand.reach.pointing, motion.at(np.array([key.time])).as_matrix()[0][:, 0], atol=1e-9
        )
        np.testing.assert_allclose(key.hand.reach.palm, [0.0, 0.0, 1.0], atol=1e-9)
        assert keys[k - 1].time + MERGE <= key.time <= keys[k].time - MERGE
        assert key.hand.passing


def test_a_hand_that_only_one_key_turns_is_not_turned_by_a_spline():
    keys = [facing(0.0, 0.0, 0.0), HandKey(1.0, Hand(Reach(np.array([0.1, -0.2, 0.9])))), facing(2.0, 0.2, 1.0)]
    for key in along(keys, 1, shape_path("circle", amplitude=(0.05, 0.0, 0.05)), unit=0.42, power=0.0):
        assert key.hand.reach.pointing is (keys[0].hand.reach.pointing if key.hand.reach.palm is not None else None)


def test_there_are_no_keys_on_a_straight_path_or_at_rest():
    keys = [facing(0.0, 0.0, 0.0), facing(1.0, 0.3, 0.0), HandKey(2.0, REST)]
    assert along(keys, 1, None, unit=0.42, power=0.0) == []
    assert along(keys, 2, shape_path("circle", amplitude=(0.05, 0.0, 0.05)), unit=0.42, power=0.0) == []


def test_power_makes_a_hand_speed_up_longer_along_its_path():
    ends = [facing(0.0, 0.1, 0.0), facing(2.0, 0.3, 0.0)]
    path = shape_path("circle", amplitude=(0.1, 0.0, 0.1), frequency=(3, 3, 3))
    begun = []
    for power in (0.0, 1.0):
        keys = along(ends, 1, path, unit=0.42, power=power)
        places = np.array([ends[0].hand.reach.position, *(key.hand.reach.position for key in keys)])
        times = np.array([0.0, *(key.time for key in keys)])
        begun.append(np.linalg.norm(np.diff(places, axis=0), axis=1)[0] / np.diff(times)[0])
    assert begun[0] > begun[1] > 0.0
