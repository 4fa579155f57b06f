"""Elements of other dialects inside a <bml>."""

import pytest

from kinesic.bml.block import Custom, Gesture, Head, Posture, Speech
from kinesic.bml.parse import parse


@pytest.mark.parametrize("lexeme", ["NOD", "Nod_RH", "head_shake", "HeadTilt_Left", "TILT", "bigNod"])
def test_head_movements_written_as_gestures_are_heads(lexeme: str) -> None:
    found = parse(f'<bml id="b"><gesture id="g" type="LEXICALIZED" lexeme="{lexeme}" stroke_end="2"/></bml>')
    assert found.behaviours[0].action == Head(lexeme)
    assert (list(found.behaviours[0].syncs), found.notices) == (["strokeEnd"], ())
    assert parse(f'<bml id="b"><gesture id="g" type="{lexeme}"/></bml>').behaviours[0].action == Head(lexeme)


@pytest.mark.parametrize("lexeme", ["shake_hands", "shake_fist", "handshake", "beat", "left", "head"])
def test_other_gestures_stay_gestures(lexeme: str) -> None:
    assert parse(f'<bml><gesture id="g" lexeme="{lexeme}"/></bml>').behaviours[0].action == Gesture(lexeme)


def test_animations_and_body_postures_are_read_in_a_bml_as_in_fragments() -> None:
    found = parse(
        '<bml id="b"><animation name="A@Idle01_RArm_GestureOffer" start="1"/><body posture="LHandOnHip_Motex"/></bml>'
    )
    offer, hip = found.behaviours
    assert (offer.action, offer.type, list(offer.syncs)) == (Gesture("GestureOffer", "right"), "animation", ["start"])
    assert hip.action == Posture(poses=(("LEFT_ARM", "LHandOnHip_Motex"),), shift=True)
    assert parse("<bml><animation/></bml>").behaviours[0].action == Custom("animation")


def test_names_in_capitals_are_read_and_said() -> None:
    found = parse(
        '<BML ID="b"><SPEECH ID="s"><TEXT>one <SYNC ID="m"/>two</TEXT></SPEECH>'
        '<HEAD id="h" LEXEME="NOD" STROKE="s:m" AMOUNT="0.2"/><NOTHING/></BML>'
    )
    speech, head, nothing = found.behaviours
    assert isinstance(speech.action, Speech)
    assert (found.id, speech.action.script.text, speech.action.script.marks[0].name) == ("b", "one two", "m")
    assert (head.action, head.syncs["stroke"].sync, nothing.action) == (Head("NOD", amount=0.2), "m", Custom("NOTHING"))
    assert [n.text for n in found.notices] == [
        "<BML>, <HEAD>, <SPEECH>, <SYNC>, <TEXT> in capitals: read as if written small"
    ]


@pytest.mark.parametrize("uri", ["VIBNameSpace", "gretaNameSpace", "GretaNameSpace"])
def test_greta_has_several_namespaces(uri: str) -> None:
    found = parse(f'<bml id="b" xmlns:g="{uri}"><g:head g:id="h" g:lexeme="NOD" g:start="1"/></bml>')
    assert (found.behaviours[0].action, found.behaviours[0].syncs["start"].offset) == (Head("NOD"), 1.0)
    assert found.notices == ()
