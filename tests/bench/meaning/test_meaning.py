from dataclasses import replace

import pytest

from kinesic.bench import meaning
from kinesic.bench.meaning.sentences import deictic_sentences, prose
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style


@pytest.fixture(scope="module")
def written():
    return meaning._write("No, I never saw the old house on the hill.", Lexicon.load(), Style.load("neutral"))


def test_a_short_talk_keeps_its_goals(monkeypatch):
    monkeypatch.setattr(meaning, "SENTENCES", 100)
    monkeypatch.setattr(meaning, "PLANNED", 1)
    monkeypatch.setattr(meaning.streaming, "bench", list)  # it needs a server: test_streaming.py
    figures = list(meaning.bench())
    assert [each.name for each in figures if each.ok is False and "p95" not in each.name] == []
    assert len(figures) == 9


def test_what_would_be_wrong_is_counted(written):
    assert meaning._nods(written) == meaning._repeats(written) == 0
    shake = next(each for each in written.behaviours if each.lexeme == "SHAKE")
    assert meaning._nods(replace(written, behaviours=[shake, replace(shake, lexeme="NOD")])) == 1
    gesture = written.gestures[0]
    assert meaning._repeats(replace(written, behaviours=[gesture] * 3)) == 2
    weak = replace(gesture, intent=replace(gesture.intent, stroke=written.passage.stress(1)))  # on `I`
    assert meaning._stressed([replace(written, behaviours=[weak])]) == 0.0


def test_sentences_are_the_same_each_time_and_enough():
    assert prose(60) == prose(60)
    assert len(set(prose(1000))) > 700
    assert len(deictic_sentences()) == 200
