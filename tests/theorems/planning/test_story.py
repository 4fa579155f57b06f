"""A monologue of half a minute keeps its gestures and their words, in every manner in which there is time."""

import pytest

from kinesic.body.config import CONFIGS
from kinesic.controller.options import LIVELY
from kinesic.controller.perform import plan, set_up

STORY, NIGHT = ((CONFIGS / "bml" / f"{name}.bml").read_text(encoding="utf-8") for name in ("story", "night"))
LATE = {"joyful": 0.4}  # [s] by which a stroke may miss its word where gestures are large and near; else 0.2

OTHERS = [pytest.param(style, marks=pytest.mark.soak) for style in ("angry", "proud")]


@pytest.mark.parametrize("style", ["neutral", "calm", "joyful", *OTHERS])
def test_nothing_is_left_out_and_strokes_stay_on_their_words(style: str):
    planned = plan(STORY, set_up(style=style, **LIVELY))
    assert [name for name, outcome in planned.keyframes.outcomes.items() if outcome.kind == "dropped"] == []
    assert max(abs(sync.planned - sync.asked) for sync in planned.syncs if sync.is_stroke) <= LATE.get(style, 0.2)


def test_a_story_that_was_not_looked_at_first_keeps_its_gestures_too():
    planned = plan(NIGHT, set_up(**LIVELY))
    assert [name for name, outcome in planned.keyframes.outcomes.items() if outcome.kind == "dropped"] == []
    assert max(abs(sync.planned - sync.asked) for sync in planned.syncs if sync.is_stroke) <= 0.2
