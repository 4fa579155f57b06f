"""Standing postures drawn like those of captured people."""

import numpy as np

from kinesic.planning.arm_directions import ARM_FEATURES
from kinesic.planning.stance import STANCE_FEATURES, draw_deviation, expand_features, read_stances


def test_rows_of_the_distribution_have_known_features_only():
    table = read_stances().hanging
    rows = [table.mean, table.within, *table.symmetric, *table.asymmetric]
    features = {name.removeprefix("l_").removeprefix("r_") for name in STANCE_FEATURES}
    assert {name for row in rows for name in row} <= features


def test_drawn_stances_have_the_distribution_of_their_table():
    table = read_stances().hanging
    draws = np.stack([draw_deviation(table, np.random.default_rng(seed)) for seed in range(400)])
    tilt = [row["trunk_tilt"] for row in table.symmetric] + [table.within["trunk_tilt"]]
    expected = float(np.linalg.norm(tilt))
    column = STANCE_FEATURES.index("trunk_tilt")
    assert 0.8 * expected < draws[:, column].std() < 1.05 * expected
    assert np.abs(draws.mean(axis=0)).max() < 1.0
    left, right = draws[:, -2 * len(ARM_FEATURES) :].reshape(len(draws), 2, -1).transpose(1, 0, 2)
    assert np.all((left - right).std(axis=0) > 0.5)
    assert np.corrcoef(left[:, 0], right[:, 0])[0, 1] > 0.5


def test_arms_of_the_mean_stance_are_bent_and_near_the_body():
    mean = dict(zip(STANCE_FEATURES, expand_features(read_stances().hanging.mean), strict=True))
    assert 15.0 < mean["l_forearm_forward"] - mean["l_upper_arm_forward"] < 30.0
    assert mean["l_upper_arm_outward"] > mean["l_forearm_outward"] > 0.0
    assert mean["l_hand_forward"] == mean["r_hand_forward"] < mean["l_forearm_forward"]
