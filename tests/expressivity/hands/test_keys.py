import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from kinesic.body.reach import Reach
from kinesic.expressivity.hands.keys import (
    HandKey,
    PathVelocity,
    RotationSpline,
    facing_rotations,
    hand_at,
    path_keys_between,
)
from kinesic.expressivity.hands.poses import REST_HAND
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.paths import shape_path
from kinesic.expressivity.turns import MIN_KEY_SPACING
from kinesic.motion.keys import PLAIN_PASSAGE, KeyPassage

KEY_TIMES = (0.0, 0.4, 1.1, 1.5, 2.3)
ORIENTATIONS = Rotation.random(5, random_state=7)
KEY_ROTATIONS = ORIENTATIONS.as_matrix()
TIME_STEP = 1e-6


def rotation_spline(passed: KeyPassage = PLAIN_PASSAGE, keys: np.ndarray = KEY_ROTATIONS) -> RotationSpline:
    return RotationSpline.through(KEY_TIMES, keys, (passed,) * len(KEY_TIMES))


def angular_velocity(motion: RotationSpline, time: float) -> np.ndarray:
    before, after = motion.at(np.array([time - TIME_STEP / 2, time + TIME_STEP / 2]))
    return Rotation.from_matrix(before.T @ after).as_rotvec() / TIME_STEP


def test_rotation_spline_interpolates_its_keys():
    np.testing.assert_allclose(rotation_spline().at(np.array(KEY_TIMES)), KEY_ROTATIONS, atol=1e-12)


@pytest.mark.parametrize("passed", [PLAIN_PASSAGE, KeyPassage(-1.0, 0.0, 1.0), KeyPassage(0.4, -0.3, -0.7)])
def test_angular_velocity_of_a_rotation_spline_is_continuous_at_keys(passed):
    motion = rotation_spline(passed)
    for time in KEY_TIMES[1:-1]:
        before, after = angular_velocity(motion, time - TIME_STEP), angular_velocity(motion, time + TIME_STEP)
        assert np.linalg.norm(before) > 0.1
        np.testing.assert_allclose(before, after, atol=1e-3)


def test_slerp_has_discontinuous_angular_velocity():
    slerp = Slerp(KEY_TIMES, ORIENTATIONS)
    jumps = [
        np.linalg.norm(
            (slerp(time).inv() * slerp(time + TIME_STEP)).as_rotvec()
            - (slerp(time - TIME_STEP).inv() * slerp(time)).as_rotvec()
        )
        / TIME_STEP
        for time in KEY_TIMES[1:-1]
    ]
    assert min(jumps) > 1.0


def test_rotation_spline_about_one_axis_equals_the_cubic_spline_of_its_angle():
    angles = np.array([0.0, 0.7, 1.1, 0.2, 0.5])
    motion = rotation_spline(keys=Rotation.from_rotvec(angles[:, None] * np.array([0.0, 0.6, 0.8])).as_matrix())
    slopes = np.zeros(5)
    slopes[1:-1] = np.gradient(angles, KEY_TIMES)[1:-1]
    at = np.linspace(0.0, 2.3, 40)
    expected = CubicHermiteSpline(KEY_TIMES, angles, slopes)(at)
    np.testing.assert_allclose(Rotation.from_matrix(motion.at(at)).as_rotvec() @ [0.0, 0.6, 0.8], expected, atol=1e-12)


def test_hand_rotation_with_full_tension_stops_at_each_key():
    for time in KEY_TIMES:
        assert np.linalg.norm(angular_velocity(rotation_spline(KeyPassage(tension=1.0)), time)) < 1e-4


def test_hand_rotation_is_constant_before_and_after_its_keys():
    motion = rotation_spline()
    np.testing.assert_allclose(motion.at(np.array([-3.0, 9.0])), KEY_ROTATIONS[[0, -1]], atol=1e-12)


def test_hand_rotation_is_constant_during_holds():
    motion = rotation_spline(keys=KEY_ROTATIONS[[0, 1, 1, 2, 3]])
    during = motion.at(np.linspace(KEY_TIMES[1], KEY_TIMES[2], 9))
    np.testing.assert_allclose(during, np.broadcast_to(KEY_ROTATIONS[1], during.shape), atol=1e-12)


def test_hand_rotation_takes_the_shortest_arc():
    there = Rotation.from_rotvec([[0.0, 0.0, 0.1], [0.0, 0.0, 2 * np.pi - 0.1]]).as_matrix()
    motion = RotationSpline.through((0.0, 1.0), there, (PLAIN_PASSAGE, PLAIN_PASSAGE))
    np.testing.assert_allclose(motion.at(np.array([0.5]))[0], np.eye(3), atol=1e-12)


def test_hand_rotation_matches_pointing_and_palm_directions():
    pointing, palm = np.array([0.0, 0.6, 0.8]), np.array([1.0, 0.0, 0.0])
    matrix = facing_rotations(pointing, palm)
    np.testing.assert_allclose(matrix[:, 0], pointing, atol=1e-12)
    np.testing.assert_allclose(matrix[:, 2], palm, atol=1e-12)


@pytest.mark.parametrize("turns", [1, 3])
def test_hand_path_with_a_late_accent_is_fastest_in_its_last_turn(turns):
    ends = [HandKey(time, Hand(Reach(np.array([0.3, -0.2, 1.0 + time / 10])))) for time in (0.0, 2.0)]
    path = shape_path("circle", amplitude=(0.1, 0.0, 0.1), frequency=(turns, turns, turns))
    fastest = []
    for late in (False, True):
        keys = [
            ends[0],
            *path_keys_between(ends, 1, path, unit=0.42, velocity=PathVelocity(0.0, has_late_peak=late)),
            ends[1],
        ]
        places = np.array([key.hand.reach.position for key in keys])
        times = np.array([key.time for key in keys])
        speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(times)
        fastest.append((times[:-1] + times[1:])[speeds.argmax()] / 2)
        assert speeds[-1] < speeds.max()
    assert fastest[1] > 2.0 - 1.0 / turns
    assert fastest[1] > fastest[0]


def test_hand_that_arrives_faster_at_a_path_starts_the_path_faster():
    ends = [HandKey(time, Hand(Reach(np.array([0.3, -0.2, 1.0 + time / 10])))) for time in (0.0, 2.0)]
    path = shape_path("circle", amplitude=(0.1, 0.0, 0.1))
    lengths = []
    for velocity in (0.0, 0.4, 0.8):
        first = path_keys_between(ends, 1, path, unit=0.42, velocity=PathVelocity(0.0, start=velocity))[0]
        lengths.append(np.linalg.norm(first.hand.reach.position - ends[0].hand.reach.position) / first.time)
    assert lengths[0] < lengths[1] < lengths[2]


def facing(time: float, x: float, angle: float) -> HandKey:
    """Return a hand key rotated about the vertical axis."""
    pointing, palm = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([0.0, 0.0, 1.0])
    return HandKey(time, Hand(Reach(np.array([x, -0.2, 0.9]), pointing=pointing, palm=palm)))


def test_hand_position_is_linear_between_keys_and_constant_outside():
    rest = Reach(np.zeros(3))
    assert hand_at([], 1.0, rest) is REST_HAND
    keys = [facing(1.0, 0.1, 0.0), facing(2.0, 0.3, 1.0), facing(4.0, 0.2, 1.0)]
    assert [hand_at(keys, time, rest) for time in (0.0, 1.0, 2.0, 4.0, 9.0)] == [keys[k].hand for k in (0, 0, 1, 2, 2)]
    np.testing.assert_allclose(hand_at(keys, 1.25, rest).reach.position, [0.15, -0.2, 0.9])
    np.testing.assert_allclose(hand_at(keys, 3.5, rest).reach.position, [0.225, -0.2, 0.9])


@pytest.mark.parametrize("k", [1, 2, 3])
def test_hand_keys_on_a_path_rotate_on_the_spline_of_neighbouring_keys(k):
    keys = [facing(0.5 * j, 0.1 * j, angle) for j, angle in enumerate((0.0, 0.3, 1.2, 1.0, 0.8))]
    result = path_keys_between(
        keys, k, shape_path("circle", amplitude=(0.05, 0.0, 0.05)), unit=0.42, velocity=PathVelocity(0.0)
    )
    near = keys[max(0, k - 2) : k + 2]
    motion = RotationSpline.through(
        [key.time for key in near],
        facing_rotations(*(np.array([getattr(key.hand.reach, name) for key in near]) for name in ("pointing", "palm"))),
        [key.passage for key in near],
    )
    assert len(result) > 3
    for key in result:
        np.testing.assert_allclose(key.hand.reach.pointing, motion.at(np.array([key.time]))[0][:, 0], atol=1e-9)
        np.testing.assert_allclose(key.hand.reach.palm, [0.0, 0.0, 1.0], atol=1e-9)
        assert keys[k - 1].time + MIN_KEY_SPACING <= key.time <= keys[k].time - MIN_KEY_SPACING
        assert key.hand.passing


def test_hand_path_to_a_key_without_orientation_keeps_the_direction_of_the_first_key_or_has_none():
    keys = [facing(0.0, 0.0, 0.0), HandKey(1.0, Hand(Reach(np.array([0.1, -0.2, 0.9])))), facing(2.0, 0.2, 1.0)]
    for key in path_keys_between(
        keys, 1, shape_path("circle", amplitude=(0.05, 0.0, 0.05)), unit=0.42, velocity=PathVelocity(0.0)
    ):
        assert key.hand.reach.pointing is (keys[0].hand.reach.pointing if key.hand.reach.palm is not None else None)


def test_straight_hand_path_and_resting_hand_have_no_intermediate_keys():
    keys = [facing(0.0, 0.0, 0.0), facing(1.0, 0.3, 0.0), HandKey(2.0, REST_HAND)]
    assert path_keys_between(keys, 1, None, unit=0.42, velocity=PathVelocity(0.0)) == []
    assert (
        path_keys_between(
            keys, 2, shape_path("circle", amplitude=(0.05, 0.0, 0.05)), unit=0.42, velocity=PathVelocity(0.0)
        )
        == []
    )


def test_high_power_starts_a_hand_path_more_slowly():
    ends = [facing(0.0, 0.1, 0.0), facing(2.0, 0.3, 0.0)]
    path = shape_path("circle", amplitude=(0.1, 0.0, 0.1), frequency=(3, 3, 3))
    begun = []
    for power in (0.0, 1.0):
        keys = path_keys_between(ends, 1, path, unit=0.42, velocity=PathVelocity(power))
        places = np.array([ends[0].hand.reach.position, *(key.hand.reach.position for key in keys)])
        times = np.array([0.0, *(key.time for key in keys)])
        begun.append(np.linalg.norm(np.diff(places, axis=0), axis=1)[0] / np.diff(times)[0])
    assert begun[0] > begun[1] > 0.0
