"""Hand shapes that a document asks for, as attribute or element, on hands with fingers and without."""

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.controller.perform import plan, set_up
from kinesic.expressivity.hands.fingers import finger_joints, lacking_shapes, shape_angles
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes

BML = '<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0">{}</bml>'
ROBOT = Robot.load("upper36")


def planned(inside: str, robot: str = "upper36"):
    return plan(BML.format(inside), set_up(robot))


def at_stroke(made, side: str):
    """Angles of a hand's finger drives at the stroke [rad]."""
    (stroke,) = [sync.planned for sync in made.syncs if sync.sync == "stroke"]
    angles = made.trajectory.sample(np.array([made.trajectory.zero + stroke]))[0][0]
    return angles[list(finger_joints(ROBOT, side))]


@pytest.mark.parametrize(
    "inside",
    [
        '<gesture id="g" lexeme="beat" mode="RIGHT_HAND" handShape="SYMBOL_2_OPEN" stroke="2"/>',
        '<gesture id="g" lexeme="beat" mode="RIGHT_HAND" handshape="vee" stroke="2"/>',
        '<gesture id="g" lexeme="beat" mode="RIGHT_HAND" stroke="2"><handShape value="two"/></gesture>',
        '<pointing id="g" target="user" mode="RIGHT_HAND" handShape="victory" stroke="2"/>',
    ],
)
def test_a_hand_has_the_shape_that_is_asked_for(inside: str):
    made = planned(inside)
    assert made.keyframes.outcomes["g"].kind == "realised"
    two = shape_angles(hand_shapes()["two"], ROBOT, "r")
    np.testing.assert_allclose(at_stroke(made, "r"), two, atol=0.02)
    assert not [notice for notice in made.keyframes.notices if "hape" in notice.text]


def test_a_shape_that_nobody_knows_is_said_and_the_gesture_done_as_it_is():
    made = planned('<gesture id="g" lexeme="thumb_up" handShape="fisst" stroke="2"/>')
    outcome = made.keyframes.outcomes["g"]
    assert (outcome.kind, outcome.why) == ("partly", "hand shape 'fisst' is unknown; did you mean fist?")
    np.testing.assert_allclose(at_stroke(made, "r"), shape_angles(hand_shapes()["thumb"], ROBOT, "r"), atol=0.02)
    assert made.keyframes.shapes["g"] == ("thumb", "fisst")
    assert lacking_shapes(made.keyframes.shapes["g"], ROBOT) == ("fisst",)


@pytest.mark.parametrize(
    ("written", "kind"), [("index", "partly"), ("flat", "realised"), ("FORM_OPEN", "realised"), ("tentacle", "partly")]
)
@pytest.mark.parametrize("element", ['gesture id="g" lexeme="beat"', 'pointing id="g" target="user"'])
def test_a_hand_without_fingers_says_which_shape_it_cannot_make(element: str, written: str, kind: str):
    made = planned(f'<{element} handShape="{written}" stroke="2"/>', "upper22")
    outcome = made.keyframes.outcomes["g"]
    assert outcome.kind == kind
    assert (f'hand shape "{written}" needs fingers' in outcome.why) == (written == "index")
    assert (f"hand shape '{written}' is unknown" in outcome.why) == (written == "tentacle")


def test_of_two_shapes_the_first_counts_and_the_other_is_warned_of():
    made = planned('<gesture id="g" lexeme="beat" handShape="fist" handshape="index" stroke="2"/>')
    assert made.keyframes.shapes["g"] == ("fist",)
    assert any("handshape 'index'" in notice.text for notice in made.keyframes.notices)
