"""The lexicon in every style: a seeded sample of what `make bench` plays in full."""

import pytest

from kinesic.bench.expressivity import lexicon
from kinesic.bench.expressivity.lexicon import (
    MOST_MISS,
    NEUTRAL_STYLE,
    GestureResult,
    every,
    judge_gesture,
    lexicon_figures,
    play_gestures,
    sample,
)
from kinesic.body.config import names_of
from kinesic.tasks.engine import Processes, using_engine

SHARE = 0.01
TASKS = every(names_of("style"))


def test_every_gesture_is_played_in_every_style(known):
    assert len(TASKS) == len(set(TASKS)) == len(known.lexicon.forms) * len(names_of("style"))
    assert len(names_of("style")) >= 7


def test_a_sample_is_seeded_and_in_order():
    chosen = sample(TASKS, share=SHARE, seed=3)
    assert chosen == sample(TASKS, share=SHARE, seed=3) != sample(TASKS, share=SHARE, seed=4)
    assert len(chosen) == len(set(chosen)) == round(SHARE * len(TASKS))
    assert [TASKS.index(task) for task in chosen] == sorted(TASKS.index(task) for task in chosen)


def test_hands_that_point_at_one_another_reach_their_places(known):
    result = judge_gesture("link_rings", NEUTRAL_STYLE, known)
    assert not result.dropped
    assert 1000 * result.miss <= MOST_MISS


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


def test_figures_tell_what_is_wrong(monkeypatch):
    monkeypatch.setattr(
        lexicon, "twins", lambda looks: []
    )  # of all gestures: tests/expressivity/hands/test_appearance.py
    good = GestureResult("beat", NEUTRAL_STYLE, False, 0.014, 0, 0, 0.001, True, True, 0.002)
    bad = GestureResult("offer", "angry", True, -0.001, 3, 2, 0.4, False, False, 0.2)
    found = {figure.name: figure for figure in lexicon_figures([good, bad])}
    assert all(figure.ok is not False for name, figure in found.items() if name.startswith("expressivity.lexicon."))
    wrong = {"dropped": 1, "penetrations": 3, "clearance": -1, "violations": 2, "unreported": 1}
    assert {name: found[f"expressivity.styles.{name}"].value for name in wrong} == pytest.approx(wrong)
    assert not any(found[f"expressivity.styles.{name}"].ok for name in wrong)
    assert found["expressivity.styles.stroke_moved"].why == "offer (angry)"


def test_a_crew_plays_them_too():
    with using_engine(Processes(2)):
        results = list(play_gestures([("beat", NEUTRAL_STYLE), ("offer", "calm")]))
    assert {(result.gesture, result.style) for result in results} == {("beat", NEUTRAL_STYLE), ("offer", "calm")}
    assert all(result.reported for result in results)
