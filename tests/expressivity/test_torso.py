from math import degrees

import pytest

from kinesic.bml.block import Torso
from kinesic.expressivity.torso import lean


@pytest.mark.parametrize(
    ("lexeme", "torsion", "tilt", "roll"),
    [
        ("BodyLean", 0, 12, 0),
        ("BodyRecline", 0, -12, 0),
        ("LeanLeftAndBack", 0, -12, -12),
        ("LeftSide", 0, 0, -12),
        ("BodyTurnRight", -12, 0, 0),
        ("subtleBodyLean", 0, 6, 0),
        ("Neutral", 0, 0, 0),
    ],
)
def test_words_of_a_lexeme_name_leans(robot, lexeme, torsion, tilt, roll):
    turn = lean(Torso(lexeme), robot, 0.0).turn
    assert [degrees(angle) for angle in (turn.torsion, turn.tilt, turn.roll)] == pytest.approx([torsion, tilt, roll])


def test_a_lean_goes_and_returns(perform, phases):
    frames = perform(("t", Torso("BodyLean"), phases(0, 1, 1, 1, 1, 2, 3)))
    tilts = {frame.time: degrees(frame.torso.tilt) for frame in frames.frames}
    assert tilts == pytest.approx({0: 0, 1: 12, 2: 12, 3: 0})
    assert frames.uses["t"] == {"torso"}
    assert all(frame.given == {"torso"} for frame in frames.frames)


def test_a_lean_beyond_the_range_is_clipped_and_warned(perform, phases, robot):
    frames = perform(("t", Torso("BodyRecline", amount=1.0), phases(0, 1, 1, 1, 1, 2, 3)))
    assert degrees(frames.frames[1].torso.tilt) == pytest.approx(-15)
    assert any("9.0 deg" in notice.text for notice in frames.notices)


def test_an_unknown_movement_is_dropped(perform, phases):
    frames = perform(("t", Torso("jingtry"), phases(0, 1, 1, 1, 1, 2, 3)))
    assert frames.outcomes["t"].kind == "dropped"
    assert "jingtry" in frames.outcomes["t"].why
    assert frames.frames == ()
