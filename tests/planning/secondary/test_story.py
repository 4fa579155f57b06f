"""Tests of stroke times at the beginning and end of a story."""

from dataclasses import replace

import pytest

from kinesic.body.config import CONFIGS
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.variation import Variation
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

# document with speech and gestures of half a minute
STORY_TEXT = (CONFIGS / "bml" / "story.bml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def known():
    return replace(set_up(), variation=Variation(1.0, 0))


@pytest.mark.parametrize("style", [pytest.param("neutral", marks=pytest.mark.soak), "joyful"])
def test_story_strokes_stay_within_0_1_s_of_their_words(known, style):
    result = plan(STORY_TEXT, replace(known, style=Style.load(style)))
    late = {
        f"{s.behaviour}:{s.sync}": s.planned - s.requested for s in result.syncs if s.sync in ("strokeStart", "stroke")
    }
    assert {name: shift for name, shift in late.items() if abs(shift) > 0.1} == {}
    assert not [id for id, outcome in result.keyframes.outcomes.items() if outcome.kind == "dropped"]
