"""Tests of random standing postures against captured people."""

import numpy as np
import pytest

from kinesic.planning.arm_directions import ARM_FEATURES
from kinesic.planning.stance import (
    STANCE_FEATURES,
    StanceComponents,
    draw_arm_pose,
    draw_components,
    draw_deviation,
    expand_features,
    mirror_features,
    read_stances,
)

# indices of the forearms' forward angles
FOREARM_FEATURES = [STANCE_FEATURES.index(f"{side}_forearm_forward") for side in "lr"]


def test_stance_distribution_contains_only_defined_features():
    table = read_stances().hanging
    parts = (table.persons, table.rests)
    rows = [table.mean, table.handedness, *(row for part in parts for row in (*part.symmetric, *part.asymmetric))]
    features = {name.removeprefix("l_").removeprefix("r_") for name in STANCE_FEATURES}
    assert {name for row in rows for name in row} <= features


def test_arm_pose_distribution_contains_only_defined_features():
    rows = [row for pose in read_stances().poses for row in (pose.mean, *pose.components)]
    assert {name for row in rows for name in row} <= {*STANCE_FEATURES}


def test_mirrored_stance_swaps_arms_and_inverts_trunk_rotation():
    features = dict.fromkeys(STANCE_FEATURES, 0.0) | {"trunk_turn": 1.0, "trunk_tilt": 2.0, "l_hand_forward": 3.0}
    mirrored = mirror_features(np.array([*features.values()]))
    expected = dict.fromkeys(STANCE_FEATURES, 0.0) | {"trunk_turn": -1.0, "trunk_tilt": 2.0, "r_hand_forward": 3.0}
    assert dict(zip(STANCE_FEATURES, mirrored, strict=True)) == expected


def test_standing_arm_poses_are_drawn_at_random_with_the_probability_of_their_weights():
    table = read_stances()
    drawn = [draw_arm_pose(table, np.random.default_rng(seed)) for seed in range(2000)]
    total = table.hanging.weight + sum(pose.weight for pose in table.poses)
    assert sum(pose is None for pose in drawn) / 2000 == pytest.approx(table.hanging.weight / total, abs=0.06)
    before = np.array([pose.mean[FOREARM_FEATURES] > 45.0 for pose in drawn if pose is not None])
    one_hand = before.sum(axis=1) == 1
    assert one_hand.sum() / 2000 == pytest.approx(table.poses[0].weight / total, abs=0.05)
    assert before[one_hand, 0].mean() == pytest.approx(0.5, abs=0.12)  # either hand


def test_randomly_drawn_arm_poses_have_the_standard_deviation_of_their_components():
    table = read_stances()
    drawn = [draw_arm_pose(table, np.random.default_rng(seed)) for seed in range(2000)]
    both = [pose.deviation for pose in drawn if pose is not None and min(pose.mean[FOREARM_FEATURES]) > 45.0]
    sizes = [row.get("head_tilt", 0.0) for row in table.poses[1].components]
    spread = np.std(both, axis=0)[STANCE_FEATURES.index("head_tilt")]
    assert spread == pytest.approx(0.93 * np.linalg.norm(sizes), rel=0.15)  # of clipped normal draws


def draw_many(table, count=1000):
    return np.stack([draw_deviation(table, np.random.default_rng(seed)) for seed in range(count)])


def test_randomly_drawn_stances_have_the_distribution_of_their_table():
    table = read_stances().hanging
    draws = draw_many(table)
    tilt = [row["trunk_tilt"] for part in (table.persons, table.rests) for row in part.symmetric]
    expected = 0.74 * float(np.linalg.norm(tilt))  # quartile of a t distribution with four degrees of freedom
    column = STANCE_FEATURES.index("trunk_tilt")
    assert np.median(np.abs(draws[:, column])) == pytest.approx(expected, rel=0.2)
    assert draws.mean(axis=0) == pytest.approx(expand_features(table.handedness, -1.0), abs=0.8)
    assert draws[:, STANCE_FEATURES.index("trunk_roll")].mean() == pytest.approx(
        table.handedness["trunk_roll"], abs=0.2
    )
    left, right = draws[:, -2 * len(ARM_FEATURES) :].reshape(len(draws), 2, -1).transpose(1, 0, 2)
    assert np.corrcoef(left[:, 0], right[:, 0])[0, 1] > 0.5


def test_randomly_drawn_stances_have_arm_asymmetries_and_head_deviations_in_given_ranges():
    draws = draw_many(read_stances().hanging)
    left, right = draws[:, -2 * len(ARM_FEATURES) :].reshape(len(draws), 2, -1).transpose(1, 0, 2)
    differences = np.median(np.abs(left - right), axis=0)
    assert np.all((differences > 1.5) & (differences < 5.5))
    deviations = dict(zip(STANCE_FEATURES, draws.std(axis=0), strict=True))
    assert 3.5 < deviations["head_turn"] < 7.0
    assert 2.0 < deviations["head_roll"] < 5.0
    assert 0.8 < deviations["shoulder_rise"] < 2.0


def test_randomly_drawn_stance_deviations_have_long_bounded_tails():
    components = StanceComponents(2.0, [{"hand_forward": 1.0}], [{"head_turn": 1.0}])
    draws = np.stack([draw_components(components, np.random.default_rng(seed)) for seed in range(1000)])
    for name in ("l_hand_forward", "head_turn"):
        sizes = np.abs(draws[:, STANCE_FEATURES.index(name)])
        assert np.quantile(sizes, 0.95) > 3.0 * np.median(sizes)  # 2.7 times in a normal distribution with this bound
        assert 2.4 < sizes.max() < 2.71


def test_symmetric_and_asymmetric_stance_deviations_are_uncorrelated_in_size():
    components = StanceComponents(2.0, [{"hand_forward": 1.0}], [{"head_turn": 1.0}])
    draws = np.stack([draw_components(components, np.random.default_rng(seed)) for seed in range(1000)])
    sizes = np.abs(draws[:, [STANCE_FEATURES.index(name) for name in ("l_hand_forward", "head_turn")]])
    assert abs(np.corrcoef(sizes.T)[0, 1]) < 0.1


def test_arms_of_the_mean_stance_are_bent_and_near_the_body():
    mean = dict(zip(STANCE_FEATURES, expand_features(read_stances().hanging.mean), strict=True))
    assert 15.0 < mean["l_forearm_forward"] - mean["l_upper_arm_forward"] < 30.0
    assert mean["l_upper_arm_outward"] > mean["l_forearm_outward"] > 0.0
    assert mean["l_hand_forward"] == mean["r_hand_forward"] < mean["l_forearm_forward"]
