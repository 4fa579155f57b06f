import random
from dataclasses import replace

import pytest

from kinesic.intent.intents import Intent, Moment
from kinesic.intent.kept_intents import KeptIntents

STROKE_GAP = 1.0  # [s] smallest time between two strokes


def intent(name: str, start: float, stroke: float, end: float) -> Intent:
    return Intent(name, *(Moment("s:start", seconds) for seconds in (start, stroke, end)), 0.5, "a test")


LONG_EMOTION = intent("emotion-joy", 0.0, 1.0, 5.0)
NEGATION_WORD = intent("negation", 0.0, 1.0, 5.0)


def conflicts_with(kept: Intent, other: Intent, *, covering: bool = True) -> bool:
    return KeptIntents([kept]).first_conflict(other, STROKE_GAP, covering=covering) is kept


@pytest.mark.parametrize(("stroke", "is_near"), [(2.0, False), (1.99, True), (0.01, True), (0.0, False)])
def test_intents_with_close_strokes_conflict(stroke: float, is_near: bool) -> None:
    assert conflicts_with(NEGATION_WORD, intent("accent", stroke, stroke, stroke)) is is_near


@pytest.mark.parametrize(
    ("start", "end", "meets"), [(5.0, 6.0, False), (4.9, 6.0, True), (-2.0, 0.0, False), (-2.0, 0.1, True)]
)
def test_long_emotion_conflicts_with_overlapping_intents_on_the_face(start: float, end: float, meets: bool) -> None:
    other = intent("accent", start, 9.0, end)
    assert conflicts_with(LONG_EMOTION, other) is meets
    assert conflicts_with(replace(other, name="accent"), replace(LONG_EMOTION, name="emotion")) is meets
    assert not conflicts_with(NEGATION_WORD, other)
    assert not conflicts_with(LONG_EMOTION, other, covering=False)
    assert not conflicts_with(LONG_EMOTION, replace(other, name="emotional-accent")) or meets


def test_earliest_chosen_intent_that_conflicts_with_a_new_one_is_returned() -> None:
    def told(one: Intent, other: Intent) -> bool:
        near = abs(one.stroke.seconds - other.stroke.seconds) < STROKE_GAP
        feels = any(item.name.startswith("emotion-") for item in (one, other))
        return near or (feels and one.start.seconds < other.end.seconds and other.start.seconds < one.end.seconds)

    chance = random.Random(3)
    some = []
    for _ in range(300):
        start = chance.uniform(0.0, 200.0)
        lasts = chance.choice((0.3, 4.0))
        some.append(intent(chance.choice(("emotion-joy", "accent")), start, start + lasts / 2, start + lasts))
    kept = KeptIntents()
    for count, entry in enumerate(some):
        assert len(kept) == count
        expected = next((other for other in some[:count] if told(other, entry)), None)
        assert kept.first_conflict(entry, STROKE_GAP, covering=True) is expected
        kept.add(entry)


@pytest.mark.parametrize(
    ("at", "room", "reached"), [(5.5, 0.5, True), (5.51, 0.5, False), (-0.5, 0.5, True), (2.0, 0.0, True)]
)
def test_time_within_the_margin_of_a_chosen_intent_counts_as_covered(at: float, room: float, reached: bool) -> None:
    assert KeptIntents([NEGATION_WORD]).covers(at, room) is reached
    assert not KeptIntents([NEGATION_WORD]).covers(-0.51, 0.5)
    assert not KeptIntents().covers(at, room)
