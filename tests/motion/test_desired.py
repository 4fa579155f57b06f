from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import desired
from kinesic.motion.desired import DesiredMotion, join_keys
from kinesic.motion.keys import PLAIN_PASSAGE, KeyPassage, KeyPosture, Keys

KEY_TIMES = np.array([0.0, 0.5, 1.2, 1.5, 2.4])  # [s]
# [rad] angles of two hinges at the key times
KEY_ANGLES = np.array([[0.0, 1.0], [0.4, 1.0], [0.9, 0.2], [0.9, -0.4], [0.1, -0.4]])
ALL_KEYED = np.ones_like(KEY_ANGLES, dtype=bool)  # both hinges have a key at each time
# limits of two hinges, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 10, 100, 1e4, 1e-3, 1e-2, 1)))


def keys(passed: KeyPassage = PLAIN_PASSAGE, keyed=ALL_KEYED, angles=KEY_ANGLES, times=KEY_TIMES):
    rows = zip(times, angles, keyed, strict=True)
    return [KeyPosture(time, sealed(row), tuple(own), passages=(passed,) * len(row)) for time, row, own in rows]


def joined(passed: KeyPassage = PLAIN_PASSAGE, keyed=ALL_KEYED, zero: float = 0.0, angles=KEY_ANGLES, times=KEY_TIMES):
    limits = JOINT_LIMITS.part(np.arange(angles.shape[1]))
    return join_keys(times, Keys.of(keys(passed, keyed, angles, times), limits, margin=0.0), zero=zero)


def state(motion, time: float):
    return [values[0] for values in motion.sample(np.array([time]))]


def test_desired_motion_meets_its_keys_exactly():
    np.testing.assert_allclose(joined().sample(KEY_TIMES)[0], KEY_ANGLES, atol=1e-12)


def test_angles_of_the_desired_motion_equal_those_of_its_samples():
    times = np.linspace(-0.2, joined().duration + 0.2, 31)
    assert np.array_equal(joined().angles(times), joined().sample(times)[0])


def test_desired_motion_of_a_hinge_does_not_depend_on_the_other_hinge():
    keyed = ALL_KEYED.copy()
    keyed[2, 1] = False
    times, both = np.linspace(0.0, 2.4, 49), joined(keyed=keyed)
    for hinge in range(2):
        alone = joined(keyed=keyed[:, hinge : hinge + 1], angles=KEY_ANGLES[:, hinge : hinge + 1])
        for one, other in zip(both.sample(times), alone.sample(times), strict=True):
            assert np.array_equal(one[:, hinge], other[:, 0])


def test_desired_motion_starts_and_ends_at_rest():
    for time in (0.0, joined().duration):
        _, speeds, accelerations = state(joined(), time)
        np.testing.assert_allclose(speeds, 0.0, atol=1e-9)
        np.testing.assert_allclose(accelerations, 0.0, atol=1e-7)


def test_velocity_and_acceleration_of_the_desired_motion_are_continuous_at_keys():
    for time in KEY_TIMES[1:-1]:
        before, after = state(joined(), time - 1e-7), state(joined(), time + 1e-7)
        np.testing.assert_allclose(before[1], after[1], atol=1e-4)
        np.testing.assert_allclose(before[2], after[2], atol=1e-3)


def test_velocities_of_the_desired_motion_are_the_derivative_of_its_angles():
    times = np.linspace(0.01, joined().duration - 0.01, 97)
    step = 1e-6
    ahead, behind = joined().sample(times + step)[0], joined().sample(times - step)[0]
    np.testing.assert_allclose((ahead - behind) / (2 * step), joined().sample(times)[1], atol=1e-5)


def test_hinge_of_the_desired_motion_does_not_move_during_a_hold():
    times = np.linspace(1.2, 1.5, 31)
    np.testing.assert_allclose(joined().sample(times)[0][:, 0], 0.9, atol=1e-12)


def test_hinge_without_a_key_in_a_posture_ignores_the_angle_given_there():
    keyed = ALL_KEYED.copy()
    keyed[2, 1] = False
    motion = joined(keyed=keyed)
    assert abs(state(motion, 1.2)[0][1] - KEY_ANGLES[2, 1]) > 0.05
    np.testing.assert_allclose(state(motion, 1.5)[0][1], KEY_ANGLES[3, 1], atol=1e-12)


def test_spline_tension_of_one_stops_the_motion_at_each_key():
    np.testing.assert_allclose(joined(KeyPassage(tension=1.0)).sample(KEY_TIMES)[1], 0.0, atol=1e-9)


def test_spline_continuity_of_minus_one_stops_the_motion_at_a_key():
    stiff, fluid = joined(KeyPassage(continuity=-1.0)), joined(KeyPassage(continuity=0.0))
    assert abs(state(stiff, 0.5)[1][0]) < 1e-9
    assert state(fluid, 0.5)[1][0] > 0.5


def test_desired_motion_keeps_the_given_time_of_the_block_start():
    assert joined(zero=0.7).zero == pytest.approx(0.7)


def test_desired_motion_is_at_rest_after_its_end():
    angles, speeds, _ = state(joined(), 99.0)
    np.testing.assert_allclose(angles, KEY_ANGLES[-1])
    np.testing.assert_array_equal(speeds, 0.0)


def eased(easing: str, steepness: float = 3.0, to: float = 0.9) -> DesiredMotion:
    """Return a desired motion of one hinge, rest to rest in 1 s."""
    angles, times = np.array([[0.0], [to]]), np.array([0.0, 1.0])
    return joined(KeyPassage(easing=easing, steepness=steepness), ALL_KEYED[:2, :1], angles=angles, times=times)


SAMPLE_TIMES = np.linspace(0.0, 1.0, 501)  # [s]


def test_easing_changes_the_desired_motion_but_neither_its_end_angles_nor_end_velocities():
    for easing in ("linear", "out_quart", "out_back", "out_bounce", "out_power"):
        motion = eased(easing, 6.0)
        np.testing.assert_allclose(motion.sample(np.array([0.0, 1.0]))[0][:, 0], [0.0, 0.9], atol=1e-12)
        np.testing.assert_allclose(motion.sample(np.array([0.0, 1.0]))[1], 0.0, atol=1e-9)
        assert np.abs(motion.angles(SAMPLE_TIMES) - eased("minimum_jerk").angles(SAMPLE_TIMES)).max() > 0.01
        assert np.abs(np.diff(motion.sample(SAMPLE_TIMES)[2], axis=0)).max() < 2.5


def test_steeper_easing_raises_the_peak_velocity_of_the_desired_motion():
    peaks = [float(eased("out_back", k).sample(SAMPLE_TIMES)[1].max()) for k in (1.0, 1.5, 2.0, 3.0)]
    assert np.all(np.diff(peaks) > 0.0)
    assert peaks[-1] > 1.8 * peaks[0]


def test_out_back_overshoot_is_limited_by_the_joint_range():
    def beyond(to: float) -> float:
        return float(eased("out_back", 6.0, to).angles(SAMPLE_TIMES).max()) - to

    assert beyond(0.9) == pytest.approx(0.1 * 0.9, rel=0.15)
    assert 0.02 * 1.9 < beyond(1.9) <= 0.1
    assert beyond(1.98) <= 1e-9


def test_easing_becomes_minimum_jerk_for_all_hinges_if_one_hinge_cannot_keep_its_limits():
    slow = replace(JOINT_LIMITS, acceleration=sealed([100.0, 0.01]))
    angles, times = np.array([[0.0, 0.0], [0.9, 0.9]]), np.array([0.0, 1.0])
    rows = keys(KeyPassage(easing="out_back"), ALL_KEYED[:2], angles, times)
    result = join_keys(times, Keys.of(rows, slow, margin=0.0)).angles(SAMPLE_TIMES)
    np.testing.assert_allclose(result, eased("minimum_jerk").angles(SAMPLE_TIMES) @ np.ones((1, 2)), atol=1e-12)


def test_motion_through_unevenly_spaced_keys_on_a_circle_follows_it_within_2_mrad():
    times = np.linspace(0.0, 2.0, 25)
    ease = 10 * (times / 2) ** 3 - 15 * (times / 2) ** 4 + 6 * (times / 2) ** 5
    angles = 0.3 * np.stack([np.cos(2 * np.pi * ease), np.sin(2 * np.pi * ease)], axis=1)
    motion = joined(keyed=np.ones_like(angles, dtype=bool), angles=angles, times=times)
    result = motion.angles(np.linspace(0.0, 2.0, 801))
    np.testing.assert_allclose(np.linalg.norm(result, axis=1), 0.3, atol=2e-3)


def test_motion_through_keys_on_a_smooth_curve_has_the_derivatives_of_the_curve():
    times = np.linspace(0.0, 2 * np.pi, 25)
    times[1:-1] += 0.1 * np.sin(17.0 * times[1:-1])
    angles = 0.3 * (1.0 - np.cos(times))[:, None]
    motion = joined(keyed=np.ones_like(angles, dtype=bool), angles=angles, times=times)
    inner = np.linspace(times[2], times[-3], 801)
    np.testing.assert_allclose(motion.sample(inner)[1][:, 0], 0.3 * np.sin(inner), atol=8e-3)
    np.testing.assert_allclose(motion.sample(inner)[2][:, 0], 0.3 * np.cos(inner), atol=0.1)


def test_negative_tension_makes_the_desired_motion_overshoot_keys_but_not_the_joint_range():
    angles, times = np.array([[0.0], [1.2], [1.9], [1.5], [0.0]]), np.array([0.0, 0.4, 0.8, 1.2, 1.6])
    grid = np.linspace(0.0, 1.6, 801)
    highest = [
        joined(KeyPassage(tension=tension), np.ones((5, 1), dtype=bool), angles=angles, times=times).angles(grid).max()
        for tension in (1.0, 0.0, -1.0)
    ]
    assert highest[0] == pytest.approx(1.9)
    assert highest[0] <= highest[1] < highest[2] <= 2.0


def test_larger_swing_parameter_overshoots_a_reversal_further_but_within_the_joint_range():
    angles, times = np.array([[0.0], [1.2], [1.9], [1.5], [0.0]]), np.array([0.0, 0.4, 0.8, 1.2, 1.6])
    grid, keyed = np.linspace(0.0, 1.6, 801), np.ones((5, 1), dtype=bool)
    highest = [
        joined(KeyPassage(swing=swing), keyed, angles=angles, times=times).angles(grid).max()
        for swing in (0.0, 0.5, 1.0)
    ]
    assert highest[0] < highest[1] < highest[2] <= 2.0
    still = joined(KeyPassage(tension=1.0, swing=1.0), keyed, angles=angles, times=times)
    np.testing.assert_allclose(still.sample(times)[1], 0.0, atol=1e-9)


def test_out_power_does_not_overshoot_the_key_after_a_swing_but_out_back_does():
    angles, times, grid = np.array([[0.0], [1.2], [0.6]]), np.array([0.0, 0.5, 1.0]), np.linspace(0.5, 1.0, 401)
    keyed = np.ones((3, 1), dtype=bool)

    def lowest(easing: str, tension: float = 0.0) -> float:
        passage = KeyPassage(tension, continuity=-0.5, easing=easing, steepness=2.9, swing=0.9)
        return float(joined(passage, keyed, angles=angles, times=times).angles(grid).min())

    assert lowest("out_power") == pytest.approx(0.6, abs=1e-3)
    assert lowest("out_power", -0.5) == pytest.approx(0.6, abs=1e-3)
    assert 0.59 < lowest("out_back") < 0.599
    assert lowest("out_back", -0.5) < 0.59


def test_key_passage_parameters_can_differ_per_hinge_and_key():
    stiff, plain = KeyPassage(tension=1.0), PLAIN_PASSAGE
    rows = [replace(key, passages=(plain, stiff)) for key in keys()]
    rows[1] = replace(rows[1], passages=(stiff, plain))
    speeds = join_keys(KEY_TIMES, Keys.of(rows, JOINT_LIMITS, margin=0.0)).sample(KEY_TIMES)[1]
    assert speeds[1, 0] == pytest.approx(0.0, abs=1e-9)
    assert abs(speeds[2, 1]) < 1e-9
    plainly = joined().sample(KEY_TIMES)[1]
    assert plainly[1, 0] > 0.5
    assert abs(plainly[2, 1]) > 0.5


def test_unchanged_interpolated_curves_come_from_the_cache():
    keyed = ALL_KEYED.copy()
    keyed[2, 1] = False
    limits = JOINT_LIMITS.part(np.arange(2))
    asked = Keys.of(keys(keyed=keyed), limits, margin=0.0)
    first, moved = join_keys(KEY_TIMES, asked), asked.angles.copy()
    moved[1, 0] += 0.1
    again = join_keys(KEY_TIMES, replace(asked, angles=sealed(moved)))
    assert again.curves[1,] is first.curves[1,]
    assert again.curves[0,] is not first.curves[0,]
    np.testing.assert_allclose(again.angles(KEY_TIMES)[:, 0], moved[:, 0], atol=1e-12)
    tense = replace(asked, passage_values=asked.passage_values + np.array([1.0, 0, 0, 0, 0, 0])[:, None, None])
    later = KEY_TIMES + np.array([0.0, 0.0, 0.1, 0.1, 0.1])
    for other in (
        join_keys(KEY_TIMES, tense),
        join_keys(later, asked),
        join_keys(KEY_TIMES, replace(asked, limits=JOINT_LIMITS)),
    ):
        assert other.curves[1,] is not first.curves[1,]


def test_curves_with_many_keys_are_not_cached(monkeypatch):
    asked = Keys.of(keys(), JOINT_LIMITS.part(np.arange(2)), margin=0.0)
    known = join_keys(KEY_TIMES, asked)
    monkeypatch.setattr(desired, "MAX_CACHED_KEYS", len(KEY_TIMES) * 2 - 1)
    again = join_keys(KEY_TIMES, asked)
    assert again.curves[0, 1] is not known.curves[0, 1]
    assert np.array_equal(again.curves[0, 1].states, known.curves[0, 1].states)


@pytest.mark.parametrize("passed", [PLAIN_PASSAGE, KeyPassage(swing=0.5), KeyPassage(tension=-0.5)])
@pytest.mark.parametrize("factor", [0.5, 3.0])
def test_path_through_keys_is_unchanged_if_all_key_times_are_scaled(passed, factor):
    random = np.random.default_rng(5)
    angles = np.cumsum(random.uniform(0.02, 0.9, (9, 2)), axis=0) - 1.9
    times, keyed = np.cumsum(random.uniform(0.1, 0.9, 9)), np.ones_like(angles, dtype=bool)
    times -= times[0]
    usual, other = (joined(passed, keyed=keyed, angles=angles, times=scale * times) for scale in (1.0, factor))
    samples = np.linspace(0.0, times[-1], 97)
    for order, (one, scaled) in enumerate(zip(usual.sample(samples), other.sample(factor * samples), strict=True)):
        np.testing.assert_allclose(factor**order * scaled, one, atol=1e-9)
