from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.block import (
    BmlError,
    Custom,
    Drop,
    Face,
    Gaze,
    Gesture,
    Head,
    Locomotion,
    Manner,
    NoticeType,
    Pointing,
    Speech,
    Torso,
    Wait,
)
from kinesic.body.utterance import Script
from kinesic.expressivity.durations import spans
from kinesic.expressivity.keyframes import Outcome
from kinesic.expressivity.realise import keyframes
from kinesic.expressivity.style.pace import Pace


@pytest.fixture
def beat(phases):
    return phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 1.8)


def at(frames, time):
    return next(frame for frame in frames.frames if frame.time == time)


def test_a_block_of_waiting_has_no_frames(perform):
    frames = perform(("w", Wait(1.0), {"start": 0.0, "end": 1.0}))
    assert frames.frames == ()
    assert frames.outcomes["w"].kind == "realised"
    assert frames.uses["w"] == frozenset()


def test_an_empty_block_has_no_frames(perform):
    frames = perform()
    assert frames.frames == ()
    assert frames.outcomes == {}


def test_a_gesture_is_realised_between_rest_and_rest(perform, beat):
    frames = perform(("g", Gesture("beat", "right"), beat))
    assert frames.outcomes["g"].kind == "realised"
    assert frames.uses["g"] == {"r_hand"}
    assert frames.frames[0].hands["r"].reach is None
    assert frames.frames[-1].hands["r"].reach is None
    assert at(frames, 1.0).syncs == (("g", "stroke"), ("g", "strokeEnd"))
    assert at(frames, 1.0).hands["r"].reach is not None


def test_a_substitute_says_so(perform, beat):
    frames = perform(("g", Gesture("hello_low_Ges_R"), beat))
    assert frames.outcomes["g"].kind == "substituted"
    assert frames.outcomes["g"].why == 'substituted by greet_wave: "low" is left out'
    assert {notice.id for notice in frames.notices} == {"bml1:g"}


def test_who_leads_to_the_left_with_a_busy_hand_does_not_lead_to_the_right(perform, beat):
    for first, second in (("IndicateLeft_L", "left"), ("IndicateRight_R", "right")):
        frames = perform(("a", Gesture("stop", second), beat), ("g", Gesture(first), beat))
        assert frames.outcomes["g"].kind == "dropped"
        assert frames.uses["g"] == frozenset()


def test_a_beat_gives_way_to_what_says_more_whichever_comes_first(perform, beat):
    first, second = Gesture("beat", "both"), Gesture("offer", "both")
    later = {sync: time + 0.05 for sync, time in beat.items()}
    outcomes = perform(("a", first, beat), ("g", second, later)).outcomes
    assert {id: outcome.kind for id, outcome in outcomes.items()} == {"a": "dropped", "g": "realised"}
    assert "gives way to g, which counts for more" in outcomes["a"].why
    outcomes = perform(("a", second, beat), ("g", first, later)).outcomes
    assert {id: outcome.kind for id, outcome in outcomes.items()} == {"a": "realised", "g": "dropped"}


def test_a_synonym_is_realised_and_named(perform, beat):
    frames = perform(("g", Gesture("hello_Ges_R"), beat))
    assert frames.outcomes["g"] == Outcome("realised", "a synonym of greet_wave")
    assert NoticeType.CANNOT_CREATE_BEHAVIOR not in {notice.type for notice in frames.notices}


@pytest.mark.parametrize(
    ("lexeme", "outcome"),
    [
        ("horns", Outcome("partly", 'hand shape "horns" needs fingers')),
        ("rock_on", Outcome("partly", 'hand shape "horns" needs fingers; a synonym of horns')),
        ("thumb_up", Outcome("substituted", "thumb_up needs fingers; allright is done")),
        ("explode", Outcome("partly", 'hand shapes "fist" and "spread" need fingers')),
        (
            "point",
            Outcome(
                "substituted",
                'substituted by this_index: it stands for its class, point; hand shape "index" needs fingers',
            ),
        ),
        ("stop", Outcome("realised")),
    ],
)
def test_a_hand_shape_that_needs_fingers_is_said_to_be_missing(perform, beat, lexeme, outcome):
    frames = perform(("g", Gesture(lexeme), beat))
    assert frames.outcomes["g"] == outcome
    said = {"partly": f"partly: {outcome.why}", "substituted": outcome.why}.get(outcome.kind)
    assert [notice.text for notice in frames.notices] == ([said] if said else [])


def test_what_the_lexicon_does_not_know_is_dropped_and_named(perform, beat):
    frames = perform(("g", Gesture("xyzzy"), beat))
    assert frames.outcomes["g"].kind == "dropped"
    assert "xyzzy" in frames.outcomes["g"].why
    assert "`kinesic gestures list` shows" in frames.outcomes["g"].why
    assert [notice.id for notice in frames.notices] == ["bml1:g"]


def test_an_overlapping_gesture_is_dropped_with_a_notice(perform, beat, phases):
    frames = perform(
        ("g1", Gesture("large", "both"), beat), ("g2", Gesture("large"), phases(0.2, 0.8, 0.8, 1.1, 1.3, 1.4, 2))
    )
    assert frames.outcomes["g2"].kind == "dropped"
    assert [(notice.type, notice.id) for notice in frames.notices] == [(NoticeType.IMPOSSIBLE_TO_SCHEDULE, "bml1:g2")]
    assert not any("g2" in sync for frame in frames.frames for sync in frame.syncs)


def test_an_overlapping_gesture_moves_to_the_free_hand(perform, beat, phases):
    frames = perform(("g1", Gesture("beat"), beat), ("g2", Gesture("beat"), phases(0.2, 0.8, 0.8, 1.3, 1.3, 1.4, 2)))
    assert frames.outcomes["g2"].kind == "substituted"
    assert [notice.type for notice in frames.notices] == [NoticeType.CANNOT_CREATE_BEHAVIOR], "it has its time"
    assert frames.uses == {"g1": {"r_hand"}, "g2": {"l_hand"}}


def test_a_gesture_whose_mode_is_given_does_not_move(perform, beat, phases):
    times = phases(0.2, 0.8, 0.8, 1.1, 1.3, 1.4, 2)
    frames = perform(("g1", Gesture("beat"), beat), ("g2", Gesture("beat", "right"), times))
    assert frames.outcomes["g2"].kind == "dropped"


def test_pointing_uses_the_hand_on_that_side(perform, beat):
    assert perform(("p", Pointing("left"), beat)).uses["p"] == {"l_hand"}
    assert perform(("p", Pointing("right"), beat)).uses["p"] == {"r_hand"}
    assert perform(("p", Pointing("right", "left"), beat)).uses["p"] == {"l_hand"}
    assert perform(("p", Pointing("1 0 1", "both"), beat)).uses["p"] == {"l_hand", "r_hand"}


def test_pointing_nowhere_is_dropped(perform, beat):
    frames = perform(("p", Pointing("rihgt"), beat))
    assert frames.outcomes["p"].kind == "dropped"
    assert [notice.type for notice in frames.notices] == [NoticeType.NO_SUCH_TARGET]
    assert "did you mean right?" in frames.outcomes["p"].why


def test_targets_of_the_user_go_over_those_of_the_pace(timeline, context, beat):
    built = timeline(("p", Pointing("left"), beat))
    targets = {"left": np.array([1.0, -1.0, 1.0])}
    frames = keyframes(built, context(built.block, targets=targets))
    assert frames.uses["p"] == {"r_hand"}


@pytest.mark.parametrize(
    ("action", "type"),
    [
        (Face(("Qwrtz",)), NoticeType.CANNOT_CREATE_BEHAVIOR),
        (Face(action_unit=99), NoticeType.CANNOT_CREATE_BEHAVIOR),
        (Locomotion("door"), NoticeType.BEHAVIOR_TYPE_NOT_SUPPORTED),
        (Custom("bmlt:breathe"), NoticeType.CUSTOM_BEHAVIOUR_NOT_SUPPORTED),
    ],
)
def test_what_the_robot_cannot_do_is_dropped(perform, action, type):
    frames = perform(("b", action, {"start": 0.0, "end": 1.0}))
    assert frames.outcomes["b"].kind == "dropped"
    assert [notice.type for notice in frames.notices] == [type]


def test_a_face_is_realised_without_a_hinge(perform):
    times = {"start": 0.0, "attackPeak": 0.3, "relax": 1.0, "end": 1.5}
    frames = perform(("b", Face(("RAISE_BROWS",)), times), ("c", Face(("joy", "Qwrtz")), times))
    assert frames.outcomes["b"].kind == "realised"
    assert frames.outcomes["c"].kind == "substituted"
    assert frames.uses["b"] == frozenset()
    assert [notice.id for notice in frames.notices] == ["bml1:c"]
    assert frames.frames == ()


@pytest.mark.parametrize("amount", [1.5, -0.1])
def test_an_intensity_that_no_face_has_is_cut_and_warned(perform, amount):
    times = {"start": 0.0, "attackPeak": 0.3, "relax": 1.0, "end": 1.5}
    frames = perform(("b", Face(action_unit=12, amount=amount), times))
    assert frames.outcomes["b"].kind == "realised"
    assert [notice.text for notice in frames.notices] == [f"amount {amount:g} is cut to the range from 0 to 1"]


def test_a_required_behaviour_that_is_dropped_refuses_the_block(perform, beat):
    with pytest.raises(BmlError, match=r"<text>:1:1: Gesture g is required .* xyzzy"):
        perform(("g", Gesture("xyzzy"), beat), required=("g",))


def test_speech_is_realised_and_moves_nothing(perform):
    frames = perform(("s", Speech(Script("Hello.")), {"start": 0.0, "end": 1.0}))
    assert frames.outcomes["s"].kind == "realised"
    assert frames.frames == ()


def test_every_behaviour_has_an_outcome(timeline, context, beat):
    built = timeline(("g", Gesture("beat"), beat), ("h", Head("NOD"), beat))
    late = replace(built, timed=built.timed[:1], dropped=(Drop(built.timed[1].behaviour, "no time"),))
    frames = keyframes(late, context(built.block))
    assert frames.outcomes["h"].kind == "dropped"
    assert frames.outcomes["h"].why == "no time"
    assert set(frames.outcomes) == {"g", "h"}


def test_behaviours_can_be_left_out(perform, beat):
    frames = perform(("g", Gesture("beat"), beat), ("h", Head("NOD"), beat), without={"g": "it would touch the head"})
    assert frames.outcomes["g"].kind == "dropped"
    assert frames.outcomes["g"].why == "it would touch the head"
    assert frames.uses == {"g": frozenset(), "h": {"head"}}
    assert any("touch the head" in notice.text for notice in frames.notices)


def test_a_documents_manner_goes_over_the_style(timeline, context, beat):
    built = timeline(("g", Gesture("large"), beat))
    wide = replace(built.timed[0].behaviour, manner=Manner(spatial=1.0))
    usual = keyframes(built, context(built.block))
    widened = keyframes(
        replace(built, timed=(replace(built.timed[0], behaviour=wide),)),
        context(replace(built.block, behaviours=(wide,))),
    )
    stroke = [at(frames, 1.0).hands["l"].reach.position[1] for frames in (usual, widened)]
    assert stroke[1] > stroke[0] + 0.05


def test_all_parts_at_once(perform, beat):
    frames = perform(
        ("g", Gesture("large"), beat),
        ("h", Head("NOD"), beat),
        ("t", Torso("BodyLean"), beat),
        ("z", Gaze("left"), {"start": 0.0, "ready": 0.5, "relax": 1.5, "end": 2.0}),
    )
    assert frames.notices == ()
    assert {part for parts in frames.uses.values() for part in parts} == {"head", "torso", "l_hand", "r_hand"}
    assert at(frames, 1.0).given == {"head", "l_hand", "r_hand"}


def test_a_robot_without_neck_and_torso_says_so(timeline, robot, context, limits, beat):
    arms = replace(robot, chains={name: robot.chains[name] for name in ("l_arm", "r_arm")})
    built = timeline(
        ("g", Gesture("beat"), beat),
        ("h", Head("NOD"), beat),
        ("t", Torso("BodyLean"), beat),
        ("z", Gaze("left"), {"start": 0.0, "ready": 0.5, "relax": 1.5, "end": 2.0}),
    )
    here = context(built.block, pace=Pace(arms, limits(arms)))
    assert set(spans(here)) >= {"g"}
    frames = keyframes(built, here)
    assert {id: outcome.kind for id, outcome in frames.outcomes.items()} == {
        "g": "realised",
        "h": "dropped",
        "t": "dropped",
        "z": "dropped",
    }
    assert {notice.type for notice in frames.notices} == {NoticeType.BEHAVIOR_TYPE_NOT_SUPPORTED}


def test_a_deictic_gesture_with_a_target_points_at_it(perform, beat):
    pointed, aimed = (perform(("g", action, beat)) for action in (Pointing("left"), Gesture("you", target="left")))
    hands = [next(f for f in found.frames if ("g", "stroke") in f.syncs).hands["l"] for found in (pointed, aimed)]
    np.testing.assert_array_equal(hands[0].reach.position, hands[1].reach.position)
    assert hands[1].aim is not None


@pytest.mark.parametrize(
    ("lexeme", "target", "text"), [("you", "nowhere", "no target nowhere"), ("beat", "left", "no deictic one")]
)
def test_a_gesture_says_when_it_does_not_meet_its_target(perform, beat, lexeme, target, text):
    found = perform(("g", Gesture(lexeme, target=target), beat))
    assert found.outcomes["g"].kind == "realised"
    assert any(text in notice.text for notice in found.notices)
