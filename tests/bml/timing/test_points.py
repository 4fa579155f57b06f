"""Sync points of each type of behaviour, and what they take by nature."""

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
from kinesic.bml.timing.points import HOLDS, is_repeated, natural_spans, speech_offsets, sync_points
from kinesic.body.utterance import Mark, Script, Utterance

STAYING = [Gaze("x", shift=True), Face(("smile",), shift=True), Posture("STANDING", shift=True)]
GOING = [Gaze("x"), Face(("smile",)), Posture("STANDING"), Head("NOD"), Gesture("beat")]


@pytest.mark.parametrize("action", [*STAYING, Wait(), Interrupt("b")])
@pytest.mark.parametrize("dialect", ["bml-1.0", "draft"])
def test_what_stays_or_moves_nothing_has_a_start_and_an_end(action, dialect):
    assert sync_points(action, dialect) == SHIFT_SYNCS


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
def test_the_draft_gives_more_behaviours_the_seven_points_of_a_gesture(action, plain, draft):
    assert sync_points(action, "bml-1.0") == plain
    assert sync_points(action, "draft") == sync_points(action, "fml-apml") == draft


def test_repeated_strokes_come_before_the_end_of_the_stroke():
    twice = ("start", "ready", "strokeStart", "stroke", "stroke:2", "strokeEnd", "relax", "end")
    assert sync_points(Head("NOD", repetition=2), "bml-1.0") == twice
    assert sync_points(Gesture("beat"), "bml-1.0", ["ready", "stroke", "stroke:2"]) == twice
    assert is_repeated(Gesture("beat"), "stroke:2")
    assert not is_repeated(Gesture("beat"), "stroke")
    assert not is_repeated(Head("NOD", repetition=2), "stroke:2")


def test_a_speech_has_its_marks_between_its_start_and_its_end():
    speech = Speech(Script("one two", (Mark("m", 0), Mark("relax", 4))))
    assert sync_points(speech, "bml-1.0") == ("start", "m", "relax", "end")
    assert sync_points(speech, "draft") == (*GESTURE_SYNCS[:4], "m", "relax", "strokeEnd", "end")
    offsets = speech_offsets(Utterance(2.0, {"m": 0.0, "relax": 0.7}))
    assert [offsets[sync] for sync in ("start", "stroke", "m", "relax", "strokeEnd", "end")] == [0, 0, 0, 0.7, 2, 2]


@pytest.mark.parametrize("action", [*STAYING, *GOING, Wait()])
def test_natural_phases_are_those_of_sync_points_and_take_a_time_that_people_take(action):
    spans, points = natural_spans(action, {}), sync_points(action, "bml-1.0")
    assert spans.keys() <= set(points[1:])
    assert all(0.1 <= seconds <= 2.0 for seconds in spans.values())
    assert 0.5 <= sum(spans.values()) <= 4.0
    assert natural_spans(action, {"end": 9.0})["end"] == 9.0


def test_a_wait_takes_what_it_says_or_a_second():
    assert natural_spans(Wait(2.5), {}) == {"end": 2.5}
    assert natural_spans(Wait(), {}) == {"end": 1.0}
    assert natural_spans(Interrupt("b"), {}) == {}


def test_each_further_stroke_of_a_head_takes_as_long():
    once, thrice = (natural_spans(Head("NOD", repetition=count), {}) for count in (1, 3))
    assert thrice == {**once, "stroke:2": 0.4, "stroke:3": 0.4}


def test_holds_are_what_ends_without_a_motion():
    assert {"strokeStart", "relax"} == HOLDS
