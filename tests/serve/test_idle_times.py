"""Times at which idle motion may begin, without planning."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import pytest

from kinesic.expressivity.idle import Idling
from kinesic.motion.trajectory import stay
from kinesic.realizer.realizer import Scene
from kinesic.serve import idling as module
from kinesic.serve.idling import EMPTY_BLOCK, IdleScheduler, plan_idle


@pytest.fixture
def scene(known) -> Scene:
    """Scene whose motion ends at 50 s."""
    lively = Scene.of(replace(known, idling=Idling(0.5, 7)))
    motion = stay(known.robot.skeleton.rest)
    return replace(lively, motion=replace(motion, start=50.0 - motion.duration))


def allowed(now: float = 0.0) -> IdleScheduler:
    scheduler = IdleScheduler()
    scheduler.allow(now)
    return scheduler


def test_idle_motion_begins_three_seconds_after_the_last_motion(scene):
    assert allowed().next_time(scene) == pytest.approx(53.0)
    assert allowed().next_time(replace(scene, idle="moving")) == pytest.approx(50.0)
    assert IdleScheduler().next_time(scene) == inf


@pytest.mark.parametrize(("now", "begins"), [(-547.1, False), (-546.9, True)])
def test_idle_motion_begins_only_within_ten_minutes_after_it_was_allowed(scene, now, begins):
    assert (allowed(now).next_time(scene) < inf) is begins


def test_idle_motion_does_not_begin_at_the_end_of_its_allowed_time(scene):
    scheduler = allowed()
    scheduler._until = scheduler.next_time(scene)
    assert scheduler.next_time(scene) == inf


def test_rejected_idle_motion_is_postponed_by_its_duration_of_twelve_seconds(scene):
    scheduler = allowed()
    scheduler.postpone(48.0)
    assert scheduler.next_time(scene) == 60.0
    scheduler.postpone(1.0)
    assert scheduler.next_time(scene) == pytest.approx(53.0)


def test_robot_does_not_idle_while_blocks_play_or_with_an_idle_amount_of_zero(scene):
    assert allowed().next_time(replace(scene, blocks=("playing",))) == inf
    still = replace(scene, setup=replace(scene.setup, idling=Idling(0.0, 7)))
    assert allowed().next_time(still) == inf


def test_each_idle_motion_has_the_next_seed_and_lasts_twelve_seconds(scene, monkeypatch):
    seen = []

    def read(message, setup):
        seen.append((message.text, setup.idling))
        return "request"

    monkeypatch.setattr(module, "read_request", read)
    monkeypatch.setattr(module, "prepare_block", lambda request, setup: (request, setup.idling.seed))
    scheduler = allowed()
    assert [scheduler.plan_next(scene.setup) for _ in range(2)] == [("request", 8), ("request", 9)]
    assert plan_idle(scene.setup, 5) == ("request", 12)
    assert seen[0] == (EMPTY_BLOCK, Idling(0.5, 8))
    assert 'duration="12.0"' in EMPTY_BLOCK


def test_forbidden_idle_motion_may_be_allowed_again(scene):
    scheduler = allowed()
    scheduler.forbid()
    assert (
        scheduler.next_time(
            SimpleNamespace(blocks=(), idle=None, follows=False, motion=scene.motion, setup=scene.setup)
        )
        == inf
    )
    scheduler.allow(0.0)
    assert scheduler.next_time(scene) < inf
