"""The words, and the strokes under them."""

from itertools import pairwise

import pytest

from kinesic.controller.perform import perform
from kinesic.controller.performance import Performance
from kinesic.planning.setup import Setup
from kinesic.report.transcript import MOST_WORDS, transcribe


def test_every_stroke_stands_under_the_word_that_sounds(hurried: Performance):
    found = transcribe(hurried.plan)
    assert [said.word for said in found if said.word] == ["Hello", "there,", "welcome"]
    nod = next(sync.planned for sync in hurried.plan.syncs if (sync.behaviour, sync.sync) == ("nod", "stroke"))
    (said,) = [said for said in found if any(meant.label == "NOD" for meant in said.behaviours)]
    assert said.word == "welcome"
    assert [meant.peak for meant in said.behaviours] == [pytest.approx(hurried.plan.trajectory.zero + nod)]
    words = [said for said in found if said.word]
    assert all(earlier.end <= later.begin + 1e-9 for earlier, later in pairwise(words))
    assert "xyzzy" not in [meant.label for said in found for meant in said.behaviours]


def test_without_speech_what_is_meant_stands_in_its_order(known: Setup):
    block = '<bml id="b"><head id="h" lexeme="NOD" stroke="2"/><gesture id="g" lexeme="beat" stroke="1"/></bml>'
    (silence,) = transcribe(perform(block, known).plan)
    assert silence.word == ""
    assert [meant.label for meant in silence.behaviours] == ["beat", "NOD"]


def test_before_the_first_word_and_after_the_last_there_is_silence(known: Setup):
    block = (
        '<bml id="b"><speech id="s" start="2"><text>Yes.</text></speech><head id="h" lexeme="NOD" stroke="1"/>'
        '<gesture id="g" lexeme="beat" stroke="s:end+2"/></bml>'
    )
    found = [(said.word, [meant.label for meant in said.behaviours]) for said in transcribe(perform(block, known).plan)]
    assert found == [("", ["NOD"]), ("Yes.", ["beat"])] or found == [("", ["NOD"]), ("Yes.", []), ("", ["beat"])]


def test_a_long_pause_within_a_speech_is_a_piece_of_its_own(known: Setup):
    block = (
        '<bml id="b"><speech id="s" start="0"><text>Yes.</text></speech>'
        '<speech id="t" start="5"><text>No.</text></speech><head id="h" lexeme="NOD" stroke="3"/></bml>'
    )
    found = [(said.word, [meant.label for meant in said.behaviours]) for said in transcribe(perform(block, known).plan)]
    assert found == [("Yes.", []), ("", ["NOD"]), ("No.", [])]


def test_of_a_long_text_the_rest_is_one_piece(hurried: Performance, monkeypatch: pytest.MonkeyPatch):
    assert MOST_WORDS > 100
    monkeypatch.setattr("kinesic.report.transcript.MOST_WORDS", 1)
    found = [(said.word, [meant.label for meant in said.behaviours]) for said in transcribe(hurried.plan)]
    assert [word for word, _ in found if word] == ["Hello"]
    assert "NOD" in found[-1][1]
