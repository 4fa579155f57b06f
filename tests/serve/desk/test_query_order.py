"""Queries to helpers whose process is simulated by a thread."""

import asyncio
import threading
from collections.abc import Callable, Coroutine
from dataclasses import dataclass, replace

import pytest

from kinesic.serve import forking, planner
from kinesic.serve.desk import helper
from kinesic.serve.desk.helper import HELPER_NICENESS, Helper, Unanswered
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS, Quotas
from kinesic.session import setup as session_setup

from ..played_children import ThreadChild, played_context

SHORT_QUOTAS = replace(DEFAULT_QUOTAS, planning=0.05)  # quotas with a short time limit for answers [s]
PATIENCE = 8.0  # [s] longest wait for a condition that a test expects


@dataclass(frozen=True)
class Kit:
    """Setup that only has a lexicon."""

    lexicon: int
    name: str = "kit"


class Workshop:
    """Records of the setups, answers and child processes of one helper."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, rules: Quotas = DEFAULT_QUOTAS) -> None:
        self.children: list[ThreadChild] = []
        self.priorities: list[int] = []
        self.setups = 0
        self.hindrance = threading.Event()  # lets a hindered answer or setup go on
        self.hindered_setup = self.is_hindered = False
        self.told: list[tuple[str, object]] = []

        def start(*arguments: object, name: str) -> ThreadChild:
            self.children.append(ThreadChild(*arguments, name=name))
            return self.children[-1]

        monkeypatch.setattr(helper, "Child", start)
        monkeypatch.setattr(forking, "child_context", played_context)
        monkeypatch.setattr(helper, "lower_priority", self.priorities.append)
        self.helper: Helper[str] = Helper(self.make_setup, self.answer, rules, name="workshop")

    def make_setup(self) -> Kit:
        if self.hindered_setup:
            self.hindrance.wait(PATIENCE)
        self.setups += 1
        return Kit(self.setups)

    def answer(self, question: str, setup: Kit, rules: Quotas) -> str:
        if question == "hindered":
            self.is_hindered = True
            self.hindrance.wait(PATIENCE)
        return f"{question} {setup.lexicon}"

    def ask(self, client: int, question: str, kind: str = "") -> None:
        self.helper.ask(client, question, lambda answer: self.told.append((question, answer)), kind=kind)

    async def until(self, condition: Callable[[], bool]) -> None:
        async with asyncio.timeout(PATIENCE):
            while not condition():
                await asyncio.sleep(0.001)

    async def until_told(self, count: int) -> list[tuple[str, object]]:
        await self.until(lambda: len(self.told) >= count)
        return self.told

    def run(self, work: Callable[[], Coroutine[None, None, None]]) -> None:
        async def whole() -> None:
            try:
                await work()
            finally:
                self.hindrance.set()
                self.helper.close()
                for child in self.children:
                    child.kill()

        asyncio.run(whole())


@pytest.fixture
def workshop(monkeypatch: pytest.MonkeyPatch) -> Workshop:
    return Workshop(monkeypatch)


@pytest.fixture
def hasty(monkeypatch: pytest.MonkeyPatch) -> Workshop:
    return Workshop(monkeypatch, SHORT_QUOTAS)


def test_queries_are_answered_in_order_of_arrival_by_one_process(workshop: Workshop) -> None:
    async def work() -> None:
        for client, question in ((1, "a"), (2, "b"), (3, "c")):
            workshop.ask(client, question)
        assert await workshop.until_told(3) == [("a", "a 1"), ("b", "b 1"), ("c", "c 1")]
        workshop.ask(1, "d")
        assert (await workshop.until_told(4))[3] == ("d", "d 1")
        (child,) = workshop.children
        assert child.name == "workshop"
        assert child.context.preload == (
            planner.__name__,
            session_setup.__name__,
            __name__,
            planner.TEXT_TABLES_MODULE,
        )
        assert workshop.priorities == [HELPER_NICENESS]
        assert 0 < HELPER_NICENESS < 20

    workshop.run(work)


def test_newer_query_of_a_client_replaces_its_waiting_query_of_the_same_kind(workshop: Workshop) -> None:
    async def work() -> None:
        for client, question, kind in ((1, "old", ""), (2, "other", ""), (1, "kind", "file"), (1, "new", "")):
            workshop.ask(client, question, kind)
        assert workshop.told == [("old", Unanswered.OUTDATED)]
        answers = (await workshop.until_told(4))[1:]
        assert answers == [("new", "new 1"), ("other", "other 1"), ("kind", "kind 1")]

    workshop.run(work)


def test_query_helper_reloads_the_lexicon_once_before_its_next_answer_after_a_reload_request(
    workshop: Workshop,
) -> None:
    async def work() -> None:
        workshop.ask(1, "a")
        await workshop.until_told(1)
        workshop.helper.renew()
        workshop.ask(1, "b")
        await workshop.until_told(2)
        workshop.ask(1, "c")
        assert (await workshop.until_told(3))[1:] == [("b", "b 2"), ("c", "c 2")]
        assert len(workshop.children) == 1

    workshop.run(work)


def test_warm_up_of_the_query_helper_starts_one_process_before_any_query(workshop: Workshop) -> None:
    async def work() -> None:
        workshop.helper.warm_up()
        workshop.helper.warm_up()
        await workshop.until(workshop.helper._task.done)
        assert workshop.setups == 1
        workshop.helper.warm_up()
        await workshop.until(workshop.helper._task.done)
        workshop.ask(1, "a")
        await workshop.until_told(1)
        assert len(workshop.children) == 1
        assert workshop.children[0].is_alive

    workshop.run(work)


def test_helper_process_that_answers_too_late_is_killed_without_waiting_for_its_end(hasty: Workshop) -> None:
    async def work() -> None:
        hasty.ask(1, "hindered")
        assert (await hasty.until_told(1))[0] == ("hindered", Unanswered.FAILED)
        assert hasty.children[0].kills == [False]
        hasty.hindrance.set()
        hasty.helper._rules = DEFAULT_QUOTAS  # so that a busy machine cannot fail the second one
        hasty.ask(2, "b")
        assert (await hasty.until_told(2))[1] == ("b", "b 2")
        assert len(hasty.children) == 2

    hasty.run(work)


def test_query_fails_and_its_helper_process_is_killed_if_loading_the_setup_takes_too_long(
    workshop: Workshop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(helper, "SETUP_TIMEOUT", 0.02)
    workshop.hindered_setup = True

    async def work() -> None:
        workshop.ask(1, "a")
        assert await workshop.until_told(1) == [("a", Unanswered.FAILED)]
        assert [child.kills for child in workshop.children] == [[False]]

    workshop.run(work)


def test_query_fails_if_its_helper_process_dies_and_the_next_query_gets_a_new_process(workshop: Workshop) -> None:
    async def work() -> None:
        workshop.ask(1, "hindered")
        await workshop.until(lambda: workshop.is_hindered)
        workshop.children[0].kill()
        assert await workshop.until_told(1) == [("hindered", Unanswered.FAILED)]
        workshop.ask(1, "b")
        assert (await workshop.until_told(2))[1] == ("b", "b 2")

    workshop.run(work)


def test_closed_helper_answers_no_waiting_query_and_kills_its_process(workshop: Workshop) -> None:
    async def work() -> None:
        workshop.ask(1, "hindered")
        await workshop.until(lambda: workshop.is_hindered)
        workshop.ask(2, "b")
        task = workshop.helper._task
        workshop.helper.close()
        assert workshop.children[0].kills == [False]
        workshop.hindrance.set()
        await asyncio.wait([task])
        assert task.cancelled()
        assert workshop.told == []
        assert not workshop.helper._waiting
        with pytest.raises(RuntimeError, match="after shutdown"):
            workshop.helper._thread.submit(print)

    workshop.run(work)


def test_answer_with_a_lone_surrogate_is_sent_with_a_replacement_character(workshop: Workshop) -> None:
    async def work() -> None:
        workshop.ask(1, "\ud800")
        assert await workshop.until_told(1) == [("\ud800", "? 1")]

    workshop.run(work)


def test_helper_process_ends_when_its_pipe_is_closed(workshop: Workshop) -> None:
    async def work() -> None:
        workshop.ask(1, "a")
        await workshop.until_told(1)
        workshop.children[0].kill()
        workshop.children[0].thread.join(PATIENCE)
        assert not workshop.children[0].thread.is_alive()

    workshop.run(work)
