"""Idle motion in the pauses of a conversation, not before and not long after."""

from dataclasses import replace
from math import inf

import pytest

from kinesic.expressivity.idle import NO_IDLING
from kinesic.realizer.realizer import Scene, begin_idle
from kinesic.serve.idling import IDLE_SPELL_DURATION, IDLING_TIMEOUT, REST_BEFORE_IDLING, IdleScheduler
from kinesic.session.setup import set_up


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene.of(set_up(idle=1.0))


def test_idle_motion_is_scheduled_after_a_rest_until_its_timeout(scene: Scene):
    scheduler = IdleScheduler()
    assert scheduler.next_time(scene) == inf
    scheduler.allow(0.0)
    assert scheduler.next_time(scene) == pytest.approx(scene.motion.end + REST_BEFORE_IDLING)
    assert scheduler.next_time(replace(scene, motion=replace(scene.motion, start=IDLING_TIMEOUT))) == inf
    scheduler.forbid()
    assert scheduler.next_time(scene) == inf


def test_server_adds_no_idle_motion_if_it_is_switched_off(scene: Scene):
    scheduler = IdleScheduler()
    scheduler.allow(0.0)
    assert scheduler.next_time(replace(scene, setup=replace(scene.setup, idling=NO_IDLING))) == inf


def test_successive_idle_motions_of_a_server_differ(scene: Scene):
    scheduler = IdleScheduler()
    scheduler.allow(0.0)
    first, other = scheduler.plan_next(scene.setup), scheduler.plan_next(scene.setup)
    assert first.plan.trajectory.controls.shape == other.plan.trajectory.controls.shape
    assert abs(first.plan.trajectory.controls - other.plan.trajectory.controls).max() > 0.005
    idling = begin_idle(scene, first, 4.0)
    assert scheduler.next_time(idling) == idling.motion.end


def test_rejected_idle_motion_postpones_the_next_one_by_its_duration(scene: Scene):
    scheduler = IdleScheduler()
    scheduler.allow(0.0)
    scheduler.plan_next(scene.setup)
    soon = scene.motion.end + REST_BEFORE_IDLING
    assert scheduler.next_time(scene) == soon
    scheduler.postpone(1.0)
    assert scheduler.next_time(scene) == max(soon, 1.0 + IDLE_SPELL_DURATION)
