"""Tests that listed stage directions have behaviours that exist."""

import pytest

from kinesic.bml.actions import Face
from kinesic.expressivity.face.expressions import find_expression
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.intent.directed import find_act
from kinesic.intent.manuscript.acts import load_acts

HEAD_LEXEMES = {"NOD", "SHAKE", "TILT"}


@pytest.fixture(scope="module")
def lexicon() -> Lexicon:
    return Lexicon.load()


def test_each_listed_stage_direction_names_a_behaviour_that_exists(lexicon: Lexicon):
    for direction, behaviour in load_acts().behaviours.items():
        channel, _, lexeme = behaviour.partition(" ")
        exists = {
            "": lambda name: not name,
            "head": HEAD_LEXEMES.__contains__,
            "gesture": lambda name: (match := lexicon.find(name)) is not None and match.form.id == name,
            "face": lambda name: not find_expression(Face((name,))).unknown,
        }[channel]
        assert exists(lexeme), direction


@pytest.mark.parametrize(
    ("direction", "act"),
    [
        ("waves", ("gesture", "greet_wave")),
        ("waving happily", ("gesture", "greet_wave")),
        ("he nods slowly", ("head", "NOD")),
        ("shakes his head", ("head", "SHAKE")),
        ("claps her hands", ("gesture", "applause")),
        ("laughing", ("face", "laugh")),
        ("Hey_1", ("gesture", "greet_wave")),
        ("wave left", ("gesture", "greet_wave")),
        ("salutes", ("gesture", "salute")),
        ("\U0001f44d", ("gesture", "thumb_up")),
        ("schüttelt den Kopf", ("head", "SHAKE")),
        ("sighs", None),
        ("juggles plates", None),
    ],
)
def test_stage_direction_gives_the_behaviour_that_it_describes_or_none_if_unknown(
    lexicon: Lexicon, direction: str, act: tuple[str, str] | None
):
    assert find_act(direction, lexicon) == act
