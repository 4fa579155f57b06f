"""Tests of gazes that overlap, and of the parts that move."""

from dataclasses import replace
from itertools import combinations
from math import cos, degrees, hypot, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.block import GAZE_SYNCS, Block, Gaze, HeadDirectionShift, NoticeType
from kinesic.body.action_units import MAX_EYE_DEPRESSION, MAX_EYE_ELEVATION, MAX_EYE_YAW
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.gaze import STRAIGHT_AIM, TRUNK_DELAY, Aim, aim, from_eyes, hold_gaze, look_time, towards
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.turns import UPRIGHT_TURN, add_turns, rotation_range, scale_turn, turn_angles

from ..reduced_robots import write_robot

INFLUENCE_NAMES = (None, "EYES", "NECK", "HEAD", "SHOULDER", "CHEST", "TORSO", "WAIST", "WHOLE")
directions = st.tuples(st.floats(-3.0, 3.0), st.floats(-1.2, 1.2))  # Torsion and tilt [rad]


@pytest.fixture(scope="module")
def look_at(pace, context):
    """Return the rotations of a gaze or a head direction."""

    def of(action, *, robot=None, base=STRAIGHT_AIM, dialect="bml-1.0"):
        changed = Pace(robot or pace.robot, pace.limits)
        return aim(action, context(Block("bml1", (), dialect=dialect), pace=changed), base)

    return of


def gaze_times(*times):
    return dict(zip(GAZE_SYNCS, times, strict=True))


def test_only_one_of_two_simultaneous_gazes_is_performed(perform):
    frames = perform(
        ("one", Gaze("0.5 -1 1"), gaze_times(1, 2, 9, 10)), ("two", Gaze("0.5 1 1"), gaze_times(1, 2, 9, 10))
    )
    assert {id: outcome.kind for id, outcome in frames.outcomes.items()} == {"one": "dropped", "two": "realised"}
    (notice,) = frames.notices
    assert (notice.id, notice.type) == ("bml1:one", NoticeType.IMPOSSIBLE_TO_SCHEDULE)
    assert "two" in notice.text


def test_simultaneous_gaze_and_head_shift_are_both_performed(perform):
    frames = perform(
        ("stays", HeadDirectionShift("0.5 -1 1"), gaze_times(0, 1, 2, 3)),
        ("goes", Gaze("0.5 1 1"), gaze_times(0, 1, 2, 3)),
    )
    assert {outcome.kind for outcome in frames.outcomes.values()} == {"realised"}


@pytest.mark.parametrize(("influence", "share"), [("SHOULDER", 0.25), ("WAIST", 0.4)])
def test_trunk_starts_a_gaze_turn_after_the_head_and_arrives_with_the_head(perform, influence, share):
    frames = perform(("g", Gaze("0.9 0.4 1.1", influence=influence), gaze_times(0, 2, 3, 5)))
    turned = {frame.time: (frame.head.torsion, frame.torso.torsion) for frame in frames.frames}
    lagging = [time for time, (head, torso) in turned.items() if head > 0 and torso == 0 and time < 2]
    assert len(lagging) == 1
    assert turned[2][1] == pytest.approx(share * turned[2][0])


@pytest.mark.parametrize(("influence", "still"), [("EYES", {"head", "torso"}), ("NECK", {"torso"})])
def test_body_parts_outside_the_gaze_influence_keep_the_permanent_gaze(perform, influence, still):
    frames = perform(
        ("for_good", Gaze("0.9 0.4 1.1", influence="WAIST", shift=True), {"start": 0.0, "end": 2.0}),
        ("glance", Gaze(offset_direction="RIGHT", offset_angle=8.0, influence=influence), gaze_times(3, 4, 5, 6)),
    )
    later = [frame for frame in frames.frames if frame.time >= 2]
    assert later[0].torso.torsion > 0.05
    for part in ("head", "torso"):
        torsions = {round(getattr(frame, part).torsion, 9) for frame in later}
        assert (len(torsions) == 1) is (part in still)


@pytest.mark.parametrize(
    ("spare", "lag"), [(-0.3, 0.0), (0.0, 0.0), (0.05, 0.05), (TRUNK_DELAY, TRUNK_DELAY), (1.0, TRUNK_DELAY)]
)
def test_trunk_delay_in_a_gaze_turn_is_limited_by_the_available_time(pace, spare, lag):
    look = Aim(head=Turn(torsion=0.9), torso=Turn(torsion=0.3))
    needed = pace.turn_time("torso", look.torso)
    times = {"start": 1.0, "ready": 1.0 + needed + spare, "relax": 9.0, "end": 11.0}
    trunk = hold_gaze(look, times, part="torso", stays=False, pace=pace)
    assert trunk.start == pytest.approx(1.0 + lag)
    assert trunk.arrive >= times["ready"] - 1e-9
    assert hold_gaze(look, times, part="head", stays=False, pace=pace).start == 1.0


def place_in(robot, torsion: float, tilt: float) -> str:
    """Return a target one metre from the eyes."""
    away = np.array([cos(tilt) * cos(torsion), cos(tilt) * sin(torsion), -sin(tilt)])
    return " ".join(map(str, away - from_eyes(np.zeros(3), robot)))


@given(direction=directions, influence=st.sampled_from(INFLUENCE_NAMES))
def test_head_and_eyes_together_reach_a_target_within_range(robot, look_at, direction, influence):
    look = look_at(Gaze(place_in(robot, *direction), influence=influence))
    met = turn_angles(add_turns(look.head, look.eyes))
    if not look.clipped:
        assert met == pytest.approx((*direction, 0.0), abs=radians(0.5) + 1e-9)
    else:
        lost = max(abs(a - b) for a, b in zip(met, (*direction, 0.0), strict=True))
        assert f"{degrees(lost):.0f} deg beyond" in look.clipped
    for chain, turn in (("torso", look.torso), ("neck", add_turns(look.head, scale_turn(look.torso, -1.0)))):
        least, most = (turn_angles(item) for item in rotation_range(robot, chain))
        assert all(
            low - 1e-9 <= angle <= high + 1e-9 for low, angle, high in zip(least, turn_angles(turn), most, strict=True)
        )
    assert abs(look.eyes.torsion) <= MAX_EYE_YAW
    assert -MAX_EYE_ELEVATION <= look.eyes.tilt <= MAX_EYE_DEPRESSION


@given(direction=directions, influence=st.sampled_from(INFLUENCE_NAMES))
def test_gaze_to_a_mirrored_target_has_mirrored_rotations(robot, look_at, direction, influence):
    torsion, tilt = direction
    one, other = (look_at(Gaze(place_in(robot, side * torsion, tilt), influence=influence)) for side in (1, -1))
    for part in ("head", "torso", "eyes"):
        mirrored = turn_angles(getattr(other, part)) * np.array([-1, 1, 1])
        assert turn_angles(getattr(one, part)) == pytest.approx(tuple(mirrored), abs=1e-9)


@pytest.mark.parametrize(
    ("place", "torsion", "tilt"),
    [
        ((1, 0, 0), 0, 0),
        ((1, 1, 0), 45, 0),
        ((1, -1, 0), -45, 0),
        ((1, 0, 1), 0, -45),
        ((0, 0, -1), 0, 90),
        ((-1, 0, 0), 180, 0),
    ],
)
def test_gaze_to_the_left_has_positive_torsion_and_gaze_down_has_positive_tilt(robot, place, torsion, tilt):
    turn = towards(np.array(place) - from_eyes(np.zeros(3), robot), robot)
    assert [degrees(angle) for angle in turn_angles(turn)] == pytest.approx([torsion, tilt, 0], abs=1e-9)


def test_gaze_starts_from_the_eye_site_of_the_robot_file(robot):
    frames, neck = robot.skeleton.rest_frames, robot.skeleton.segment(robot.chains["neck"][-1])
    eyes = frames.origins[neck] + frames.rotations[neck] @ robot.sites["eyes"].position
    np.testing.assert_allclose(from_eyes(eyes, robot), 0.0, atol=1e-12)
    blind = replace(robot, sites={name: site for name, site in robot.sites.items() if name != "eyes"})
    np.testing.assert_allclose(from_eyes(frames.origins[neck], blind), 0.0, atol=1e-12)


def test_robot_without_neck_looks_from_between_its_shoulders(tmp_path):
    robot = Robot.load(write_robot(tmp_path, "neck"))
    shoulders = [robot.skeleton.rest_frames.origins[robot.arm(side).shoulder] for side in SIDES]
    np.testing.assert_allclose(from_eyes((shoulders[0] + shoulders[1]) / 2, robot), 0.0, atol=1e-12)


def test_gaze_with_the_eyes_only_starts_from_the_permanent_gaze(robot, look_at):
    base = Aim(Turn(torsion=0.5), Turn(torsion=0.2))
    look = look_at(Gaze(place_in(robot, 0.6, 0.1), influence="EYES"), base=base)
    assert (look.head.torsion, look.torso) == (pytest.approx(0.5), base.torso)
    assert turn_angles(look.eyes) == pytest.approx((0.1, 0.1, 0.0))


@pytest.mark.parametrize("word", ["UP", "DOWN", "LEFT", "RIGHT"])
def test_gaze_offset_without_target_starts_from_the_permanent_gaze(look_at, word):
    base = Aim(Turn(0.3, 0.1))
    look = look_at(Gaze(offset_angle=6.0, offset_direction=word, influence="HEAD"), base=base)
    torsion, tilt = {"UP": (0, -6), "DOWN": (0, 6), "LEFT": (6, 0), "RIGHT": (-6, 0)}[word]
    change = (degrees(look.head.torsion - 0.3), degrees(look.head.tilt - 0.1))
    assert change == pytest.approx((torsion, tilt))


@pytest.mark.parametrize(
    "words",
    [
        pair
        for pair in combinations(("UP", "DOWN", "LEFT", "RIGHT"), 2)
        if pair not in (("UP", "DOWN"), ("LEFT", "RIGHT"))
    ],
)
def test_diagonal_gaze_offset_has_the_requested_angle(look_at, words):
    head = look_at(Gaze(offset_angle=10.0, offset_direction="".join(words), influence="HEAD")).head
    assert degrees(hypot(head.torsion, head.tilt)) == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("dialect", "angle", "turned"),
    [("draft", 1.0, 50), ("draft", -1.0, -50), ("fml-apml", 0.5, 25), ("none", 1.1, 1.1), ("bml-1.0", 1.0, 1.0)],
)
def test_gaze_offset_angles_up_to_one_are_fractions_of_50_degrees_in_bml_drafts(look_at, dialect, angle, turned):
    look = look_at(Gaze(offset_angle=angle, offset_direction="LEFT", influence="HEAD"), dialect=dialect)
    assert degrees(look.head.torsion) == pytest.approx(turned)


@pytest.mark.parametrize("influence", ["SHOULDER", "CHEST", "TORSO", "WAIST", "WHOLE"])
def test_gaze_with_trunk_influence_rotates_the_torso_by_a_fraction(robot, look_at, influence):
    fraction = 0.4 if influence in ("WAIST", "WHOLE") else 0.25
    for torsion in (-0.4, 0.4):
        look = look_at(Gaze(place_in(robot, torsion, 0.2), influence=influence))
        assert turn_angles(look.torso) == pytest.approx((fraction * torsion, 0.0, 0.0))


def test_named_head_direction_shift_turns_only_the_head_by_15_degrees(look_at):
    look = look_at(HeadDirectionShift("Leftward"))
    assert [degrees(angle) for angle in turn_angles(look.head)] == pytest.approx([15, 0, 0])
    assert (look.eyes, look.substitute, look.clipped) == (UPRIGHT_TURN, "", "")
    assert look_at(HeadDirectionShift("nod")).missing


def test_gaze_shift_of_zero_angle_takes_0_2_seconds(pace):
    assert look_time(STRAIGHT_AIM, pace) == 0.2


@given(direction=directions, influence=st.sampled_from(INFLUENCE_NAMES))
def test_gaze_shift_takes_at_least_the_minimum_servo_time(robot, look_at, pace, direction, influence):
    look = look_at(Gaze(place_in(robot, *direction), influence=influence))
    neck = add_turns(look.head, scale_turn(look.torso, -1.0))
    least = max(pace.least_turn_time("neck", neck), pace.least_turn_time("torso", look.torso))
    quick, usual, slow = (look_time(look, pace, temporal) for temporal in (1.0, 0.0, -1.0))
    assert max(least, 0.2) <= quick <= usual <= slow


def test_gaze_shift_of_a_fast_neck_has_human_velocity(robot, pace):
    """Compare the peak velocity with 4/3 of the angle plus 20 deg/s.

    A minimum-jerk motion peaks at 1.875 times its mean velocity.
    """
    eager = Pace(
        robot, replace(pace.limits, speed=100 * pace.limits.speed, acceleration=1e4 * pace.limits.acceleration)
    )
    for angle in (20.0, 60.0):
        peak = 1.875 * angle / look_time(Aim(Turn(torsion=radians(angle))), eager)
        assert peak == pytest.approx(4 / 3 * angle + 20.0)
    slow = Aim(Turn(torsion=radians(30)), Turn(torsion=radians(30)))
    assert 1.875 * 30 / look_time(slow, eager) == pytest.approx(4 / 3 * 30 + 30.0)


def test_trunk_starts_a_gaze_later_than_the_head_only_by_time_that_it_can_spare(robot, pace, look_at):
    look = look_at(Gaze(place_in(robot, 0.5, 0.0), influence="WAIST"))
    needed = pace.turn_time("torso", look.torso)
    for spare, late in ((1.0, 0.12), (0.05, 0.05), (-0.1, 0.0)):
        times = gaze_times(0.5, 0.5 + needed + spare, 5.0, 6.0)
        trunk = hold_gaze(look, times, part="torso", stays=False, pace=pace)
        head = hold_gaze(look, times, part="head", stays=False, pace=pace)
        assert (head.start, head.turn, trunk.turn) == (0.5, look.head, look.torso)
        assert trunk.start == pytest.approx(0.5 + late)
        assert trunk.arrive == head.arrive == times["ready"]
        assert (trunk.leave, trunk.back) == (head.leave, head.back) == (5.0, 6.0)


def test_permanent_gaze_shift_has_no_return_motion(robot, pace, look_at):
    look = look_at(Gaze(place_in(robot, 0.5, 0.0), influence="WAIST"))
    for part in ("head", "torso"):
        hold = hold_gaze(look, {"start": 0.0, "end": 3.0}, part=part, stays=True, pace=pace)
        assert (hold.arrive, hold.leave, hold.back) == (3.0, None, None)
