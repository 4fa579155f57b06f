"""Properties of the body motion that accompanies every gesture."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.block import GESTURE_SYNCS, Behaviour, Block, Gesture, Head, Place, TimedBehaviour, Timeline
from kinesic.body.robot import OTHER_SIDE
from kinesic.expressivity.context import BlockContext, Context
from kinesic.expressivity.gather import SAME_FRAME
from kinesic.expressivity.keyframes import KeyFrame, KeyFrames, Turn
from kinesic.expressivity.lexicon.body_form import NO_BODY
from kinesic.expressivity.lexicon.lexicon import Lexicon, mirror_form
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import Style, style_preset
from kinesic.expressivity.turns import turn_angles

from ...examples import examples
from ...performances import LIMITS, ROBOT

HAND_PACE = Pace(ROBOT, LIMITS)
BUILTIN_LEXICON = Lexicon.load()
# lexicon whose gestures move only the hands
HANDS_ONLY = BUILTIN_LEXICON.changed(lambda form: replace(form, body=NO_BODY))
MIRRORED_LEXICON = BUILTIN_LEXICON.changed(mirror_form)
NO_WHOLE_BODY = Style().changed(["whole_body=0"])  # style without accompanying body motion

names = st.sampled_from([form.id for form in BUILTIN_LEXICON.forms])
styles = st.sampled_from(["neutral", "angry", "joyful", "sad", "shy"]).map(style_preset)
spans = st.lists(st.floats(0.02, 1.2), min_size=7, max_size=7)


def timed(id: str, action, spans_: list[float]) -> TimedBehaviour:
    times = dict(zip(GESTURE_SYNCS, np.cumsum(spans_).tolist(), strict=True))
    return TimedBehaviour(Behaviour(id, "x", action, Place(1, 1)), times)


def performed(
    *behaviours: TimedBehaviour, style: Style = NO_WHOLE_BODY, lexicon: Lexicon = BUILTIN_LEXICON
) -> KeyFrames:
    timeline = Timeline(Block("b", tuple(behaviour.behaviour for behaviour in behaviours)), behaviours)
    return make_keyframes(timeline, BlockContext(timeline.block, Context(style, lexicon, HAND_PACE)))


def frame_values(found: KeyFrames) -> list[object]:
    """Return every value of the key frames that planning reads."""
    return [
        (
            frame.time,
            frame.torso,
            frame.head,
            frame.given,
            frame.filled,
            frame.syncs,
            frame.passages,
            hand_values(frame),
        )
        for frame in found.frames
    ]


def hand_values(frame: KeyFrame) -> list[object]:
    return [
        (side, hand.lift, hand.effort, None if hand.reach is None else hand.reach.position.tolist())
        for side, hand in frame.hands.items()
    ]


@examples(40)
@given(names, spans, styles)
def test_only_hands_move_if_the_whole_body_weight_is_zero(name, spans_, style):
    gesture, off = timed("g", Gesture(name), spans_), style.changed(["whole_body=0"])
    result = performed(gesture, style=off)
    assert frame_values(result) == frame_values(performed(gesture, style=off, lexicon=HANDS_ONLY))
    assert result.bodies == {}


@examples(40)
@given(names, spans, styles)
def test_body_motion_changes_no_sync_point_and_no_hand(name, spans_, style):
    gesture = timed("g", Gesture(name), spans_)
    with_body, alone = (performed(gesture, style=style, lexicon=item) for item in (BUILTIN_LEXICON, HANDS_ONLY))
    assert with_body.timeline.timed == alone.timeline.timed
    assert with_body.outcomes == alone.outcomes
    frames = {frame.time: frame for frame in with_body.frames}
    for frame in alone.frames:
        if not frame.syncs:
            continue
        beside = frames[frame.time]
        assert beside.syncs == frame.syncs
        for side, hand in frame.hands.items():
            other = beside.hands[side]
            assert (other.reach is None) == (hand.reach is None)
            if hand.reach is not None and other.reach is not None:
                np.testing.assert_array_equal(other.reach.position, hand.reach.position)


@examples(40)
@given(names, spans, styles)
def test_mirrored_gesture_has_mirrored_body_motion(name, spans_, style):
    gesture = timed("g", Gesture(name), spans_)
    right, left = (performed(gesture, style=style, lexicon=item) for item in (BUILTIN_LEXICON, MIRRORED_LEXICON))
    assert [frame.time for frame in left.frames] == pytest.approx([frame.time for frame in right.frames])
    for a, b in zip(right.frames, left.frames, strict=True):
        for here, there in ((a.head, b.head), (a.torso, b.torso)):
            mirrored = Turn(-there.torsion, there.tilt, -there.roll)
            assert turn_angles(here) == pytest.approx(turn_angles(mirrored), abs=1e-9)
        for side, hand in a.hands.items():
            assert b.hands[OTHER_SIDE[side]].lift == pytest.approx(hand.lift)


@examples(40)
@given(names, spans, spans, styles, st.sampled_from(("NOD", "SHAKE")))
def test_head_behaviours_replace_accompanying_head_motion(name, spans_, nodding, style, lexeme):
    gesture, head = timed("g", Gesture(name), spans_), timed("h", Head(lexeme), nodding)
    result, asked = (performed(gesture, head, style=style, lexicon=item) for item in (BUILTIN_LEXICON, HANDS_ONLY))
    axis = "tilt" if lexeme == "NOD" else "torsion"
    heads = {frame.time: frame.head for frame in result.frames}
    gesturing = max(gesture.times["start"], head.times["start"]), min(gesture.times["end"], head.times["end"])
    if gesturing[0] < gesturing[1]:  # Gesture and nod overlap
        for frame in asked.frames:
            merged = any(abs(frame.time - time) < SAME_FRAME for time in gesture.times.values())
            if "head" in frame.given and frame.time in heads and not merged:
                assert getattr(heads[frame.time], axis) == pytest.approx(getattr(frame.head, axis), abs=1e-9)


@examples(40)
@given(names, spans, styles)
def test_body_motion_of_a_gesture_ends_with_head_and_shoulders_at_rest(name, spans_, style):
    result = performed(timed("g", Gesture(name), spans_), style=style)
    assert turn_angles(result.frames[0].head) == turn_angles(result.frames[-1].head) == (0.0, 0.0, 0.0)
    if not BUILTIN_LEXICON.forms_by_id[name].rest:
        assert all(hand.lift == 0.0 for hand in result.frames[-1].hands.values())
