"""Lexicon benchmark in every style: a seeded sample of the full benchmark."""

from collections.abc import Sequence

import numpy as np
import pytest

from kinesic.bench.expressivity import lexicon
from kinesic.bench.expressivity.lexicon import (
    MAX_POSITION_ERROR,
    NEUTRAL_STYLE,
    GestureResult,
    GestureTask,
    judge_gesture,
    lexicon_metrics,
    list_tasks,
    play_gestures,
)
from kinesic.body.config import names_of
from kinesic.tasks.engine import Processes, using_engine

SAMPLE_FRACTION = 0.006
ALL_TASKS = list_tasks(names_of("style"))


def sample_tasks(tasks: Sequence[GestureTask], *, fraction: float, seed: int) -> list[GestureTask]:
    """Choose a seeded fraction (0..1) of the tasks, in their order."""
    count = max(1, round(fraction * len(tasks)))
    chosen = np.random.default_rng(seed).choice(len(tasks), size=count, replace=False)
    return [tasks[k] for k in sorted(chosen)]


def test_benchmark_tasks_combine_every_gesture_with_every_style(known):
    assert len(ALL_TASKS) == len(set(ALL_TASKS)) == len(known.lexicon.forms) * len(names_of("style"))
    assert len(names_of("style")) >= 7


def test_benchmark_task_sample_depends_on_the_seed_and_keeps_lexicon_order():
    chosen = sample_tasks(ALL_TASKS, fraction=SAMPLE_FRACTION, seed=3)
    assert (
        chosen
        == sample_tasks(ALL_TASKS, fraction=SAMPLE_FRACTION, seed=3)
        != sample_tasks(ALL_TASKS, fraction=SAMPLE_FRACTION, seed=4)
    )
    assert len(chosen) == len(set(chosen)) == round(SAMPLE_FRACTION * len(ALL_TASKS))
    assert [ALL_TASKS.index(task) for task in chosen] == sorted(ALL_TASKS.index(task) for task in chosen)


def test_hands_of_the_link_rings_gesture_reach_their_positions(known):
    result = judge_gesture("link_rings", NEUTRAL_STYLE, known)
    assert not result.dropped
    assert 1000 * result.miss <= MAX_POSITION_ERROR


@pytest.mark.parametrize(("gesture", "style"), sample_tasks(ALL_TASKS, fraction=SAMPLE_FRACTION, seed=1))
def test_lexicon_gesture_keeps_limits_and_clearance_and_reports_time_shifts(known, gesture, style):
    result = judge_gesture(gesture, style, known)
    assert not result.dropped
    assert result.penetrations == 0
    assert result.violations == 0
    assert result.clearance >= known.robot.min_clearance
    assert result.reported


@pytest.mark.parametrize(("gesture", "style"), sample_tasks(list_tasks((NEUTRAL_STYLE,)), fraction=0.03, seed=2))
def test_gestures_in_neutral_style_have_punctual_strokes_and_hands_in_position(known, gesture, style):
    result = judge_gesture(gesture, style, known)
    assert result.on_time
    assert result.stroke_error <= 0.010
    assert result.miss < 0.03


def test_lexicon_metrics_report_each_kind_of_problem(monkeypatch):
    monkeypatch.setattr(
        lexicon, "twins", lambda looks: []
    )  # the whole lexicon is tested in tests/expressivity/hands/test_appearance.py
    good = GestureResult("beat", NEUTRAL_STYLE, False, 0.014, 0, 0, 0.001, True, True, 0.002)
    bad = GestureResult("offer", "angry", True, -0.001, 3, 2, 0.4, False, False, 0.2)
    metrics = {metric.name: metric for metric in lexicon_metrics([good, bad])}
    assert all(metric.ok is not False for name, metric in metrics.items() if name.startswith("expressivity.lexicon."))
    wrong = {"dropped": 1, "penetrations": 3, "clearance": -1, "violations": 2, "unreported": 1}
    assert {name: metrics[f"expressivity.styles.{name}"].value for name in wrong} == pytest.approx(wrong)
    assert not any(metrics[f"expressivity.styles.{name}"].ok for name in wrong)
    assert metrics["expressivity.styles.stroke_moved"].why == "offer (angry)"


def test_worker_processes_perform_each_gesture_with_its_style():
    with using_engine(Processes(2)):
        results = list(play_gestures([("beat", NEUTRAL_STYLE), ("offer", "calm")]))
    assert {(result.gesture, result.style) for result in results} == {("beat", NEUTRAL_STYLE), ("offer", "calm")}
    assert all(result.reported for result in results)
