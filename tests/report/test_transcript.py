"""The words, and the strokes under them."""

from itertools import pairwise

import pytest

from kinesic.metrics.dry_run import DryRun
from kinesic.planning.setup import Setup
from kinesic.report.transcript import MAX_LISTED_WORDS, transcribe
from kinesic.session.plan import plan


def test_every_stroke_is_listed_under_the_spoken_word(hurried: DryRun):
    found = transcribe(hurried.plan)
    assert [said.word for said in found if said.word] == ["Hello", "there,", "welcome"]
    nod = next(sync.planned for sync in hurried.plan.syncs if (sync.behaviour, sync.sync) == ("nod", "stroke"))
    (said,) = [said for said in found if any(meant.label == "NOD" for meant in said.behaviours)]
    assert said.word == "welcome"
    assert [meant.peak for meant in said.behaviours] == [pytest.approx(hurried.plan.trajectory.zero + nod)]
    words = [said for said in found if said.word]
    assert all(earlier.end <= later.begin + 1e-9 for earlier, later in pairwise(words))
    assert "xyzzy" not in [meant.label for said in found for meant in said.behaviours]


def test_without_speech_behaviours_are_listed_by_time(known: Setup):
    block = '<bml id="b"><head id="h" lexeme="NOD" stroke="2"/><gesture id="g" lexeme="beat" stroke="1"/></bml>'
    (silence,) = transcribe(plan(block, known))
    assert silence.word == ""
    assert [meant.label for meant in silence.behaviours] == ["beat", "NOD"]


def test_silence_precedes_the_first_and_follows_the_last_word(known: Setup):
    block = (
        '<bml id="b"><speech id="s" start="2"><text>Yes.</text></speech><head id="h" lexeme="NOD" stroke="1"/>'
        '<gesture id="g" lexeme="beat" stroke="s:end+2"/></bml>'
    )
    found = [(said.word, [meant.label for meant in said.behaviours]) for said in transcribe(plan(block, known))]
    assert found == [("", ["NOD"]), ("Yes.", ["beat"])] or found == [("", ["NOD"]), ("Yes.", []), ("", ["beat"])]


def test_long_pause_within_a_speech_is_a_separate_piece(known: Setup):
    block = (
        '<bml id="b"><speech id="s" start="0"><text>Yes.</text></speech>'
        '<speech id="t" start="5"><text>No.</text></speech><head id="h" lexeme="NOD" stroke="3"/></bml>'
    )
    found = [(said.word, [meant.label for meant in said.behaviours]) for said in transcribe(plan(block, known))]
    assert found == [("Yes.", []), ("", ["NOD"]), ("No.", [])]


def test_transcript_beyond_the_maximum_number_of_words_is_one_entry(hurried: DryRun, monkeypatch: pytest.MonkeyPatch):
    assert MAX_LISTED_WORDS > 100
    monkeypatch.setattr("kinesic.report.transcript.MAX_LISTED_WORDS", 1)
    found = [(said.word, [meant.label for meant in said.behaviours]) for said in transcribe(hurried.plan)]
    assert [word for word, _ in found if word] == ["Hello"]
    assert "NOD" in found[-1][1]
