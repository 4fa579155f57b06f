"""The process that drafts: plans documents for whoever asks, so that neither the loop nor other clients wait."""

import traceback
from asyncio import TimerHandle, get_running_loop
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection

from kinesic.bml.block import Bounds
from kinesic.body.config import ConfigError
from kinesic.child import Child, child_context
from kinesic.controller import perform
from kinesic.planning.setup import Setup
from kinesic.serve import planner
from kinesic.serve.desk.draft import Json, draft
from kinesic.serve.desk.gesture import draft_gesture, gesture_text
from kinesic.serve.planner import DEFECTS
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import GestureQuestion, PlanQuestion
from kinesic.serve.wire.quotas import Quotas

Send = Callable[[str], None]
DraftQuestion = PlanQuestion | GestureQuestion


def run_drafter(make_setup: Callable[[], Setup], questions: Connection, rules: Quotas) -> None:
    """Answers one question after the other until the server is gone.

    Args:
        make_setup: makes what planning needs.
        questions: of clients; answers go back the same way.
        rules: how large a document may be, and how long a block.
    """
    setup, bounds = make_setup(), Bounds(rules.message, rules.depth)
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        while True:
            question: DraftQuestion = questions.recv()
            found: dict[str, Json]
            try:
                found = _answer(question, setup, bounds, rules.duration)
            except DEFECTS as error:
                traceback.print_exception(error)
                found = _failure(f"planning failed ({type(error).__name__}); please report the document")
            questions.send(json_answer(message_type(question), id=question.id, **found))


class Drafter:
    """Has questions answered one by one; of a client's that wait, only the newest."""

    def __init__(self, make_setup: Callable[[], Setup], rules: Quotas) -> None:
        """Begins no process before the first question.

        Args:
            make_setup: makes what planning needs, in the other process.
            rules: how large a document may be, and how long planning may take.
        """
        self._make_setup, self._rules = make_setup, rules
        self._child: Child | None = None
        self._pipe: Connection | None = None
        self._waiting: dict[int, tuple[DraftQuestion, Send]] = {}  # by client
        self._in_progress: tuple[DraftQuestion, Send] | None = None
        self._timeout: TimerHandle | None = None

    def ask(self, client: int, question: DraftQuestion, send: Send) -> None:
        """Takes a question; an older one of this client's that still waits is answered as outdated."""
        older = self._waiting.pop(client, None)
        if older is not None:
            older[1](json_answer(message_type(older[0]), id=older[0].id, outdated=True))
        self._waiting[client] = (question, send)
        self._next()

    def warm_up(self) -> None:
        """Begins the process before anybody asks."""
        if self._pipe is None:
            self._begin()

    def renew(self) -> None:
        """Restarts the process, so that it loads new gestures; a question in progress is answered as outdated."""
        self._end()
        self._cancel_timeout()
        present, self._in_progress = self._in_progress, None
        if present is not None:
            present[1](json_answer(message_type(present[0]), id=present[0].id, outdated=True))
        self._next()

    def close(self) -> None:
        """Ends the process; nobody is answered any more."""
        self._cancel_timeout()
        self._waiting.clear()
        self._in_progress = None
        self._end()

    def _next(self) -> None:
        if self._in_progress is not None or not self._waiting:
            return
        self.warm_up()
        self._in_progress = self._waiting.pop(next(iter(self._waiting)))
        with suppress(OSError):  # it has died, as the reader finds out
            if self._pipe is not None:
                self._pipe.send(self._in_progress[0])
        self._timeout = get_running_loop().call_later(self._rules.planning, self._give_up)

    def _begin(self) -> None:
        context = child_context(planner.__name__, perform.__name__, self._make_setup.__module__)
        self._pipe, theirs = context.Pipe()
        self._child = Child(context, run_drafter, self._make_setup, theirs, self._rules, name="drafter")
        get_running_loop().add_reader(self._pipe.fileno(), self._receive)

    def _receive(self) -> None:
        if self._pipe is None:
            return
        try:
            self._finish(self._pipe.recv())
        except (EOFError, OSError):
            self._give_up()

    def _give_up(self) -> None:
        """Ends a process that has died or takes too long; the next question begins another."""
        self._end()
        if self._in_progress is not None:
            what = f"planning failed, or took longer than {self._rules.planning:g} s; send something simpler"
            self._finish(json_answer(message_type(self._in_progress[0]), id=self._in_progress[0].id, **_failure(what)))

    def _finish(self, answer: str) -> None:
        self._cancel_timeout()
        present, self._in_progress = self._in_progress, None
        if present is not None:
            present[1](answer)
        self._next()

    def _cancel_timeout(self) -> None:
        if self._timeout is not None:
            self._timeout.cancel()

    def _end(self) -> None:
        if self._pipe is not None:
            get_running_loop().remove_reader(self._pipe.fileno())
            self._pipe.close()
            self._pipe = None
        if self._child is not None:
            self._child.kill()
            self._child = None


def message_type(question: DraftQuestion) -> str:
    """Returns the message type that a question and its answer share."""
    return "plan" if isinstance(question, PlanQuestion) else "gesture"


def _answer(question: DraftQuestion, setup: Setup, bounds: Bounds, longest: float) -> dict[str, Json]:
    match question:
        case PlanQuestion(bml, changes):
            return draft(bml, changes, setup, bounds=bounds, longest=longest)
        case GestureQuestion(str(toml), None, changes):
            return draft_gesture(toml, changes, setup)
        case GestureQuestion(None, str(lexeme)):
            try:
                return {"toml": gesture_text(lexeme, setup.lexicon)}
            except ConfigError as error:
                return _failure(str(error))
    return _failure("give either toml or lexeme")


def _failure(text: str) -> dict[str, Json]:
    return {"error": {"line": 1, "column": 1, "text": text}}
