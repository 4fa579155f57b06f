"""Followed gaze and posture, which blocks override."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.expressivity.keyframes import HeldTurns, Turn
from kinesic.motion.transition import extend_controls
from kinesic.realizer.follow_steps import STEP_LIMITS, FollowStep, fit_step
from kinesic.realizer.following import FOLLOWING_PREFIX, NOD_DOWN_DURATION, follow, nod
from kinesic.realizer.held import trunk_hinges
from kinesic.realizer.realizer import interrupt
from tests.realizer.certified import certified

GAZE = '<gaze id="z" target="right" start="{}" ready="{}" relax="{}" end="{}"/>'
WAVE = '<gesture id="g" lexeme="greet_wave" start="0"/>'


def look(side: float, up: float = 0.0) -> HeldTurns:
    """Return a gaze at angles [deg] to the left and up."""
    turn = Turn(np.radians(side), -np.radians(up))
    trunk = np.copysign(max(0.0, abs(turn.torsion) - np.radians(40)), turn.torsion)
    return HeldTurns("look", turn, Turn(float(trunk)))


def neck(play, time=None):
    """Return torsion, tilt and roll [deg] of the neck.

    Without a time, they are those at the end of the motion.
    """
    motion, joints = play.scene.motion, list(play.scene.setup.robot.joints("neck"))
    return np.degrees(motion.controls[-1] if time is None else motion.at(time).angles)[joints]


def checked(play, change, *, is_sampled=True):
    """Change the scene and check the certificate of its motion."""
    before, after = play.scene.motion, change(play.scene)
    if after.motion is not before and is_sampled:
        same = replace(before, controls=extend_controls(before.controls, len(after.motion.controls)))
        certified(after.motion, play.scene.setup, same, play.scene.first_change(play.now) - before.start)
    return play.take(after)


def followed(play, turns):
    return play.take(follow(play.scene, turns, play.now))


def test_followed_chain_of_100_random_gazes_keeps_limits_and_ends_at_the_last_gaze(played, known):
    play, random = played(ahead=0.02), np.random.default_rng(5)
    for number in range(100):
        goal = (random.uniform(-55, 55), random.uniform(-15, 15))
        checked(play, lambda scene: follow(scene, look(*goal), play.now), is_sampled=number % 8 == 0)  # noqa: B023
        play.until(play.now + float(random.uniform(0.05, 0.6)))
    play.until(play.now + 4.0)
    followed(play, look(*goal)).until(play.now + 4.0)
    head = Turn(np.radians(goal[0]), -np.radians(goal[1]))
    torso = np.degrees(play.scene.motion.controls[-1])[list(known.robot.joints("torso"))]
    assert neck(play)[0] + torso.sum() == pytest.approx(np.degrees(head.torsion), abs=0.01)
    assert neck(play)[1] == pytest.approx(-goal[1], abs=0.01)


def test_overlapping_gaze_following_steps_together_keep_comfortable_velocity_and_acceleration():
    random, steps, begin = np.random.default_rng(2), [], 0.0
    for _ in range(60):
        step = fit_step("neck", np.append(random.uniform(-0.8, 0.8, 2), 0.0), begin, steps)
        if step is not None:
            steps.append(step)
        begin += 0.25
    assert len(steps) > 10
    times = np.arange(0.0, begin + 3.0, 0.004)
    velocity, acceleration = (np.abs(np.sum([s.rates(times)[k] for s in steps], axis=0)).max() for k in (0, 1))
    assert 0.8 < velocity / STEP_LIMITS["neck"].velocity < 1.03
    assert 0.8 < acceleration / STEP_LIMITS["neck"].acceleration < 1.05


def test_velocity_and_acceleration_of_a_gaze_following_step_are_derivatives_of_its_progress():
    step = FollowStep("neck", np.array([0.4, -0.2, 0.1]), 1.0, 1.7)
    times, width = np.linspace(0.9, 1.8, 40), 1e-4
    angle = lambda at: step.progress(at)[:, None] * step.change  # noqa: E731  # the definition itself
    velocity, acceleration = step.rates(times)
    np.testing.assert_allclose(velocity, (angle(times + width) - angle(times - width)) / (2 * width), atol=1e-4)
    second = (angle(times + width) - 2 * angle(times) + angle(times - width)) / width**2
    np.testing.assert_allclose(acceleration, second, atol=2e-2)


def test_gaze_behaviour_replaces_the_followed_gaze_and_returns_to_it(played):
    alone = played().send("b", GAZE.format(0.2, 1.0, 3.0, 4.0)).until(2.0)
    play = followed(played(), look(25.0)).until(1.5).send("b", GAZE.format(0.2, 1.0, 3.0, 4.0)).until(3.5)
    assert play.was_told("b:z:ready")
    assert neck(play, 3.5)[0] == pytest.approx(neck(alone, 2.0)[0], abs=0.1)
    assert followed(play, look(-40.0)).scene.lasting[-1].offset is not None
    assert neck(play.until(8.0))[0] == pytest.approx(25.0, abs=0.01)


def test_later_gaze_of_a_running_block_still_reaches_its_target_during_gaze_following(played):
    alone = played().send("b", GAZE.format(3.0, 4.0, 6.0, 7.0)).until(5.0)
    play = followed(played(), look(10.0)).until(1.0).send("b", GAZE.format(3.0, 4.0, 6.0, 7.0)).until(2.0)
    followed(play, look(30.0))
    assert neck(play.until(3.3), 3.3)[0] == pytest.approx(30.0, abs=5.0)
    assert neck(play.until(6.0), 6.0)[0] == pytest.approx(neck(alone, 5.0)[0], abs=0.1)
    assert neck(play.until(10.0))[0] == pytest.approx(30.0, abs=0.01)


def test_gaze_following_never_moves_the_arms(played, known):
    arms = ~trunk_hinges(known.robot)
    plain, play = played().send("b", WAVE), played().send("b", WAVE)
    for number in range(8):
        followed(play, look(12.0 * (number % 5 - 2))).until(play.now + 0.3)
    times = np.arange(play.scene.motion.start, 6.0, 0.05)
    expected, result = (item.scene.motion.angles(times)[:, arms] for item in (plain, play))
    np.testing.assert_allclose(result, expected, atol=1e-12)
    assert np.ptp(neck(play, 2.4)) > 1.0


def test_robot_returns_to_the_followed_gaze_after_an_interrupted_block(played):
    play = followed(played(), look(20.0)).until(1.0).send("b", WAVE + GAZE.format(0.0, 0.8, 4.0, 5.0)).until(2.5)
    play.take(interrupt(play.scene, play.now)).until(6.0)
    assert neck(play)[0] == pytest.approx(20.0, abs=0.01)
    followed(play, None).until(8.0)
    assert neck(play)[0] == pytest.approx(0.0, abs=0.01)
    assert not [entry for entry in play.scene.lasting if entry.behaviour.startswith(FOLLOWING_PREFIX)]


def test_followed_posture_and_followed_gaze_are_added_and_end_together(played, known):
    lean = HeldTurns("posture", Turn(roll=np.radians(5)), Turn(tilt=np.radians(2)))
    play = followed(followed(played(), look(15.0)), lean).until(2.0)
    assert neck(play) == pytest.approx([15.0, -2.0, 5.0], abs=0.1)  # the neck keeps the head level
    followed(play, None).until(5.0)
    np.testing.assert_allclose(play.scene.motion.controls[-1], known.robot.skeleton.rest, atol=1e-9)


def test_followed_gaze_beyond_the_range_of_the_neck_is_clipped(played, known):
    play = followed(played(), HeldTurns("look", Turn(tilt=np.radians(-80)), Turn())).until(2.0)
    lowest = known.robot.skeleton.lower[list(known.robot.joints("neck"))]
    assert neck(play)[1] == pytest.approx(np.degrees(lowest[1]), abs=0.01)
    assert neck(followed(play, look(0.0)).until(5.0))[1] == pytest.approx(0.0, abs=0.01)


def test_listening_nod_is_added_to_the_running_motion_and_returns_to_the_followed_gaze(played):
    play = followed(played(ahead=0.02), look(20.0)).until(1.0)
    checked(play, lambda scene: nod(scene, np.radians(5.0), play.now))
    assert neck(play, play.now + 0.02 + NOD_DOWN_DURATION)[1] == pytest.approx(5.0, abs=0.5)
    assert neck(play) == pytest.approx([20.0, 0.0, 0.0], abs=0.01)


def test_listening_nod_is_omitted_during_the_nod_of_a_block(played):
    play = played().send("b", '<head id="h" lexeme="NOD" start="0" end="2"/>').until(0.5)
    assert nod(play.scene, 0.08, play.now) is play.scene
    play.until(4.0)
    assert nod(play.scene, 0.08, play.now) is not play.scene
