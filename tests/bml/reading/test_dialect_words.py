"""Tests of elements of other dialects inside a <bml>."""

import pytest

from kinesic.bml.block import Custom, Gesture, Head, Posture, Speech
from kinesic.bml.parse import parse


@pytest.mark.parametrize("lexeme", ["NOD", "Nod_RH", "head_shake", "HeadTilt_Left", "TILT", "bigNod"])
def test_gesture_elements_named_after_head_movements_become_head_behaviours(lexeme: str) -> None:
    block = parse(f'<bml id="b"><gesture id="g" type="LEXICALIZED" lexeme="{lexeme}" stroke_end="2"/></bml>')
    assert block.behaviours[0].action == Head(lexeme)
    assert (list(block.behaviours[0].syncs), block.notices) == (["strokeEnd"], ())
    assert parse(f'<bml id="b"><gesture id="g" type="{lexeme}"/></bml>').behaviours[0].action == Head(lexeme)


@pytest.mark.parametrize("lexeme", ["shake_hands", "shake_fist", "handshake", "beat", "left", "head"])
def test_gesture_names_that_contain_head_words_stay_gestures(lexeme: str) -> None:
    assert parse(f'<bml><gesture id="g" lexeme="{lexeme}"/></bml>').behaviours[0].action == Gesture(lexeme)


def test_smartbody_elements_within_a_bml_element_are_translated() -> None:
    block = parse(
        '<bml id="b"><animation name="A@Idle01_RArm_GestureOffer" start="1"/><body posture="LHandOnHip_Motex"/></bml>'
    )
    offer, hip = block.behaviours
    assert (offer.action, offer.type, list(offer.syncs)) == (Gesture("GestureOffer", "right"), "animation", ["start"])
    assert hip.action == Posture(poses=(("LEFT_ARM", "LHandOnHip_Motex"),), shift=True)
    assert parse("<bml><animation/></bml>").behaviours[0].action == Custom("animation")


def test_bml_element_names_in_capitals_are_read_with_a_notice() -> None:
    block = parse(
        '<BML ID="b"><SPEECH ID="s"><TEXT>one <SYNC ID="m"/>two</TEXT></SPEECH>'
        '<HEAD id="h" LEXEME="NOD" STROKE="s:m" AMOUNT="0.2"/><NOTHING/></BML>'
    )
    speech, head, nothing = block.behaviours
    assert isinstance(speech.action, Speech)
    assert (block.id, speech.action.script.text, speech.action.script.marks[0].name) == ("b", "one two", "m")
    assert (head.action, head.syncs["stroke"].sync, nothing.action) == (Head("NOD", amount=0.2), "m", Custom("NOTHING"))
    assert [n.text for n in block.notices] == [
        "<BML>, <HEAD>, <SPEECH>, <SYNC>, <TEXT> in capitals: read as lower case"
    ]


@pytest.mark.parametrize("uri", ["VIBNameSpace", "gretaNameSpace", "GretaNameSpace"])
def test_greta_namespaces_are_recognised(uri: str) -> None:
    block = parse(f'<bml id="b" xmlns:g="{uri}"><g:head g:id="h" g:lexeme="NOD" g:start="1"/></bml>')
    assert (block.behaviours[0].action, block.behaviours[0].syncs["start"].offset) == (Head("NOD"), 1.0)
    assert block.notices == ()
