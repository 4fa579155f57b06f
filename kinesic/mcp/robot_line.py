"""The connections of tools to the server that performs: one for questions and documents, one that only stops."""

import json
import re
from collections import deque
from queue import Empty, Queue
from threading import Lock, Thread
from typing import TypeVar
from xml.sax.saxutils import unescape

from kinesic.client import Client, StopLine
from kinesic.mcp.teaching import Json

KEPT_FEEDBACK = 40  # messages of feedback that status shows
LONGEST_WAIT = 15.0  # [s] for an answer
# The id in the first tag of a feedback: of a warning the block or behaviour, of progress also `:` and the sync point.
_SUBJECT = re.compile(r'^<\w+ [^>]*?\bid="([^"]+)"')
# The id of the block in a predictionFeedback, whose own tag has none.
_PREDICTED_BLOCK = re.compile(r'<bml [^>]*?\bid="([^"]+)"')

RobotAnswer = dict[str, Json]
T = TypeVar("T")


class RobotError(RuntimeError):
    """The server is gone or has not answered in time; the text says which of both, and what to do."""


class RobotLine:
    """A connection for questions and documents, whose messages a thread reads, and another one for stops."""

    def __init__(self, host: str, port: int, *, token: str | None = None) -> None:
        """Connects.

        Raises:
            OSError: nobody is there.
            PermissionError: the token is wrong, or missing.
        """
        self._stop_line = StopLine(host, port, token=token)
        try:
            self._client = Client(host, port, token=token)
        except OSError:
            self._stop_line.close()
            raise
        self._sending, self._stopping = Lock(), Lock()
        self._asked = 0  # questions so far
        self._answers: dict[
            int, Queue[RobotAnswer | RobotError]
        ] = {}  # who waits for one, by the number of the question
        # Who waits to hear of a block: why it is refused, or nothing once it is expected to begin.
        self._verdicts: dict[str, Queue[str | RobotError]] = {}
        self._performed = set[str]()  # blocks of this connection whose end was not told yet
        self._gone: RobotError | None = None  # once the server has closed the connection
        self._feedback = deque[str](maxlen=KEPT_FEEDBACK)
        Thread(target=self._read, daemon=True, name="feedback").start()

    def ask(self, verb: str, **values: Json) -> RobotAnswer:
        """Asks a question of docs/serve.md, and waits for its answer.

        Raises:
            RobotError: there is none.
        """
        answers: Queue[RobotAnswer | RobotError] = Queue()
        with self._sending:
            self._asked += 1
            number = self._asked
        self._answers[number] = answers
        try:
            with self._sending:
                self._send(json.dumps({"do": verb, "id": number, **values}))
            return _next(answers)
        finally:
            self._answers.pop(number, None)

    def status(self) -> RobotAnswer:
        """Says how the robot is, and the last messages of feedback.

        Raises:
            RobotError: nobody answers.
        """
        return {**self.ask("status"), "feedback": list(self._feedback)}

    def perform(self, document: str, block: str) -> str:
        """Sends a document, and waits until its block is expected to be performed or refused.

        Args:
            document: BML, as XML or JSON.
            block: its id.

        Returns:
            Why it is refused; empty where it is performed.

        Raises:
            RobotError: nobody answers.
        """
        if block in self._performed:  # what is told of one could not be told from what is told of the other
            return f"the block {block} is not over yet: give each block an id of its own"
        verdict = self._verdicts[block] = Queue[str | RobotError]()
        try:
            with self._sending:
                self._send(document)
            why = _next(verdict)
        finally:
            self._verdicts.pop(block, None)
        if why:
            self._performed.discard(block)
        return why

    def tell(self, verb: str) -> None:
        """Sends a control message without an answer.

        Raises:
            RobotError: the server is gone.
        """
        with self._sending:
            self._send(json.dumps({"do": verb}))

    def stop(self) -> None:
        """Stops the robot in the least time, whatever else waits for an answer.

        Raises:
            RobotError: the server does not say that it has stopped.
        """
        with self._stopping:
            try:
                self._stop_line.stop()
            except OSError as error:
                raise RobotError(f"{error}: use the switch that cuts the power") from None

    def close(self) -> None:
        """Closes the connections; what was sent is performed all the same."""
        self._client.close()
        self._stop_line.close()

    def _send(self, message: str) -> None:
        if self._gone is not None:
            raise self._gone
        try:
            self._client.send(message)
        except OSError as error:
            raise RobotError(f"the server is gone ({error}): start it again") from None

    def _read(self) -> None:
        """Hands messages to those who wait for them, until the server is gone or the connection is closed here."""
        while True:
            try:
                message = self._client.receive()
            except (OSError, ValueError) as error:  # the latter: closed just before it waits again
                self._end(error)
                return
            if message is not None:
                self._hand_over(message)

    def _end(self, why: Exception) -> None:
        """Tells all who wait that the server is gone, and whoever asks from now on."""
        self._gone = RobotError(f"the server is gone ({why}): start it again")
        with self._sending:  # whoever sends from now on sees that it is gone
            answers, verdicts = list(self._answers.values()), list(self._verdicts.values())
        for answer in answers:
            answer.put(self._gone)
        for verdict in verdicts:
            verdict.put(self._gone)

    def _hand_over(self, message: str) -> None:
        """Gives an answer to whoever asked, and what is told of a block to whoever sent it."""
        if message.startswith("{"):
            answer: RobotAnswer = json.loads(message)
            number = answer.get("id")
            waiting = self._answers.get(number) if isinstance(number, int) else None
            if waiting is not None:
                waiting.put(answer)
            return
        self._feedback.append(message)
        found = _SUBJECT.match(message) or _PREDICTED_BLOCK.search(message)
        subject = unescape(found[1], {"&quot;": '"'}) if found else ""
        kind = message.partition(" ")[0].partition(">")[0]
        if kind == "<blockProgress" and subject.endswith(":end"):
            self._performed.discard(subject.removesuffix(":end"))
        elif kind == "<warningFeedback" and _is_over(message):
            self._performed.discard(subject)
        verdict = self._verdicts.get(subject) or self._verdicts.get(subject.rpartition(":")[0])
        if verdict is None:
            return
        if kind == "<warningFeedback" and _refuses(message):
            verdict.put(unescape(message.partition(">")[2].partition("<")[0]) or "it is refused without a reason")
        elif kind in ("<predictionFeedback", "<blockProgress"):
            self._performed.add(subject if subject in self._verdicts else subject.rpartition(":")[0])
            verdict.put("")


def _refuses(message: str) -> bool:
    text = message.partition(">")[2]
    return "PARSING_FAILURE" in message.partition(">")[0] or text.startswith(("rule ", "not performed"))


def _is_over(message: str) -> bool:
    """Whether a warning about a block says that no end will be told of it."""
    return _refuses(message) or message.partition(">")[2].startswith(("revoked", "a block of this id"))


def _next(queue: Queue[T | RobotError]) -> T:
    try:
        found = queue.get(timeout=LONGEST_WAIT)
    except Empty:
        raise RobotError(f"the server has not answered in {LONGEST_WAIT:g} s; ask for status") from None
    if isinstance(found, RobotError):
        raise found
    return found
