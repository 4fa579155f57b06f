"""A robot idles in the pauses of a conversation, and not before or long after it."""

from dataclasses import replace
from math import inf

import pytest

from kinesic.controller.perform import set_up
from kinesic.expressivity.idle import OFF
from kinesic.realizer.realizer import Scene, begin_idle
from kinesic.serve.idling import LONGEST, PAUSE, SPELL, IdleTimes


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene.of(set_up(idle=1.0))


def test_it_idles_in_the_minutes_after_a_request(scene: Scene):
    times = IdleTimes()
    assert times.next_time(scene) == inf
    times.allow(0.0)
    assert times.next_time(scene) == pytest.approx(scene.motion.end + PAUSE)
    assert times.next_time(replace(scene, motion=replace(scene.motion, start=LONGEST))) == inf
    times.forbid()
    assert times.next_time(scene) == inf


def test_it_never_idles_where_idle_motion_is_off(scene: Scene):
    times = IdleTimes()
    times.allow(0.0)
    assert times.next_time(replace(scene, setup=replace(scene.setup, idling=OFF))) == inf


def test_spells_follow_one_another_and_differ(scene: Scene):
    times = IdleTimes()
    times.allow(0.0)
    first, other = (times.prepare(scene.setup, now) for now in (4.0, 4.0))
    assert first.plan.trajectory.controls.shape == other.plan.trajectory.controls.shape
    assert abs(first.plan.trajectory.controls - other.plan.trajectory.controls).max() > 0.005
    idling = begin_idle(scene, first, 4.0)
    assert times.next_time(idling) == pytest.approx(max(idling.motion.end, 4.0 + SPELL))
