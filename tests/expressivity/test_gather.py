from itertools import pairwise
from math import radians

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.gather import Sequences, SyncPoint, gathered
from kinesic.expressivity.hands import REST
from kinesic.expressivity.keyframes import Hand, Turn
from kinesic.expressivity.phases import HandKey
from kinesic.expressivity.turns import TurnKey

A, B = Hand(Reach(sealed([0.2, 0.2, 0.8]))), Hand(Reach(sealed([0.4, 0.2, 0.8])))
HANDS = {"l": (HandKey(0.0, REST), HandKey(1.0, A), HandKey(2.0, B), HandKey(3.0, REST))}
NOD = ((TurnKey(1.5, Turn()), TurnKey(1.75, Turn(tilt=0.2)), TurnKey(2.5, Turn())),)


def test_every_frame_has_all_parts(robot):
    frames = gathered(Sequences(head=NOD, hands=HANDS), [], robot)
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
    frames = {frame.time: frame for frame in gathered(Sequences(head=NOD, hands=HANDS), [], robot)}
    np.testing.assert_allclose(frames[1.5].hands["l"].reach.position, [0.3, 0.2, 0.8])
    assert frames[2].head.tilt == pytest.approx(0.2 * 2 / 3)
    assert frames[1.75].hands["r"] == REST


def test_layers_add_up_inside_the_range(robot):
    lean = ((TurnKey(0, Turn()), TurnKey(1, Turn(tilt=radians(20))), TurnKey(2, Turn())),) * 2
    frames = gathered(Sequences(torso=lean), [], robot)
    assert frames[1].torso.tilt == pytest.approx(radians(35))


def test_the_head_is_bound_by_the_neck_on_the_torso(robot):
    turned = ((TurnKey(0, Turn()), TurnKey(1, Turn(torsion=radians(40))), TurnKey(2, Turn())),)
    aside = ((TurnKey(0, Turn()), TurnKey(1, Turn(torsion=radians(100))), TurnKey(2, Turn())),)
    assert gathered(Sequences(torso=turned, head=aside), [], robot)[1].head.torsion == pytest.approx(radians(100))
    assert gathered(Sequences(head=aside), [], robot)[1].head.torsion == pytest.approx(radians(75))


def test_near_keys_share_the_frame_of_the_stroke(robot):
    nod = ((TurnKey(0.99, Turn()), TurnKey(1.4, Turn(tilt=0.2)), TurnKey(3.0, Turn())),)
    syncs = [SyncPoint(1.0, "g", "stroke"), SyncPoint(0.99, "h", "start"), SyncPoint(1.0, "g", "strokeEnd")]
    frames = gathered(Sequences(head=nod, hands=HANDS), syncs, robot)
    shared = next(frame for frame in frames if frame.time == 1.0)
    assert shared.syncs == (("h", "start"), ("g", "stroke"), ("g", "strokeEnd"))
    assert shared.given == {"head", "l_hand"}
    assert shared.hands["l"] is A
    assert all(b.time - a.time >= 0.02 for a, b in pairwise(frames))


def test_a_stroke_at_zero_is_a_stroke(robot):
    hands = {"l": (HandKey(-0.5, REST), HandKey(0.0, A), HandKey(1.0, REST))}
    nod = ((TurnKey(-0.015, Turn()), TurnKey(0.3, Turn(tilt=0.2)), TurnKey(0.6, Turn())),)
    frames = gathered(Sequences(head=nod, hands=hands), [SyncPoint(0.0, "g", "stroke")], robot)
    assert [frame.time for frame in frames] == [-0.5, 0.0, 0.3, 0.6, 1.0]


def test_a_sync_point_without_a_key_has_a_frame(robot):
    frames = gathered(Sequences(hands=HANDS), [SyncPoint(2.2, "g", "relax")], robot)
    frame = next(frame for frame in frames if frame.time == 2.2)
    assert frame.given == frozenset()
    assert frame.syncs == (("g", "relax"),)


def test_ends_are_at_rest_even_when_keys_merge(robot):
    nod = ((TurnKey(0.01, Turn()), TurnKey(1.5, Turn(tilt=0.2)), TurnKey(3.01, Turn())),)
    frames = gathered(Sequences(head=nod, hands=HANDS), [], robot)
    for frame in (frames[0], frames[-1]):
        assert frame.head == Turn()
        assert frame.hands["l"] is REST


def test_nothing_gathers_to_nothing(robot):
    assert gathered(Sequences(hands={"l": (), "r": ()}), [], robot) == ()
