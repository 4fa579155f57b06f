"""Descriptions: which form of a behaviour is performed."""

import pytest

from kinesic.bml.block import Action, Gaze, Gesture, Head, Pointing, Speech, SyncRef
from kinesic.bml.parse import parse

OURS = '<description priority="{}" type="application/bml"><pointing target="user"/></description>'
NOT_OURS = '<description priority="{}" type="RobotLights"><lights colour="red"/></description>'
NOD = '<description priority="{}" type="x"><head lexeme="NOD"/></description>'
GRETA = '<description priority="{}" type="gretabml"><PWR.value>0.5</PWR.value></description>'


@pytest.mark.parametrize(
    ("inside", "action"),
    [
        ("", Gesture("beat")),
        (OURS.format(1), Pointing("user")),
        (NOT_OURS.format(9), Gesture("beat")),
        (OURS.format(1) + NOT_OURS.format(9), Pointing("user")),
        (OURS.format(1) + NOD.format(2), Head("NOD")),
        (NOD.format(3) + OURS.format(1), Head("NOD")),
        (OURS.format("high"), Pointing("user")),
        (GRETA.format(2) + OURS.format(1), Gesture("beat")),
        (GRETA.format(1) + OURS.format(2), Pointing("user")),
    ],
)
def test_the_highest_priority_that_is_understood_counts(inside: str, action: Action) -> None:
    (behaviour,) = parse(f'<bml id="b"><gesture id="g" lexeme="beat">{inside}</gesture></bml>').behaviours
    assert (behaviour.id, behaviour.action) == ("g", action)


def test_a_richer_form_keeps_the_times_unless_it_has_its_own() -> None:
    richer = '<description priority="1" type="x"><gaze id="z" target="user" end="4"/></description>'
    text = f'<bml id="b"><head id="h" lexeme="NOD" start="1" end="2">{richer}</head></bml>'
    (behaviour,) = parse(text).behaviours
    assert (behaviour.id, behaviour.action) == ("h", Gaze("user"))
    assert behaviour.syncs == {
        "start": SyncRef("b", "bml", "start", offset=1.0),
        "end": SyncRef("b", "bml", "start", offset=4.0),
    }


def test_a_speech_keeps_its_text_beside_its_markup() -> None:
    ssml = '<description priority="1" type="application/ssml+xml"><speak>hi <mark name="m"/>you</speak></description>'
    (behaviour,) = parse(f'<bml id="b"><speech id="s"><text>hello</text>{ssml}</speech></bml>').behaviours
    assert isinstance(behaviour.action, Speech)
    assert behaviour.action.script.text == "hi you"
