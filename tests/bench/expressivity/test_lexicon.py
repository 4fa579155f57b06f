"""The lexicon in every style: a seeded sample of what `make bench` plays in full."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.expressivity.lexicon import (
    LEAST_WAY,
    NEUTRAL_STYLE,
    GestureResult,
    distinct,
    every,
    judge_gesture,
    lexicon_figures,
    look,
    play_gestures,
    sample,
    turn_between,
    twins,
    way_between,
)
from kinesic.body.arrays import sealed
from kinesic.body.config import names_of
from kinesic.expressivity.lexicon.form import StrokeKey
from kinesic.expressivity.lexicon.lexicon import in_mode

SHARE = 0.01
TASKS = every(names_of("style"))
UP = np.array([0.0, 0.0, 1.0])


def test_every_gesture_is_played_in_every_style(known):
    assert len(TASKS) == len(set(TASKS)) == len(known.lexicon.forms) * len(names_of("style"))
    assert len(names_of("style")) >= 7


def test_a_sample_is_seeded_and_in_order():
    chosen = sample(TASKS, share=SHARE, seed=3)
    assert chosen == sample(TASKS, share=SHARE, seed=3) != sample(TASKS, share=SHARE, seed=4)
    assert len(chosen) == len(set(chosen)) == round(SHARE * len(TASKS))
    assert [TASKS.index(task) for task in chosen] == sorted(TASKS.index(task) for task in chosen)


@pytest.mark.parametrize(("gesture", "style"), sample(TASKS, share=SHARE, seed=1))
def test_a_gesture_keeps_limits_and_distances_and_tells_what_moves(known, gesture, style):
    result = judge_gesture(gesture, style, known)
    assert not result.dropped
    assert result.penetrations == 0
    assert result.violations == 0
    assert result.clearance >= known.robot.least_clearance
    assert result.reported


@pytest.mark.parametrize(("gesture", "style"), sample(every((NEUTRAL_STYLE,)), share=0.05, seed=2))
def test_in_the_neutral_style_strokes_are_on_time_and_hands_where_they_belong(known, gesture, style):
    result = judge_gesture(gesture, style, known)
    assert result.on_time
    assert result.stroke_error <= 0.010
    assert result.miss < 0.03


def test_figures_tell_what_is_wrong():
    good = GestureResult("beat", NEUTRAL_STYLE, False, 0.014, 0, 0, 0.001, True, True, 0.002)
    bad = GestureResult("offer", "angry", True, -0.001, 3, 2, 0.4, False, False, 0.2)
    found = {figure.name: figure for figure in lexicon_figures([good, bad])}
    assert all(figure.ok is not False for name, figure in found.items() if name.startswith("expressivity.lexicon."))
    wrong = {"dropped": 1, "penetrations": 3, "clearance": -1, "violations": 2, "unreported": 1}
    assert {name: found[f"expressivity.styles.{name}"].value for name in wrong} == pytest.approx(wrong)
    assert not any(found[f"expressivity.styles.{name}"].ok for name in wrong)
    assert found["expressivity.styles.stroke_moved"].why == "offer (angry)"


def test_a_crew_plays_them_too():
    results = list(play_gestures([("beat", NEUTRAL_STYLE), ("offer", "calm")], jobs=2))
    assert {(result.gesture, result.style) for result in results} == {("beat", NEUTRAL_STYLE), ("offer", "calm")}
    assert all(result.reported for result in results)


@pytest.fixture(scope="module")
def form(lexicon):
    return lexicon.find("present").form


def changed(form, **fields):
    """The form with something else in every pose."""
    keys = [
        StrokeKey(
            {side: replace(pose, **{name: of(pose) for name, of in fields.items()}) for side, pose in key.hands.items()}
        )
        for key in form.keys
    ]
    return replace(form, keys=tuple(keys))


def raised(form, robot, height):
    """The form, higher by [m]."""
    return changed(form, position=lambda pose: sealed(pose.position + UP * height / robot.arm_length))


def test_a_gesture_is_no_other_than_itself(form, pace):
    seen = look(form, pace)
    assert way_between(seen, seen) == 0.0
    assert turn_between(seen, seen) == pytest.approx(0.0, abs=1e-7)
    assert not distinct(seen, look(form, pace))


def test_the_way_is_the_mean_over_both_hands(form, robot, pace):
    seen = look(form, pace)
    assert way_between(seen, look(raised(form, robot, 0.06), pace)) == pytest.approx(0.06 / np.sqrt(2), rel=1e-6)
    both = in_mode(form, "both")
    assert way_between(look(both, pace), look(raised(both, robot, 0.06), pace)) == pytest.approx(0.06, rel=1e-6)


def test_two_gestures_are_two_from_5_cm_on(form, robot, pace):
    both = in_mode(form, "both")
    seen = look(both, pace)
    assert not distinct(seen, look(raised(both, robot, LEAST_WAY - 0.002), pace))
    assert distinct(seen, look(raised(both, robot, LEAST_WAY + 0.002), pace))


def test_another_shape_or_another_palm_makes_another_gesture(form, pace):
    seen = look(form, pace)
    assert distinct(seen, look(changed(form, shape=lambda _: "fist"), pace))
    assert distinct(seen, look(changed(form, palm=lambda pose: sealed(-pose.palm)), pace))


def test_a_path_makes_another_gesture(lexicon, pace):
    waving = lexicon.find("wave_far").form
    still = changed(waving, path=lambda _: None)
    assert way_between(look(waving, pace), look(still, pace)) > 0.02


def test_what_is_like_an_earlier_one_does_not_count(form, robot, pace):
    looks = [
        ("a", look(form, pace)),
        ("b", look(raised(form, robot, 0.01), pace)),
        ("c", look(in_mode(form, "left"), pace)),
    ]
    assert twins(looks) == [("b", "a")]


def test_no_two_gestures_of_the_lexicon_are_alike(lexicon, pace):
    assert len(lexicon.forms) >= 150
    assert twins((form.id, look(form, pace)) for form in lexicon.forms) == []
