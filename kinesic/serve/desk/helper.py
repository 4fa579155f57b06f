"""Helper processes that answer queries without blocking loop or clients.

A separate thread starts the process and waits for its answers. A process that exceeds its time limit is killed.
"""

import pickle
from asyncio import Task, create_task, get_running_loop, timeout
from collections.abc import Callable, Coroutine, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from enum import Enum
from functools import partial
from typing import Generic, TypeVar

from kinesic.child import Child, PipeEnd
from kinesic.host import lower_priority
from kinesic.planning.setup import Setup
from kinesic.serve.forking import planning_context
from kinesic.serve.renewal import renew_setup
from kinesic.serve.wire.quotas import Quotas

HELPER_NICENESS = 5  # niceness of helpers: lower priority than loop and planner
SETUP_TIMEOUT = 30.0  # [s] time limit for the start of a helper process

Q = TypeVar("Q")  # type of the queries
R = TypeVar("R")  # type of an exchange's result
MakeSetup = Callable[[], Setup]
Answer = Callable[[Q, Setup, Quotas], str]


class Unanswered(Enum):
    """Reason why a client's query was not answered."""

    OUTDATED = "replaced by a later question"
    FAILED = "answering failed, or took too long"


Reply = Callable[[str | Unanswered], None]


def run_helper(make_setup: MakeSetup, line: PipeEnd, answer: Answer[Q], rules: Quotas) -> None:
    """Answer queries in sequence until the server ends.

    Args:
        make_setup: creates the setup for answers.
        line: pipe to the server: a ready message is sent, then queries are received and answers sent.
        answer: computes an answer.
        rules: limits for clients.
    """
    lower_priority(HELPER_NICENESS)
    setup = make_setup()
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        line.send_bytes(b"ready")
        while True:
            question, is_renewed = pickle.loads(line.recv_bytes())
            if is_renewed:
                setup = renew_setup(make_setup, setup)
            line.send_bytes(answer(question, setup, rules).encode(errors="replace"))


class Helper(Generic[Q]):
    """Process that answers queries in sequence.

    A new query replaces the client's waiting query of the same kind.
    """

    def __init__(
        self, make_setup: MakeSetup, answer: Answer[Q], rules: Quotas, *, name: str, tables: Sequence[str] = ()
    ) -> None:
        """Create a helper whose process starts at the first query.

        Args:
            make_setup: creates the setup for answers, in the helper process.
            answer: computes an answer, in the helper process.
            rules: limits with the time for one answer.
            name: name of the process.
            tables: modules that are imported once for all processes.
        """
        self._make_setup, self._answer, self._rules, self._name = make_setup, answer, rules, name
        self._tables = tables
        self._thread = ThreadPoolExecutor(1, thread_name_prefix=name)
        self._process: tuple[Child, PipeEnd] | None = None
        self._waiting: dict[tuple[int, str], tuple[Q, Reply]] = {}  # by client and kind, in order of arrival
        self._task: Task[None] | None = None
        self._is_outdated = False  # whether gestures were saved since the last query

    def warm_up(self) -> None:
        """Start the helper process if it does not run."""
        if self._task is None or self._task.done():
            self._task = create_task(self._answer_all())

    def ask(self, client: int, question: Q, reply: Reply, *, kind: str = "") -> None:
        """Queue a query, replacing a waiting one of this client and kind.

        Args:
            client: number of the client.
            question: picklable query.
            reply: called with the answer.
            kind: kind of the query; queries of other kinds are not replaced.
        """
        older = self._waiting.get((client, kind))
        self._waiting[client, kind] = question, reply
        if older is not None:
            older[1](Unanswered.OUTDATED)
        self.warm_up()

    def renew(self) -> None:
        """Reload the gesture lexicon before the next answer."""
        self._is_outdated = True

    def close(self) -> None:
        """End the helper process.

        Waiting queries get no answer.
        """
        self._waiting.clear()
        if self._task is not None:
            self._task.cancel()
        self._end()
        self._thread.shutdown(wait=False, cancel_futures=True)

    async def _answer_all(self) -> None:
        if not self._waiting:
            await self._try(self._connect)
        while self._waiting:
            question, reply = self._waiting.pop(next(iter(self._waiting)))
            answer = await self._try(partial(self._exchange, question))
            reply(Unanswered.FAILED if answer is None else answer)

    async def _try(self, action: Callable[[], Coroutine[None, None, R]]) -> R | None:
        """Return the result of an exchange with the process, None on failure.

        After a failure or timeout, the process is killed.

        The next query starts another process.
        """
        try:
            return await action()
        except (TimeoutError, EOFError, OSError):
            self._end()
            return None

    async def _connect(self) -> PipeEnd:
        if self._process is None:
            self._process = await self._wait_for(self._begin)
            async with timeout(SETUP_TIMEOUT):
                await self._wait_for(self._process[1].recv_bytes)
        return self._process[1]

    async def _exchange(self, question: Q) -> str:
        line, is_renewed = await self._connect(), self._is_outdated
        self._is_outdated = False
        async with timeout(self._rules.planning):
            return await self._wait_for(lambda: _exchange(line, (question, is_renewed)))

    async def _wait_for(self, action: Callable[[], R]) -> R:
        return await get_running_loop().run_in_executor(self._thread, action)

    def _begin(self) -> tuple[Child, PipeEnd]:
        context = planning_context(self._make_setup, self._tables)
        server_end, helper_end = context.Pipe()
        arguments = (self._make_setup, helper_end, self._answer, self._rules)
        return Child(context, run_helper, *arguments, name=self._name), server_end

    def _end(self) -> None:
        """Kill the process, which also unblocks its thread."""
        if self._process is not None:
            self._process[0].kill(wait=False)
            self._process = None


def _exchange(line: PipeEnd, message: object) -> str:
    line.send_bytes(pickle.dumps(message, pickle.HIGHEST_PROTOCOL))
    return line.recv_bytes().decode()
