from dataclasses import replace

import pytest

from kinesic.bench import meaning
from kinesic.bench.meaning.sentences import deictic_sentences, prose
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style


@pytest.fixture(scope="module")
def written():
    return meaning._author_text("No, I never saw the old house on the hill.", Lexicon.load(), Style.load("neutral"))


@pytest.mark.soak
def test_generated_texts_meet_the_gesture_choice_goals(monkeypatch):
    monkeypatch.setattr(meaning, "SENTENCE_COUNT", 100)
    monkeypatch.setattr(meaning, "PLANNED_TEXTS", 1)
    monkeypatch.setattr(meaning.streaming, "bench", list)  # needs a server, see test_streaming.py
    monkeypatch.setattr(meaning.judged, "bench", lambda _: ())  # see test_judged.py
    monkeypatch.setattr(meaning.rhythm, "bench", list)  # plans nine stories, see test_rhythm.py
    metrics = list(meaning.bench())
    assert [metric.name for metric in metrics if metric.ok is False and "p95" not in metric.name] == []
    assert len(metrics) == 9


def test_nods_in_negations_and_repeated_or_unstressed_gestures_are_counted(written):
    assert meaning._count_negated_nods(written) == meaning._count_repeats(written) == 0
    shake = next(behaviour for behaviour in written.behaviours if behaviour.lexeme == "SHAKE")
    assert meaning._count_negated_nods(replace(written, behaviours=[shake, replace(shake, lexeme="NOD")])) == 1
    gesture = written.gestures[0]
    assert meaning._count_repeats(replace(written, behaviours=[gesture] * 3)) == 2
    weak = replace(gesture, intent=replace(gesture.intent, stroke=written.passage.stress(1)))  # on the word `I`
    assert meaning._stressed_fraction([replace(written, behaviours=[weak])]) == 0.0


def test_generated_sentences_are_reproducible_and_varied():
    assert prose(60) == prose(60)
    assert len(set(prose(1000))) > 700
    assert len(deictic_sentences()) == 200
