from pathlib import Path

import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.hands.fingers import lacking_shapes
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import plan_gesture

LEXICON_TOML = """category = "emblem"

[[gesture]]
id = "hook"
fallback = "nudge"
keys = [{ right = { at = [0.3, 0.3, 0.5], shape = "claw" } }]

[[gesture]]
id = "nudge"
keys = [{ right = { at = [0.3, 0.2, 0.5] } }]
"""
BML_BLOCK = '<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0"><gesture id="g" lexeme="hook"/></bml>'


@pytest.mark.parametrize(
    ("robot", "kind", "why"),
    [("upper22", "substituted", "hook needs fingers; nudge is performed instead"), ("upper36", "realised", "")],
)
def test_hand_without_fingers_performs_the_fallback_gesture_of_the_lexicon(
    tmp_path: Path, robot: str, kind: str, why: str
):
    file = tmp_path / "mine.toml"
    file.write_text(LEXICON_TOML, encoding="utf-8")
    outcome = plan(BML_BLOCK, set_up(robot, lexicon=file)).keyframes.outcomes["g"]
    assert (outcome.kind, outcome.why) == (kind, why)


def test_fallback_gestures_of_the_lexicon_need_no_fingers():
    lexicon, robot = Lexicon.load(), Robot.load("upper22")
    others = {form.id: lexicon.forms_by_id[form.fallback] for form in lexicon.forms if form.fallback}
    assert len(others) >= 7
    assert not {
        id: lacking_shapes(other.shapes, robot) for id, other in others.items() if lacking_shapes(other.shapes, robot)
    }
    assert all(lacking_shapes(lexicon.forms_by_id[id].shapes, robot) for id in others)
    assert not any(other.fallback for other in others.values())


def test_gesture_planned_from_its_lexicon_entry_is_not_replaced_by_its_fallback():
    known = set_up("upper22")
    planned = plan_gesture(known.lexicon.forms_by_id["thumb_up"], known)
    assert planned.keyframes.outcomes["gesture"].kind == "partly"


@pytest.mark.parametrize(("lexeme", "sides"), [("hook_left", {"l"}), ("hook_both", {"l", "r"}), ("hook", {"r"})])
def test_fallback_gesture_uses_the_hands_named_in_the_lexeme(tmp_path: Path, lexeme: str, sides: set[str]):
    file = tmp_path / "mine.toml"
    file.write_text(LEXICON_TOML, encoding="utf-8")
    planned = plan(BML_BLOCK.replace("hook", lexeme), set_up("upper22", lexicon=file))
    assert planned.keyframes.outcomes["g"].why == "hook needs fingers; nudge is performed instead"
    given = set().union(*(frame.given for frame in planned.keyframes.frames))
    assert given & {"l_hand", "r_hand"} == {f"{side}_hand" for side in sides}
