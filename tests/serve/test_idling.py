"""A robot idles in the pauses of a conversation, and not before or long after it."""

from dataclasses import replace
from math import inf

import pytest

from kinesic.controller.perform import set_up
from kinesic.expressivity.idle import OFF
from kinesic.realizer.realizer import Scene, begin_idle
from kinesic.serve.idling import ATTENDED, PAUSE, SPELL, IdleScheduler


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene.of(set_up(idle=1.0))


def test_it_idles_in_the_minutes_after_a_request(scene: Scene):
    scheduler = IdleScheduler()
    assert scheduler.next_time(scene) == inf
    scheduler.allow(0.0)
    assert scheduler.next_time(scene) == pytest.approx(scene.motion.end + PAUSE)
    assert scheduler.next_time(replace(scene, motion=replace(scene.motion, start=ATTENDED))) == inf
    scheduler.forbid()
    assert scheduler.next_time(scene) == inf


def test_it_never_idles_where_idle_motion_is_off(scene: Scene):
    scheduler = IdleScheduler()
    scheduler.allow(0.0)
    assert scheduler.next_time(replace(scene, setup=replace(scene.setup, idling=OFF))) == inf


def test_spells_follow_one_another_and_differ(scene: Scene):
    scheduler = IdleScheduler()
    scheduler.allow(0.0)
    first, other = scheduler.plan_next(scene.setup), scheduler.plan_next(scene.setup)
    assert first.plan.trajectory.controls.shape == other.plan.trajectory.controls.shape
    assert abs(first.plan.trajectory.controls - other.plan.trajectory.controls).max() > 0.005
    idling = begin_idle(scene, first, 4.0)
    assert scheduler.next_time(idling) == idling.motion.end


def test_a_spell_that_was_ended_delays_none_and_one_without_a_place_does(scene: Scene):
    scheduler = IdleScheduler()
    scheduler.allow(0.0)
    scheduler.plan_next(scene.setup)
    soon = scene.motion.end + PAUSE
    assert scheduler.next_time(scene) == soon
    scheduler.postpone(1.0)
    assert scheduler.next_time(scene) == max(soon, 1.0 + SPELL)
