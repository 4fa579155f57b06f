"""Connection for documents and plans, with a sending and a reading thread."""

import json
from asyncio import get_running_loop, timeout, wrap_future
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future, InvalidStateError, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from threading import Thread
from typing import TypeVar

from kinesic.client import Client
from kinesic.mcp.errors import RefusedError, RobotError
from kinesic.mcp.feedback import Feedback, read_feedback
from kinesic.mcp.teaching import Json
from kinesic.serve.wire.quotas import NOBODY, USUAL

MAX_KEPT_FEEDBACK = 40  # messages
MAX_WAIT = 15.0  # [s] for an answer
MAX_MESSAGE = USUAL.message  # [bytes]; a longer one would end the connection

RobotAnswer = Mapping[str, Json]
T = TypeVar("T")


@dataclass(eq=False)
class _Verdict:
    """Pending verdict: the reason of a refusal, or an empty text."""

    block: str
    names: frozenset[str]  # ids by which the server may refuse it
    future: Future[str] = field(default_factory=Future)


class DocumentLine:
    """Sends documents and questions of one call at a time."""

    def __init__(self, connect: Callable[[], Client]) -> None:
        """Connect.

        Raises:
            OSError: nobody is there.
        """
        self._client = connect()
        self._sender = ThreadPoolExecutor(1, thread_name_prefix="documents")
        self._count = 0  # questions so far
        self._answers: dict[int, Future[RobotAnswer]] = {}  # by the number of the question
        self._verdict: _Verdict | None = None  # of the last document
        self._playing = set[str]()  # blocks of this connection whose end has not come
        self._gone: RobotError | None = None  # once the server has closed the connection
        self._feedback = deque[str](maxlen=MAX_KEPT_FEEDBACK)
        Thread(target=self._read, daemon=True, name="feedback").start()

    @property
    def feedback(self) -> list[str]:
        """The last messages of feedback."""
        return list(self._feedback)

    async def ask(self, verb: str, **values: Json) -> RobotAnswer:
        """Ask a question of docs/serve.md, and wait for its answer.

        Raises:
            RefusedError: the message is longer than the server takes.
            RobotError: no answer came.
        """
        self._count += 1
        number = self._count
        answer = self._answers[number] = Future()
        try:
            await self.send(lambda: json.dumps({"do": verb, "id": number, **values}, ensure_ascii=False))
            return await _in_time(answer)
        finally:
            del self._answers[number]

    async def perform(self, document: str, block: str, *names: str) -> str:
        """Send a document, and wait until its block is predicted or refused.

        Args:
            document: BML in any notation.
            block: id of its block.
            names: further ids by which the server may refuse it.

        Returns:
            Why it is refused; empty if it is expected to begin.

        Raises:
            RefusedError: the message is longer than the server takes.
            RobotError: no answer came.
        """
        if block in self._playing:  # feedback about one could not be told from feedback about the other
            return f"the block {block} is not over yet: give each block an id of its own"
        self._verdict = verdict = _Verdict(block, frozenset((block, NOBODY, *names)))
        await self.send(lambda: document)
        return await _in_time(verdict.future)

    async def send(self, write: Callable[[], str]) -> None:
        """Send a message after all earlier ones, unless the caller leaves.

        Args:
            write: writes the message, in the thread that sends.

        Raises:
            RefusedError: it is longer than the server takes.
            RobotError: the server is gone.
        """
        await get_running_loop().run_in_executor(self._sender, self._send, write)

    def close(self) -> None:
        """Close the connection, and leave blocks that were sent to the server."""
        self._sender.shutdown(wait=False, cancel_futures=True)
        self._client.close()

    def _send(self, write: Callable[[], str]) -> None:
        message = write().encode()
        if len(message) > MAX_MESSAGE:
            what = f"as a message the document takes {len(message)} bytes, at most {MAX_MESSAGE} are taken"
            raise RefusedError(f"{what}: send it in parts")
        if self._gone is not None:
            raise self._gone
        try:
            self._client.send_bytes(message)
        except OSError as error:
            self._client.close()  # half of the message may be on its way, and nothing can follow it
            raise _gone(error) from None

    def _read(self) -> None:
        """Hand messages to the waiting calls until the connection ends."""
        while True:
            try:
                message = self._client.receive()
            except (OSError, ValueError) as error:  # the latter: closed just before it waits again
                self._end(error)
                return
            if message is not None:
                self._hand_over(message)

    def _end(self, why: Exception) -> None:
        self._gone = _gone(why)
        verdict = self._verdict
        for future in (*self._answers.values(), *(() if verdict is None else (verdict.future,))):
            _fail(future, self._gone)

    def _hand_over(self, message: str) -> None:
        if message.startswith("{"):
            answer: RobotAnswer = json.loads(message)
            number = answer.get("id")
            waiting = self._answers.get(number) if isinstance(number, int) else None
            if waiting is not None:
                _settle(waiting, answer)
            return
        self._feedback.append(message)
        feedback = read_feedback(message)
        if feedback is not None:
            self._judge(feedback)

    def _judge(self, feedback: Feedback) -> None:
        """Hand the verdict of a feedback to the waiting call."""
        if feedback.kind == "predictionFeedback":
            self._playing.add(feedback.subject)
        self._playing.discard(feedback.ended_block)
        verdict = self._verdict
        if feedback.is_refusal and feedback.subject == NOBODY:  # a message that the server has not even read
            for answer in tuple(self._answers.values()):
                _fail(answer, RobotError(feedback.text))
        if verdict is None:
            return
        if feedback.begins(verdict.block):
            _settle(verdict.future, "")
        elif feedback.is_refusal and feedback.subject in verdict.names:
            _settle(verdict.future, feedback.text or "it is refused without a reason")


def _gone(why: Exception) -> RobotError:
    return RobotError(f"the server is gone ({why}): start it again")


def _settle(future: Future[T], result: T) -> None:
    with suppress(InvalidStateError):  # the caller has left
        future.set_result(result)


def _fail(future: Future[T], error: RobotError) -> None:
    with suppress(InvalidStateError):
        future.set_exception(error)


async def _in_time(future: Future[T]) -> T:
    try:
        async with timeout(MAX_WAIT):
            return await wrap_future(future)
    except TimeoutError:
        raise RobotError(f"the server has not answered in {MAX_WAIT:g} s; ask for status") from None
