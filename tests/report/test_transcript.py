"""Transcript of the speech, with the strokes below their words."""

from itertools import pairwise

import pytest

from kinesic.metrics.dry_run import DryRun
from kinesic.planning.setup import Setup
from kinesic.report.transcript import MAX_LISTED_WORDS, transcribe
from kinesic.session.plan import plan


def test_stroke_is_listed_under_the_word_spoken_at_its_time(hurried: DryRun):
    transcript = transcribe(hurried.plan)
    assert [said.word for said in transcript if said.word] == ["Hello", "there,", "welcome"]
    nod = next(sync.planned for sync in hurried.plan.syncs if (sync.behaviour, sync.sync) == ("nod", "stroke"))
    (said,) = [said for said in transcript if any(meant.label == "NOD" for meant in said.behaviours)]
    assert said.word == "welcome"
    assert [meant.peak for meant in said.behaviours] == [pytest.approx(hurried.plan.trajectory.zero + nod)]
    words = [said for said in transcript if said.word]
    assert all(earlier.end <= later.begin + 1e-9 for earlier, later in pairwise(words))
    assert "xyzzy" not in [meant.label for said in transcript for meant in said.behaviours]


def test_transcript_without_speech_lists_behaviours_by_time(known: Setup):
    block = '<bml id="b"><head id="h" lexeme="NOD" stroke="2"/><gesture id="g" lexeme="beat" stroke="1"/></bml>'
    (silence,) = transcribe(plan(block, known))
    assert silence.word == ""
    assert [meant.label for meant in silence.behaviours] == ["beat", "NOD"]


def test_silence_before_the_first_word_is_a_transcript_entry(known: Setup):
    block = (
        '<bml id="b"><speech id="s" start="2"><text>Yes.</text></speech><head id="h" lexeme="NOD" stroke="1"/>'
        '<gesture id="g" lexeme="beat" stroke="s:end+2"/></bml>'
    )
    rows = [(said.word, [meant.label for meant in said.behaviours]) for said in transcribe(plan(block, known))]
    assert rows == [("", ["NOD"]), ("Yes.", ["beat"])] or rows == [("", ["NOD"]), ("Yes.", []), ("", ["beat"])]


def test_long_pause_between_speeches_is_a_separate_transcript_entry(known: Setup):
    block = (
        '<bml id="b"><speech id="s" start="0"><text>Yes.</text></speech>'
        '<speech id="t" start="5"><text>No.</text></speech><head id="h" lexeme="NOD" stroke="3"/></bml>'
    )
    rows = [(said.word, [meant.label for meant in said.behaviours]) for said in transcribe(plan(block, known))]
    assert rows == [("Yes.", []), ("", ["NOD"]), ("No.", [])]


def test_transcript_beyond_the_maximum_number_of_words_is_one_entry(hurried: DryRun, monkeypatch: pytest.MonkeyPatch):
    assert MAX_LISTED_WORDS > 100
    monkeypatch.setattr("kinesic.report.transcript.MAX_LISTED_WORDS", 1)
    rows = [(said.word, [meant.label for meant in said.behaviours]) for said in transcribe(hurried.plan)]
    assert [word for word, _ in rows if word] == ["Hello"]
    assert "NOD" in rows[-1][1]
