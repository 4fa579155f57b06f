"""Answers to questions about plain texts: documents and alternative gestures."""

import json
from dataclasses import replace

import pytest

from kinesic.expressivity.style.style import style_preset
from kinesic.intent.text_parts import MAX_TEXT_WORDS
from kinesic.planning.setup import Setup
from kinesic.serve.desk.drafter import answer_draft
from kinesic.serve.wire.questions import AlternativesQuestion, AuthorQuestion
from kinesic.serve.wire.quotas import Quotas
from kinesic.session.documents import write_bml

TEXT = "No, I did not say that! There were three big boxes."


def answered(question: AuthorQuestion | AlternativesQuestion, setup: Setup) -> dict:
    return json.loads(answer_draft(question, setup, Quotas()))


def test_author_query_returns_the_document_of_the_say_command(upper22_setup: Setup):
    answer = answered(AuthorQuestion(TEXT, id=7), upper22_setup)
    assert answer == {
        "told": "author",
        "id": 7,
        "bml": write_bml(TEXT, upper22_setup),
        "words": 11,
        "warnings": [],
    }


def test_requested_style_changes_the_gestures_in_bml_written_from_text(upper22_setup: Setup):
    text = f"{TEXT} The waiter opened the door and we went down the road to the big house on the hill."
    lively = answered(AuthorQuestion(text, "joyful"), upper22_setup)["bml"]
    assert lively == write_bml(text, replace(upper22_setup, style=style_preset("joyful")))
    assert lively != answered(AuthorQuestion(text), upper22_setup)["bml"]


@pytest.mark.parametrize(
    ("question", "text"),
    [
        (AuthorQuestion(" \n"), "no words"),
        (AuthorQuestion("x", "nobody"), "no style nobody"),
        (AuthorQuestion("word " * (MAX_TEXT_WORDS + 1)), f"{MAX_TEXT_WORDS + 1} words"),
    ],
)
def test_text_without_words_with_too_many_words_or_with_an_unknown_style_is_refused(
    upper22_setup: Setup, question: AuthorQuestion, text: str
):
    assert text in answered(question, upper22_setup)["error"]["text"]


def test_gesture_alternatives_of_a_word_have_meanings_and_reasons(upper22_setup: Setup):
    answer = answered(AlternativesQuestion(TEXT, TEXT.index("three"), "picture", id=3), upper22_setup)
    assert (answer["told"], answer["id"], answer["word"]) == ("alternatives", 3, "three")
    first = answer["gestures"][0]
    assert (first["id"], first["why"], first["intent"]) == ("count_three", "'three' is a number (0.68)", "picture")
    assert first["says"]
