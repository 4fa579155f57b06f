"""A monologue of 30 s keeps its gestures on their words.

Every run plans it without idle motion and with a silent voice, in tests/planning/secondary.
"""

import pytest

from kinesic.body.config import CONFIGS
from kinesic.session.options import INTERACTIVE_DEFAULTS
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

STORY_BML, NIGHT_BML = ((CONFIGS / "bml" / f"{name}.bml").read_text(encoding="utf-8") for name in ("story", "night"))
MAX_STROKE_SHIFTS = {"joyful": 0.4}  # [s] largest distance of a stroke from its word by style; 0.2 in other styles


@pytest.mark.soak
@pytest.mark.parametrize("style", ["neutral", "joyful", "calm", "angry", "proud"])
def test_story_document_drops_no_behaviour_and_shifts_strokes_by_at_most_400_ms(style: str):
    planned = plan(STORY_BML, set_up(style=style, **INTERACTIVE_DEFAULTS))
    assert [name for name, outcome in planned.keyframes.outcomes.items() if outcome.kind == "dropped"] == []
    assert max(abs(sync.planned - sync.requested) for sync in planned.syncs if sync.is_stroke) <= MAX_STROKE_SHIFTS.get(
        style, 0.2
    )


@pytest.mark.soak
def test_second_story_document_drops_no_behaviour_and_shifts_strokes_by_at_most_200_ms():
    planned = plan(NIGHT_BML, set_up(**INTERACTIVE_DEFAULTS))
    assert [name for name, outcome in planned.keyframes.outcomes.items() if outcome.kind == "dropped"] == []
    assert max(abs(sync.planned - sync.requested) for sync in planned.syncs if sync.is_stroke) <= 0.2
