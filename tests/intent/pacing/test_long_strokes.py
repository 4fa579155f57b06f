"""Tests of gestures with a long stroke, which accompanies a word."""

import pytest

from kinesic.expressivity.durations import stroke_durations
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.style.effort import Effort
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours
from kinesic.intent.pacing.long_strokes import (
    LONG_STROKES,
    MAX_STROKE_DELAY,
    is_in_long_stroke,
    slowness_of,
    stroke_delay,
)
from kinesic.session.setup import set_up

DRAWING_CATEGORIES = ("iconic", "metaphoric", "deictic")
MIN_LONG_STROKE = 1.15  # [s] shortest stroke of a drawing gesture that must be in the table
MIN_LISTED_STROKE = 1.05  # [s] shortest stroke of a gesture that may be in the table


def test_table_of_long_strokes_lists_all_gestures_with_a_slow_drawing_stroke_and_no_fast_strokes():
    setup = set_up(robot="human")
    natural = {}
    for form in setup.lexicon.forms:
        work = poses(form, setup.robot, setup.style.gesture)
        natural[form.id] = stroke_durations(work, Effort(setup.context.pace, work.traits))["stroke"]
    drawing = {form.id for form in setup.lexicon.forms if form.category in DRAWING_CATEGORIES}
    assert {name for name in drawing if natural[name] > MIN_LONG_STROKE} <= LONG_STROKES.keys()
    assert {name: natural[name] for name in LONG_STROKES if natural[name] < MIN_LISTED_STROKE} == {}


def test_long_stroke_is_delayed_relative_to_its_word():
    setup = set_up()
    _, selection = plan_behaviours("We sat in the kitchen and the rain came.", setup.lexicon, Style.load("neutral"))
    rain = next(behaviour for behaviour in selection.behaviours if behaviour.lexeme == "rain")
    assert rain.intent.stroke.reference == "s:w8+1.67"


def test_long_stroke_of_a_slow_style_is_delayed_further_so_that_it_begins_at_the_same_time() -> None:
    delays = {}
    for name in ("neutral", "joyful", "sad"):
        slowness = slowness_of(Style.load(name))
        delays[name] = stroke_delay(("circle_drawn",), slowness) - slowness * LONG_STROKES["circle_drawn"]
    assert delays["neutral"] == delays["joyful"] == pytest.approx(delays["sad"])
    strokes = {
        name: {
            each.lexeme: each.intent.stroke.seconds
            for each in plan_behaviours(
                "We sat in the kitchen and the storm blew everything away.", set_up().lexicon, Style.load(name)
            )[1].behaviours
        }
        for name in ("neutral", "sad")
    }
    assert strokes["sad"]["wind"] > strokes["neutral"]["wind"]


def test_beat_that_replaces_a_long_stroke_of_a_slow_style_falls_on_its_word() -> None:
    text = "We sat in the kitchen and the rain came. We sat in the garden, and again the rain came."
    _, selection = plan_behaviours(text, set_up().lexicon, Style.load("sad"))
    beats = [each for each in selection.behaviours if "shown a moment ago" in each.intent.reason]
    assert [each.intent.stroke.reference for each in beats] == ["s:w18+0.07"]


def test_stroke_delay_of_alternative_gestures_is_the_mean_of_their_delays_up_to_a_maximum():
    assert stroke_delay(()) == stroke_delay(("large",)) == 0.0
    assert stroke_delay(("river",)) == MAX_STROKE_DELAY
    assert stroke_delay(("path_along", "large")) == pytest.approx(stroke_delay(("path_along",)) / 2)


def test_usual_stroke_of_a_slow_style_ends_later_so_that_it_begins_shortly_before_its_word():
    assert stroke_delay(("past_over_shoulder",)) == 0.0
    slowness = slowness_of(Style.load("sad"))
    assert 0.25 < stroke_delay(("past_over_shoulder",), slowness) < 0.35
    strokes = {
        name: [
            behaviour.intent.stroke.reference
            for behaviour in plan_behaviours(
                "We waited. Then we went back the way we came.", set_up().lexicon, Style.load(name)
            )[1].behaviours
            if behaviour.lexeme == "past_over_shoulder"
        ]
        for name in ("neutral", "sad")
    }
    assert strokes["neutral"] != strokes["sad"]


def test_no_gesture_is_chosen_during_the_long_stroke_of_another_gesture():
    strokes = [("large", 3.0), ("fire", 9.0)]
    assert [at for at in (2.5, 6.0, 6.8, 8.9, 9.1) if is_in_long_stroke(at, strokes)] == [6.8, 8.9]
    setup = set_up()
    text = "The window was shut, the oil in the new pan had caught fire, and our cat was sitting right beside it."
    for seed in range(4):
        _, selection = plan_behaviours(text, setup.lexicon, Style.load("joyful"), seed=seed)
        times = {each.lexeme: each.intent.stroke.seconds for each in selection.behaviours if each.channel == "gesture"}
        assert len(times) > 1
        assert not [name for name, at in times.items() if 0.0 < times["fire"] - at < LONG_STROKES["fire"]]


def test_beat_that_replaces_a_repeated_long_stroke_falls_on_its_word():
    text = "We sat in the kitchen and the rain came. We sat in the garden, and again the rain came."
    _, selection = plan_behaviours(text, set_up().lexicon, Style.load("neutral"))
    beats = [each for each in selection.behaviours if "shown a moment ago" in each.intent.reason]
    assert [each.intent.stroke.reference for each in beats] == ["s:w18+0.07"]


def test_short_text_has_no_beat_during_a_long_stroke():
    text = "I think that everybody in the village could hardly believe the whole story before the rain came."
    for seed in range(4):
        _, selection = plan_behaviours(text, set_up().lexicon, Style.load("neutral"), seed=seed)
        times = {each.lexeme: each.intent.stroke.seconds for each in selection.behaviours if each.channel == "gesture"}
        assert len(times) > 1
        assert not [name for name, at in times.items() if 0.0 < times["rain"] - at < LONG_STROKES["rain"]]
