"""Metrics of the gesture strokes in a story."""

from dataclasses import replace

import pytest

from kinesic.bench.meaning import rhythm
from kinesic.bench.meaning.rhythm import PlannedStroke, StoryRhythm, measure_rhythm
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan

BEAT = PlannedStroke(2.0, 0.0, "beat", frozenset({"r"}))
STORY = StoryRhythm(
    60.0,
    (BEAT, replace(BEAT, time=5.0, lexeme="large", delay=0.3), replace(BEAT, time=50.0), replace(BEAT, time=58.0)),
    lost=1,
    returns=(True, False),
)


def test_rhythm_metrics_of_a_story_are_computed_from_its_strokes() -> None:
    assert (STORY.rate, STORY.beats, STORY.silence) == (4.0, 0.75, 45.0)
    assert (STORY.repeats, STORY.late) == (2, 1)
    values = {metric.name.rpartition(".")[2]: metric.value for metric in rhythm.rhythm_metrics("x", [STORY])}
    assert values["returns"] == 50.0
    assert values["lost"] == values["late"] == 1


@pytest.mark.parametrize(("gap", "returned"), [(1.5, [False]), (5.0, [])])
def test_return_of_a_hand_to_rest_is_measured_only_between_strokes_that_are_close_in_time(
    known: Setup, gap: float, returned: list[bool]
) -> None:
    times = {"beat": 2.0, "beat_lift": 2.0 + gap}
    beats = "".join(f'<gesture id="{name}" lexeme="{name}" stroke="{time}"/>' for name, time in times.items())
    measured = measure_rhythm(plan(f'<bml id="b">{beats}</bml>', known))
    assert [stroke.lexeme for stroke in measured.strokes] == ["beat", "beat_lift"]
    assert list(measured.returns) == returned
