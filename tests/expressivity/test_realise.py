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
from kinesic.expressivity.durations import natural_durations
from kinesic.expressivity.keyframes import Outcome
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.style.pace import Pace


@pytest.fixture
def beat(phases):
    return phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 1.8)


def at(frames, time):
    return next(frame for frame in frames.frames if frame.time == time)


def test_block_with_only_a_wait_has_no_key_frames(perform):
    frames = perform(("w", Wait(1.0), {"start": 0.0, "end": 1.0}))
    assert frames.frames == ()
    assert frames.outcomes["w"].kind == "realised"
    assert frames.uses["w"] == frozenset()


def test_empty_block_has_no_key_frames(perform):
    frames = perform()
    assert frames.frames == ()
    assert frames.outcomes == {}


def test_hand_begins_and_ends_a_gesture_at_rest(perform, beat):
    frames = perform(("g", Gesture("beat", "right"), beat))
    assert frames.outcomes["g"].kind == "realised"
    assert frames.uses["g"] == {"r_hand"}
    assert frames.frames[0].hands["r"].reach is None
    assert frames.frames[-1].hands["r"].reach is None
    assert at(frames, 1.0).syncs == (("g", "stroke"), ("g", "strokeEnd"))
    assert at(frames, 1.0).hands["r"].reach is not None


def test_gesture_substitution_is_reported(perform, beat):
    frames = perform(("g", Gesture("hello_low_Ges_R"), beat))
    assert frames.outcomes["g"].kind == "substituted"
    assert frames.outcomes["g"].why == 'substituted by greet_wave: "low" is left out'
    assert {notice.id for notice in frames.notices} == {"bml1:g"}


def test_gesture_that_indicates_a_side_is_dropped_instead_of_mirrored_if_its_hand_is_busy(perform, beat):
    for first, second in (("IndicateLeft_L", "left"), ("IndicateRight_R", "right")):
        frames = perform(("a", Gesture("stop", second), beat), ("g", Gesture(first), beat))
        assert frames.outcomes["g"].kind == "dropped"
        assert frames.uses["g"] == frozenset()


def test_beat_is_dropped_for_a_more_important_gesture_in_either_order(perform, beat):
    first, second = Gesture("beat", "both"), Gesture("offer", "both")
    later = {sync: time + 0.05 for sync, time in beat.items()}
    outcomes = perform(("a", first, beat), ("g", second, later)).outcomes
    assert {id: outcome.kind for id, outcome in outcomes.items()} == {"a": "dropped", "g": "realised"}
    assert "gives way to g, which is more important" in outcomes["a"].why
    outcomes = perform(("a", second, beat), ("g", first, later)).outcomes
    assert {id: outcome.kind for id, outcome in outcomes.items()} == {"a": "realised", "g": "dropped"}


def test_gesture_found_by_a_synonym_is_realised_with_a_remark(perform, beat):
    frames = perform(("g", Gesture("hello_Ges_R"), beat))
    assert frames.outcomes["g"] == Outcome("realised", "a synonym of greet_wave")
    assert NoticeType.CANNOT_CREATE_BEHAVIOR not in {notice.type for notice in frames.notices}


@pytest.mark.parametrize(
    ("lexeme", "outcome"),
    [
        ("horns", Outcome("partly", 'hand shape "horns" needs fingers')),
        ("rock_on", Outcome("partly", 'hand shape "horns" needs fingers; a synonym of horns')),
        ("thumb_up", Outcome("substituted", "thumb_up needs fingers; allright is performed instead")),
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
def test_hand_shape_that_needs_fingers_is_reported_on_a_robot_without_fingers(perform, beat, lexeme, outcome):
    frames = perform(("g", Gesture(lexeme), beat))
    assert frames.outcomes["g"] == outcome
    said = {"partly": f"partly: {outcome.why}", "substituted": outcome.why}.get(outcome.kind)
    assert [notice.text for notice in frames.notices] == ([said] if said else [])


def test_finger_motion_that_needs_fingers_is_reported_on_a_robot_without_fingers(perform, beat):
    outcome = perform(("g", Gesture("piano"), beat)).outcomes["g"]
    assert outcome == Outcome("partly", 'finger motion "typing" needs fingers')


def test_unknown_gesture_is_dropped_and_named(perform, beat):
    frames = perform(("g", Gesture("xyzzy"), beat))
    assert frames.outcomes["g"].kind == "dropped"
    assert "xyzzy" in frames.outcomes["g"].why
    assert "`kinesic gestures list` shows" in frames.outcomes["g"].why
    assert [notice.id for notice in frames.notices] == ["bml1:g"]


def test_gesture_without_a_free_hand_is_dropped_with_a_notice(perform, beat, phases):
    frames = perform(
        ("g1", Gesture("large", "both"), beat), ("g2", Gesture("large"), phases(0.2, 0.8, 0.8, 1.1, 1.3, 1.4, 2))
    )
    assert frames.outcomes["g2"].kind == "dropped"
    assert [(notice.type, notice.id) for notice in frames.notices] == [(NoticeType.IMPOSSIBLE_TO_SCHEDULE, "bml1:g2")]
    assert not any("g2" in sync for frame in frames.frames for sync in frame.syncs)


def test_overlapping_gesture_moves_to_the_free_hand(perform, beat, phases):
    frames = perform(("g1", Gesture("beat"), beat), ("g2", Gesture("beat"), phases(0.2, 0.8, 0.8, 1.3, 1.3, 1.4, 2)))
    assert frames.outcomes["g2"].kind == "substituted"
    assert [notice.type for notice in frames.notices] == [NoticeType.CANNOT_CREATE_BEHAVIOR], "it has its time"
    assert frames.uses == {"g1": {"r_hand"}, "g2": {"l_hand"}}


def test_gesture_with_a_given_hand_is_not_moved_to_the_free_hand(perform, beat, phases):
    times = phases(0.2, 0.8, 0.8, 1.1, 1.3, 1.4, 2)
    frames = perform(("g1", Gesture("beat"), beat), ("g2", Gesture("beat", "right"), times))
    assert frames.outcomes["g2"].kind == "dropped"


def test_pointing_uses_the_hand_on_the_target_side(perform, beat):
    assert perform(("p", Pointing("left"), beat)).uses["p"] == {"l_hand"}
    assert perform(("p", Pointing("right"), beat)).uses["p"] == {"r_hand"}
    assert perform(("p", Pointing("right", "left"), beat)).uses["p"] == {"l_hand"}
    assert perform(("p", Pointing("1 0 1", "both"), beat)).uses["p"] == {"l_hand", "r_hand"}


def test_pointing_at_unknown_target_is_dropped(perform, beat):
    frames = perform(("p", Pointing("rihgt"), beat))
    assert frames.outcomes["p"].kind == "dropped"
    assert [notice.type for notice in frames.notices] == [NoticeType.NO_SUCH_TARGET]
    assert "did you mean right?" in frames.outcomes["p"].why


def test_user_target_replaces_robot_target_for_pointing(timeline, context, beat):
    built = timeline(("p", Pointing("left"), beat))
    targets = {"left": np.array([1.0, -1.0, 1.0])}
    frames = make_keyframes(built, context(built.block, targets=targets))
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
def test_unsupported_behaviour_is_dropped(perform, action, type):
    frames = perform(("b", action, {"start": 0.0, "end": 1.0}))
    assert frames.outcomes["b"].kind == "dropped"
    assert [notice.type for notice in frames.notices] == [type]


def test_facial_expression_moves_no_joint(perform):
    times = {"start": 0.0, "attackPeak": 0.3, "relax": 1.0, "end": 1.5}
    frames = perform(("b", Face(("RAISE_BROWS",)), times), ("c", Face(("joy", "Qwrtz")), times))
    assert frames.outcomes["b"].kind == "realised"
    assert frames.outcomes["c"].kind == "substituted"
    assert frames.uses["b"] == frozenset()
    assert [notice.id for notice in frames.notices] == ["bml1:c"]
    assert frames.frames == ()


@pytest.mark.parametrize("amount", [1.5, -0.1])
def test_out_of_range_face_amount_is_clipped_with_warning(perform, amount):
    times = {"start": 0.0, "attackPeak": 0.3, "relax": 1.0, "end": 1.5}
    frames = perform(("b", Face(action_unit=12, amount=amount), times))
    assert frames.outcomes["b"].kind == "realised"
    assert [notice.text for notice in frames.notices] == [f"amount {amount:g} is cut to the range from 0 to 1"]


def test_dropped_required_behaviour_refuses_the_block(perform, beat):
    with pytest.raises(BmlError, match=r"<text>:1:1: Gesture g is required .* xyzzy"):
        perform(("g", Gesture("xyzzy"), beat), required=("g",))


def test_speech_behaviour_moves_no_joint(perform):
    frames = perform(("s", Speech(Script("Hello.")), {"start": 0.0, "end": 1.0}))
    assert frames.outcomes["s"].kind == "realised"
    assert frames.frames == ()


def test_dropped_and_realised_behaviours_both_have_an_outcome(timeline, context, beat):
    built = timeline(("g", Gesture("beat"), beat), ("h", Head("NOD"), beat))
    late = replace(built, timed=built.timed[:1], dropped=(Drop(built.timed[1].behaviour, "no time"),))
    frames = make_keyframes(late, context(built.block))
    assert frames.outcomes["h"].kind == "dropped"
    assert frames.outcomes["h"].why == "no time"
    assert set(frames.outcomes) == {"g", "h"}


def test_behaviour_excluded_from_a_block_is_reported_as_dropped_with_the_given_reason(perform, beat):
    frames = perform(("g", Gesture("beat"), beat), ("h", Head("NOD"), beat), without={"g": "it would touch the head"})
    assert frames.outcomes["g"].kind == "dropped"
    assert frames.outcomes["g"].why == "it would touch the head"
    assert frames.uses == {"g": frozenset(), "h": {"head"}}
    assert any("touch the head" in notice.text for notice in frames.notices)


def test_document_expressivity_overrides_style(timeline, context, beat):
    built = timeline(("g", Gesture("large"), beat))
    wide = replace(built.timed[0].behaviour, manner=Manner(spatial=1.0))
    usual = make_keyframes(built, context(built.block))
    widened = make_keyframes(
        replace(built, timed=(replace(built.timed[0], behaviour=wide),)),
        context(replace(built.block, behaviours=(wide,))),
    )
    stroke = [at(frames, 1.0).hands["l"].reach.position[1] for frames in (usual, widened)]
    assert stroke[1] > stroke[0] + 0.05


def test_hand_head_and_torso_behaviours_of_a_block_move_at_the_same_time(perform, beat):
    frames = perform(
        ("g", Gesture("large"), beat),
        ("h", Head("NOD"), beat),
        ("t", Torso("BodyLean"), beat),
        ("z", Gaze("left"), {"start": 0.0, "ready": 0.5, "relax": 1.5, "end": 2.0}),
    )
    assert frames.notices == ()
    assert {part for parts in frames.uses.values() for part in parts} == {"head", "torso", "l_hand", "r_hand"}
    assert at(frames, 1.0).given == {"head", "l_hand", "r_hand"}


def test_head_torso_and_gaze_behaviours_are_dropped_on_a_robot_without_neck_and_torso(
    timeline, robot, context, limits, beat
):
    arms = replace(robot, chains={name: robot.chains[name] for name in ("l_arm", "r_arm")})
    built = timeline(
        ("g", Gesture("beat"), beat),
        ("h", Head("NOD"), beat),
        ("t", Torso("BodyLean"), beat),
        ("z", Gaze("left"), {"start": 0.0, "ready": 0.5, "relax": 1.5, "end": 2.0}),
    )
    here = context(built.block, pace=Pace(arms, limits(arms)))
    assert set(natural_durations(here)) >= {"g"}
    frames = make_keyframes(built, here)
    assert {id: outcome.kind for id, outcome in frames.outcomes.items()} == {
        "g": "realised",
        "h": "dropped",
        "t": "dropped",
        "z": "dropped",
    }
    assert {notice.type for notice in frames.notices} == {NoticeType.BEHAVIOR_TYPE_NOT_SUPPORTED}


def test_deictic_gesture_with_target_points_at_it(perform, beat):
    pointed, aimed = (perform(("g", action, beat)) for action in (Pointing("left"), Gesture("you", target="left")))
    hands = [next(f for f in item.frames if ("g", "stroke") in f.syncs).hands["l"] for item in (pointed, aimed)]
    np.testing.assert_array_equal(hands[0].reach.position, hands[1].reach.position)
    assert hands[1].aim is not None


@pytest.mark.parametrize(
    ("action", "outcome", "shapes"),
    [
        (Gesture("this_index", target="left"), Outcome("partly", 'hand shape "index" needs fingers'), ("index",)),
        (Gesture("you", target="left"), Outcome("realised"), ()),
        (Pointing("left"), Outcome("realised"), ()),
    ],
)
def test_robot_without_fingers_points_partly_only_if_the_index_finger_is_requested(
    perform, beat, action, outcome, shapes
):
    frames = perform(("g", action, beat))
    assert frames.outcomes["g"] == outcome
    assert frames.shapes.get("g", ()) == shapes


@pytest.mark.parametrize(
    ("lexeme", "target", "text"), [("you", "nowhere", "no target nowhere"), ("beat", "left", "is not deictic")]
)
def test_ignored_gesture_target_is_reported(perform, beat, lexeme, target, text):
    performance = perform(("g", Gesture(lexeme, target=target), beat))
    assert performance.outcomes["g"].kind == "realised"
    assert any(text in notice.text for notice in performance.notices)
