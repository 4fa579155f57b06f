"""Dying planners: a warm spare takes over, cold deaths end the attempts."""

import asyncio
from collections.abc import Callable
from functools import partial

import pytest

from kinesic.planning.setup import Setup
from kinesic.serve.loop import Loop
from kinesic.serve.messages import Clock, Interruption, PlannerReady, RequestDone
from kinesic.serve.planner_process import MAX_COLD_DEATHS, Planner
from kinesic.serve.tracks import TrackEffects
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS
from kinesic.session.setup import set_up

pytestmark = pytest.mark.realtime

MAX_WAIT = 60.0  # [s] longest wait for a message or condition

News = PlannerReady | RequestDone | None


async def plan_until(
    make_setup: Callable[[], Setup],
    known: Setup,
    done: Callable[[Planner, News], bool],
    spare_delay: float = 0.0,
) -> Planner:
    """Run a planner with a loop until a condition holds after a message."""
    tasks, enough = asyncio.get_running_loop(), asyncio.Event()

    def hear(news: News) -> None:
        planner.receive(news)
        if done(planner, news):
            enough.set()

    loop = Loop(
        known,
        [],
        Clock(),
        effects=TrackEffects(),
        send_feedback=lambda message, sender: None,
        notify_server=lambda news: tasks.call_soon_threadsafe(hear, news),
    )
    planner = Planner(
        make_setup,
        loop,
        rules=DEFAULT_QUOTAS,
        idle=lambda: None,
        lost=lambda request: None,
        spare_delay=spare_delay,
    )
    planner.start()
    loop.start()
    try:
        async with asyncio.timeout(MAX_WAIT):
            await enough.wait()
    finally:
        loop.shut_down()
        loop.join()
        planner.close()
    return planner


def test_spare_planner_process_replaces_a_dead_planner_process(known):
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
    assert not planner.has_failed
    assert len({id(spare) for spare in spares}) == 3
    assert not any(spare.child.is_alive for spare in spares)


def test_dead_spare_planner_is_restarted(known):
    def done(planner: Planner, news: News) -> bool:
        if isinstance(news, PlannerReady) and planner.deaths == 0:
            planner._spare.child.kill()
            planner._working.child.kill()
        return isinstance(news, PlannerReady) and planner.deaths == 1

    assert asyncio.run(plan_until(set_up, known, done)).is_warm


def test_request_postpones_the_start_of_the_spare_planner_at_most_until_its_deadline(known):
    starts = []

    def done(planner: Planner, news: News) -> bool:
        if isinstance(news, PlannerReady):
            assert planner._spare is None
            starts.append(planner._spare_start.when())
            planner.send(Interruption(None))
            starts.append(planner._spare_start.when())
        return isinstance(news, RequestDone)

    planner = asyncio.run(plan_until(set_up, known, done, spare_delay=30.0))
    assert starts[0] <= starts[1] == planner._spare_deadline  # the deadline comes before the quiet time
    assert planner._spare is None


def test_planner_process_that_never_warms_up_is_reported_as_failed(known):
    planner = asyncio.run(plan_until(partial(set_up, "nobody"), known, lambda planner, news: planner.has_failed))
    assert planner.deaths == MAX_COLD_DEATHS
    assert not planner.is_warm
