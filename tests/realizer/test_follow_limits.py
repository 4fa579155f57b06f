"""Refusal of followed gazes and nods that violate a limit, with figures set by the test."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.expressivity.keyframes import HeldTurns, Turn
from kinesic.planning.clearance import MIN_LAG_RESERVE
from kinesic.realizer import following
from kinesic.realizer.conflicts import MAX_DUTY
from kinesic.realizer.following import follow, is_looking_elsewhere, nod

NECK = HeldTurns("look", Turn(np.radians(10.0)))
TRUNK = HeldTurns("look", Turn(np.radians(10.0)), Turn(np.radians(4.0)))
GAZE_SHIFT = '<gazeShift id="z" target="right" start="1" end="2"/>'
GAZE = '<gaze id="z" target="right" start="1" ready="2" relax="3" end="4"/>'


def moves(play, turns=NECK):
    """Return whether the robot follows a gaze now."""
    return follow(play.scene, turns, play.now).motion is not play.scene.motion


@pytest.mark.parametrize(("excess", "is_moved"), [(-1e-6, False), (0.0, True)])
def test_follow_step_is_refused_if_it_comes_nearer_than_clearance_with_reserve(play, monkeypatch, excess, is_moved):
    limit = play.scene.setup.robot.min_clearance + MIN_LAG_RESERVE
    scanned = SimpleNamespace(distances=np.array([9.0, limit + excess, 9.0]), worst=1)
    monkeypatch.setattr(following, "scan_clearance", lambda motion, distances: (None, scanned))
    assert moves(play) == is_moved
    assert (nod(play.scene, 0.05, 0.0) is not play.scene) == is_moved


@pytest.mark.parametrize(("ratio", "is_moved"), [(1.0 + 1e-6, True), (1.0 + 3e-6, False)])
def test_follow_step_is_refused_if_any_hinge_exceeds_a_limit(play, monkeypatch, ratio, is_moved):
    monkeypatch.setattr(following, "largest_limit_ratios", lambda controls, limits: np.array([0.1, ratio, 0.1]))
    assert moves(play) == is_moved


@pytest.mark.parametrize(
    ("before", "after", "is_moved"),
    [(0.2, MAX_DUTY, True), (0.2, MAX_DUTY + 1e-6, False), (2.0, 2.0, True), (2.0, 2.1, False), (2.0, 1.9, True)],
)
def test_follow_step_of_the_trunk_is_refused_if_it_overloads_a_drive_more_than_before(
    play, monkeypatch, before, after, is_moved
):
    peaks = iter([np.array([0.1, after, 0.1]), np.array([0.1, before, 0.1])])
    monkeypatch.setattr(following, "compute_peak_duties", lambda motion, setup: next(peaks))
    assert moves(play, TRUNK) == is_moved
    assert next(peaks, None) is None, "duties with and without the step are compared"


def test_duties_of_drives_are_not_computed_for_a_follow_step_of_the_neck_alone(play, monkeypatch):
    monkeypatch.setattr(following, "compute_peak_duties", lambda motion, setup: pytest.fail("computed"))
    assert moves(play, NECK)
    assert nod(play.scene, 0.05, 0.0) is not play.scene


@pytest.mark.parametrize(("angle", "is_moved"), [(0.9e-4, False), (1.1e-4, True)])
def test_gaze_that_differs_by_less_than_a_tenth_of_a_milliradian_moves_nothing(play, angle, is_moved):
    play.take(follow(play.scene, NECK, 0.0)).until(2.0)
    assert not moves(play)
    assert moves(play, HeldTurns("look", Turn(NECK.head.torsion + angle))) == is_moved


def test_nod_goes_down_for_0_30_s_and_up_for_0_36_s(play):
    motion = nod(play.scene, 0.08, 0.0).motion
    tilt = play.scene.setup.robot.joints("neck")[1]
    times = np.arange(0.0, 1.0, 0.01)
    angles = motion.sample(times)[0][:, tilt] - play.scene.motion.controls[-1][tilt]
    begin = play.scene.first_change(0.0)
    assert times[angles.argmax()] == pytest.approx(begin + 0.30, abs=0.021)
    assert angles.max() == pytest.approx(0.08, rel=0.01)
    assert np.flatnonzero(np.abs(angles) > 1e-6).max() * 0.01 == pytest.approx(begin + 0.66, abs=0.021)


@pytest.mark.parametrize(("now", "is_added"), [(0.2, True), (0.4, False), (1.5, False), (2.6, True)])
def test_nod_is_added_only_if_it_does_not_overlap_a_nod_of_a_block(played, now, is_added):
    play = played().send("b", '<head id="h" lexeme="NOD" start="1" end="2.5"/>')
    (sign,) = [entry for entry in play.scene.occupancy if "sign" in entry.roles]
    play.until(now)
    begin = play.scene.first_change(now)
    assert (sign.begin < begin + 0.66 and sign.end > begin) == (not is_added)
    assert (nod(play.scene, 0.05, now) is not play.scene) == is_added


def test_block_determines_the_gaze_between_its_start_and_end_only(played):
    play = played().send("b", GAZE)
    assert [is_looking_elsewhere(play.scene, time) for time in (0.5, 1.5, 3.5, 4.5)] == [False, True, True, False]
    play.until(1.5)
    assert not moves(play)


def test_held_gaze_of_a_block_still_replaces_the_followed_one_after_its_end(played):
    alone = played().send("b", GAZE_SHIFT).until(4.0)
    play = played()
    play.take(follow(play.scene, NECK, 0.0)).send("b", GAZE_SHIFT)
    play.take(follow(play.scene, HeldTurns("look", Turn(np.radians(-20.0))), play.now)).until(4.0)
    neck = list(play.scene.setup.robot.joints("neck"))
    np.testing.assert_allclose(play.scene.motion.controls[-1][neck], alone.scene.motion.controls[-1][neck], atol=2e-3)


def test_scene_keeps_only_follow_steps_that_have_not_ended(play):
    play.take(follow(play.scene, TRUNK, 0.0))
    first = play.scene.following
    assert {step.chain for step in first} == {"neck", "torso"}
    play.until(5.0).take(follow(play.scene, HeldTurns("look", Turn(np.radians(-8.0))), play.now))
    assert play.scene.following
    assert not set(first) & set(play.scene.following)
    assert all(step.begin >= 5.0 for step in play.scene.following)
