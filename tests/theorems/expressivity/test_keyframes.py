"""Properties of the key frames of every timeline."""

from itertools import accumulate, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.bml.block import (
    GAZE_SYNCS,
    GESTURE_SYNCS,
    SHIFT_SYNCS,
    Behaviour,
    Block,
    Gaze,
    Gesture,
    Head,
    HeadDirectionShift,
    Place,
    Pointing,
    Posture,
    TimedBehaviour,
    Timeline,
    Torso,
    Wait,
)
from kinesic.body.robot import SIDES
from kinesic.expressivity.context import BlockContext, Context
from kinesic.expressivity.gather import SAME_FRAME
from kinesic.expressivity.hands.poses import poses, resting_hands
from kinesic.expressivity.keyframes import Hand, KeyFrames
from kinesic.expressivity.lexicon.lexicon import Lexicon, in_mode, mirror_form
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import Expressivity, Style

from ...examples import examples
from ...performances import LIMITS, ROBOT

HAND_PACE = Pace(ROBOT, LIMITS)
BUILTIN_LEXICON = Lexicon.load()
BODY_PARTS = {"head", "torso", "l_hand", "r_hand"}

modes = st.sampled_from(("left", "right", "both", "unspecified"))
targets = st.sampled_from(("left", "right", "audience", "bluebox", "1 0.2 0.9"))
lexemes = st.sampled_from([form.id for form in BUILTIN_LEXICON.forms] + ["xyzzy"])
arms = st.sampled_from((("ARMS", "ARMS_CROSSED"), ("LEFT_ARM", "ARMS_NEUTRAL"), ("WHOLEBODY", "LEANING_FORWARD")))
unit = st.floats(-1.0, 1.0)
manners = st.builds(Expressivity, unit, unit, unit, unit, unit, unit, unit, st.floats(0.0, 1.0))
styles = st.builds(Style, st.just("any"), manners, manners, manners, manners)
actions = st.one_of(
    st.builds(Gesture, lexemes, modes),
    st.builds(Pointing, targets, modes),
    st.builds(Head, st.sampled_from(("NOD", "SHAKE", "Down_Aside_Right", "SPIN")), st.integers(1, 4), st.floats(0, 3)),
    st.builds(HeadDirectionShift, targets),
    st.builds(Gaze, targets, st.sampled_from((None, "EYES", "WAIST")), shift=st.booleans()),
    st.builds(Torso, st.sampled_from(("BodyLean", "TurnLeft", "jingtry")), st.floats(0, 2)),
    st.builds(Posture, st.none(), st.tuples(arms), shift=st.booleans()),
    st.builds(Wait),
)


def names(action) -> tuple[str, ...]:
    if isinstance(action, Wait) or getattr(action, "shift", False):
        return SHIFT_SYNCS
    if isinstance(action, Gaze | Posture):
        return GAZE_SYNCS
    if isinstance(action, Head):
        more = tuple(f"stroke:{k}" for k in range(2, action.repetition + 1))
        return (*GESTURE_SYNCS[:4], *more, *GESTURE_SYNCS[4:])
    return GESTURE_SYNCS


@st.composite
def timelines(draw) -> Timeline:
    timed = []
    for k in range(draw(st.integers(0, 6))):
        action = draw(actions)
        syncs = names(action)
        spans = draw(st.lists(st.one_of(st.just(0.0), st.floats(0, 1.5)), min_size=len(syncs), max_size=len(syncs)))
        start = draw(st.floats(-1.0, 5.0))
        times = accumulate([start, *spans[1:]])
        timed.append(TimedBehaviour(Behaviour(f"b{k}", "x", action, Place(1, 1)), dict(zip(syncs, times, strict=True))))
    return Timeline(Block("bml1", tuple(one.behaviour for one in timed)), tuple(timed))


def stays(behaviour: Behaviour) -> bool:
    action = behaviour.action
    rest = (
        isinstance(action, Gesture) and (match := BUILTIN_LEXICON.find(action.lexeme)) is not None and match.form.rest
    )
    return rest or isinstance(action, HeadDirectionShift) or getattr(action, "shift", False)


def performed(timeline: Timeline, style: Style) -> KeyFrames:
    return make_keyframes(timeline, BlockContext(timeline.block, Context(style, BUILTIN_LEXICON, HAND_PACE)))


def same(a: Hand, b: Hand) -> bool:
    if a.reach is None or b.reach is None:
        return a.reach is b.reach
    return np.array_equal(a.reach.position, b.reach.position)


@examples(100)
@given(timelines(), styles)
def test_each_sync_point_of_a_moving_behaviour_has_a_key_frame(timeline, style):
    result = performed(timeline, style)
    on = {sync: frame.time for frame in result.frames for sync in frame.syncs}
    asked, moved = (
        {
            (timed.behaviour.id, sync): time
            for timed in of.timed
            if result.uses[timed.behaviour.id]
            for sync, time in timed.times.items()
        }
        for of in (timeline, result.timeline)
    )
    still = {id for id, outcome in result.outcomes.items() if "upright head" in outcome.why}
    again = {(id, sync) for id, sync in asked if id in still and sync.startswith("stroke:")}
    assert set(on) == set(moved) == set(asked) - again
    assert sum(len(frame.syncs) for frame in result.frames) == len(moved)
    strokes = sorted(time for (_, sync), time in moved.items() if sync.partition(":")[0] == "stroke")
    for (behaviour, sync), time in moved.items():
        assert abs(on[behaviour, sync] - time) < SAME_FRAME
        if sync == "stroke" and not any(0 < abs(other - time) < 2 * SAME_FRAME for other in strokes):
            assert on[behaviour, sync] == time
    for (behaviour, sync), time in asked.items():  # Gestures that another stroke of the same hand displaces
        later = moved[behaviour, sync] - time
        assert (
            later == 0.0
            or (later > 0.0 and sync == "strokeStart")
            or (later < 0.0 and (sync in ("strokeEnd", "relax", "end") or sync.startswith("stroke:")))
        )


@examples(100)
@given(timelines(), styles)
def test_key_frames_contain_all_body_parts_keep_a_minimum_gap_and_start_at_rest(timeline, style):
    result = performed(timeline, style)
    assert set(result.outcomes) == {behaviour.id for behaviour in timeline.block.behaviours}
    assert set(result.uses) == set(result.outcomes)
    for frame in result.frames:
        assert set(frame.hands) == set(SIDES)
        assert frame.given <= BODY_PARTS
    assert all(b.time - a.time >= SAME_FRAME - 1e-9 for a, b in pairwise(result.frames))
    if result.frames:
        first = result.frames[0]
        assert all(first.hands[side].reach is None for side in SIDES)
        assert vars(first.head) == vars(first.torso) == {"torsion": 0, "tilt": 0, "roll": 0}
        if not any(stays(behaviour) for behaviour in timeline.block.behaviours):
            last = result.frames[-1]
            assert all(last.hands[side].reach is None for side in SIDES)
            assert max(map(abs, (*vars(last.head).values(), *vars(last.torso).values()))) < 1e-9
    for id, outcome in result.outcomes.items():
        if outcome.kind == "dropped":
            assert outcome.why
            assert not result.uses[id]
            assert any(notice.id == f"bml1:{id}" for notice in result.notices)


@examples(50)
@given(timelines(), styles)
def test_key_frames_of_a_timeline_are_deterministic(timeline, style):
    first, second = performed(timeline, style), performed(timeline, style)
    assert [frame.time for frame in first.frames] == [frame.time for frame in second.frames]
    for a, b in zip(first.frames, second.frames, strict=True):
        assert (a.torso, a.head, a.given, a.syncs) == (b.torso, b.head, b.given, b.syncs)
        assert all(same(a.hands[side], b.hands[side]) for side in SIDES)
    assert first.outcomes == second.outcomes
    assert first.notices == second.notices


@examples(60)
@given(st.sampled_from([form for form in BUILTIN_LEXICON.forms if len(form.sides) == 1]), manners)
def test_left_handed_poses_mirror_right_handed_poses(form, manner):
    flip = np.array([1.0, -1.0, 1.0])
    left = poses(in_mode(form, "left"), ROBOT, manner).hands["l"]
    right = poses(in_mode(form, "right"), ROBOT, manner).hands["r"]
    for here, there in zip(left, right, strict=True):
        np.testing.assert_allclose(here.reach.position, there.reach.position * flip, atol=1e-12)
        assert (here.openness, here.effort) == (there.openness, there.effort)
        for a, b in ((here.reach.palm, there.reach.palm), (here.reach.pointing, there.reach.pointing)):
            assert (a is None) == (b is None)
            if a is not None:
                np.testing.assert_allclose(a, b * flip, atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(st.sampled_from([form.id for form in BUILTIN_LEXICON.forms if not form.rest]), styles)
def test_left_handed_gesture_mode_mirrors_the_right_handed_mode(lexeme, style):
    times = dict(zip(GESTURE_SYNCS, (0.0, 0.6, 0.6, 1.0, 1.2, 1.4, 2.0), strict=True))
    rows = []
    for mode in ("left", "right"):
        behaviour = Behaviour("g", "gesture", Gesture(lexeme, mode), Place(1, 1))
        rows.append(performed(Timeline(Block("bml1", (behaviour,)), (TimedBehaviour(behaviour, times),)), style).frames)
    if len(BUILTIN_LEXICON.find(lexeme).form.sides) == 2:
        return  # The hands of a form may differ
    for left, right in zip(*rows, strict=True):
        assert left.time == right.time
        a, b = left.hands["l"].reach, right.hands["r"].reach
        assert (a is None) == (b is None)
        if a is not None:
            assert a.position == pytest.approx(b.position * [1, -1, 1], abs=1e-12)


def test_resting_hands_are_mirror_images():
    rest = resting_hands(ROBOT)
    assert rest["l"].position == pytest.approx(rest["r"].position * [1, -1, 1])
    assert mirror_form(mirror_form(BUILTIN_LEXICON.forms[0])).sides == BUILTIN_LEXICON.forms[0].sides
