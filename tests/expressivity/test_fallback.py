from pathlib import Path

import pytest

from kinesic.body.robot import Robot
from kinesic.controller.perform import plan, set_up
from kinesic.expressivity.hands.fingers import lacking_shapes
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.studies.gestures.isolated import plan_gesture

LEXICON = """category = "emblem"

[[gesture]]
id = "hook"
fallback = "nudge"
keys = [{ right = { at = [0.3, 0.3, 0.5], shape = "claw" } }]

[[gesture]]
id = "nudge"
keys = [{ right = { at = [0.3, 0.2, 0.5] } }]
"""
BLOCK = '<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0"><gesture id="g" lexeme="hook"/></bml>'


@pytest.mark.parametrize(
    ("robot", "kind", "why"),
    [("upper22", "substituted", "hook needs fingers; nudge is done"), ("upper36", "realised", "")],
)
def test_a_hand_without_fingers_does_what_the_gesture_names_for_it(tmp_path: Path, robot: str, kind: str, why: str):
    file = tmp_path / "mine.toml"
    file.write_text(LEXICON, encoding="utf-8")
    outcome = plan(BLOCK, set_up(robot, lexicon=file)).keyframes.outcomes["g"]
    assert (outcome.kind, outcome.why) == (kind, why)


def test_every_fallback_of_the_lexicon_is_a_gesture_that_needs_no_fingers():
    lexicon, robot = Lexicon.load(), Robot.load("upper22")
    others = {form.id: lexicon.forms_by_id[form.fallback] for form in lexicon.forms if form.fallback}
    assert len(others) >= 7
    assert not {
        id: lacking_shapes(other.shapes, robot) for id, other in others.items() if lacking_shapes(other.shapes, robot)
    }
    assert all(lacking_shapes(lexicon.forms_by_id[id].shapes, robot) for id in others)
    assert not any(other.fallback for other in others.values())


def test_a_gesture_that_is_shown_alone_is_itself_on_every_robot():
    known = set_up("upper22")
    planned = plan_gesture(known.lexicon.forms_by_id["thumb_up"], known)
    assert planned.keyframes.outcomes["gesture"].kind == "partly"
