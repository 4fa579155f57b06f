from dataclasses import replace

from kinesic.intent.intents import Intent
from kinesic.intent.pacing.accents import find_accents, follow_accents
from kinesic.intent.pacing.rhythm import BEAT_INTENTS
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.passage import Passage
from kinesic.intent.reading.words import read_text

PASSAGE = read_text("The big dog ran home, and the cat slept there.", load_language("en"))
HEARD = replace(PASSAGE, accents=frozenset({1, 6}), times=tuple(0.5 * k for k in range(11)))


def beat_on(passage: Passage, word: int) -> Intent:
    onset, stroke, close = passage.onset(word), passage.stress(word), passage.close(word)
    return Intent("accent", onset, stroke, close, 0.4, "test", word=word, phrase=passage.words[word].phrase)


def test_words_accented_in_a_recording_replace_content_words_as_accents():
    assert [intent.word for intent in find_accents(HEARD)] == [1, 6]
    assert [intent.word for intent in find_accents(HEARD, taken={1})] == [6]
    assert [PASSAGE.words[intent.word].plain for intent in find_accents(PASSAGE)][:2] == ["big", "dog"]


def test_word_times_of_a_recording_replace_estimated_times():
    assert HEARD.starts[6] == 3.0
    assert HEARD.onset(6).seconds == 3.0
    assert PASSAGE.starts[6] != 3.0


def test_beat_moves_to_the_recorded_accent_of_its_phrase_or_is_dropped():
    moved = follow_accents([beat_on(HEARD, 4), beat_on(HEARD, 6)], HEARD, BEAT_INTENTS)
    assert [(intent.word, intent.stroke.reference.partition("+")[0]) for intent in moved] == [(1, "s:w2"), (6, "s:w7")]
    assert "'big' carries an accent in the recording" in moved[0].reason
    silent = replace(HEARD, accents=frozenset({6}))
    assert follow_accents([beat_on(silent, 4)], silent, BEAT_INTENTS) == ()


def test_beats_without_a_recording_and_other_intents_keep_their_words():
    beat = beat_on(PASSAGE, 4)
    assert follow_accents([beat], PASSAGE, BEAT_INTENTS) == (beat,)
    picture = replace(beat, name="picture")
    assert follow_accents([picture], HEARD, BEAT_INTENTS) == (picture,)
