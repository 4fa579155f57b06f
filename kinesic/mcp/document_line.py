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

from kinesic.bml.block import DEFAULT_BLOCK_ID
from kinesic.client import Client
from kinesic.mcp.document_schema import Json
from kinesic.mcp.errors import RefusedError, RobotError
from kinesic.mcp.feedback import Feedback, read_feedback
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS, UNKNOWN_ID

MAX_KEPT_WARNINGS = 5  # number of most recent warnings kept for status answers
MAX_KEPT_OUTCOMES = 256  # number of most recently ended blocks whose outcome is kept
PHRASE_WAIT = 2.0  # [s] longest wait for the first phrase of a streamed text
MAX_WAIT = 15.0  # [s] longest wait for the server's answer to a message
NO_CONVERSATION = "off"  # state without a conversation
MAX_MESSAGE_SIZE = DEFAULT_QUOTAS.message  # [bytes] largest message; the server ends the connection at a longer one

RobotAnswer = Mapping[str, Json]
T = TypeVar("T")  # type of an answer


@dataclass(eq=False)
class _Verdict:
    """Pending answer to a document: its refusal reason, empty if accepted."""

    block: str
    names: frozenset[str]  # ids under which the server's refusal may name the block
    future: Future[str] = field(default_factory=Future)


class DocumentLine:
    """Connection to the robot's server for BML documents and queries.

    One call of `perform` or `speak` at a time.
    """

    def __init__(self, connect: Callable[[], Client]) -> None:
        """Open the connection for documents.

        Raises:
            OSError: no server listens.
        """
        self._client = connect()
        self._sender = ThreadPoolExecutor(1, thread_name_prefix="documents")
        self._count = 0  # number of queries sent
        self._answers: dict[int, Future[RobotAnswer]] = {}  # pending answers by number of the query
        self._verdict: _Verdict | None = None  # pending answer to the last document
        self._playing = set[str]()  # blocks of this connection that have not ended
        self._phrase: Future[str] | None = None  # block of the first phrase of a streamed text, once it is spoken
        self._is_talking = False  # whether streamed text waits or is being spoken
        self._gone: RobotError | None = None  # set when the server has closed the connection
        self._warnings = deque[str](maxlen=MAX_KEPT_WARNINGS)
        self._outcomes: dict[str, str] = {}  # outcomes of ended blocks by id, the latest last
        self._conversation = NO_CONVERSATION  # state of the conversation
        self._refusal = ""  # why the server refuses the last request to converse
        Thread(target=self._read, daemon=True, name="feedback").start()

    @property
    def warnings(self) -> list[str]:
        """Last warnings, each prefixed with the id of its block or behaviour."""
        return list(self._warnings)

    @property
    def is_playing(self) -> bool:
        """Whether a block or streamed text of this connection has not ended."""
        return bool(self._playing) or self._is_talking

    @property
    def accepted_blocks(self) -> frozenset[str]:
        """Ids of this connection's predicted blocks that have not ended."""
        return frozenset(self._playing.copy())

    @property
    def is_talking(self) -> bool:
        """Whether streamed text of this connection waits or is being spoken."""
        return self._is_talking

    @property
    def conversation(self) -> str:
        """State of this connection's conversation, such as `listening`.

        It is `off` without a conversation.
        """
        return self._conversation

    def outcome(self, block: str) -> str | None:
        """Return the outcome of a block of this connection, None if unknown.

        Returns:
            For example `finished`; empty for a block that has not ended, None for an unknown one.
        """
        return "" if block in self._playing else self._outcomes.get(block)

    async def ask(self, verb: str, **values: Json) -> RobotAnswer:
        """Send a query of docs/reference/wire-protocol.md and wait for the answer.

        Raises:
            RefusedError: the message exceeds the server's size limit.
            RobotError: there is no answer in time.
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
        """Send a document and wait until its block is predicted or refused.

        Args:
            document: BML in any notation.
            block: id of its block.
            names: further ids by which the server may refuse it.

        Returns:
            Reason of the refusal; empty if the block is expected to begin.

        Raises:
            RefusedError: the message exceeds the server's size limit.
            RobotError: there is no answer in time.
        """
        if block in self._playing:  # feedback would be ambiguous
            return f"the block {block} has not ended yet: give each block a unique id"
        self._verdict = verdict = _Verdict(block, frozenset((block, UNKNOWN_ID, *names)))
        await self.send(lambda: document)
        return await _in_time(verdict.future)

    async def speak(self, text: str, style: str) -> str:
        """Stream a text, which the server divides into phrases.

        Args:
            text: complete text.
            style: its name; empty: that of the server.

        Returns:
            Block of the first phrase; empty if it waits for running blocks.

        Raises:
            RefusedError: the server refuses the text.
            RobotError: the server has closed the connection.
        """
        phrase: Future[str] = Future()
        self._phrase = phrase
        message = json.dumps({"do": "words", "text": text, "ends": True, "style": style}, ensure_ascii=False)
        await self.send(lambda: message)
        self._is_talking = True
        try:
            async with timeout(PHRASE_WAIT):
                return await wrap_future(phrase)
        except TimeoutError:
            return ""

    async def converse(self, *, on: bool, amount: float, fillers: bool) -> str:
        """Begin or end a conversation, and return its state.

        Args:
            on: whether the robot converses.
            amount: amount of movement, 0..1.
            fillers: whether the robot says a short filler while an answer takes long.

        Raises:
            RefusedError: the robot cannot move now.
            RobotError: there is no answer in time.
        """
        self._refusal = ""
        request = json.dumps({"do": "converse", "on": on, "amount": amount, "fillers": fillers})
        await self.send(lambda: request)
        await self.ask("status")  # answered after a refusal
        if self._refusal:
            raise RefusedError(self._refusal)
        if not on:
            self._conversation = NO_CONVERSATION
        elif self._conversation == NO_CONVERSATION:
            self._conversation = "idle"  # until the planner reports another state
        return self._conversation

    def end_talk(self) -> None:
        """Mark the streamed text as ended, after an emergency stop."""
        self._is_talking = False

    async def send(self, write: Callable[[], str]) -> None:
        """Send a message in order, unless its caller is cancelled.

        Args:
            write: creates the message, in the sending thread.

        Raises:
            RefusedError: the message exceeds the server's size limit.
            RobotError: the server has closed the connection.
        """
        await get_running_loop().run_in_executor(self._sender, self._send, write)

    def close(self) -> None:
        """Close the connection for documents.

        The server still performs blocks that were sent.
        """
        self._sender.shutdown(wait=False, cancel_futures=True)
        self._client.close()

    def _send(self, write: Callable[[], str]) -> None:
        message = write().encode()
        if len(message) > MAX_MESSAGE_SIZE:
            what = f"the message has {len(message)} bytes, at most {MAX_MESSAGE_SIZE} are accepted"
            raise RefusedError(f"{what}: send it in parts")
        if self._gone is not None:
            raise self._gone
        try:
            self._client.send_bytes(message)
        except OSError as error:
            self._client.close()  # part of the message may be sent already
            raise _gone(error) from None

    def _read(self) -> None:
        """Pass received messages to waiting calls until the connection ends."""
        while True:
            try:
                message = self._client.receive()
            except (OSError, ValueError) as error:  # ValueError: closed just before the next wait
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
            self._follow_state(answer)
            number = answer.get("id")
            waiting = self._answers.get(number) if isinstance(number, int) else None
            if waiting is not None:
                _settle(waiting, answer)
            return
        feedback = read_feedback(message)
        if feedback is not None:
            self._judge(feedback)

    def _follow_state(self, answer: RobotAnswer) -> None:
        """Record the states of streamed text and conversation.

        The first phrase settles the call that waits for it.
        """
        match answer:
            case {"told": "saying", "block": str(block)} if self._phrase is not None:
                _settle(self._phrase, block)
            case {"told": "all_said"}:
                self._is_talking = False
            case {"told": "conversing", "state": str(state)}:
                self._conversation = state
            case {"told": "refused", "do": "converse", "why": str(why)}:
                self._refusal = why

    def _judge(self, feedback: Feedback) -> None:
        """Record a feedback message and answer the calls that wait for it."""
        if feedback.kind == "predictionFeedback":
            self._playing.add(feedback.subject)
        if feedback.kind == "warningFeedback":
            self._warnings.append(f"{feedback.subject}: {feedback.text}")
        if ended := feedback.ended_block:
            self._outcomes.pop(ended, None)
            self._outcomes[ended] = feedback.outcome
            for oldest in tuple(self._outcomes)[:-MAX_KEPT_OUTCOMES]:
                del self._outcomes[oldest]
            self._playing.discard(ended)
            self._is_talking = self._is_talking and feedback.outcome == "finished"
        verdict = self._verdict
        if feedback.is_refusal and feedback.subject == UNKNOWN_ID:  # a message that the server has not parsed
            for answer in tuple(self._answers.values()):
                _fail(answer, RobotError(feedback.text))
        if feedback.is_refusal and feedback.subject in (UNKNOWN_ID, DEFAULT_BLOCK_ID) and self._phrase is not None:
            self._is_talking = False
            _fail(self._phrase, RefusedError(feedback.text))
        if verdict is None:
            return
        if feedback.begins(verdict.block):
            _settle(verdict.future, "")
        elif feedback.is_refusal and feedback.subject in verdict.names:
            _settle(verdict.future, feedback.text or "refused without a reason")


def _gone(why: Exception) -> RobotError:
    return RobotError(f"the server is gone ({why}): start it again")


def _settle(future: Future[T], result: T) -> None:
    with suppress(InvalidStateError):  # the caller was cancelled
        future.set_result(result)


def _fail(future: Future[T], error: Exception) -> None:
    with suppress(InvalidStateError):
        future.set_exception(error)


async def _in_time(future: Future[T]) -> T:
    try:
        async with timeout(MAX_WAIT):
            return await wrap_future(future)
    except TimeoutError:
        raise RobotError(f"the server has not answered in {MAX_WAIT:g} s; ask for status") from None
