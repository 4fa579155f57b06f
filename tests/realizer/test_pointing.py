"""Pointing hands on a trunk moved by other blocks."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import Trajectory
from kinesic.motion.transition import MIN_TRANSITION, extend_controls, knot_at
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer import pointing
from kinesic.realizer.occupancy import occupancy_of
from kinesic.realizer.pointing import PointingStroke, correct_pointing, pointing_hands
from kinesic.realizer.realizer import begin, improve_block, interrupt, prepare_block, take_replans
from kinesic.realizer.release import motion_from_knot
from kinesic.realizer.scene import Scene

from .conftest import Play

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
POINT = '<pointing id="p" target="user" mode="RIGHT_HAND" stroke="1.4"/>'
TRUNK_ROTATION = np.radians(8.0)  # [rad] rotation of the trunk by another block
LEAN = '<torso id="t" lexeme="lean" amount="1" start="0" end="3"/>'
GAZE = '<gaze id="t" target="left" influence="WAIST" start="0" end="3"/>'
POINT_AUDIENCE = '<pointing id="p" target="audience" mode="RIGHT_HAND"/>'
LEFT_BEAT = '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND"/>'
POINTING_ACCURACY = np.radians(0.2)  # [rad] largest pointing error of a corrected hand


@pytest.fixture(scope="module")
def alone(known):
    return plan_quickly(parse(ROOT.format(POINT + '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND"/>')), known)


@pytest.fixture(scope="module")
def stroke(alone):
    planned = {(sync.behaviour, sync.sync): sync.planned for sync in alone.syncs}
    return planned["p", "stroke"] + alone.trajectory.zero


@pytest.fixture(scope="module")
def leaning(alone, known):
    """Return the motion on a rotated trunk."""
    controls = np.array(alone.trajectory.controls)
    controls[:, known.robot.joints("torso")[0]] += TRUNK_ROTATION
    return Trajectory(controls, alone.trajectory.zero)


def posture(motion, time):
    return motion.sample(np.array([time]))[0][0]


def test_pointing_hands_of_a_plan_name_behaviour_and_side(alone):
    (one,) = pointing_hands(alone)
    assert (one.behaviour, one.side) == ("p", "r")


def test_planned_hand_points_at_its_target(alone, stroke, known):
    (one,) = pointing_hands(alone)
    assert one.miss(posture(alone.trajectory, stroke), known.robot) < np.radians(0.5)


def test_arm_compensates_for_a_turned_trunk(leaning, alone, stroke, known):
    (one,) = pointing_hands(alone)
    off = posture(leaning, stroke)
    assert one.miss(off, known.robot) > np.radians(3.0)
    mended = one.arm(off, known.robot)
    assert one.miss(mended, known.robot) < np.radians(0.5)
    others = np.setdiff1d(np.arange(len(off)), known.robot.joints("r_arm"))
    np.testing.assert_array_equal(mended[others], off[others])


def test_arm_of_a_pointing_hand_without_a_reach_target_is_unchanged(alone, stroke, known):
    (one,), angles = pointing_hands(alone), posture(alone.trajectory, stroke)
    hanging = replace(one, hand=replace(one.hand, reach=None))
    assert hanging.arm(angles, known.robot) is angles


def test_pointing_correction_changes_only_the_pointing_arm_after_the_change_time(leaning, alone, stroke, known):
    (one,), needs = pointing_hands(alone), {item.behaviour: item for item in occupancy_of(alone)}
    cut = stroke - 0.4
    result = correct_pointing(leaning, cut, PointingStroke(one, stroke, needs["p"]), [needs["g"]], known)
    assert result is not None
    assert one.miss(posture(result, stroke), known.robot) < np.radians(0.5)
    count = max(len(result.controls), len(leaning.controls))
    change = np.abs(extend_controls(result.controls, count) - extend_controls(leaning.controls, count))
    assert set(np.flatnonzero(change.max(axis=0) > 1e-9)) <= set(known.robot.joints("r_arm"))
    assert change[: knot_at(cut) + 3].max() < 1e-9
    assert change[-3:].max() < 1e-9


def test_pointing_is_not_corrected_after_the_pointing_behaviour_has_ended(leaning, alone, stroke, known):
    (one,), needs = pointing_hands(alone), {item.behaviour: item for item in occupancy_of(alone)}
    moment = PointingStroke(one, stroke, needs["p"])
    assert correct_pointing(leaning, needs["p"].end + 1.0, moment, [], known) is None


def missed(play, block: str, *, motion=None) -> float:
    """Return the pointing error [rad] of a block in its stroke."""
    running = play.scene.find(block)
    (one,) = pointing_hands(running.prepared.plan)
    stroke = running.zero + running.times[one.behaviour]["stroke"]
    return one.miss((motion or play.scene.motion).sample(np.array([stroke]))[0][0], play.scene.setup.robot)


def check(play) -> None:
    known = play.scene.setup
    for name, peak in check_limits(play.scene.motion, known.limits).by_quantity.items():
        assert peak.ratios.max() <= 1.001, name
    nearest = scan_clearance(play.scene.motion, known.distances)[1].distances.min()
    assert nearest >= known.robot.min_clearance + LAG_RESERVE - 1e-4


@pytest.mark.parametrize("other", [LEAN, GAZE])
def test_new_pointing_hand_accounts_for_a_moving_trunk(play, other):
    play.send("a", other).until(0.4).send("b", POINT_AUDIENCE)
    assert missed(play, "b") < POINTING_ACCURACY
    check(play)
    play.until(6.0)
    assert play.warnings() == []
    assert play.scene.motion.controls[-1] == pytest.approx(play.scene.setup.robot.skeleton.rest, abs=1e-6)


@pytest.mark.parametrize("other", [LEAN, GAZE])
def test_pending_pointing_hand_accounts_for_a_later_trunk_motion(play, other):
    play.send("a", POINT_AUDIENCE).until(0.2)
    before = play.scene.motion
    play.send("b", other)
    assert missed(play, "a") < POINTING_ACCURACY
    check(play)
    knot = knot_at(0.2 - play.scene.motion.start)
    np.testing.assert_allclose(play.scene.motion.controls[:knot], before.controls[:knot], atol=1e-8)
    play.until(6.0)
    assert play.warnings() == []


def test_hand_still_points_at_its_target_if_the_lean_of_the_trunk_is_interrupted(play):
    play.send("a", LEAN).until(0.4).send("b", POINT_AUDIENCE).until(0.5)
    play.take(interrupt(play.scene, play.now, "a"))
    assert missed(play, "b") < pointing.POINTING_TOLERANCE
    check(play)


def test_interrupted_pointing_hand_ends_at_rest_and_the_trunk_motion_continues(play):
    play.send("a", LEAN).until(0.4).send("b", POINT_AUDIENCE).until(0.8)
    play.take(interrupt(play.scene, play.now, "b"))
    check(play)
    play.until(6.0)
    assert play.scene.motion.controls[-1] == pytest.approx(play.scene.setup.robot.skeleton.rest, abs=1e-6)
    assert play.was_told("a:t:end")


def test_pointing_correction_does_not_change_a_later_beat_of_the_same_hand(play):
    row = (
        POINT_AUDIENCE.replace("/>", ' stroke="1.2"/>')
        + '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" stroke="5.2"/>'
    )
    play.send("b", row)
    before = play.scene.motion
    beat = play.scene.find("b").times["g"]
    play.until(0.2).send("a", LEAN.replace('end="3"', 'end="2"'))
    assert missed(play, "b") < POINTING_ACCURACY
    times = np.arange(beat["ready"], beat["relax"], 0.01)
    arm = list(play.scene.setup.robot.joints("r_arm"))
    np.testing.assert_allclose(play.scene.motion.sample(times)[0][:, arm], before.sample(times)[0][:, arm], atol=1e-6)


@pytest.fixture
def still_trunk(known) -> Play:
    """Scene whose trunk does not follow the hands."""
    return Play(Scene.of(replace(known, style=known.style.changed(["whole_body=0"]))))


def test_uncorrectable_pointing_error_causes_one_warning(still_trunk, monkeypatch):
    play = still_trunk
    monkeypatch.setattr(pointing, "correct_pointing", lambda *_: None)
    play.send("a", LEAN).until(0.4).send("b", POINT_AUDIENCE)
    (text,) = play.warnings()
    assert 'id="b:p" type="IMPOSSIBLE_TO_SCHEDULE"' in text
    assert f"points {np.degrees(missed(play, 'b')):.0f} deg off its target" in text
    play.until(0.6).send("c", LEFT_BEAT)
    assert len(play.warnings()) == 1


def test_trunk_motion_just_before_a_pointing_stroke_causes_a_warning_if_the_hand_misses(play):
    play.send("a", POINT_AUDIENCE)
    stroke = play.scene.find("a").times["p"]["stroke"]
    play.until(stroke - 0.12).send("b", LEAN.replace("lean", "turn left"))
    off = missed(play, "a")
    assert (len(play.warnings("a:p")) == 1) == (off > pointing.POINTING_TOLERANCE)
    check(play)


def test_gesture_of_the_left_arm_does_not_change_the_travel_of_the_right_pointing_arm(still_trunk):
    play = still_trunk
    play.send("a", LEFT_BEAT).until(0.3).send("b", POINT_AUDIENCE)
    alone = play.ready("c", POINT_AUDIENCE).plan.trajectory.controls
    arm = list(play.scene.setup.robot.joints("r_arm"))
    own = play.scene.find("b").merged.layer.controls[:, arm]
    assert np.ptp(own, axis=0) == pytest.approx(np.ptp(alone[:, arm], axis=0), abs=1e-6)


def test_refined_plan_still_points_at_its_target_while_the_trunk_leans(play):
    nods = "".join(f'<head id="h{k}" lexeme="NOD" stroke="{1.0 + 1.2 * k}"/>' for k in range(4))
    play.send("a", LEAN).until(0.3)
    coming = play.ready("b", POINT_AUDIENCE.replace("/>", ' stroke="1.3"/>') + nods)
    assert coming.is_provisional
    play.take(begin(play.scene, coming, play.now))
    assert missed(play, "b") < POINTING_ACCURACY
    play.scene, (request,) = take_replans(play.scene)
    after = improve_block(play.scene, "b", prepare_block(request, play.scene.setup).plan, play.now)
    assert after is not None
    play.scene = after
    assert missed(play, "b") < POINTING_ACCURACY
    check(play)


def test_corrected_pointing_arm_may_approach_the_body_up_to_the_required_clearance(alone, known):
    controls = alone.trajectory.controls
    last = len(controls) - MIN_TRANSITION
    nearest = float(scan_clearance(motion_from_knot(controls, 0), known.distances)[1].distances.min())
    least = nearest - LAG_RESERVE
    while least + LAG_RESERVE < nearest:
        least = np.nextafter(least, np.inf)
    for required, is_feasible in ((least, True), (least + 1e-9, False)):
        setup = replace(known, robot=replace(known.robot, min_clearance=required))
        assert pointing._is_feasible(controls, alone.trajectory, 0, last, setup) is is_feasible
