"""What a story asks for in its first moments, and near its end, comes at its words."""

from dataclasses import replace

import pytest

from kinesic.body.config import CONFIGS
from kinesic.controller.perform import plan, set_up
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.variation import Variation

TEXT = (CONFIGS / "bml" / "story.bml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def known():
    return replace(set_up(), variation=Variation(1.0, 0))


@pytest.mark.parametrize("style", ["neutral", "joyful"])
def test_no_stroke_of_a_story_comes_at_another_time_than_its_word(known, style):
    told = plan(TEXT, replace(known, style=Style.load(style)))
    late = {f"{s.behaviour}:{s.sync}": s.planned - s.asked for s in told.syncs if s.sync in ("strokeStart", "stroke")}
    assert {name: shift for name, shift in late.items() if abs(shift) > 0.1} == {}
    assert not [id for id, outcome in told.keyframes.outcomes.items() if outcome.kind == "dropped"]
