"""Tests of requested hand shapes, on hands with and without fingers."""

from functools import cache

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.hands.fingers import finger_joints, lacking_shapes, shape_angles
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BML_TEMPLATE = '<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0">{}</bml>'
FINGER_ROBOT = Robot.load("upper36")


set_up_once = cache(set_up)


def planned(inside: str, robot: str = "upper36"):
    return plan(BML_TEMPLATE.format(inside), set_up_once(robot))


def at_stroke(made, side: str):
    """Return the finger drive angles of a hand at the stroke [rad]."""
    (stroke,) = [sync.planned for sync in made.syncs if sync.sync == "stroke"]
    angles = made.trajectory.sample(np.array([made.trajectory.zero + stroke]))[0][0]
    return angles[list(finger_joints(FINGER_ROBOT, side))]


@pytest.mark.parametrize(
    "inside",
    [
        '<gesture id="g" lexeme="beat" mode="RIGHT_HAND" handShape="SYMBOL_2_OPEN" stroke="2"/>',
        '<gesture id="g" lexeme="beat" mode="RIGHT_HAND" handshape="vee" stroke="2"/>',
        '<gesture id="g" lexeme="beat" mode="RIGHT_HAND" stroke="2"><handShape value="two"/></gesture>',
        '<pointing id="g" target="user" mode="RIGHT_HAND" handShape="victory" stroke="2"/>',
    ],
)
def test_hand_takes_the_hand_shape_requested_in_the_document(inside: str):
    made = planned(inside)
    assert made.keyframes.outcomes["g"].kind == "realised"
    two = shape_angles(hand_shapes()["two"], FINGER_ROBOT, "r")
    np.testing.assert_allclose(at_stroke(made, "r"), two, atol=0.02)
    assert not [notice for notice in made.keyframes.notices if "hape" in notice.text]


def test_unknown_requested_hand_shape_is_reported_and_ignored():
    made = planned('<gesture id="g" lexeme="thumb_up" handShape="fisst" stroke="2"/>')
    outcome = made.keyframes.outcomes["g"]
    assert (outcome.kind, outcome.why) == ("partly", "hand shape 'fisst' is unknown; did you mean fist?")
    np.testing.assert_allclose(at_stroke(made, "r"), shape_angles(hand_shapes()["thumb"], FINGER_ROBOT, "r"), atol=0.02)
    assert made.keyframes.shapes["g"] == ("thumb", "fisst")
    assert lacking_shapes(made.keyframes.shapes["g"], FINGER_ROBOT) == ("fisst",)


@pytest.mark.parametrize(
    ("written", "kind"), [("index", "partly"), ("flat", "realised"), ("FORM_OPEN", "realised"), ("tentacle", "partly")]
)
@pytest.mark.parametrize("element", ['gesture id="g" lexeme="beat"', 'pointing id="g" target="user"'])
def test_hand_without_fingers_reports_an_impossible_hand_shape(element: str, written: str, kind: str):
    made = planned(f'<{element} handShape="{written}" stroke="2"/>', "upper22")
    outcome = made.keyframes.outcomes["g"]
    assert outcome.kind == kind
    assert (f'hand shape "{written}" needs fingers' in outcome.why) == (written == "index")
    assert (f"hand shape '{written}' is unknown" in outcome.why) == (written == "tentacle")


@pytest.mark.parametrize("lexeme", ["piano", "air_quotes"])
def test_hand_with_fingers_realises_a_finger_motion(lexeme: str):
    assert planned(f'<gesture id="g" lexeme="{lexeme}" stroke="2"/>').keyframes.outcomes["g"].kind == "realised"


def test_pointing_hand_with_fingers_reports_its_index_finger():
    assert planned('<pointing id="g" target="user" stroke="2"/>').keyframes.shapes["g"] == ("index",)


def test_second_requested_hand_shape_is_ignored_with_a_warning():
    made = planned('<gesture id="g" lexeme="beat" handShape="fist" handshape="index" stroke="2"/>')
    assert made.keyframes.shapes["g"] == ("fist",)
    assert any("handshape 'index'" in notice.text for notice in made.keyframes.notices)
