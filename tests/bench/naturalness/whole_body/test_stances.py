import numpy as np
import pytest

from kinesic.bench.naturalness.whole_body.stances import find_resting_frames, fit_stances, group_hanging, measure_stance
from kinesic.planning.arm_directions import ARM_FEATURES
from kinesic.planning.stance import STANCE_FEATURES, draw_deviation, expand_features

from .bodies import make_body


def name_features(stance):
    return dict(zip(STANCE_FEATURES, stance, strict=True))


def test_stance_contains_link_directions_and_trunk_angles():
    stance = name_features(measure_stance(make_body(bend=(30.0, 10.0))))
    assert (stance["l_upper_arm_forward"], stance["l_forearm_forward"]) == pytest.approx((0.0, 30.0))
    assert stance["r_forearm_forward"] == pytest.approx(10.0)
    assert stance["trunk_tilt"] == stance["head_turn"] == stance["shoulder_rise"] == pytest.approx(0.0)


def test_trunk_turn_is_the_rotation_of_the_shoulders_relative_to_the_hips():
    turned = make_body(pelvis=-20.0)
    assert name_features(measure_stance(turned))["trunk_turn"] == pytest.approx(0.0)
    assert name_features(measure_stance(turned, len(turned.times) // 2))["trunk_turn"] == pytest.approx(20.0, abs=0.5)


def make_turning_clips(pose, count=5, **options):
    return [make_body(head=20.0, set_name="s", name=f"A@{pose}_{k}", **options) for k in range(count)]


def test_bent_arms_do_not_count_as_hanging_arms():
    clips = [*make_turning_clips("Idle01"), *make_turning_clips("Idle02", bend=(90.0, 90.0))]
    assert list(group_hanging(clips)) == ["s Idle01"]


def test_frames_close_to_the_first_pose_of_their_clip_are_excluded_from_stances():
    turns = group_hanging(make_turning_clips("Idle01"))["s Idle01"][:, STANCE_FEATURES.index("head_turn")]
    assert 3.0 < turns.min() < 4.0
    assert turns.max() == pytest.approx(20.0, abs=0.5)
    assert not group_hanging([make_body(name=f"A@Idle01_{k}") for k in range(5)])


def test_standing_posture_statistics_exclude_a_person_with_too_few_clips():
    assert not group_hanging(make_turning_clips("Idle01", count=4))


def test_frames_with_fast_hands_do_not_count_as_resting():
    resting = find_resting_frames(make_body(swing=(0.25, 0.0)))
    assert 0 in resting
    assert 18 not in resting  # a quarter of the clip, where the swing is fastest


def test_fit_of_standing_postures_recovers_mean_and_correlation_of_a_population():
    chance = np.random.default_rng(4)
    groups = {}
    for person in range(60):
        symmetric, turn = chance.normal(size=2)
        features = {"trunk_tilt": 3.0 + 4.0 * symmetric, "upper_arm_outward": 10.0 + 2.0 * symmetric}
        centre = expand_features(features)
        centre[STANCE_FEATURES.index("head_turn")] = 5.0 * turn
        groups[str(person)] = centre + chance.normal(size=(5, len(centre)))
    table = fit_stances(groups)
    assert table.mean["trunk_tilt"] == pytest.approx(3.0, abs=1.5)
    draws = np.stack([draw_deviation(table, np.random.default_rng(seed)) for seed in range(300)])
    columns = [STANCE_FEATURES.index(name) for name in ("trunk_tilt", "l_upper_arm_outward", "head_turn")]
    assert draws[:, columns].std(axis=0) == pytest.approx([4.1, 2.3, 5.1], rel=0.25)
    assert np.corrcoef(draws[:, columns].T)[0, 1] > 0.7
    hand = [row["hand_forward"] for row in (*table.rests.symmetric, *table.rests.asymmetric)]
    # 0.9 about the mean of five rests, less the small components that are left out.
    assert np.linalg.norm(hand) == pytest.approx(0.8, rel=0.2)
    assert set(table.mean) == {"trunk_tilt", "head_tilt", *ARM_FEATURES}


def test_rare_poses_hardly_increase_the_spread_of_rest_postures():
    chance = np.random.default_rng(5)
    rows = chance.normal(size=(400, len(STANCE_FEATURES)))
    rows[:20] *= 10.0
    persons = {str(person): rows + 5.0 * chance.normal(size=rows.shape[1]) for person in range(8)}
    hand = [row["hand_forward"] for row in fit_stances(persons).rests.symmetric]
    assert np.linalg.norm(hand) < 1.2 * np.sqrt(0.5)  # of the mean of two independent hands, without rare poses
