"""Tests of body motion that accompanies gestures."""

from dataclasses import replace
from itertools import pairwise
from math import radians

import pytest

from kinesic.bml.block import Face, Gaze, Gesture, Head, Pointing, Torso
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.hands.strokes import Stroke, time_stroke
from kinesic.expressivity.keyframes import BodyMove, Turn
from kinesic.expressivity.lexicon.body_form import BodyForm
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY, Style
from kinesic.expressivity.turns import UPRIGHT_TURN, turn_angles, turn_at
from kinesic.expressivity.whole_body import (
    MAX_RISE_TIME,
    MAX_TIME_FRACTION,
    AccompaniedGesture,
    BodyDemands,
    accompany_gestures,
)

NOD_ANGLE, LEAN_TURN = radians(4), Turn(tilt=radians(6))
BODY_FORM = BodyForm(head=Turn(roll=radians(5)), nod=NOD_ANGLE, trunk=LEAN_TURN)


@pytest.fixture
def gesture(lexicon, robot, pace, phases):
    """Return a gesture with a body form and sync points."""

    def of(body: BodyForm = BODY_FORM, *times: float, id: str = "g", form: str = "offer") -> AccompaniedGesture:
        posed = poses(replace(lexicon.forms_by_id[form], body=body), robot, NEUTRAL_EXPRESSIVITY)
        stroke = Stroke(id, phases(*(times or (0, 1, 1, 1.6, 1.6, 2, 3))), (posed,))
        return AccompaniedGesture(time_stroke(stroke, posed, pace), NEUTRAL_EXPRESSIVITY, NEUTRAL_EXPRESSIVITY)

    return of


def test_head_and_trunk_motion_follows_the_gesture_phases_of_the_hands(gesture, pace):
    body_motion = accompany_gestures([gesture()], BodyDemands(), pace)
    assert [turn_at(body_motion.torso, time) for time in (0, 1.6, 2, 3)] == [
        UPRIGHT_TURN,
        LEAN_TURN,
        LEAN_TURN,
        UPRIGHT_TURN,
    ]
    assert turn_at(body_motion.head, 1.6) == Turn(tilt=NOD_ANGLE, roll=radians(5))
    assert turn_at(body_motion.head, 2.0) == Turn(roll=radians(5))
    assert body_motion.head[0].turn == body_motion.head[-1].turn == UPRIGHT_TURN
    assert body_motion.head[-1].time == 3.0


def test_head_and_trunk_wait_at_the_start_of_a_long_preparation(gesture, pace):
    plain = BodyForm(trunk=LEAN_TURN, head=Turn(roll=radians(5)))
    for ready, start in ((0.1, 0.0), (2.0, 2.6 - MAX_RISE_TIME)):
        times = (ready, ready, ready + 0.6, ready + 0.6, ready + 1, ready + 2)
        body_motion = accompany_gestures([gesture(plain, 0, *times)], BodyDemands(), pace)
        assert body_motion.head[0].time == body_motion.torso[0].time == pytest.approx(start)


def test_trunk_does_not_return_upright_between_close_gestures(gesture, pace):
    second = gesture(BODY_FORM, 3.2, 4, 4, 4.6, 4.6, 5, 6, id="h")
    body_motion = accompany_gestures([gesture(), second], BodyDemands(), pace)
    assert all(turn_at(body_motion.torso, 1.6 + 0.1 * k) == pytest.approx(LEAN_TURN) for k in range(34))
    apart = accompany_gestures([gesture(), gesture(BODY_FORM, 4, 5, 5, 5.6, 5.6, 6, 7, id="h")], BodyDemands(), pace)
    assert turn_at(apart.torso, 3.5) == UPRIGHT_TURN


def test_head_turns_partly_back_while_a_hand_waits_for_the_next_gesture(gesture, pace):
    aside = replace(BODY_FORM, nod=0.0, head=Turn(torsion=radians(20)))
    first, second = gesture(aside), gesture(aside, 3.3, 4.3, 4.3, 4.9, 4.9, 5.3, 6.3, id="h")
    body_motion = accompany_gestures([first, second], BodyDemands(), pace)
    turned = [turn_at(body_motion.head, time).torsion for time in (1.6, 2.6, 3.2, 4.9)]
    assert turned == pytest.approx([radians(20), radians(6), radians(6), radians(20)])
    soon = accompany_gestures([first, gesture(aside, 2.5, 3.3, 3.3, 3.9, 3.9, 4.3, 5.3, id="h")], BodyDemands(), pace)
    assert [turn_at(soon.head, time).torsion for time in (1.6, 2.4, 3.9)] == pytest.approx([radians(20)] * 3)


def test_body_motion_accompanying_a_hurried_gesture_is_reduced_to_the_available_time(gesture, pace):
    hurried = gesture(BODY_FORM, 0, 0.05, 0.05, 0.1, 0.1, 0.15, 0.2)
    body_motion = accompany_gestures([hurried], BodyDemands(), pace)
    for layer, chain in ((body_motion.torso, "torso"), (body_motion.head, "neck")):
        for a, b in pairwise(layer):
            if layer is body_motion.torso:
                change = Turn(*(y - x for x, y in zip(turn_angles(a.turn), turn_angles(b.turn), strict=True)))
                assert pace.least_turn_time(chain, change) <= MAX_TIME_FRACTION * (b.time - a.time) + 1e-6
    assert 0.0 < turn_at(body_motion.torso, 0.1).tilt < LEAN_TURN.tilt


def test_accompanying_motion_excludes_rotation_axes_used_by_other_behaviours(gesture, pace):
    asked = BodyDemands(head=((), [(0.5, 1.0)], ()), torso=((), (), [(0.5, 1.0)]), eyes=[(2.5, 4.0)], face=[(5.0, 6.0)])
    body = replace(BODY_FORM, gaze="hands", look=0.5, face=(("smile", 0.5),))
    move = accompany_gestures([gesture(body)], asked, pace).moves["g"]
    assert (move.head.tilt, move.nod, move.eyes) == (0.0, 0.0, None)
    assert move.head.roll == pytest.approx(radians(5))
    assert move.trunk == LEAN_TURN
    assert move.face == body.face
    assert move.gave_way == ("head", "nod", "eyes")
    later = accompany_gestures([gesture(body)], BodyDemands(head=((), [(3.0, 4.0)], ())), pace).moves["g"]
    assert later.gave_way == ()


def test_head_accompanying_a_gesture_shakes_to_both_sides_during_the_stroke(gesture, pace):
    body_motion = accompany_gestures([gesture(BodyForm(shake=radians(8)))], BodyDemands(), pace)
    turned = [key.turn.torsion for key in body_motion.head]
    assert min(turned) < -radians(4)
    assert max(turned) > radians(7)
    assert all(1.0 <= key.time <= 2.0 for key in body_motion.head if key.turn.torsion)


def test_eyes_head_and_trunk_turn_to_the_place_shown_by_a_gesture(gesture, pace):
    aside = gesture(BodyForm(gaze="place", look=0.5, towards=radians(8)), form="that_far")
    move = accompany_gestures([aside], BodyDemands(), pace).moves["g"]
    assert move.eyes is not None
    assert move.eyes.torsion < 0.0  # The right hand points to the right
    assert move.head.torsion == pytest.approx(max(move.eyes.torsion / 2, -radians(35)))
    assert move.trunk.torsion == pytest.approx(max(move.eyes.torsion / 2, -radians(8)))
    away = accompany_gestures([gesture(BodyForm(head=Turn(tilt=-0.1), gaze="away"))], BodyDemands(), pace).moves["g"]
    assert away.eyes == Turn(tilt=-0.2)


def test_gesture_without_body_motion_in_the_lexicon_moves_only_the_hands(gesture, pace):
    body_motion = accompany_gestures([gesture(BodyForm())], BodyDemands(), pace)
    assert (body_motion.head, body_motion.torso, body_motion.moves) == ((), (), {})
    assert BodyMove().still


def test_head_and_gaze_behaviours_override_motion_that_accompanies_gestures(perform, phases):
    times = phases(0, 1, 1, 1.6, 1.6, 2, 3)
    alone = perform(("g", Gesture("offer"), times)).bodies["g"]
    assert alone.nod > 0.0
    assert alone.gave_way == ()
    nodding = perform(("g", Gesture("offer"), times), ("n", Head("NOD"), phases(1, 1.2, 1.2, 1.4, 1.6, 1.6, 1.8)))
    assert nodding.bodies["g"].gave_way == ("nod",)
    assert nodding.bodies["g"].head.roll == alone.head.roll
    looking = perform(
        ("g", Pointing("left"), times), ("l", Gaze("right"), {"start": 0.5, "ready": 1, "relax": 2, "end": 2.5})
    )
    assert "eyes" in looking.bodies["g"].gave_way
    assert looking.bodies["g"].head.torsion == 0.0
    leaning = perform(("g", Gesture("drink"), times), ("t", Torso("LEAN_FORWARD"), phases(0, 1, 1, 1, 1, 2, 3)))
    assert "trunk" in leaning.bodies["g"].gave_way
    frowning = perform(
        ("g", Gesture("offer"), times), ("f", Face(("frown",)), {"start": 1, "attackPeak": 1.2, "relax": 2, "end": 2.5})
    )
    assert frowning.bodies["g"].face == ()


def test_robot_without_neck_and_torso_accompanies_gestures_only_with_shoulders(
    timeline, context, robot, limits, phases
):
    arms = replace(robot, chains={name: robot.chains[name] for name in ("l_arm", "r_arm")})
    built = timeline(("g", Gesture("doubt_shrug"), phases(0, 1, 1, 1.6, 1.6, 2, 3)))
    keyframes = make_keyframes(built, context(built.block, pace=Pace(arms, limits(arms))))
    move = keyframes.bodies["g"]
    assert (move.head, move.nod, move.trunk, move.gave_way) == (UPRIGHT_TURN, 0.0, UPRIGHT_TURN, ())
    assert move.shoulders > 0.0
    assert {turn_angles(turn) for frame in keyframes.frames for turn in (frame.head, frame.torso)} == {
        turn_angles(UPRIGHT_TURN)
    }


def test_pointing_turns_eyes_head_and_trunk_to_the_target(perform, phases):
    times = phases(0, 1, 1, 1.6, 1.6, 2, 3)
    left, right = (perform(("g", Pointing(side), times)).bodies["g"] for side in ("left", "right"))
    assert left.eyes is not None
    assert right.eyes is not None
    assert left.eyes.torsion == pytest.approx(-right.eyes.torsion)
    assert radians(5) <= left.trunk.torsion <= radians(10)
    assert left.head.torsion == pytest.approx(-right.head.torsion) != 0.0


def test_body_motion_weight_of_the_style_scales_accompanying_motion(perform, phases):
    times = phases(0, 1, 1, 1.6, 1.6, 2, 3)

    def nod(style: Style) -> float:
        move = perform(("g", Gesture("offer"), times), style=style).bodies.get("g")
        return 0.0 if move is None else move.nod

    loud, quiet, none = (nod(Style().changed([f"whole_body={weight}"])) for weight in (2, 0.5, 0))
    assert (loud, quiet, none) == pytest.approx((2 * nod(Style()), nod(Style()) / 2, 0.0))
    assert nod(Style().changed(["head.spatial=1"])) == pytest.approx(1.5 * nod(Style()))


def test_head_accompanying_a_gesture_turns_once_and_holds_until_relax(gesture, pace):
    body_motion = accompany_gestures([gesture(BodyForm(head=Turn(roll=radians(5))))], BodyDemands(), pace)
    assert [key.time for key in body_motion.head] == pytest.approx([1.6 - MAX_RISE_TIME, 1.6, 2, 3])
    assert [key.turn.roll for key in body_motion.head] == pytest.approx([0, radians(5), radians(5), 0])
    assert not any(key.turn.tilt or key.turn.torsion for key in body_motion.head)


def test_head_rises_before_the_stroke_and_nods_at_it(gesture, pace):
    body_motion = accompany_gestures([gesture(BodyForm(nod=NOD_ANGLE))], BodyDemands(), pace)
    tilts = {key.time: key.turn.tilt for key in body_motion.head}
    assert tilts[1.0] < 0.0
    assert tilts[1.6] == pytest.approx(NOD_ANGLE)
    assert (tilts[1.0 - MAX_RISE_TIME], tilts[2.0], tilts[3.0]) == pytest.approx((0.0, 0.0, 0.0))


def test_trunk_accompanying_a_gesture_holds_until_the_hands_relax(gesture, pace):
    body_motion = accompany_gestures([gesture(BodyForm(trunk=LEAN_TURN))], BodyDemands(), pace)
    assert body_motion.head == ()
    assert [(key.time, key.turn) for key in body_motion.torso] == [
        (1.6 - MAX_RISE_TIME, UPRIGHT_TURN),
        (1.6, LEAN_TURN),
        (2, LEAN_TURN),
        (3, UPRIGHT_TURN),
    ]
