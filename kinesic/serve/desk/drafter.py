"""What the process that drafts answers: what documents and gestures would become, and whether gestures may be kept."""

import os
import traceback
from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.bml.block import BmlError, Bounds
from kinesic.body.config import ConfigError
from kinesic.planning.setup import Setup
from kinesic.serve.desk.draft import Json, draft, place_error, plan_draft
from kinesic.serve.desk.export import NO_WRITERS, Writers, export, export_name
from kinesic.serve.desk.gesture import draft_gesture, gesture_text
from kinesic.serve.desk.gesture_file import find_fault
from kinesic.serve.desk.helper import Unanswered
from kinesic.serve.planner import DEFECTS
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import ExportQuestion, GestureQuestion, PlanQuestion
from kinesic.serve.wire.quotas import Quotas

SOUND = ""  # the answer to a file that may be kept


@dataclass(frozen=True)
class FileQuestion:
    """Asks whether a file of gestures may be kept."""

    name: str
    text: str
    present: str | None  # what the file holds that it would replace; None: there is none


ClientQuestion = PlanQuestion | ExportQuestion | GestureQuestion
DraftQuestion = ClientQuestion | FileQuestion
TELLS: Mapping[type[ClientQuestion], str] = {PlanQuestion: "plan", ExportQuestion: "export", GestureQuestion: "gesture"}


def answer_draft(question: DraftQuestion, setup: Setup, rules: Quotas, *, writers: Writers = NO_WRITERS) -> str:
    """Answer a question, with an error if planning or writing files fails."""
    try:
        if isinstance(question, FileQuestion):
            return find_fault(question.text, question.present, setup)
        return _written(question, _draft(question, setup, rules, writers))
    except DEFECTS as error:
        traceback.print_exception(error)
        why = f"planning failed ({type(error).__name__}); please report the document"
    except OSError as error:
        traceback.print_exception(error)
        why = f"the server cannot write its temporary files ({os.strerror(error.errno or 0)}); "
        why += "free disk space there, or set TMPDIR to a folder that it may write, and ask again"
    return why if isinstance(question, FileQuestion) else _written(question, _failure(why))


def unanswered_draft(question: ClientQuestion, why: Unanswered, rules: Quotas) -> str:
    """Answers a question that was not drafted."""
    if why is Unanswered.OUTDATED:
        return _written(question, {"outdated": True})
    return _written(question, _failure(took_too_long(rules)))


def took_too_long(rules: Quotas) -> str:
    """Says that planning has not come to an end."""
    return f"planning failed, or took longer than {rules.planning:g} s; send something simpler"


def _draft(question: ClientQuestion, setup: Setup, rules: Quotas, writers: Writers) -> dict[str, Json]:
    bounds = Bounds(rules.message, rules.depth)
    match question:
        case PlanQuestion(bml, changes):
            return draft(bml, changes, setup, bounds=bounds, longest=rules.duration)
        case ExportQuestion(bml, format_, changes):
            try:
                planned = plan_draft(bml, changes, setup, bounds=bounds, longest=rules.duration)
                return {"name": export_name(planned, format_), "data": export(planned, format_, writers)}
            except (BmlError, ConfigError) as error:
                return {"error": place_error(str(error))}
        case GestureQuestion(str(toml), None, changes):
            return draft_gesture(toml, changes, setup)
        case GestureQuestion(None, str(lexeme)):
            try:
                return {"toml": gesture_text(lexeme, setup.lexicon)}
            except ConfigError as error:
                return _failure(str(error))
    return _failure("give either toml or lexeme")


def _written(question: ClientQuestion, found: dict[str, Json]) -> str:
    return json_answer(TELLS[type(question)], id=question.id, **found)


def _failure(text: str) -> dict[str, Json]:
    return {"error": {"line": 1, "column": 1, "text": text}}
