from dataclasses import replace
from math import degrees

import numpy as np
import pytest
from msgspec import structs

from kinesic.bml.block import Gesture, Pointing
from kinesic.expressivity.hands.poses import poses, resting_hands
from kinesic.expressivity.lexicon.body_form import BodyForm
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY, Style
from kinesic.expressivity.trunk_following import MAX_FOLLOWING_ANGLE, follow_hands
from kinesic.expressivity.turns import UPRIGHT_TURN, turn_angles


@pytest.fixture
def times(phases):
    return phases(0, 1, 1, 1.6, 1.6, 2.2, 3.4)


def torsos(perform, action, times, weight=1.0):
    frames = perform(("g", action, times), style=Style().changed([f"whole_body={weight}"]))
    return {sync: frame.torso for frame in frames.frames for _, sync in frame.syncs}


def test_trunk_turns_the_shoulder_of_the_gesturing_hand_forward(perform, times):
    left, right = (torsos(perform, Gesture("beat", mode), times)["stroke"] for mode in ("left", "right"))
    assert degrees(right.torsion) > 1.0
    assert turn_angles(left) == pytest.approx((-right.torsion, right.tilt, -right.roll))
    assert right.tilt > 0.0


def test_trunk_follows_a_sweep_from_the_start_of_the_stroke_to_its_end(perform, times):
    at = torsos(perform, Gesture("refuse_sweep", "right"), times)
    assert at["start"] == at["end"] == UPRIGHT_TURN
    assert at["strokeStart"].torsion > at["stroke"].torsion
    assert at["stroke"] == at["relax"]


def test_style_weight_scales_the_trunk_rotation_that_follows_the_hands(perform, times):
    none, half, whole = (torsos(perform, Gesture("offer", "right"), times, weight) for weight in (0.0, 0.5, 1.0))
    assert not any(any(turn_angles(turn)) for turn in none.values())
    assert half["stroke"].torsion == pytest.approx(whole["stroke"].torsion / 2)


def test_pointing_to_the_left_turns_the_trunk_by_5_to_10_degrees(perform, times):
    frames = perform(("g", Pointing("left"), times))
    assert 5 <= degrees(frames.bodies["g"].trunk.torsion) <= 10


def test_trunk_rotation_with_the_hands_is_bounded_and_zero_while_arms_touch(lexicon, robot):
    form = replace(lexicon.forms_by_id["beat"], body=BodyForm(along=1.0))
    posed, rest = poses(form, robot, NEUTRAL_EXPRESSIVITY), resting_hands(robot)
    (side,) = posed.hands
    far = structs.replace(rest[side], position=rest[side].position + np.array([9.0, 9.0, 0.0]))
    reaching = [replace(hand, reach=far) for hand in posed.hands[side]]
    turn = follow_hands(replace(posed, hands={side: tuple(reaching)}), posed.stroke, rest, robot)
    assert max(map(abs, turn_angles(turn))) == pytest.approx(MAX_FOLLOWING_ANGLE)
    touching = tuple(replace(hand, touch="forearm") for hand in reaching)
    assert follow_hands(replace(posed, hands={side: touching}), posed.stroke, rest, robot) == UPRIGHT_TURN
