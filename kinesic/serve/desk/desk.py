"""Answers clients' questions; nothing of it is worked out in the thread that reads clients."""

from collections.abc import Awaitable, Callable
from functools import partial
from pathlib import Path

from kinesic.planning.setup import Setup
from kinesic.serve.desk.asker import Asker
from kinesic.serve.desk.drafter import ClientQuestion, DraftQuestion, answer_draft, unanswered_draft
from kinesic.serve.desk.dragging import answer_reach, unanswered_reach
from kinesic.serve.desk.export import NO_WRITERS, Writers
from kinesic.serve.desk.helper import Helper, Unanswered
from kinesic.serve.desk.keeper import DocumentKeeper
from kinesic.serve.desk.watches import Watches
from kinesic.serve.loop import Loop
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import (
    ExportQuestion,
    GestureQuestion,
    OpenRequest,
    PlanQuestion,
    Question,
    ReachQuestion,
    SaveRequest,
    ServosQuestion,
    WatchRequest,
)
from kinesic.serve.wire.quotas import Quotas


async def _know_already() -> None:
    """What is done about saved gestures where nobody performs."""


class Desk:
    """Answers questions, now or when the answer is known; never waits."""

    def __init__(
        self,
        make_setup: Callable[[], Setup],
        loop: Loop,
        rules: Quotas,
        *,
        folder: Path | None = None,
        on_gestures_saved: Callable[[], Awaitable[None]] = _know_already,
        writers: Writers = NO_WRITERS,
    ) -> None:
        """Opens; nothing is begun before the first question.

        Args:
            make_setup: makes what planning needs, in other processes.
            loop: of the robot that is watched.
            rules: for documents that are planned.
            folder: where documents are kept; None: nowhere.
            on_gestures_saved: returns when saved gestures will be known to whatever comes next.
            writers: of files that the desk does not know how to write; picklable.
        """
        self._rules, self._loop = rules, loop
        self._watches = Watches(loop.body)
        drafts = partial(answer_draft, writers=writers)
        self.drafter = Helper[DraftQuestion](make_setup, drafts, rules, name="drafter")
        self._reacher = Helper[ReachQuestion](make_setup, answer_reach, rules, name="reacher")
        self._keeper = DocumentKeeper(folder, self.drafter, rules, on_gestures_saved)

    def answer(self, asker: Asker, question: Question) -> None:
        """Answers a question."""
        match question:
            case ReachQuestion():
                self._reacher.ask(asker.number, question, partial(self._tell_reach, asker, question))
            case GestureQuestion(toml=None):  # for a file, which no plan makes outdated
                self.drafter.ask(asker.number, question, partial(self._tell_draft, asker, question), kind="file")
            case PlanQuestion() | GestureQuestion():
                self.drafter.ask(asker.number, question, partial(self._tell_draft, asker, question))
                self._reacher.warm_up()  # whoever writes may drag a hand soon
            case ExportQuestion():
                self.drafter.ask(asker.number, question, partial(self._tell_draft, asker, question), kind="export")
            case WatchRequest(rate):
                self._watches.set(asker, rate)
            case ServosQuestion(id):
                servos = self._loop.servos
                asker.send(json_answer("servos", id=id, servos=() if servos is None else servos.members))
            case SaveRequest() | OpenRequest():
                self._keeper.take(asker, question)

    def close(self) -> None:
        """Ends all that it has begun."""
        self._watches.close()
        self._keeper.close()
        self.drafter.close()
        self._reacher.close()

    def _tell_reach(self, asker: Asker, question: ReachQuestion, found: str | Unanswered) -> None:
        asker.send(unanswered_reach(question, found) if isinstance(found, Unanswered) else found)

    def _tell_draft(self, asker: Asker, question: ClientQuestion, found: str | Unanswered) -> None:
        asker.send(unanswered_draft(question, found, self._rules) if isinstance(found, Unanswered) else found)
