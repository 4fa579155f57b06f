"""Idle motion between blocks and its end by other blocks."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.expressivity.idle import Idling
from kinesic.expressivity.keyframes import HeldTurns, Turn
from kinesic.motion.stopping import stop
from kinesic.planning.setup import Setup
from kinesic.realizer.following import follow
from kinesic.realizer.realizer import Scene, begin_idle, interrupt
from kinesic.realizer.running_block import PreparedBlock
from kinesic.serve.idling import plan_idle
from tests.realizer.certified import certified
from tests.realizer.conftest import Play

WELCOME = '<gesture id="g" lexeme="greet_wave" start="0"/><head id="h" lexeme="NOD" start="0.1"/>'
SHIFT = '<gaze id="z" target="left" start="0" end="1"/>'


@pytest.fixture(scope="module")
def lively(known: Setup) -> Setup:
    return replace(known, idling=Idling(2.0, 0))


@pytest.fixture(scope="module")
def spell(lively: Setup) -> PreparedBlock:
    return plan_idle(lively, 0)


@pytest.fixture
def idling(lively: Setup, spell: PreparedBlock) -> Play:
    play = Play(Scene.of(lively, ahead=0.02)).until(1.0)
    return play.take(begin_idle(play.scene, spell, play.now))


def farthest(play: Play, since: float) -> float:
    """Return the largest deviation [rad] of a hinge from rest after a time [s]."""
    angles = play.scene.motion.sample(np.arange(since, max(since, play.scene.motion.end) + 0.1, 0.02))[0]
    return float(np.abs(angles - play.scene.setup.robot.skeleton.rest).max())


def test_idle_motion_sends_no_feedback_messages(idling: Play):
    assert np.degrees(farthest(idling, 1.0)) > 1.0
    assert not idling.until(14.0).told
    assert idling.scene.states == {}


def test_block_has_the_same_times_on_an_idling_robot_as_on_a_resting_one(idling: Play, lively: Setup):
    resting = Play(Scene.of(lively, ahead=0.02))
    outcomes = []
    for play in (idling.until(5.3), resting.until(5.3)):
        before = play.scene.motion
        running = play.send("b", WELCOME).scene.find("b")
        outcomes.append((running.times, running.merged.dropped))
        assert running.zero - play.now < 0.02 + 0.011 + running.lead_in  # no later than the next knot
        if play is idling:
            certified(play.scene.motion, lively, before, 5.3 - before.start)
    assert outcomes[0] == outcomes[1]
    assert idling.scene.idle is None
    assert farthest(idling.until(12.0), 12.0) < 1e-6


def test_idling_begins_only_without_running_blocks(lively: Setup, spell: PreparedBlock):
    play = Play(Scene.of(lively)).send("b", WELCOME).until(0.5)
    assert begin_idle(play.scene, spell, play.now) is play.scene


def test_held_gaze_shift_is_restored_when_idle_motion_is_interrupted(lively: Setup, spell: PreparedBlock):
    play = Play(Scene.of(lively)).send("b", '<gazeShift id="z" target="left" start="0" end="1"/>').until(4.0)
    before = play.scene.motion.controls[-1]
    play.take(begin_idle(play.scene, spell, play.now)).until(7.0)
    play.take(interrupt(play.scene, play.now))
    assert play.scene.motion.controls[-1] == pytest.approx(before, abs=1e-9)


def test_idle_motion_ends_within_0_8_s_of_an_interruption_and_0_3_s_of_a_stop(idling: Play, lively: Setup):
    idling.until(5.0)
    halted = stop(idling.scene.motion, 5.0, lively.limits)
    assert halted.end < 5.0 + 0.3
    idling.take(interrupt(idling.scene, idling.now))
    assert idling.scene.motion.end < 5.0 + 0.8
    assert farthest(idling, idling.scene.motion.end) < 1e-6


def test_idle_motion_begins_while_the_head_follows_a_person(lively: Setup, spell: PreparedBlock):
    play = Play(Scene.of(lively, ahead=0.02)).until(1.0)
    moving = follow(play.scene, HeldTurns("look", Turn(np.radians(30.0))), play.now)
    assert moving.motion.end > play.now + 0.3
    idling = begin_idle(moving, spell, play.now)
    assert idling.idle is not None
    neck = list(lively.robot.joints("neck"))
    swayed = np.degrees(idling.motion.angles(np.arange(2.0, idling.motion.end, 0.1))[:, neck[0]])
    assert 10.0 < swayed.mean() < 50.0
    released = Play(idling).until(3.0).send("b", SHIFT).until(9.0).scene.motion
    assert np.degrees(released.controls[-1])[neck[0]] == pytest.approx(30.0, abs=0.01)
