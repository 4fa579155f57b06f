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

KEPT = 40  # messages of feedback
ANSWER = 15.0  # [s] that an answer may take
_BLOCK = re.compile(r'^<\w+ [^>]*?\bid="([^":]+)')
_PREDICTED = re.compile(r'<bml [^>]*?\bid="([^"]+)"')

Answer = dict[str, Json]
T = TypeVar("T")


class RobotError(RuntimeError):
    """The server is gone, does not answer or refuses; says so."""


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
        self._sending, self._asking, self._stopping = Lock(), Lock(), Lock()
        self._asked = 0  # questions so far
        self._answers: dict[int, Queue[Answer]] = {}  # to those who wait for them, by the number of the question
        self._status: Queue[Answer] = Queue()  # answers to `status`, which have no number
        self._begun: dict[str, Queue[str]] = {}  # by block: why it is refused, or nothing once it is expected to begin
        self._feedback = deque[str](maxlen=KEPT)
        Thread(target=self._read, daemon=True, name="feedback").start()

    def ask(self, verb: str, **values: Json) -> Answer:
        """Asks a question of docs/serve.md, and waits for its answer.

        Raises:
            RobotError: there is none.
        """
        answers: Queue[Answer] = Queue()
        with self._sending:
            self._asked += 1
            number = self._asked
            self._answers[number] = answers
            self._send(json.dumps({"do": verb, "id": number, **values}))
        try:
            return _next(answers)
        finally:
            self._answers.pop(number, None)

    def status(self) -> Answer:
        """Says how the robot is, and the last messages of feedback.

        Raises:
            RobotError: nobody answers.
        """
        with self._asking:
            while not self._status.empty():  # answers that came too late
                self._status.get_nowait()
            with self._sending:
                self._send('{"do": "status"}')
            told: Answer = _next(self._status)
        return {**told, "feedback": list(self._feedback)}

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
        told = self._begun[block] = Queue[str]()
        try:
            with self._sending:
                self._send(document)
            return _next(told)
        finally:
            self._begun.pop(block, None)

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
        try:
            self._client.send(message)
        except OSError as error:
            raise RobotError(f"the server is gone ({error}): start it again") from None

    def _read(self) -> None:
        """Hands messages to those who wait for them, until the server is gone or the connection is closed here."""
        while True:
            try:
                message = self._client.receive()
            except (OSError, ValueError):  # the latter: closed just before it waits again
                return
            if message is not None:
                self._take(message)

    def _take(self, message: str) -> None:
        if message.startswith("{"):
            answer: Answer = json.loads(message)
            number = answer.get("id")
            waiting = self._answers.get(number) if isinstance(number, int) else None
            if waiting is not None:
                waiting.put(answer)
            elif answer.get("told") == "status":
                self._status.put(answer)
            return
        self._feedback.append(message)
        kind, found = message.partition(" ")[0], _BLOCK.match(message) or _PREDICTED.search(message)
        told = self._begun.get(found[1]) if found else None
        if told is None:
            return
        if kind == "<warningFeedback" and _refuses(message):
            told.put(unescape(message.partition(">")[2].partition("<")[0]) or "it is refused without a reason")
        elif kind in ("<predictionFeedback", "<blockProgress"):
            told.put("")


def _refuses(message: str) -> bool:
    text = message.partition(">")[2]
    return "PARSING_FAILURE" in message.partition(">")[0] or text.startswith(("rule ", "not performed"))


def _next(queue: Queue[T]) -> T:
    try:
        return queue.get(timeout=ANSWER)
    except Empty:
        raise RobotError(f"the server has not answered in {ANSWER:g} s; ask for status") from None
