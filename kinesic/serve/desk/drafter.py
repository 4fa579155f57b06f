"""Answers of the planning helper process: previews, exports and checks of files."""

import os
import traceback
from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.bml.block import BmlError, DocumentBounds
from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.search import GestureHit, find_gestures
from kinesic.planning.setup import Setup
from kinesic.serve.desk.draft import Json, draft, locate_error, plan_draft
from kinesic.serve.desk.export import NO_WRITERS, Writers, export, export_name
from kinesic.serve.desk.gesture import draft_gesture, gesture_text
from kinesic.serve.desk.gesture_file import find_fault
from kinesic.serve.desk.helper import Unanswered
from kinesic.serve.desk.text import list_alternatives, write_document
from kinesic.serve.rejections import DEFECT_TYPES
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import (
    AlternativesQuestion,
    AuthorQuestion,
    ExportQuestion,
    FindQuestion,
    GestureQuestion,
    PlanQuestion,
)
from kinesic.serve.wire.quotas import Quotas

MAX_HITS = 50  # largest number of gestures in the answer to a search
NO_FAULT = ""  # answer to a `FileQuestion` about a gesture or style file that may be saved


@dataclass(frozen=True)
class FileQuestion:
    """Query whether a gesture or style file may be saved."""

    name: str
    text: str
    present: str | None  # content of the file that would be overwritten; None: no such file


ClientQuestion = PlanQuestion | ExportQuestion | GestureQuestion | FindQuestion | AuthorQuestion | AlternativesQuestion
DraftQuestion = ClientQuestion | FileQuestion
ANSWER_NAMES: Mapping[type[ClientQuestion], str] = {  # query -> value of `told` in its answer
    PlanQuestion: "plan",
    ExportQuestion: "export",
    GestureQuestion: "gesture",
    FindQuestion: "find",
    AuthorQuestion: "author",
    AlternativesQuestion: "alternatives",
}


def answer_draft(question: DraftQuestion, setup: Setup, rules: Quotas, *, writers: Writers = NO_WRITERS) -> str:
    """Answer a query, with an error if planning or writing files fails."""
    try:
        if isinstance(question, FileQuestion):
            return find_fault(question.text, question.present, setup)
        return _answer_json(question, _draft(question, setup, rules, writers))
    except DEFECT_TYPES as error:
        traceback.print_exception(error)
        why = f"planning failed ({type(error).__name__}); please report the document"
    except OSError as error:
        traceback.print_exception(error)
        why = f"the server cannot write its temporary files ({os.strerror(error.errno or 0)}); "
        why += "free disk space there, or set TMPDIR to a folder that it may write, and ask again"
    return why if isinstance(question, FileQuestion) else _answer_json(question, _failure(why))


def draft_failure(question: ClientQuestion, why: Unanswered, rules: Quotas) -> str:
    """Return the answer to a drafting query that was not processed."""
    if why is Unanswered.OUTDATED:
        return _answer_json(question, {"outdated": True})
    return _answer_json(question, _failure(timeout_message(rules)))


def timeout_message(rules: Quotas) -> str:
    """Return the error message for planning that failed or timed out."""
    return f"planning failed, or took longer than {rules.planning:g} s; send something simpler"


def _draft(question: ClientQuestion, setup: Setup, rules: Quotas, writers: Writers) -> dict[str, Json]:
    bounds = DocumentBounds(rules.message, rules.depth)
    match question:
        case PlanQuestion(bml, changes):
            return draft(bml, changes, setup, bounds=bounds, max_duration=rules.duration)
        case ExportQuestion(bml, format_, changes):
            try:
                plan = plan_draft(bml, changes, setup, bounds=bounds, max_duration=rules.duration)
                return {"name": export_name(plan, format_), "data": export(plan, format_, writers)}
            except (BmlError, ConfigError) as error:
                return {"error": locate_error(str(error))}
        case GestureQuestion(str(toml), None, changes):
            return draft_gesture(toml, changes, setup)
        case GestureQuestion(None, str(lexeme)):
            try:
                return {"toml": gesture_text(lexeme, setup.lexicon)}
            except ConfigError as error:
                return _failure(str(error))
        case AuthorQuestion() | AlternativesQuestion():
            try:
                return (
                    write_document(question, setup)
                    if isinstance(question, AuthorQuestion)
                    else list_alternatives(question, setup)
                )
            except (BmlError, ConfigError) as error:
                return _failure(str(error))
        case FindQuestion(words):
            return {"gestures": [_describe_hit(hit) for hit in find_gestures(setup.lexicon, words, count=MAX_HITS)]}
    return _failure("give either toml or lexeme")


def _describe_hit(hit: GestureHit) -> Json:
    return {"id": hit.id, "category": hit.category, "says": hit.says, "near": hit.kind == "near"}


def _answer_json(question: ClientQuestion, values: dict[str, Json]) -> str:
    return json_answer(ANSWER_NAMES[type(question)], id=question.id, **values)


def _failure(text: str) -> dict[str, Json]:
    return {"error": {"line": 1, "column": 1, "text": text}}
