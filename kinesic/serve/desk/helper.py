"""A process that answers questions, so that neither the loop nor the thread of the clients ever waits for an answer.

It is begun, spoken to and awaited by a thread of its own. Whatever it does, it has so much time and is then ended.
"""

import os
import pickle
from asyncio import Task, create_task, get_running_loop, timeout
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from enum import Enum
from functools import partial
from multiprocessing.connection import Connection
from typing import Generic, TypeVar

from kinesic.child import Child, child_context
from kinesic.controller import perform
from kinesic.planning.setup import Setup
from kinesic.serve import planner
from kinesic.serve.renewal import renew_setup
from kinesic.serve.wire.quotas import Quotas

NICE = 5  # behind the planner of what is performed
START = 30.0  # [s] that setting up may take

Q = TypeVar("Q")
R = TypeVar("R")
MakeSetup = Callable[[], Setup]
Answer = Callable[[Q, Setup, Quotas], str]


class Unanswered(Enum):
    """Why a question has no answer."""

    OUTDATED = "a later question took its place"
    FAILED = "answering failed, or took too long"


Reply = Callable[[str | Unanswered], None]


def run_helper(make_setup: MakeSetup, line: Connection, answer: Answer[Q], rules: Quotas) -> None:
    """Answers one question after the other until the server is gone.

    Args:
        make_setup: makes what answers need.
        line: to the server: says that it is ready, then questions come, and answers go back.
        answer: finds the answer.
        rules: for whoever asks.
    """
    os.nice(NICE)
    setup = make_setup()
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        line.send_bytes(b"ready")
        while True:
            question, is_renewed = pickle.loads(line.recv_bytes())
            if is_renewed:
                setup = renew_setup(make_setup, setup)
            line.send_bytes(answer(question, setup, rules).encode(errors="replace"))


class Helper(Generic[Q]):
    """Has questions answered one by one; of a client's that wait, only the newest."""

    def __init__(self, make_setup: MakeSetup, answer: Answer[Q], rules: Quotas, *, name: str) -> None:
        """Begins no process before the first question.

        Args:
            make_setup: makes what answers need, in the other process.
            answer: finds an answer there.
            rules: how long that may take.
            name: of the process.
        """
        self._make_setup, self._answer, self._rules, self._name = make_setup, answer, rules, name
        self._thread = ThreadPoolExecutor(1, thread_name_prefix=name)
        self._process: tuple[Child, Connection] | None = None
        self._waiting: dict[tuple[int, str], tuple[Q, Reply]] = {}  # by client and kind, those that asked first first
        self._task: Task[None] | None = None
        self._is_outdated = False  # whether gestures were saved since its last question

    def warm_up(self) -> None:
        """Begins the process, if there is none."""
        if self._task is None or self._task.done():
            self._task = create_task(self._answer_all())

    def ask(self, client: int, question: Q, reply: Reply, *, kind: str = "") -> None:
        """Takes a question; it goes to the place of an older one of this client's that still waits.

        Args:
            client: its number.
            question: picklable.
            reply: called with the answer, as soon as it is known.
            kind: of the question; one of another kind takes no place.
        """
        older = self._waiting.get((client, kind))
        self._waiting[client, kind] = question, reply
        if older is not None:
            older[1](Unanswered.OUTDATED)
        self.warm_up()

    def renew(self) -> None:
        """Has gestures read anew before the next question is answered."""
        self._is_outdated = True

    def close(self) -> None:
        """Ends the process; nobody is answered any more."""
        self._waiting.clear()
        if self._task is not None:
            self._task.cancel()
        self._end()
        self._thread.shutdown(wait=False, cancel_futures=True)

    async def _answer_all(self) -> None:
        if not self._waiting:
            await self._try(self._be_ready)
        while self._waiting:
            question, reply = self._waiting.pop(next(iter(self._waiting)))
            found = await self._try(partial(self._exchange, question))
            reply(Unanswered.FAILED if found is None else found)

    async def _try(self, act: Callable[[], Coroutine[None, None, R]]) -> R | None:
        """Ends a process that has died or takes too long; the next question begins another."""
        try:
            return await act()
        except (TimeoutError, EOFError, OSError):
            self._end()
            return None

    async def _be_ready(self) -> Connection:
        if self._process is None:
            self._process = await self._wait_for(self._begin)
            async with timeout(START):
                await self._wait_for(self._process[1].recv_bytes)
        return self._process[1]

    async def _exchange(self, question: Q) -> str:
        line, is_renewed = await self._be_ready(), self._is_outdated
        self._is_outdated = False
        async with timeout(self._rules.planning):
            return await self._wait_for(lambda: _exchange(line, (question, is_renewed)))

    async def _wait_for(self, act: Callable[[], R]) -> R:
        return await get_running_loop().run_in_executor(self._thread, act)

    def _begin(self) -> tuple[Child, Connection]:
        context = child_context(planner.__name__, perform.__name__, self._make_setup.__module__)
        ours, theirs = context.Pipe()
        work = (self._make_setup, theirs, self._answer, self._rules)
        return Child(context, run_helper, *work, name=self._name), ours

    def _end(self) -> None:
        """Ends the process, and with it whatever its thread waits for."""
        if self._process is not None:
            self._process[0].kill(wait=False)
            self._process = None


def _exchange(line: Connection, message: object) -> str:
    line.send_bytes(pickle.dumps(message, pickle.HIGHEST_PROTOCOL))
    return line.recv_bytes().decode()
