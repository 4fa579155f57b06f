"""Tests of hands inferred from gesture names."""

import pytest

from kinesic.bml.block import Gesture, HandMode, Posture
from kinesic.bml.parse import parse
from kinesic.bml.reading.hands import infer_hands


@pytest.mark.parametrize(
    ("name", "hands"),
    [
        ("dismiss_LH", "left"),
        ("bridge_RH_2", "right"),
        ("frame_2H", "both"),
        ("frame_2h_3", "both"),
        ("CUP_LH", "left"),
        ("LHandOnHip_Motex", "left"),
        ("RHandOnHip", "right"),
        ("LHandOnHip_RArm_GestureOffer", "right"),
        ("LHandOnHip_Arms_GestureWhy", "both"),
        ("WeRt01", "unspecified"),
        ("left_arm_up", "left"),
        ("both_hands_open", "both"),
        ("HandsAtSide_Motex", "unspecified"),
        ("past_Ges_L", "unspecified"),
        ("turn_left", "unspecified"),
        ("thumbs_up", "unspecified"),
        ("", "unspecified"),
    ],
)
def test_hand_is_inferred_from_the_last_hand_named_in_a_gesture_name(name: str, hands: HandMode) -> None:
    assert infer_hands(name) == hands


@pytest.mark.parametrize(
    ("name", "hands"),
    [
        ("Someone@Idle01_BeatMidRt01", "right"),
        ("Someone@Idle01_NoLeftRt01", "right"),
        ("Someone@Idle01_MeLf01", "left"),
        ("Someone@Idle01_Guitar01", "unspecified"),
        ("HandsAtSide_RArm_GestureYou", "right"),
    ],
)
def test_hand_is_inferred_from_abbreviations_in_animation_names(name: str, hands: HandMode) -> None:
    assert infer_hands(name, of_animation=True) == hands
    (gesture,) = parse(f'<gesture name="{name}"/>').behaviours
    assert isinstance(gesture.action, Gesture)
    assert gesture.action.mode == hands


def test_mode_attribute_overrides_the_hand_in_a_gesture_name() -> None:
    block = parse(
        '<bml><gesture lexeme="cup_LH"/><gesture lexeme="cup_LH" mode="RIGHT_HAND"/><gesture lexeme="cup"/></bml>'
    )
    assert [b.action.mode for b in block.behaviours if isinstance(b.action, Gesture)] == [
        "left",
        "right",
        "unspecified",
    ]


@pytest.mark.parametrize(
    ("posture", "pose"),
    [
        ('<pose part="ARMS" lexeme="LHandOnHip"/>', ("LEFT_ARM", "LHandOnHip")),
        ('<pose part="WHOLEBODY" shape="RHand_OnHip"/>', ("RIGHT_ARM", "RHand_OnHip")),
        ('<pose part="RIGHT_ARM" lexeme="LHandOnHip"/>', ("RIGHT_ARM", "LHandOnHip")),
        ('<pose part="ARMS" lexeme="ARMS_CROSSED"/>', ("ARMS", "ARMS_CROSSED")),
        ('<pose part="HEAD" lexeme="LHandUp"/>', ("HEAD", "LHandUp")),
    ],
)
def test_pose_of_both_arms_is_restricted_to_the_arm_in_its_lexeme(posture: str, pose: tuple[str, str]) -> None:
    (block,) = parse(f"<bml><posture>{posture}</posture></bml>").behaviours
    assert block.action == Posture(poses=(pose,))
