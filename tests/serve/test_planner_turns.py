"""Requests to planners whose processes are only recorded."""

import asyncio
import fcntl
import sys
from collections.abc import Callable, Coroutine
from multiprocessing import Pipe
from types import SimpleNamespace

import pytest

from kinesic.realizer.request import Message
from kinesic.serve import planner as planner_module
from kinesic.serve import planner_process, refiner
from kinesic.serve.messages import DocumentRequest, Interruption, Renewal, RequestDone
from kinesic.serve.planner_process import MAX_COLD_DEATHS, MAX_SPARE_DELAY, PIPE_CAPACITY, _widen
from kinesic.session import setup as session_setup

from .planner_office import LOOP_START, PATIENCE, READY_MESSAGE, Loop, Office, make_setup

DONE_MESSAGE = RequestDone()
DOCUMENT = DocumentRequest(Message("<bml/>", 7), 0)


Act = Callable[[Office], Coroutine[None, None, None]]


@pytest.fixture
def in_office(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    def run(act: Act, *, planning: float = 1000.0, spare_delay: float = 1000.0) -> None:
        async def whole() -> None:
            office = Office(monkeypatch, planning=planning, spare_delay=spare_delay)
            await act(office)
            office.planner.close()

        asyncio.run(whole())

    return run


async def until(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(PATIENCE):
        while not condition():
            await asyncio.sleep(0.001)


def test_started_planner_gets_the_state_of_the_loop_and_a_refiner(in_office) -> None:
    async def act(office: Office) -> None:
        planner = office.planner
        planner.start()
        assert office.received() == [LOOP_START]
        (process,), (helper,) = office.of("planner"), office.of("refiner")
        assert process.work is planner_module.run_planner
        assert process.context.directions == [False, True, True]
        assert (process.arguments[0], *process.arguments[4:]) == (make_setup, Loop.properties, planner._rules)
        assert helper.work is refiner.run_refiner
        assert helper.arguments == (make_setup, planner._working.refiner)
        assert office.loop.connected == [(planner._working.loop, LOOP_START)]
        for child in office.children:
            modules = (
                planner_module.__name__,
                session_setup.__name__,
                make_setup.__module__,
                planner_module.TEXT_TABLES_MODULE,
            )
            assert child.context.preload == modules
        planner._working.loop.send("to the planner")
        assert process.arguments[2].recv() == "to the planner"
        planner._working.refiner.send("from the refiner")
        assert process.arguments[3].recv() == "from the refiner"

    in_office(act)


def test_planner_accepts_no_request_before_it_is_ready(in_office) -> None:
    async def act(office: Office) -> None:
        with pytest.raises(RuntimeError, match="busy"):
            office.planner.send(DOCUMENT)
        office.planner.start()
        assert not office.planner.is_free
        with pytest.raises(RuntimeError, match="busy"):
            office.planner.send(DOCUMENT)
        assert office.calls == []

    in_office(act)


def test_ready_planner_takes_one_request_at_a_time(in_office) -> None:
    async def act(office: Office) -> None:
        planner = office.start()
        assert planner.is_free
        assert not planner.is_planning
        planner.send(DOCUMENT)
        assert (planner.is_free, planner.is_planning, planner.serves(7), planner.serves(8)) == (
            False,
            True,
            True,
            False,
        )
        with pytest.raises(RuntimeError, match="busy"):
            planner.send(DOCUMENT)
        (document,) = office.received()
        assert document.message == DOCUMENT.message
        planner.receive(DONE_MESSAGE)
        assert (planner.is_free, planner.is_planning, planner.serves(7)) == (True, False, False)
        planner.send(Interruption(None))
        assert (planner.is_free, planner.is_planning, planner.serves(7)) == (False, False, False)
        assert office.calls == ["idle", "idle"]
        assert planner.deaths == 0

    in_office(act)


def test_request_beyond_its_time_limit_kills_the_planner_without_waiting_for_its_end(in_office) -> None:
    async def act(office: Office) -> None:
        office.start()
        office.planner.send(DOCUMENT)
        await until(lambda: not office.children[0].is_alive)
        assert office.children[0].kills == [False]

    in_office(act, planning=0.005)


def test_answer_of_the_planner_cancels_the_timeout_of_its_request(in_office) -> None:
    async def act(office: Office) -> None:
        office.start()
        office.planner.send(DOCUMENT)
        watch = office.planner._watch
        assert not watch.cancelled()
        office.planner.receive(DONE_MESSAGE)
        assert watch.cancelled()

    in_office(act)


def test_dead_planner_reports_its_request_and_is_replaced(in_office) -> None:
    async def act(office: Office) -> None:
        planner = office.start()
        planner.send(DOCUMENT)
        planner.receive(None)
        assert office.calls == ["idle", ("lost", DOCUMENT)]
        assert (planner.is_warm, planner.is_free, planner.deaths, planner.has_failed) == (False, False, 1, False)
        assert [child.kills for child in office.children] == [[False], [False], [], []]
        assert office.received(1) == [LOOP_START]
        planner.receive(READY_MESSAGE)
        assert planner.is_free

    in_office(act)


def test_planner_that_dies_too_often_before_it_is_ready_is_not_replaced(in_office) -> None:
    async def act(office: Office) -> None:
        planner = office.planner
        planner.start()
        for _ in range(MAX_COLD_DEATHS - 1):
            planner.receive(None)
        planner.receive(READY_MESSAGE)  # warm again: the count starts anew
        planner.receive(None)
        for _ in range(MAX_COLD_DEATHS):
            assert not planner.has_failed
            planner.receive(None)
        assert planner.has_failed
        assert planner.deaths == 2 * MAX_COLD_DEATHS
        assert len(office.of("planner")) == 2 * MAX_COLD_DEATHS

    in_office(act)


def test_spare_planner_starts_at_once_if_its_delay_is_zero_and_replaces_a_dead_planner(in_office) -> None:
    async def act(office: Office) -> None:
        planner = office.planner
        planner.start()
        assert len(office.of("planner")) == 1
        planner.receive(READY_MESSAGE)
        assert len(office.of("planner")) == 2
        planner.receive(None)
        assert len(office.of("planner")) == 2
        assert planner._working.child is office.of("planner")[1]
        assert planner._spare is None
        planner.receive(READY_MESSAGE)
        assert len(office.of("planner")) == 3
        planner._spare.child.kill()
        planner.receive(None)
        assert len(office.of("planner")) == 4
        assert planner._working.child is office.of("planner")[3]

    in_office(act, spare_delay=0.0)


def test_one_spare_planner_starts_after_a_time_without_requests(in_office) -> None:
    async def act(office: Office) -> None:
        office.start()
        assert len(office.of("planner")) == 1
        await until(lambda: len(office.of("planner")) == 2)
        office.planner._begin_spare()
        assert len(office.of("planner")) == 2

    in_office(act, spare_delay=0.01)


def test_repeated_requests_postpone_the_spare_planner_at_most_until_its_deadline(
    in_office, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def act(office: Office) -> None:
        clock = SimpleNamespace(now=100.0)
        handles: list[SimpleNamespace] = []

        def call_at(time: float, call: Callable[[], None]) -> SimpleNamespace:
            handles.append(SimpleNamespace(time=time, call=call, cancels=0))
            handle = handles[-1]
            handle.cancel = lambda: setattr(handle, "cancels", handle.cancels + 1)
            return handle

        tasks = SimpleNamespace(time=lambda: clock.now, call_at=call_at, call_later=call_at)
        monkeypatch.setattr(planner_process, "get_running_loop", lambda: tasks)
        planner = office.start()
        (first,) = handles
        assert first.time == 103.0
        clock.now = 102.0
        planner.send(Interruption(None))
        watch, second = handles[1:]
        assert (first.cancels, second.time, watch.time) == (1, 105.0, planner._rules.planning)
        planner.receive(DONE_MESSAGE)
        clock.now = 100.0 + MAX_SPARE_DELAY - 1.0
        planner.send(Interruption(None))
        assert handles[-1].time == 100.0 + MAX_SPARE_DELAY
        handles[-1].call()
        count = len(handles)
        planner.receive(DONE_MESSAGE)
        planner.send(Interruption(None))
        assert len(handles) == count + 1  # the watch alone: the spare planner exists

    in_office(act, spare_delay=3.0)


def test_spare_planner_started_before_a_lexicon_reload_repeats_it(in_office) -> None:
    async def act(office: Office) -> None:
        planner = office.start()
        planner.send(Renewal())
        planner.receive(DONE_MESSAGE)
        planner.receive(None)
        assert office.received(1) == [LOOP_START]
        planner.receive(READY_MESSAGE)
        assert office.received(1) == [Renewal()]
        assert not planner.is_free
        planner.receive(DONE_MESSAGE)
        planner.receive(None)  # its successor was started after the renewal
        planner.receive(READY_MESSAGE)
        assert planner.is_free
        assert office.received(2) == [LOOP_START]

    in_office(act, spare_delay=0.0)


def test_closing_the_planner_kills_its_processes_and_waits_for_their_end(in_office) -> None:
    async def act(office: Office) -> None:
        planner = office.start()
        planner.receive(None)
        planner.receive(READY_MESSAGE)
        planner._begin_spare()
        spare_start = planner._spare_start
        working, spare = office.of("planner")[-2:]
        planner.close()
        assert spare_start.cancelled()
        assert [child.kills for child in office.children if child.is_alive] == []
        assert (working.kills, working.waits, spare.kills, spare.waits) == ([False], 1, [False], 1)
        assert planner._spare.requests.closed
        with pytest.raises(RuntimeError, match="after shutdown"):
            planner._thread.submit(print)

    in_office(act)


def test_request_to_a_dead_planner_raises_no_error(in_office) -> None:
    async def act(office: Office) -> None:
        office.start()
        office.of("planner")[0].kill()
        office.planner.send(DOCUMENT)
        assert office.planner.is_planning

    in_office(act)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has pipes of another size")
def test_pipe_to_the_planner_is_widened_to_its_configured_capacity() -> None:
    receiver, sender = Pipe(duplex=False)
    _widen(sender)
    assert fcntl.fcntl(sender.fileno(), fcntl.F_GETPIPE_SZ) == PIPE_CAPACITY
    for end in (receiver, sender):
        end.close()
