from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.naturalness import style_metrics
from kinesic.bench.naturalness.body import BodyMeasures
from kinesic.bench.naturalness.captured_table import read_captured_table
from kinesic.bench.naturalness.legibility import ALIKE_DISTANCE
from kinesic.bench.naturalness.lexicon import MeasuredGesture, measure_gesture, measure_lexicon
from kinesic.bench.naturalness.likeness import nearest_pairs
from kinesic.expressivity.durations import stroke_durations
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.style.effort import Effort
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY, Style
from kinesic.studies.gestures.isolated import STROKE_TIME, plan_gesture

ARM_LENGTH = 0.42


def form(known, name):
    return next(form for form in known.lexicon.forms if form.id == name)


@pytest.fixture(scope="module")
def wave(known):
    return measure_gesture(form(known, "wave_far"), known)


def test_measured_gesture_with_long_preparation_keeps_natural_durations(known, wave):
    work = poses(form(known, "wave_far"), known.robot, NEUTRAL_EXPRESSIVITY)
    natural = stroke_durations(work, Effort(known.pace, work.traits))
    assert natural["ready"] + natural["stroke"] > STROKE_TIME
    assert wave.hand.duration == pytest.approx(sum(natural.values()), abs=1e-6)
    assert wave.hand.stroke_time == pytest.approx(natural["stroke"] + natural["strokeEnd"], abs=1e-6)
    assert wave.hand.return_time == pytest.approx(natural["end"], abs=1e-6)
    assert not wave.is_late
    assert wave.violations == 0


def test_gesture_speed_is_measured_at_the_hand_with_the_longer_path(known, wave):
    planned = plan_gesture(form(known, "wave_far"), known, stroke=8.0)
    times = np.linspace(0.0, planned.trajectory.duration, 2000)
    wrist = known.robot.skeleton.frames(planned.trajectory.sample(times)[0]).origins[:, known.robot.arm("r").wrist]
    speeds = np.linalg.norm(np.gradient(wrist, times, axis=0), axis=1) / known.robot.arm_length
    assert wave.hand.largest_speed == pytest.approx(speeds.max(), rel=0.01)
    assert wave.hand.arm_lengths == pytest.approx(wave.hand.path / known.robot.arm_length)


def test_strokes_along_a_path_count_as_dynamic_and_held_poses_do_not(known, wave):
    assert wave.is_dynamic
    assert not measure_gesture(form(known, "arms_crossed"), known).is_dynamic
    assert not replace(wave, keys=1).is_dynamic
    assert not replace(wave, hand=replace(wave.hand, stroke_path=0.2)).is_dynamic


SIMILAR_PAIRS = (("me_low", "tiny_low"), ("beat_purse", "beckon_finger"), ("victory", "high_five"))


@pytest.mark.parametrize("pair", SIMILAR_PAIRS)
def test_similar_gesture_pairs_differ_by_over_1_3_times_the_similarity_threshold(known, pair):
    seen = {name: measure_gesture(form(known, name), known).seen for name in pair}
    (results,) = nearest_pairs(seen, 1.0)
    assert results.distance > 1.3 * ALIKE_DISTANCE


def test_gesture_measures_are_equal_in_a_worker_process(known, wave):
    (results,) = measure_lexicon([("wave_far", "sad")])
    sad = measure_gesture(form(known, "wave_far"), replace(known, style=Style.load("sad")))
    assert results.hand.duration > wave.hand.duration
    assert replace(results, hand=None) == replace(sad, hand=None)
    assert results.hand.largest_speed == pytest.approx(sad.hand.largest_speed, rel=1e-9)


@pytest.fixture
def gestures(wave):
    """Return a fast gesture without flow, and a slow flowing gesture."""
    wave = replace(wave, hand=replace(wave.hand, flow=0.1))
    slow = replace(wave.hand, largest_speed=1.0, preparation_speed=0.8, stroke_speed=1.0, return_speed=0.4, flow=0.5)
    return [wave, replace(wave, gesture="slow", hand=slow, body=BodyMeasures())]


def metrics_by_name(gestures: list[MeasuredGesture]):
    return {metric.name.removeprefix("naturalness."): metric for metric in style_metrics(gestures, ARM_LENGTH)}


def test_naturalness_metrics_are_medians_or_fractions_of_gestures(gestures):
    results = metrics_by_name(gestures)
    fast = gestures[0].hand
    assert results["stroke_dynamic"].value == pytest.approx((fast.stroke_speed + 1.0) / 2)
    assert results["flow_share"].value == 0.5
    assert results["flow_share"].ok
    assert results["peak_in_stroke"].value == 0.5
    assert results["whole_body"].value == 0.5
    assert results["variety"].value == pytest.approx(
        (0.05 + 0.95 * fast.largest_speed) / (0.95 + 0.05 * fast.largest_speed)
    )
    assert results["return_speed_all"].value == pytest.approx((fast.return_speed + 0.4) / 2)
    assert results["largest_speed"].why.count("captured") == 1


def test_return_speed_metric_excludes_returns_shorter_than_0_7_s(gestures):
    cut = replace(gestures[1], hand=replace(gestures[1].hand, return_time=0.65, return_speed=9.0))
    results = metrics_by_name([gestures[1], cut])
    assert (results["return_speed"].value, results["return_speed_p95"].value) == pytest.approx((0.4, 0.4))
    assert results["return_speed_all"].value == pytest.approx(4.7)
    assert results["return_speed_all_p95"].value == pytest.approx(0.05 * 0.4 + 0.95 * 9.0)
    assert results["return_to_preparation"].value == pytest.approx(0.4 / 0.8)
    assert results["return_to_preparation_all"].value == pytest.approx((0.4 + 9.0) / 2 / 0.8)


def test_gesture_without_preparation_is_excluded_from_stroke_to_preparation_ratio(gestures):
    here = replace(gestures[0], hand=replace(gestures[0].hand, preparation_speed=0.0))
    results = metrics_by_name([gestures[0], here])
    assert results["peak_in_stroke"].value == 0.5
    assert results["stroke_to_preparation"].value == pytest.approx(gestures[0].hand.stroke_to_preparation)


def test_metric_of_expressive_strokes_contains_only_beats_deictics_and_emblems(gestures):
    fast, slow = gestures
    for category in ("beat", "deictic", "emblem"):
        results = metrics_by_name([replace(fast, category="iconic"), replace(slow, category=category)])
        assert results["stroke_expressive"].value == slow.hand.stroke_speed
    assert metrics_by_name([replace(fast, category="adaptor")])["stroke_expressive"].value is None


def test_gestures_of_two_body_sizes_are_compared_in_metres_and_arm_lengths(gestures):
    people = read_captured_table()
    like = [
        replace(
            gestures[0],
            hand=replace(
                gestures[0].hand, largest_speed=speed * people.arm / ARM_LENGTH, arm_lengths=path / people.arm
            ),
        )
        for speed, path in zip(people.values["largest_speed"], people.values["path"], strict=True)
    ]
    results = metrics_by_name(like)
    assert results["ks_largest_speed_metres"].value < 0.02
    assert results["ks_path_arms"].value == 0.0
    assert results["ks_largest_speed"].value > 0.1


def test_gestures_that_are_dropped_late_or_beyond_limits_are_counted_and_named(gestures):
    lost = replace(gestures[0], gesture="lost", hand=None, stroke_error=float("nan"))
    late = replace(gestures[0], gesture="late", stroke_error=0.02, violations=3)
    results = metrics_by_name([*gestures, lost, late])
    assert (results["dropped"].value, results["dropped"].why) == (1, "lost")
    assert (results["stroke_moved"].value, results["stroke_moved"].why) == (1, "late")
    assert results["violations"].value == 3


def test_non_neutral_style_has_naturalness_metrics_without_goals(gestures):
    results = metrics_by_name([*gestures, *(replace(gesture, style="calm") for gesture in gestures)])
    assert results["calm.return_speed_all"].value == results["return_speed_all"].value
    assert results["calm.return_speed_all"].goal is None
    assert "calm.variety" not in results


def test_gesture_categories_have_separate_naturalness_metrics(gestures):
    results = metrics_by_name([*gestures, replace(gestures[1], category="beat")])
    assert results["category.beat.flow"].value == 0.5
    assert results["category.emblem.flow"].value == pytest.approx((gestures[0].hand.flow + 0.5) / 2)
    assert "category.iconic.flow" not in results
