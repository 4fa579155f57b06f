from itertools import pairwise
from math import radians

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.gather import BODY_PARTS, PART_PRIORITIES, SAME_FRAME, Sequences, SyncPoint, gather_frames
from kinesic.expressivity.hands.keys import HandKey
from kinesic.expressivity.hands.poses import REST_HAND
from kinesic.expressivity.keyframes import Hand, Turn
from kinesic.expressivity.turns import TurnKey
from kinesic.motion.keys import KeyPassage

A, B = Hand(Reach(sealed([0.2, 0.2, 0.8]))), Hand(Reach(sealed([0.4, 0.2, 0.8])))
HAND_KEYS = {"l": (HandKey(0.0, REST_HAND), HandKey(1.0, A), HandKey(2.0, B), HandKey(3.0, REST_HAND))}
NOD_LAYERS = ((TurnKey(1.5, Turn()), TurnKey(1.75, Turn(tilt=0.2)), TurnKey(2.5, Turn())),)


def test_every_key_frame_has_both_hands_and_records_the_body_parts_with_a_key(robot):
    frames = gather_frames(Sequences(head=NOD_LAYERS, hands=HAND_KEYS), [], robot)
    assert [frame.time for frame in frames] == [0, 1, 1.5, 1.75, 2, 2.5, 3]
    for frame in frames:
        assert set(frame.hands) == {"l", "r"}
    assert [sorted(frame.given) for frame in frames] == [
        ["l_hand"],
        ["l_hand"],
        ["head"],
        ["head"],
        ["l_hand"],
        ["head"],
        ["l_hand"],
    ]


def test_body_parts_without_a_key_are_interpolated(robot):
    frames = {frame.time: frame for frame in gather_frames(Sequences(head=NOD_LAYERS, hands=HAND_KEYS), [], robot)}
    np.testing.assert_allclose(frames[1.5].hands["l"].reach.position, [0.3, 0.2, 0.8])
    assert frames[2].head.tilt == pytest.approx(0.2 * 20 / 27)
    assert frames[1.75].hands["r"] == REST_HAND


def test_rotation_layers_of_head_or_torso_are_added_and_clipped_to_the_joint_range(robot):
    lean = ((TurnKey(0, Turn()), TurnKey(1, Turn(tilt=radians(20))), TurnKey(2, Turn())),) * 2
    frames = gather_frames(Sequences(torso=lean), [], robot)
    assert frames[1].torso.tilt == pytest.approx(radians(35))


def test_rotation_range_of_the_neck_is_relative_to_the_torso(robot):
    turned = ((TurnKey(0, Turn()), TurnKey(1, Turn(torsion=radians(40))), TurnKey(2, Turn())),)
    aside = ((TurnKey(0, Turn()), TurnKey(1, Turn(torsion=radians(100))), TurnKey(2, Turn())),)
    assert gather_frames(Sequences(torso=turned, head=aside), [], robot)[1].head.torsion == pytest.approx(radians(100))
    assert gather_frames(Sequences(head=aside), [], robot)[1].head.torsion == pytest.approx(radians(75))


def test_head_key_close_to_a_hand_stroke_merges_into_the_key_frame_of_the_stroke(robot):
    nod = ((TurnKey(0.995, Turn()), TurnKey(1.4, Turn(tilt=0.2)), TurnKey(3.0, Turn())),)
    syncs = [SyncPoint(1.0, "g", "stroke"), SyncPoint(0.995, "h", "start"), SyncPoint(1.0, "g", "strokeEnd")]
    frames = gather_frames(Sequences(head=nod, hands=HAND_KEYS), syncs, robot)
    shared = next(frame for frame in frames if frame.time == 1.0)
    assert shared.syncs == (("h", "start"), ("g", "stroke"), ("g", "strokeEnd"))
    assert shared.given == {"head", "l_hand"}
    assert shared.hands["l"] is A
    assert all(b.time - a.time >= 0.01 for a, b in pairwise(frames))


def test_key_frame_of_a_stroke_at_time_zero_is_kept(robot):
    hands = {"l": (HandKey(-0.5, REST_HAND), HandKey(0.0, A), HandKey(1.0, REST_HAND))}
    nod = ((TurnKey(-0.008, Turn()), TurnKey(0.3, Turn(tilt=0.2)), TurnKey(0.6, Turn())),)
    frames = gather_frames(Sequences(head=nod, hands=hands), [SyncPoint(0.0, "g", "stroke")], robot)
    assert [frame.time for frame in frames] == [-0.5, 0.0, 0.3, 0.6, 1.0]


def test_sync_point_at_which_no_body_part_has_a_key_gets_a_key_frame(robot):
    frames = gather_frames(Sequences(hands=HAND_KEYS), [SyncPoint(2.2, "g", "relax")], robot)
    frame = next(frame for frame in frames if frame.time == 2.2)
    assert frame.given == frozenset()
    assert frame.syncs == (("g", "relax"),)


def test_first_and_last_key_frame_stay_at_rest_when_keys_merge(robot):
    nod = ((TurnKey(0.01, Turn()), TurnKey(1.5, Turn(tilt=0.2)), TurnKey(3.01, Turn())),)
    frames = gather_frames(Sequences(head=nod, hands=HAND_KEYS), [], robot)
    for frame in (frames[0], frames[-1]):
        assert frame.head == Turn()
        assert frame.hands["l"] is REST_HAND


def test_block_without_any_keys_has_no_key_frames(robot):
    assert gather_frames(Sequences(hands={"l": (), "r": ()}), [], robot) == ()


LEAN_LAYERS = ((TurnKey(0.5, Turn()), TurnKey(1.5, Turn(tilt=0.1)), TurnKey(2.75, Turn())),)
LAZY_PRIORITIES = PART_PRIORITIES["lazy"]
ALL_SEQUENCES = Sequences(torso=LEAN_LAYERS, head=NOD_LAYERS, hands=HAND_KEYS)


def defined_parts(frames):
    return {frame.time: sorted(frame.posed_parts) for frame in frames}


def test_complex_gathering_defines_every_body_part_at_every_key_frame(robot):
    assert set(map(tuple, defined_parts(gather_frames(ALL_SEQUENCES, [], robot)).values())) == {
        tuple(sorted(BODY_PARTS))
    }


def test_lazy_gathering_defines_only_body_parts_of_at_least_the_priority_of_the_key(robot):
    frames = defined_parts(gather_frames(ALL_SEQUENCES, [], robot, LAZY_PRIORITIES))
    assert frames[2] == ["l_hand", "r_hand"]  # Hand key: torso and head are free
    assert frames[0.5] == ["l_hand", "r_hand", "torso"]  # Torso key: hands keep their world position
    assert frames[1.75] == sorted(BODY_PARTS)  # Head key only, with the lowest priority


def test_lazy_gathering_holds_lower_priority_body_parts_at_their_last_key(robot):
    frames = {frame.time: frame for frame in gather_frames(ALL_SEQUENCES, [], robot, LAZY_PRIORITIES)}
    assert frames[2].head.tilt == pytest.approx(0.2)  # Its key at 1.75 s
    assert frames[2].torso.tilt == pytest.approx(0.1)
    halfway = {frame.time: frame for frame in gather_frames(ALL_SEQUENCES, [], robot)}[2]
    assert 0.1 < halfway.head.tilt < 0.2
    assert 0.0 < halfway.torso.tilt < 0.1


def test_priorities_of_body_parts_in_lazy_gathering_are_configurable(robot):
    frames = defined_parts(gather_frames(ALL_SEQUENCES, [], robot, LAZY_PRIORITIES | {"head": 2.0}))
    assert frames[1.75] == ["head"]
    assert frames[2] == ["head", "l_hand", "r_hand"]


def test_lazy_gathering_with_equal_priorities_equals_complex_gathering(robot):
    lazy, complete = (
        gather_frames(ALL_SEQUENCES, [], robot, dict.fromkeys(BODY_PARTS, 0.5)),
        gather_frames(ALL_SEQUENCES, [], robot),
    )
    for one, other in zip(lazy, complete, strict=True):
        assert (one.time, one.torso, one.head, one.given, one.filled) == (
            (other.time, other.torso, other.head, other.given, other.filled)
        )
        for side in ("l", "r"):
            reaches = one.hands[side].reach, other.hands[side].reach
            assert (reaches[0] is None) == (reaches[1] is None)
            if reaches[0] is not None:
                np.testing.assert_array_equal(reaches[0].position, reaches[1].position)


def test_lazy_and_complex_gathering_give_key_frames_of_equal_times_and_keyed_parts(robot):
    lazy, complete = gather_frames(ALL_SEQUENCES, [], robot, LAZY_PRIORITIES), gather_frames(ALL_SEQUENCES, [], robot)
    assert [(frame.time, frame.given) for frame in lazy] == [(frame.time, frame.given) for frame in complete]


def test_key_frames_contain_the_spline_parameters_of_their_keys(robot):
    stiff = KeyPassage(tension=0.7)
    hands = {"l": (HandKey(0.0, REST_HAND), HandKey(1.0, A, stiff), HandKey(2.0, REST_HAND))}
    nod = ((TurnKey(0.0, Turn()), TurnKey(1.0, Turn(tilt=0.2), KeyPassage(bias=0.3)), TurnKey(1.5, Turn())),)
    frames = {frame.time: frame for frame in gather_frames(Sequences(head=nod, hands=hands), [], robot)}
    assert frames[1].passages == {"l_hand": stiff, "head": KeyPassage(bias=0.3)}
    assert set(frames[1.5].passages) == {"head"}


def test_head_key_between_two_strokes_merges_into_the_nearer_key_frame(robot):
    first, second = 1.0, 1.0 + 1.5 * SAME_FRAME
    for near, other in ((first, second), (second, first)):
        nod = ((TurnKey(0.5, Turn()), TurnKey(0.6 * near + 0.4 * other, Turn(tilt=0.2)), TurnKey(2.0, Turn())),)
        syncs = [SyncPoint(time, id, "stroke") for time, id in ((first, "g"), (second, "h"))]
        frames = {frame.time: frame for frame in gather_frames(Sequences(head=nod), syncs, robot)}
        assert (frames[near].given, frames[other].given) == ({"head"}, set())


def test_hands_without_a_path_have_no_path_points_in_their_key_frames(robot):
    frames = gather_frames(Sequences(head=NOD_LAYERS, hands=HAND_KEYS), [], robot)
    assert not any(hand.passing for frame in frames for hand in frame.hands.values())
