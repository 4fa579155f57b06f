from pathlib import Path

import pytest

from kinesic.controller.perform import plan, set_up

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
