"""Arm motion of blocks that yield to a person.

The arms decelerate, hold and return.
"""

import numpy as np
import pytest

from kinesic.bml.composition import BlockState
from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.realizer.occupancy import ARM_ROLES, arm_hinges
from kinesic.realizer.realizer import interrupt
from kinesic.realizer.yielding import ARM_HOLD_DURATION, DECELERATION_DURATION, _stop_angles

from .certified import certified

GESTURE = '<gesture id="g" lexeme="{}" mode="RIGHT_HAND"/>'
GAZE = '<gazeShift id="z" target="1 0.5 0.5"/>'
STILL_VELOCITY = np.radians(2.0)  # [rad/s] velocity below which an arm holds
MAX_STOPPING_TIME = 0.23  # [s] largest time from the interruption until all arms hold


def arm_velocities(motion, robot, times):
    """Return the highest velocity [rad/s] of all arm hinges at each time."""
    hinges = [hinge for role in ARM_ROLES for hinge in arm_hinges(role, robot)]
    return np.abs(motion.sample(times)[1])[:, hinges].max(axis=1)


def test_arms_of_a_block_that_yields_to_a_person_stop_then_hold_then_return_within_limits(play, known):
    """Interrupt gestures in different phases.

    Phases are the preparation, the stroke, the retraction and a posture near the chin.
    """
    for lexeme, times in (("BEAT", (0.6, 1.4)), ("think", (0.9, 1.95)), ("offer", (0.4, 1.5)), ("wave", (0.75, 1.2))):
        made = play.ready(lexeme, GESTURE.format(lexeme))
        for time in times:
            one = type(play)(play.scene)
            one.send(lexeme, GESTURE.format(lexeme)).until(time)
            before = one.scene.motion
            motion = interrupt(one.scene, time, yields=True).motion
            certified(motion, known, before, time)
            velocities = arm_velocities(motion, known.robot, np.arange(time, time + 1.2, KNOT_INTERVAL))
            still = np.flatnonzero(velocities < STILL_VELOCITY)
            assert still[0] * KNOT_INTERVAL <= MAX_STOPPING_TIME, (lexeme, time)
            np.testing.assert_allclose(motion.controls[-1], known.robot.skeleton.rest, atol=1e-6)
        assert made.moves


def test_arm_of_an_interrupted_block_decelerates_and_then_holds_for_the_set_durations(play, known):
    play.send("a", GESTURE.format("BEAT")).until(0.65)
    motion = interrupt(play.scene, 0.65, yields=True).motion
    times = np.arange(0.65, 3.0, KNOT_INTERVAL)
    still = np.flatnonzero(arm_velocities(motion, known.robot, times) < 1e-6)
    held = still[: np.argmax(np.diff(still) > 1) + 1] if (np.diff(still) > 1).any() else still
    assert len(held) * KNOT_INTERVAL == pytest.approx(ARM_HOLD_DURATION, abs=2 * KNOT_INTERVAL)
    assert held[0] * KNOT_INTERVAL == pytest.approx(DECELERATION_DURATION, abs=2 * KNOT_INTERVAL)


def test_yielding_arm_returns_without_a_hold_if_another_block_uses_it_later(play):
    play.send("a", GESTURE.format("BEAT")).send("b", '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" stroke="4"/>')
    play.until(0.65)
    yielding, direct = (interrupt(play.scene, 0.65, "a", yields=yields).motion for yields in (True, False))
    np.testing.assert_array_equal(yielding.controls, direct.controls)


def test_yielding_arm_near_the_end_of_its_retraction_is_not_stopped(play):
    play.send("a", GESTURE.format("BEAT"))
    end = play.scene.blocks[0].end
    for remaining, stops in ((0.2, False), (0.4, True)):
        one = type(play)(play.scene).until(end - remaining)
        motion = interrupt(one.scene, one.now, yields=True).motion
        assert (motion.end > one.scene.motion.end + 0.2) == stops


def test_trunk_of_a_yielding_block_returns_while_its_arms_hold(play, known):
    play.send("a", GESTURE.format("BEAT") + '<gaze id="z" target="left" start="0" ready="0.5" relax="3" end="4"/>')
    play.until(0.65)
    motion = interrupt(play.scene, 0.65, yields=True).motion
    neck = list(known.robot.joints("neck"))
    held = motion.sample(np.array([0.65 + DECELERATION_DURATION, 0.65 + DECELERATION_DURATION + ARM_HOLD_DURATION]))[0]
    assert np.abs(np.diff(held, axis=0))[0, neck].max() > np.radians(1.0)


def test_yielding_block_reports_its_interruption_once(play):
    play.send("a", GESTURE.format("BEAT") + GAZE).until(0.7)
    play.take(interrupt(play.scene, play.now, yields=True)).until(4.0)
    ends = [due.xml for due in play.told if 'id="a:end"' in due.xml]
    assert len(ends) == 1
    assert "INTERRUPTED" in ends[0]
    assert play.state("a") is BlockState.INTERRUPTED
    assert not play.was_told("a:g:end")


def test_stop_angle_of_a_yielding_arm_follows_from_a_deceleration_with_least_jerk():
    """A cubic velocity that ends with zero acceleration covers vT/2 + aT^2/12."""
    times = KNOT_INTERVAL * np.arange(-1, 2)[:, None]
    assert _stop_angles(0.3 + 0.0 * times, 0.5) == pytest.approx([0.3])
    assert _stop_angles(2.0 * times, 0.5) == pytest.approx([0.5])
    assert _stop_angles(3.0 * times**2, 0.5) - _stop_angles(0.0 * times, 0.5) == pytest.approx([0.125], abs=1e-3)
