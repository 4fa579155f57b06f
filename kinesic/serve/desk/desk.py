"""Dispatcher of client queries.

No answer is computed in the thread that reads client messages.
"""

from collections.abc import Awaitable, Callable, Sequence
from functools import partial
from pathlib import Path

from kinesic.planning.setup import Setup
from kinesic.serve.desk.drafter import ANSWER_NAMES, ClientQuestion, DraftQuestion, answer_draft, draft_failure
from kinesic.serve.desk.dragging import answer_reach, reach_failure
from kinesic.serve.desk.export import NO_WRITERS, Writers
from kinesic.serve.desk.helper import Helper, Unanswered
from kinesic.serve.desk.keeper import DocumentKeeper
from kinesic.serve.desk.requester import Requester
from kinesic.serve.desk.watches import Watches
from kinesic.serve.loop import Loop
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import (
    AlternativesQuestion,
    AuthorQuestion,
    BackupRequest,
    BackupsRequest,
    ExportQuestion,
    FindQuestion,
    GestureQuestion,
    OpenRequest,
    PlanQuestion,
    Question,
    ReachQuestion,
    SaveRequest,
    ServosQuestion,
    StylesRequest,
    VersionsRequest,
    WatchRequest,
)
from kinesic.serve.wire.quotas import Quotas


async def _ignore_saved_gestures() -> None:
    """Do nothing after clients have saved gestures.

    Default without a planner.
    """


class Desk:
    """Non-blocking dispatcher of client queries to helper processes and threads."""

    def __init__(
        self,
        make_setup: Callable[[], Setup],
        loop: Loop,
        rules: Quotas,
        *,
        folder: Path | None = None,
        on_gestures_saved: Callable[[], Awaitable[None]] = _ignore_saved_gestures,
        writers: Writers = NO_WRITERS,
        tables: Sequence[str] = (),
    ) -> None:
        """Create a dispatcher.

        Helper processes start at the first query.

        Args:
            make_setup: creates the setup for planning, in helper processes.
            loop: source of the robot's telemetry.
            rules: limits for planned documents.
            folder: folder for documents of clients; None disables saving.
            on_gestures_saved: returns when the planner is about to use saved gestures.
            writers: additional file writers for exports; picklable.
            tables: modules that are imported once for all helper processes.
        """
        self._rules, self._loop = rules, loop
        self._watches = Watches(loop.report_body)
        drafts = partial(answer_draft, writers=writers)
        self.drafter = Helper[DraftQuestion](make_setup, drafts, rules, name="drafter", tables=tables)
        self._reacher = Helper[ReachQuestion](make_setup, answer_reach, rules, name="reacher", tables=tables)
        self._keeper = DocumentKeeper(folder, self.drafter, rules, on_gestures_saved)

    def answer(self, requester: Requester, question: Question) -> None:
        """Pass a query to the process or thread that answers it.

        Its answer is sent when it is available.
        """
        match question:
            case ReachQuestion():
                self._reacher.ask(requester.number, question, partial(self._send_reach, requester, question))
            case GestureQuestion(toml=None):  # a file request, which later previews do not replace
                self.drafter.ask(
                    requester.number, question, partial(self._send_draft, requester, question), kind="file"
                )
            case PlanQuestion() | GestureQuestion():
                self.drafter.ask(requester.number, question, partial(self._send_draft, requester, question))
                self._reacher.warm_up()  # an author may drag a hand soon
            case ExportQuestion() | FindQuestion() | AuthorQuestion() | AlternativesQuestion():
                self.drafter.ask(
                    requester.number,
                    question,
                    partial(self._send_draft, requester, question),
                    kind=ANSWER_NAMES[type(question)],
                )
            case WatchRequest(rate):
                self._watches.set(requester, rate)
            case ServosQuestion(id):
                servos = self._loop.servos
                requester.send(json_answer("servos", id=id, servos=() if servos is None else servos.members))
            case (
                SaveRequest() | OpenRequest() | VersionsRequest() | BackupRequest() | BackupsRequest() | StylesRequest()
            ):
                self._keeper.take(requester, question)

    def close(self) -> None:
        """End all helper processes and tasks."""
        self._watches.close()
        self._keeper.close()
        self.drafter.close()
        self._reacher.close()

    def _send_reach(self, requester: Requester, question: ReachQuestion, answer: str | Unanswered) -> None:
        requester.send(reach_failure(question, answer) if isinstance(answer, Unanswered) else answer)

    def _send_draft(self, requester: Requester, question: ClientQuestion, answer: str | Unanswered) -> None:
        requester.send(draft_failure(question, answer, self._rules) if isinstance(answer, Unanswered) else answer)
