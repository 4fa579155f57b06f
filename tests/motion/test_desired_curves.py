"""Tests of velocities, accelerations and easings against formulas for one hinge."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.desired import _adapt_easing, _change, _is_allowed, _soften_stepwise, join_keys
from kinesic.motion.easing import soften_easing
from kinesic.motion.keys import KeyPassage, KeyPosture, Keys

# limits of two hinges, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value] * 2) for value in (-1.2, 1.5, 10, 100, 1e4, 1e-3, 1e-2, 1)))
# velocity, acceleration and duty limits that no easing exceeds
WIDE_LIMITS = replace(JOINT_LIMITS, speed=sealed([1e6] * 2), acceleration=sealed([1e6] * 2), duty=sealed([1e6] * 2))


def random_keys(seed: int) -> tuple[np.ndarray, np.ndarray, list[list[KeyPassage]]]:
    """Return random times, angles and passages of eight keys of two hinges."""
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.1, 0.9, 8))
    angles = np.clip(np.cumsum(random.normal(0.0, 0.5, (8, 2)) * (random.random((8, 2)) < 0.8), axis=0), -1.1, 1.4)
    kinds = random.choice(["plain", "tense", "loose", "swing"], (8, 2))
    parameters = {
        "plain": lambda: KeyPassage(bias=random.uniform(-1, 1)),
        "tense": lambda: KeyPassage(random.uniform(0, 1), random.uniform(-1, 0)),
        "loose": lambda: KeyPassage(random.uniform(-1, 0), bias=random.uniform(-0.5, 0.5)),
        "swing": lambda: KeyPassage(random.uniform(-0.5, 0.5), swing=random.uniform(0, 1)),
    }
    return times, angles, [[parameters[kind]() for kind in row] for row in kinds]


def joined(times, angles, passages, limits: Limits = JOINT_LIMITS):
    rows = [
        KeyPosture(float(time), sealed(row), (True,) * len(row), passages=tuple(own))
        for time, row, own in zip(times, angles, passages, strict=True)
    ]
    return join_keys(np.asarray(times), Keys.of(rows, limits.part(np.arange(len(angles[0]))), margin=0.0))


def velocity_at(times, angles, passage: KeyPassage) -> float:
    """Return the velocity at the second of three keys."""
    (h, g), (d, e), middle = np.diff(times), np.diff(angles), angles[1]
    if min(abs(d), abs(e)) < 1e-9:
        return 0.0
    kept = (1 - passage.tension) * (1 + passage.continuity) + 2 * (1 - max(passage.tension, 0)) * passage.swing
    free = kept * ((1 + passage.bias) * d / h * g + (1 - passage.bias) * e / g * h) / (h + g)
    inside = 0.0 if d * e < 0 else 2 * min(abs(d) / h, abs(e) / g)
    ahead, behind = (1.5 - middle, middle + 1.2) if free > 0 else (middle + 1.2, 1.5 - middle)
    within_range = 2.5 * min(ahead / g, behind / h)
    usual = max(inside, min(0.25 / max(h, g), within_range))
    widening = min(max(-passage.tension, 0) + passage.swing, 1)
    bound = usual + widening * max(within_range - usual, 0.0)
    return float(np.clip(free, -bound, bound))


def acceleration_at(times, angles, velocities, passage: KeyPassage) -> float:
    """Return the acceleration at the second of three keys with given velocities."""
    (h, g), (d, e), (u, v, w) = np.diff(times), np.diff(angles), velocities
    if min(abs(d), abs(e)) < 1e-9:
        return 0.0
    end, begin = (-6 * d + h * (2 * u + 4 * v)) / h**2, (6 * e - g * (4 * v + 2 * w)) / g**2
    bound = max(6 * min(abs(d) / h**2, abs(e) / g**2), 58 * 0.05 / max(h, g) ** 2)
    return float(np.clip(min(passage.flow, 1) * (end + begin) / 2, -bound, bound))


@pytest.mark.parametrize("seed", range(30))
def test_velocities_and_accelerations_at_keys_match_the_formulas_for_three_keys(seed):
    times, angles, passages = random_keys(seed)
    (curve,) = joined(times, angles, passages).curves.values()
    _, velocities, accelerations = curve.states
    for hinge in (0, 1):
        for k in range(1, 7):
            near, own = slice(k - 1, k + 2), passages[k][hinge]
            expected = velocity_at(times[near], angles[near, hinge], own)
            assert velocities[k, hinge] == pytest.approx(expected, abs=1e-9)
            expected = acceleration_at(times[near], angles[near, hinge], velocities[near, hinge], own)
            assert accelerations[k, hinge] == pytest.approx(expected, abs=1e-9)
    assert not velocities[[0, -1]].any()
    assert not accelerations[[0, -1]].any()


def test_desired_motion_of_mirrored_keys_is_the_mirrored_desired_motion():
    even = replace(JOINT_LIMITS, lower=sealed([-1.5] * 2))
    for seed in range(5):
        times, angles, passages = random_keys(seed)
        asked = np.linspace(times[0], times[-1], 50) - times[0]
        one, other = joined(times, angles, passages, even), joined(times, -angles, passages, even)
        np.testing.assert_allclose(other.angles(asked), -one.angles(asked), atol=1e-9)


def test_desired_motion_moves_until_its_last_key_and_rests_afterwards():
    motion = joined([2.0, 2.5, 3.5], np.array([[0.0], [0.4], [1.0]]), [[KeyPassage()]] * 3)
    assert (motion.duration, motion.zero) == (1.5, -2.0)
    angles, speeds, accelerations = motion.sample(np.array([-1e-9, 1e-3, 0.5, 1.499, 1.5 + 1e-9, 9.0]))
    assert speeds[:, 0].astype(bool).tolist() == [False, True, True, True, False, False]
    assert accelerations[[0, 4, 5]].any() == np.False_
    np.testing.assert_allclose(angles[[0, 2, 4, 5], 0], [0.0, 0.4, 1.0, 1.0])


@pytest.mark.parametrize(
    ("room", "expected"),
    [
        (0.019, ("out_quart", 0.1)),
        (0.02, ("out_back", 0.02)),
        (0.0399999, ("out_back", 0.03)),
        (0.04 - 1e-9, ("out_back", 0.04)),
        (0.1, ("out_back", 0.1)),
    ],
)
def test_easing_overshoot_is_rounded_down_to_0_01_within_the_joint_range(room, expected):
    easing, overshoot = _adapt_easing("out_back", room)
    assert (easing, overshoot) == (expected[0], pytest.approx(expected[1], abs=1e-12))
    assert _adapt_easing("out_bounce", room) == ("out_bounce", 0.1)


def test_easings_are_softened_in_quarter_steps_down_to_minimum_jerk():
    requested = (("out_power", 0.1, 2.0), ("out_back", 0.05, 1.6))
    steps = [*_soften_stepwise(requested)]
    assert len(steps) == 4
    smooth = soften_easing("minimum_jerk", 1.0)[:, :-1]
    for step, first, second in zip(steps, (2.0, 1.75, 1.5, 1.25), (1.6, 1.35, 1.1, 1.0), strict=True):
        assert step.shape == (3, 2, 16)
        np.testing.assert_allclose(step[:, 0], soften_easing("out_power", first)[:, :-1] - smooth)
        gentle = smooth if second == 1.0 else soften_easing("out_back", second, 0.05)[:, :-1]
        np.testing.assert_allclose(step[:, 1], gentle - smooth, atol=1e-12)


@pytest.mark.parametrize(("easing", "least"), [("linear", 3.3), ("out_power", 1.0), ("late", 1.0)])
def test_easings_of_minimum_steepness_are_exactly_minimum_jerk(easing, least):
    assert not _change(easing, 0.1, least).any()
    assert _change(easing, 0.1, least + 0.1).any()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_eased_motion_may_reach_three_times_each_limit_and_no_more(sign):
    limits = np.array([[2.0, 1.0], [30.0, 9.0], [0.5, 0.4], [0.01, 0.02], [0.1, 0.3]])
    for hinge in (0, 1):
        speed, acceleration, duty, inertial, viscous = limits[:, hinge]
        for velocity, force in (
            (3.0 * speed, 0.0),
            (0.0, 3.0 * acceleration),
            (0.5, (3.0 * duty - 0.5 * viscous) / inertial),
        ):
            wide = limits.copy()
            if velocity == 0.0:
                wide[2] = 1e3
            elif force:
                wide[:2] = 1e3
            else:
                wide[1:3] = 1e3
            for factor, is_allowed in ((0.999, True), (1.001, False)):
                states = np.zeros((3, 2, 4))
                states[1:, hinge, 2] = sign * factor * np.array([velocity, force])
                assert _is_allowed(states, wide) is is_allowed


def eased(easing: str, angles, times=(0.0, 1.0), limits: Limits = WIDE_LIMITS, **options):
    """Return an easing's offsets at 17 times of the last interval."""
    asked = times[-2] + np.arange(17) / 16 * (times[-1] - times[-2])
    plain, changed = (
        joined(times, np.array(angles), [[own] * len(angles[0])] * len(times), limits).sample(asked)
        for own in (KeyPassage(**options), KeyPassage(easing=easing, **options))
    )
    return [one - other for one, other in zip(changed, plain, strict=True)]


@pytest.mark.parametrize("duration", [0.5, 2.0])
@pytest.mark.parametrize("to", [0.8, -0.6])
def test_easing_offsets_scale_with_the_rotation_and_its_time(duration, to):
    offsets = eased("out_power", [[0.0], [to]], (0.0, duration), steepness=5.0)
    expected = soften_easing("out_power", 5.0) - soften_easing("minimum_jerk", 1.0)
    for order, values in enumerate(offsets):
        np.testing.assert_allclose(values[:, 0], expected[order] * to / duration**order, atol=1e-9)


@pytest.mark.parametrize(("to", "room"), [(1.46, 0.02), (1.45, 0.03), (1.3, 0.1), (-1.16, 0.03), (-1.0, 0.1)])
def test_easing_overshoot_uses_the_available_joint_range_in_either_direction(to, room):
    offsets = eased("out_back", [[0.0], [to]], steepness=5.0)
    expected = soften_easing("out_back", 5.0, room) - soften_easing("minimum_jerk", 1.0)
    np.testing.assert_allclose(offsets[0][:, 0], expected[0] * to, atol=1e-9)


def test_easing_of_one_hinge_changes_no_other_hinge_and_no_other_interval():
    times, angles = [0.0, 1.0, 2.0], np.array([[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]])
    plain, accent = KeyPassage(tension=1.0), KeyPassage(tension=1.0, easing="out_power")
    asked = np.linspace(0.0, 2.0, 41)
    usual = joined(times, angles, [[plain] * 2] * 3, WIDE_LIMITS).angles(asked)
    changed = joined(times, angles, [[plain] * 2, [plain, accent], [plain] * 2], WIDE_LIMITS).angles(asked)
    np.testing.assert_allclose(changed[:, 0], usual[:, 0], atol=1e-12)
    np.testing.assert_allclose(changed[20:, 1], usual[20:, 1], atol=1e-12)
    assert np.abs(changed[:20, 1] - usual[:20, 1]).max() > 0.05


@pytest.mark.parametrize(("easing", "tension", "is_rebound"), [("out_bounce", 0.0, True), ("out_back", 0.0, False)])
def test_swing_enlarges_the_easing_offset_of_out_bounce_and_that_of_out_back_only_at_negative_tension(
    easing, tension, is_rebound
):
    angles, times = [[0.0], [0.6], [0.3]], (0.0, 0.5, 1.0)
    offsets = eased(easing, angles, times, swing=0.9, tension=tension, steepness=5.0)[0][:, 0]
    expected = (soften_easing(easing, 5.0) - soften_easing("minimum_jerk", 1.0))[0]
    eased_share = float(offsets @ expected / (expected @ expected)) / -0.3
    np.testing.assert_allclose(offsets, -0.3 * eased_share * expected, atol=1e-9)
    assert (eased_share > 1.0 + 1e-6) is is_rebound
    if not is_rebound:
        assert eased_share == pytest.approx(1.0)
        loose = eased(easing, angles, times, swing=0.9, tension=-1e-9, steepness=5.0)[0][:, 0]
        assert float(np.abs(loose).max()) > 1.1 * float(np.abs(offsets).max())
