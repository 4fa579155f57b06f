from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.naturalness import lexicon_figures
from kinesic.bench.naturalness.body import BodyMeasures
from kinesic.bench.naturalness.captured_table import captured_table
from kinesic.bench.naturalness.legibility import TOO_NEAR
from kinesic.bench.naturalness.lexicon import MeasuredGesture, measure_gesture, measure_lexicon
from kinesic.bench.naturalness.likeness import nearest_pairs
from kinesic.expressivity.durations import stroke_spans
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.style.effort import Effort
from kinesic.expressivity.style.style import NEUTRAL, Style
from kinesic.studies.gestures.isolated import STROKE, plan_gesture

ARM = 0.42


def form(known, name):
    return next(form for form in known.lexicon.forms if form.id == name)


@pytest.fixture(scope="module")
def wave(known):
    return measure_gesture(form(known, "wave_far"), known)


def test_a_gesture_that_takes_long_to_its_stroke_has_its_natural_times(known, wave):
    work = poses(form(known, "wave_far"), known.robot, NEUTRAL)
    natural = stroke_spans(work, Effort(known.pace, work.nature))
    assert natural["ready"] + natural["stroke"] > STROKE
    assert wave.hand.duration == pytest.approx(sum(natural.values()), abs=1e-6)
    assert wave.hand.stroke_time == pytest.approx(natural["stroke"] + natural["strokeEnd"], abs=1e-6)
    assert wave.hand.return_time == pytest.approx(natural["end"], abs=1e-6)
    assert not wave.late
    assert wave.violations == 0


def test_the_hand_that_goes_farther_is_measured(known, wave):
    planned = plan_gesture(form(known, "wave_far"), known, stroke=8.0)
    times = np.linspace(0.0, planned.trajectory.duration, 2000)
    wrist = known.robot.skeleton.frames(planned.trajectory.sample(times)[0]).origins[:, known.robot.arm("r").wrist]
    speeds = np.linalg.norm(np.gradient(wrist, times, axis=0), axis=1) / known.robot.arm_length
    assert wave.hand.largest_speed == pytest.approx(speeds.max(), rel=0.01)
    assert wave.hand.arm_lengths == pytest.approx(wave.hand.path / known.robot.arm_length)


def test_a_path_is_dynamic_and_a_pose_is_not(known, wave):
    assert wave.dynamic
    assert not measure_gesture(form(known, "arms_crossed"), known).dynamic
    assert not replace(wave, keys=1).dynamic
    assert not replace(wave, hand=replace(wave.hand, stroke_path=0.2)).dynamic


LOOKED_ALIKE = (("me_low", "tiny_low"), ("beat_purse", "beckon_finger"), ("victory", "high_five"))


@pytest.mark.parametrize("pair", LOOKED_ALIKE)
def test_gestures_that_looked_alike_are_told_apart_with_a_margin(known, pair):
    seen = {name: measure_gesture(form(known, name), known).seen for name in pair}
    (found,) = nearest_pairs(seen, 1.0)
    assert found.distance > 1.3 * TOO_NEAR


def test_processes_measure_what_one_does(known, wave):
    (found,) = measure_lexicon([("wave_far", "sad")])
    sad = measure_gesture(form(known, "wave_far"), replace(known, style=Style.load("sad")))
    assert found.hand.duration > wave.hand.duration
    assert replace(found, hand=None) == replace(sad, hand=None)
    assert found.hand.largest_speed == pytest.approx(sad.hand.largest_speed, rel=1e-9)


@pytest.fixture
def gestures(wave):
    """A fast gesture that stops where its stroke begins, and a slow one that strokes as fast as it comes."""
    wave = replace(wave, hand=replace(wave.hand, flow=0.1))
    slow = replace(wave.hand, largest_speed=1.0, preparation_speed=0.8, stroke_speed=1.0, return_speed=0.4, flow=0.5)
    return [wave, replace(wave, gesture="slow", hand=slow, body=BodyMeasures())]


def named(gestures: list[MeasuredGesture]):
    return {figure.name.removeprefix("naturalness."): figure for figure in lexicon_figures(gestures, ARM)}


def test_bars_are_shares_and_medians_over_gestures(gestures):
    found = named(gestures)
    fast = gestures[0].hand
    assert found["stroke_dynamic"].value == pytest.approx((fast.stroke_speed + 1.0) / 2)
    assert found["flow_share"].value == 0.5
    assert found["flow_share"].ok
    assert found["peak_in_stroke"].value == 0.5
    assert found["whole_body"].value == 0.5
    assert found["variety"].value == pytest.approx(
        (0.05 + 0.95 * fast.largest_speed) / (0.95 + 0.05 * fast.largest_speed)
    )
    assert found["return_speed_all"].value == pytest.approx((fast.return_speed + 0.4) / 2)
    assert found["largest_speed"].why.count("captured") == 1


def test_returns_count_from_0_7_s_on_and_all_of_them_beside(gestures):
    cut = replace(gestures[1], hand=replace(gestures[1].hand, return_time=0.65, return_speed=9.0))
    found = named([gestures[1], cut])
    assert (found["return_speed"].value, found["return_speed_p95"].value) == pytest.approx((0.4, 0.4))
    assert found["return_speed_all"].value == pytest.approx(4.7)
    assert found["return_speed_all_p95"].value == pytest.approx(0.05 * 0.4 + 0.95 * 9.0)
    assert found["return_to_preparation"].value == pytest.approx(0.4 / 0.8)
    assert found["return_to_preparation_all"].value == pytest.approx((0.4 + 9.0) / 2 / 0.8)


def test_a_gesture_without_a_way_to_its_stroke_is_fastest_in_it(gestures):
    here = replace(gestures[0], hand=replace(gestures[0].hand, preparation_speed=0.0))
    found = named([gestures[0], here])
    assert found["peak_in_stroke"].value == 0.5
    assert found["stroke_to_preparation"].value == pytest.approx(gestures[0].hand.stroke_to_preparation)


def test_strokes_of_beats_deictics_and_emblems_stand_alone(gestures):
    fast, slow = gestures
    for category in ("beat", "deictic", "emblem"):
        found = named([replace(fast, category="iconic"), replace(slow, category=category)])
        assert found["stroke_expressive"].value == slow.hand.stroke_speed
    assert named([replace(fast, category="adaptor")])["stroke_expressive"].value is None


def test_bodies_of_two_sizes_are_compared_in_metres_and_in_arm_lengths(gestures):
    people = captured_table()
    like = [
        replace(
            gestures[0],
            hand=replace(gestures[0].hand, largest_speed=speed * people.arm / ARM, arm_lengths=path / people.arm),
        )
        for speed, path in zip(people.values["largest_speed"], people.values["path"], strict=True)
    ]
    found = named(like)
    assert found["ks_largest_speed_metres"].value < 0.02
    assert found["ks_path_arms"].value == 0.0
    assert found["ks_largest_speed"].value > 0.1


def test_what_natural_motion_costs_is_counted_by_name(gestures):
    lost = replace(gestures[0], gesture="lost", hand=None, stroke_error=float("nan"))
    late = replace(gestures[0], gesture="late", stroke_error=0.02, violations=3)
    found = named([*gestures, lost, late])
    assert (found["dropped"].value, found["dropped"].why) == (1, "lost")
    assert (found["stroke_moved"].value, found["stroke_moved"].why) == (1, "late")
    assert found["violations"].value == 3


def test_other_styles_have_rows_without_goals(gestures):
    found = named([*gestures, *(replace(each, style="calm") for each in gestures)])
    assert found["calm.return_speed_all"].value == found["return_speed_all"].value
    assert found["calm.return_speed_all"].goal is None
    assert "calm.variety" not in found


def test_categories_are_told_apart(gestures):
    found = named([*gestures, replace(gestures[1], category="beat")])
    assert found["category.beat.flow"].value == 0.5
    assert found["category.emblem.flow"].value == pytest.approx((gestures[0].hand.flow + 0.5) / 2)
    assert "category.iconic.flow" not in found
