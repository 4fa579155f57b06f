"""Idle motion of merged blocks."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.expressivity.idle import Idling
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import Scene, interrupt
from tests.realizer.conftest import Play

STORY = '<speech id="s"><text>Once upon a time a robot had nothing at all to do, and so it stood there</text></speech>'
WAVE = '<gesture id="g" lexeme="greet_wave" mode="LEFT_HAND" stroke="1.5"/><head id="h" lexeme="NOD" start="2"/>'


@pytest.fixture
def idling(known: Setup) -> Play:
    return Play(Scene.of(replace(known, idling=Idling(1.0, 0))))


def away(play: Play) -> float:
    """Return the largest deviation [deg] of a hinge from rest from now on."""
    motion = play.scene.motion
    later = motion.sample(np.arange(play.now, max(play.now, motion.end) + 0.1, 0.02))[0]
    return float(np.degrees(np.abs(later - play.scene.setup.robot.skeleton.rest).max()))


def test_speech_only_block_has_idle_motion(idling: Play, play: Play):
    assert away(idling.send("a", STORY)) > 0.5
    assert away(play.send("a", STORY)) == pytest.approx(0.0, abs=1e-9)


def test_idle_motion_of_a_block_does_not_delay_the_next_block_and_ends_at_rest(idling: Play, play: Play):
    times = []
    for item in (idling, play):
        item.send("a", STORY).until(2.0).send("b", WAVE)
        running = item.scene.find("b")
        times.append((running.zero, running.times, running.merged.dropped))
    assert times[0] == times[1]
    assert idling.scene.motion.controls[-1] == pytest.approx(idling.scene.setup.robot.skeleton.rest, abs=1e-9)


def test_interruption_removes_the_idle_motion_of_a_block(idling: Play):
    idling.send("a", STORY).until(2.0)
    end = idling.scene.motion.end
    idling.take(interrupt(idling.scene, idling.now, "a"))
    assert idling.scene.motion.end < min(end, idling.now + 0.6)
    idling.until(idling.now + 0.6)
    assert away(idling) == pytest.approx(0.0, abs=1e-6)
