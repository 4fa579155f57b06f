from itertools import pairwise
from math import radians

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.gather import PARTS, PRIORITIES, SAME_FRAME, Sequences, SyncPoint, gather_frames
from kinesic.expressivity.hands.keys import HandKey
from kinesic.expressivity.hands.poses import REST
from kinesic.expressivity.keyframes import Hand, Turn
from kinesic.expressivity.turns import TurnKey
from kinesic.motion.keys import KeyPassage

A, B = Hand(Reach(sealed([0.2, 0.2, 0.8]))), Hand(Reach(sealed([0.4, 0.2, 0.8])))
HANDS = {"l": (HandKey(0.0, REST), HandKey(1.0, A), HandKey(2.0, B), HandKey(3.0, REST))}
NOD = ((TurnKey(1.5, Turn()), TurnKey(1.75, Turn(tilt=0.2)), TurnKey(2.5, Turn())),)


def test_every_frame_has_all_parts(robot):
    frames = gather_frames(Sequences(head=NOD, hands=HANDS), [], robot)
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


def test_what_is_not_given_is_interpolated_between_its_own_neighbours(robot):
    frames = {frame.time: frame for frame in gather_frames(Sequences(head=NOD, hands=HANDS), [], robot)}
    np.testing.assert_allclose(frames[1.5].hands["l"].reach.position, [0.3, 0.2, 0.8])
    assert frames[2].head.tilt == pytest.approx(0.2 * 2 / 3)
    assert frames[1.75].hands["r"] == REST


def test_layers_add_up_inside_the_range(robot):
    lean = ((TurnKey(0, Turn()), TurnKey(1, Turn(tilt=radians(20))), TurnKey(2, Turn())),) * 2
    frames = gather_frames(Sequences(torso=lean), [], robot)
    assert frames[1].torso.tilt == pytest.approx(radians(35))


def test_the_head_is_bound_by_the_neck_on_the_torso(robot):
    turned = ((TurnKey(0, Turn()), TurnKey(1, Turn(torsion=radians(40))), TurnKey(2, Turn())),)
    aside = ((TurnKey(0, Turn()), TurnKey(1, Turn(torsion=radians(100))), TurnKey(2, Turn())),)
    assert gather_frames(Sequences(torso=turned, head=aside), [], robot)[1].head.torsion == pytest.approx(radians(100))
    assert gather_frames(Sequences(head=aside), [], robot)[1].head.torsion == pytest.approx(radians(75))


def test_near_keys_share_the_frame_of_the_stroke(robot):
    nod = ((TurnKey(0.995, Turn()), TurnKey(1.4, Turn(tilt=0.2)), TurnKey(3.0, Turn())),)
    syncs = [SyncPoint(1.0, "g", "stroke"), SyncPoint(0.995, "h", "start"), SyncPoint(1.0, "g", "strokeEnd")]
    frames = gather_frames(Sequences(head=nod, hands=HANDS), syncs, robot)
    shared = next(frame for frame in frames if frame.time == 1.0)
    assert shared.syncs == (("h", "start"), ("g", "stroke"), ("g", "strokeEnd"))
    assert shared.given == {"head", "l_hand"}
    assert shared.hands["l"] is A
    assert all(b.time - a.time >= 0.01 for a, b in pairwise(frames))


def test_a_stroke_at_zero_is_a_stroke(robot):
    hands = {"l": (HandKey(-0.5, REST), HandKey(0.0, A), HandKey(1.0, REST))}
    nod = ((TurnKey(-0.008, Turn()), TurnKey(0.3, Turn(tilt=0.2)), TurnKey(0.6, Turn())),)
    frames = gather_frames(Sequences(head=nod, hands=hands), [SyncPoint(0.0, "g", "stroke")], robot)
    assert [frame.time for frame in frames] == [-0.5, 0.0, 0.3, 0.6, 1.0]


def test_a_sync_point_without_a_key_has_a_frame(robot):
    frames = gather_frames(Sequences(hands=HANDS), [SyncPoint(2.2, "g", "relax")], robot)
    frame = next(frame for frame in frames if frame.time == 2.2)
    assert frame.given == frozenset()
    assert frame.syncs == (("g", "relax"),)


def test_ends_are_at_rest_even_when_keys_merge(robot):
    nod = ((TurnKey(0.01, Turn()), TurnKey(1.5, Turn(tilt=0.2)), TurnKey(3.01, Turn())),)
    frames = gather_frames(Sequences(head=nod, hands=HANDS), [], robot)
    for frame in (frames[0], frames[-1]):
        assert frame.head == Turn()
        assert frame.hands["l"] is REST


def test_nothing_gathers_to_nothing(robot):
    assert gather_frames(Sequences(hands={"l": (), "r": ()}), [], robot) == ()


LEAN = ((TurnKey(0.5, Turn()), TurnKey(1.5, Turn(tilt=0.1)), TurnKey(2.75, Turn())),)
LAZY = PRIORITIES["lazy"]
ALL = Sequences(torso=LEAN, head=NOD, hands=HANDS)


def known(frames):
    return {frame.time: sorted(frame.known) for frame in frames}


def test_complex_fills_every_part_of_every_frame(robot):
    assert set(map(tuple, known(gather_frames(ALL, [], robot)).values())) == {tuple(sorted(PARTS))}


def test_lazy_fills_only_what_is_as_important_as_what_moves(robot):
    frames = known(gather_frames(ALL, [], robot, LAZY))
    assert frames[2] == ["l_hand", "r_hand"]  # a hand has a key: torso and head go along
    assert frames[0.5] == ["l_hand", "r_hand", "torso"]  # the torso has one: hands stay where they are in the world
    assert frames[1.75] == sorted(PARTS)  # only the head has one, which counts least


def test_lazy_leaves_the_rest_at_its_last_key(robot):
    frames = {frame.time: frame for frame in gather_frames(ALL, [], robot, LAZY)}
    assert frames[2].head.tilt == pytest.approx(0.2)  # its key at 1.75 s
    assert frames[2].torso.tilt == pytest.approx(0.1)
    halfway = {frame.time: frame for frame in gather_frames(ALL, [], robot)}[2]
    assert 0.1 < halfway.head.tilt < 0.2
    assert 0.0 < halfway.torso.tilt < 0.1


def test_who_counts_most_is_a_setting(robot):
    frames = known(gather_frames(ALL, [], robot, LAZY | {"head": 2.0}))
    assert frames[1.75] == ["head"]
    assert frames[2] == ["head", "l_hand", "r_hand"]


def test_lazy_with_equal_priorities_is_complex(robot):
    lazy, complete = gather_frames(ALL, [], robot, dict.fromkeys(PARTS, 0.5)), gather_frames(ALL, [], robot)
    for one, other in zip(lazy, complete, strict=True):
        assert (one.time, one.torso, one.head, one.given, one.filled) == (
            (other.time, other.torso, other.head, other.given, other.filled)
        )
        for side in ("l", "r"):
            reaches = one.hands[side].reach, other.hands[side].reach
            assert (reaches[0] is None) == (reaches[1] is None)
            if reaches[0] is not None:
                np.testing.assert_array_equal(reaches[0].position, reaches[1].position)


def test_both_have_the_same_times_and_keys(robot):
    lazy, complete = gather_frames(ALL, [], robot, LAZY), gather_frames(ALL, [], robot)
    assert [(frame.time, frame.given) for frame in lazy] == [(frame.time, frame.given) for frame in complete]


def test_keys_bring_how_they_are_passed(robot):
    stiff = KeyPassage(tension=0.7)
    hands = {"l": (HandKey(0.0, REST), HandKey(1.0, A, stiff), HandKey(2.0, REST))}
    nod = ((TurnKey(0.0, Turn()), TurnKey(1.0, Turn(tilt=0.2), KeyPassage(bias=0.3)), TurnKey(1.5, Turn())),)
    frames = {frame.time: frame for frame in gather_frames(Sequences(head=nod, hands=hands), [], robot)}
    assert frames[1].passages == {"l_hand": stiff, "head": KeyPassage(bias=0.3)}
    assert set(frames[1.5].passages) == {"head"}


def test_a_key_between_two_strokes_joins_the_nearer_one(robot):
    first, second = 1.0, 1.0 + 1.5 * SAME_FRAME
    for near, other in ((first, second), (second, first)):
        nod = ((TurnKey(0.5, Turn()), TurnKey(0.6 * near + 0.4 * other, Turn(tilt=0.2)), TurnKey(2.0, Turn())),)
        syncs = [SyncPoint(time, id, "stroke") for time, id in ((first, "g"), (second, "h"))]
        frames = {frame.time: frame for frame in gather_frames(Sequences(head=nod), syncs, robot)}
        assert (frames[near].given, frames[other].given) == ({"head"}, set())


def test_hands_without_a_path_are_not_passing_by(robot):
    frames = gather_frames(Sequences(head=NOD, hands=HANDS), [], robot)
    assert not any(hand.passing for frame in frames for hand in frame.hands.values())
