"""Tests of sync points and natural durations of all behaviour types."""

import pytest

from kinesic.bml.block import (
    FACE_SYNCS,
    GAZE_SYNCS,
    GESTURE_SYNCS,
    SHIFT_SYNCS,
    Face,
    Gaze,
    Gesture,
    Head,
    Interrupt,
    Posture,
    Speech,
    Wait,
)
from kinesic.bml.timing.points import HOLD_SYNCS, find_natural_spans, find_speech_offsets, is_repeated, list_sync_points
from kinesic.body.utterance import Mark, Script, Utterance

# actions whose result persists
SHIFT_ACTIONS = [Gaze("x", shift=True), Face(("smile",), shift=True), Posture("STANDING", shift=True)]
# actions after which the body returns
RETURNING_ACTIONS = [Gaze("x"), Face(("smile",)), Posture("STANDING"), Head("NOD"), Gesture("beat")]


@pytest.mark.parametrize("action", [*SHIFT_ACTIONS, Wait(), Interrupt("b")])
@pytest.mark.parametrize("dialect", ["bml-1.0", "draft"])
def test_shifts_and_motionless_behaviours_have_only_sync_points_start_and_end(action, dialect):
    assert list_sync_points(action, dialect) == SHIFT_SYNCS


@pytest.mark.parametrize(
    ("action", "plain", "draft"),
    [
        (Gaze("x"), GAZE_SYNCS, GESTURE_SYNCS),
        (Posture("STANDING"), GAZE_SYNCS, GESTURE_SYNCS),
        (Face(("smile",)), FACE_SYNCS, ("start", "attackPeak", *GESTURE_SYNCS[1:])),
        (Head("NOD"), GESTURE_SYNCS, GESTURE_SYNCS),
        (Gesture("beat"), GESTURE_SYNCS, GESTURE_SYNCS),
    ],
)
def test_bml_draft_gaze_posture_and_face_have_the_seven_gesture_sync_points(action, plain, draft):
    assert list_sync_points(action, "bml-1.0") == plain
    assert list_sync_points(action, "draft") == list_sync_points(action, "fml-apml") == draft


def test_repeated_strokes_precede_the_stroke_end():
    twice = ("start", "ready", "strokeStart", "stroke", "stroke:2", "strokeEnd", "relax", "end")
    assert list_sync_points(Head("NOD", repetition=2), "bml-1.0") == twice
    assert list_sync_points(Gesture("beat"), "bml-1.0", ["ready", "stroke", "stroke:2"]) == twice
    assert is_repeated(Gesture("beat"), "stroke:2")
    assert not is_repeated(Gesture("beat"), "stroke")
    assert not is_repeated(Head("NOD", repetition=2), "stroke:2")


def test_speech_marks_lie_between_start_and_end():
    speech = Speech(Script("one two", (Mark("m", 0), Mark("relax", 4))))
    assert list_sync_points(speech, "bml-1.0") == ("start", "m", "relax", "end")
    assert list_sync_points(speech, "draft") == (*GESTURE_SYNCS[:4], "m", "relax", "strokeEnd", "end")
    offsets = find_speech_offsets(Utterance(2.0, {"m": 0.0, "relax": 0.7}))
    assert [offsets[sync] for sync in ("start", "stroke", "m", "relax", "strokeEnd", "end")] == [0, 0, 0, 0.7, 2, 2]


@pytest.mark.parametrize("action", [*SHIFT_ACTIONS, *RETURNING_ACTIONS, Wait()])
def test_natural_durations_of_behaviour_phases_are_between_0_1_and_2_seconds(action):
    spans, points = find_natural_spans(action, {}), list_sync_points(action, "bml-1.0")
    assert spans.keys() <= set(points[1:])
    assert all(0.1 <= seconds <= 2.0 for seconds in spans.values())
    assert 0.5 <= sum(spans.values()) <= 4.0
    assert find_natural_spans(action, {"end": 9.0})["end"] == 9.0


def test_wait_behaviour_lasts_its_given_duration_or_else_one_second():
    assert find_natural_spans(Wait(2.5), {}) == {"end": 2.5}
    assert find_natural_spans(Wait(), {}) == {"end": 1.0}
    assert find_natural_spans(Interrupt("b"), {}) == {}


def test_each_repeated_nod_adds_a_stroke_of_equal_duration():
    once, thrice = (find_natural_spans(Head("NOD", repetition=count), {}) for count in (1, 3))
    assert thrice == {**once, "stroke:2": 0.4, "stroke:3": 0.4}


def test_pre_and_post_stroke_holds_end_at_stroke_start_and_relax():
    assert {"strokeStart", "relax"} == HOLD_SYNCS
