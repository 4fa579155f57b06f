"""Planners that die: a warm one takes over, and one that never warms up is given up."""

import asyncio
from collections.abc import Callable
from functools import partial

import pytest

from kinesic.controller.perform import set_up
from kinesic.planning.setup import Setup
from kinesic.serve.loop import Loop
from kinesic.serve.messages import Clock, PlannerReady, RequestDone
from kinesic.serve.planner_process import COLD_DEATHS, Planner
from kinesic.serve.tracks import Effects
from kinesic.serve.wire.quotas import USUAL

pytestmark = pytest.mark.realtime

PATIENCE = 60.0  # [s]

News = PlannerReady | RequestDone | None


async def plan_until(make_setup: Callable[[], Setup], known: Setup, done: Callable[[Planner, News], bool]) -> Planner:
    """A planner beside a loop, until something is so of it after some news."""
    tasks, enough = asyncio.get_running_loop(), asyncio.Event()

    def hear(news: News) -> None:
        planner.receive(news)
        if done(planner, news):
            enough.set()

    loop = Loop(
        known,
        [],
        Clock(),
        effects=Effects(),
        tell=lambda message, sender: None,
        news=lambda news: tasks.call_soon_threadsafe(hear, news),
    )
    planner = Planner(make_setup, loop, rules=USUAL, idle=lambda: None, lost=lambda request: None)
    planner.start()
    loop.start()
    try:
        async with asyncio.timeout(PATIENCE):
            await enough.wait()
    finally:
        loop.leave()
        loop.join()
        planner.close()
    return planner


def test_a_spare_takes_over_from_one_that_dies_and_another_stands_by(known):
    spares = []

    def done(planner: Planner, news: News) -> bool:
        if isinstance(news, PlannerReady):
            spares.append(planner._spare)
            if len(spares) < 3:
                planner._working.child.kill()
        elif news is None:
            assert planner._working is spares[-1]
        return len(spares) == 3

    planner = asyncio.run(plan_until(set_up, known, done))
    assert planner.deaths == 2
    assert not planner.failed
    assert len({id(spare) for spare in spares}) == 3
    assert not any(spare.child.is_alive for spare in spares)


def test_a_spare_that_has_died_is_no_hope_and_is_begun_anew(known):
    def done(planner: Planner, news: News) -> bool:
        if isinstance(news, PlannerReady) and planner.deaths == 0:
            planner._spare.child.kill()
            planner._working.child.kill()
        return isinstance(news, PlannerReady) and planner.deaths == 1

    assert asyncio.run(plan_until(set_up, known, done)).warm


def test_one_that_never_warms_up_is_given_up(known):
    planner = asyncio.run(plan_until(partial(set_up, "nobody"), known, lambda planner, news: planner.failed))
    assert planner.deaths == COLD_DEATHS
    assert not planner.warm
