"""Tests of long texts: several speeches in one block, one after the other."""

import re
from itertools import pairwise

import pytest

from kinesic.bml.block import BmlError, Speech
from kinesic.bml.parse import parse
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import author
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.words import read_text
from kinesic.intent.speeches import FULL_SPEECH, LONGEST_SPEECH, UNDIVIDED_TEXT, divide_speech, gap_before
from kinesic.session import documents
from kinesic.session.setup import set_up

PARAGRAPH_TEXT = " ".join("No, we never saw the old house on the hill, and it was dark." for _ in range(6))
LONG_TEXT = "\n\n".join([PARAGRAPH_TEXT] * 8)


@pytest.fixture(scope="module")
def long_bml():
    return author(LONG_TEXT, Lexicon.load(), Style.load("neutral"))


def test_long_text_is_spoken_once_by_speeches_that_follow_one_another(long_bml):
    block = parse(long_bml)
    speeches = [behaviour for behaviour in block.behaviours if isinstance(behaviour.action, Speech)]
    spoken = " ".join(speech.action.script.text for speech in speeches)
    assert spoken.split() == LONG_TEXT.split()
    assert len(speeches) > 4
    assert all(speech.action.script.text.rstrip().endswith("dark.") for speech in speeches)
    starts = re.findall(r'<speech id="(\w+)" language="en"(?: start="(\w+):end\+([\d.]+)")?>', long_bml)
    assert [(before, after) for (before, _, _), (_, after, _) in pairwise(starts)] == [
        (before, before) for (before, _, _) in starts[:-1]
    ]
    assert {float(gap) for _, _, gap in starts[1:]} == {0.9}  # sentence and paragraph


def test_strokes_of_a_long_text_refer_to_the_speech_with_their_word(long_bml):
    marks = {
        name: speech
        for speech, text in re.findall(r'<speech id="(\w+)".*?<text>(.*?)</text>', long_bml, re.DOTALL)
        for name in re.findall(r'<sync id="(w\d+)"/>', text)
    }
    references = re.findall(r'="(s\d*):(w\d+)', long_bml)
    assert len(references) > 100
    assert {(marks[name], name) for _, name in references} == {*references}
    assert not parse(long_bml).notices


def test_long_text_is_divided_into_speeches_at_paragraphs_sentences_or_phrases():
    english = load_language()

    def lengths(text):
        return [len(part) for part in divide_speech(read_text(text, english))]

    assert lengths("a word " * (UNDIVIDED_TEXT // 2)) == [UNDIVIDED_TEXT]
    assert max(lengths("We saw the old house. " * 100)) == FULL_SPEECH
    assert max(lengths("we saw the old big house, " * 100)) == LONGEST_SPEECH
    assert max(lengths("house " * 1000)) == 2 * LONGEST_SPEECH
    passage = read_text("We go, they stay <break time='300ms'/> now. Then we go.", english)
    assert [round(gap_before(passage, k), 2) for k in (1, 2, 4, 5)] == [0.0, 0.2, 0.3, 0.45]


def test_plain_text_may_have_more_behaviours_than_a_bml_document():
    text = "\n".join(["The garden needs water today."] * 345)
    block = documents.read_plain_text(text, set_up(), source="long.txt")
    assert len(block.behaviours) > 1000
    assert block.max_duration == documents.MAX_TEXT_DURATION


def test_error_of_a_too_long_text_counts_words_and_names_the_verbs_for_long_texts(monkeypatch):
    monkeypatch.setattr(documents, "MAX_TEXT_WORDS", 30)
    text = "\n".join(["The garden needs water today."] * 10)
    with pytest.raises(
        BmlError, match=r"long.txt: 50 words; one plan holds 30: .*perform FILE.* divides .*say - < FILE"
    ):
        documents.read_plain_text(text, set_up(), source="long.txt")
