import random
from dataclasses import replace

import pytest

from kinesic.intent.intents import Intent, Moment
from kinesic.intent.kept_intents import KeptIntents

GAP = 1.0  # [s]


def intent(name: str, start: float, stroke: float, end: float) -> Intent:
    return Intent(name, *(Moment("s:start", seconds) for seconds in (start, stroke, end)), 0.5, "a test")


LONG = intent("emotion-joy", 0.0, 1.0, 5.0)
WORD = intent("negation", 0.0, 1.0, 5.0)


def beside(kept: Intent, other: Intent, *, covering: bool = True) -> bool:
    return KeptIntents([kept]).first_beside(other, GAP, covering=covering) is kept


@pytest.mark.parametrize(("stroke", "is_near"), [(2.0, False), (1.99, True), (0.01, True), (0.0, False)])
def test_strokes_keep_a_distance(stroke: float, is_near: bool) -> None:
    assert beside(WORD, intent("accent", stroke, stroke, stroke)) is is_near


@pytest.mark.parametrize(
    ("start", "end", "meets"), [(5.0, 6.0, False), (4.9, 6.0, True), (-2.0, 0.0, False), (-2.0, 0.1, True)]
)
def test_an_emotion_has_the_face_for_itself_while_it_lasts(start: float, end: float, meets: bool) -> None:
    other = intent("accent", start, 9.0, end)
    assert beside(LONG, other) is meets
    assert beside(replace(other, name="accent"), replace(LONG, name="emotion")) is meets
    assert not beside(WORD, other)
    assert not beside(LONG, other, covering=False)
    assert not beside(LONG, replace(other, name="emotional-accent")) or meets


def test_what_was_kept_first_is_named_first() -> None:
    def told(one: Intent, other: Intent) -> bool:
        near = abs(one.stroke.seconds - other.stroke.seconds) < GAP
        feels = any(each.name.startswith("emotion-") for each in (one, other))
        return near or (feels and one.start.seconds < other.end.seconds and other.start.seconds < one.end.seconds)

    chance = random.Random(3)
    some = []
    for _ in range(300):
        start = chance.uniform(0.0, 200.0)
        lasts = chance.choice((0.3, 4.0))
        some.append(intent(chance.choice(("emotion-joy", "accent")), start, start + lasts / 2, start + lasts))
    kept = KeptIntents()
    for count, each in enumerate(some):
        assert len(kept) == count
        expected = next((other for other in some[:count] if told(other, each)), None)
        assert kept.first_beside(each, GAP, covering=True) is expected
        kept.add(each)


@pytest.mark.parametrize(
    ("at", "room", "reached"), [(5.5, 0.5, True), (5.51, 0.5, False), (-0.5, 0.5, True), (2.0, 0.0, True)]
)
def test_a_time_lies_within_with_some_room(at: float, room: float, reached: bool) -> None:
    assert KeptIntents([WORD]).reach(at, room) is reached
    assert not KeptIntents([WORD]).reach(-0.51, 0.5)
    assert not KeptIntents().reach(at, room)
