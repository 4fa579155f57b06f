"""Standing postures with one hand or both hands before the body."""

import numpy as np
import pytest

from kinesic.bench.naturalness.whole_body.arm_poses import find_pose, fit_poses, group_poses, weigh_poses
from kinesic.planning.stance import STANCE_FEATURES

from .bodies import make_body

HANGING_ARM = {"upper_arm_outward": 10.0, "forearm_forward": 20.0}
ARM_BEFORE_BODY = {"upper_arm_outward": 10.0, "forearm_forward": 70.0, "hand_forward": 80.0}
ARM_ON_HIP = {"upper_arm_outward": 45.0, "forearm_forward": 10.0, "forearm_outward": -25.0}


def make_stance(left, right, **body):
    arms = {f"{side}_{name}": value for side, arm in (("l", left), ("r", right)) for name, value in arm.items()}
    return np.array([{**body, **arms}.get(name, 0.0) for name in STANCE_FEATURES])


@pytest.mark.parametrize(
    ("left", "right", "pose"),
    [
        (HANGING_ARM, HANGING_ARM, None),
        (ARM_BEFORE_BODY, HANGING_ARM, "one_hand_before"),
        (HANGING_ARM, ARM_BEFORE_BODY, "one_hand_before"),
        (ARM_BEFORE_BODY, ARM_BEFORE_BODY, "both_hands_before"),
        (ARM_ON_HIP, ARM_ON_HIP, None),
        (ARM_BEFORE_BODY, {**ARM_BEFORE_BODY, "forearm_outward": -50.0}, None),  # folded
        (ARM_BEFORE_BODY, {**ARM_BEFORE_BODY, "forearm_forward": 130.0}, None),  # raised
    ],
)
def test_arm_pose_is_named_by_the_positions_of_both_hands(left, right, pose):
    assert find_pose(make_stance(left, right)) == pose


def test_pose_with_the_left_hand_in_front_of_the_body_is_mirrored_to_the_right():
    clips = [make_body(bend=(70.0, 20.0), head=20.0, set_name="s", name=f"A@Idle01_{k}") for k in range(5)]
    poses = group_poses(clips)
    assert [*poses["one_hand_before"]] == ["s Idle01"]
    assert not poses["both_hands_before"]
    stance = dict(zip(STANCE_FEATURES, poses["one_hand_before"]["s Idle01"].mean(axis=0), strict=True))
    assert (stance["l_forearm_forward"], stance["r_forearm_forward"]) == pytest.approx((20.0, 70.0))
    assert stance["head_turn"] < 0.0  # the clip turns it to the left


def test_arm_pose_weight_is_the_mean_fraction_of_resting_frames_over_capture_sets():
    both = make_body(bend=(70.0, 70.0), set_name="a")
    one, hanging, folded = (make_body(bend=bend, set_name="b") for bend in ((20.0, 70.0), (20.0, 20.0), (150.0, 20.0)))
    weights = weigh_poses([both, one, hanging, hanging, folded])
    assert weights == pytest.approx({"hanging": 1 / 3, "one_hand_before": 1 / 6, "both_hands_before": 0.5})


def test_mean_arm_pose_omits_small_angles():
    one = make_stance(HANGING_ARM, ARM_BEFORE_BODY, head_tilt=6.0, head_roll=0.2)
    poses = {name: {"a Idle01": np.stack([one, one])} for name in ("one_hand_before", "both_hands_before")}
    tables = fit_poses(poses, {"one_hand_before": 0.254, "both_hands_before": 0.1})
    assert [table.weight for table in tables] == [0.25, 0.1]
    assert tables[0].mean["head_tilt"] == 6.0
    assert {"head_roll", "l_hand_forward"}.isdisjoint(tables[0].mean)


def test_arm_pose_components_have_the_standard_deviation_of_the_frames():
    chance = np.random.default_rng(3)
    shifts = chance.normal(size=400)
    rows = np.stack(
        [make_stance(HANGING_ARM, ARM_BEFORE_BODY, head_tilt=4.0 * shift, trunk_tilt=2.0 * shift) for shift in shifts]
    )
    poses = {name: {"a Idle01": rows} for name in ("one_hand_before", "both_hands_before")}
    table = fit_poses(poses, dict.fromkeys(poses, 0.2))[0]
    assert abs(table.components[0]["head_tilt"]) == pytest.approx(4.0, rel=0.1)
    assert table.components[0]["trunk_tilt"] / table.components[0]["head_tilt"] == pytest.approx(0.5, abs=0.03)
