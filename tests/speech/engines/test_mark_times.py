from kinesic.body.utterance import Mark, Pause, Script
from kinesic.speech.engines.mark_times import place_marks
from kinesic.speech.engines.phrase import SpokenWord

# words with character range, start [s] and end [s]
TIMED_WORDS = (SpokenWord(0, 3, 0.1, 0.4), SpokenWord(5, 8, 1.0, 1.3), SpokenWord(9, 12, 1.3, 1.6))
SPOKEN_TEXT = "one, two six."


def test_speech_mark_falls_on_the_next_word_but_stays_before_closing_punctuation():
    marks = tuple(Mark(f"m{position}", position) for position in (0, 2, 3, 4, 5, 8, 12, 13))
    times = place_marks(Script(SPOKEN_TEXT, marks), TIMED_WORDS, 1.7)
    assert times == {"m0": 0.1, "m2": 1.0, "m3": 1.0, "m4": 1.0, "m5": 1.0, "m8": 1.3, "m12": 1.6, "m13": 1.6}


def test_speech_marks_at_the_same_position_are_separated_by_the_pauses_between_them():
    script = Script(SPOKEN_TEXT, tuple(Mark(name, 5) for name in "abc"), pauses=(Pause(5, 0.3, 1), Pause(5, 0.2, 2)))
    times = place_marks(script, TIMED_WORDS, 1.7)
    assert (times["a"], times["b"], times["c"]) == (0.4, 0.4 + 0.3, 1.0)


def test_first_of_two_engine_marks_with_the_same_name_sets_the_time_of_the_name():
    assert place_marks(Script(SPOKEN_TEXT, (Mark("m", 0), Mark("m", 9))), TIMED_WORDS, 1.7) == {"m": 0.1}


def test_speech_marks_of_a_text_without_words_lie_between_its_pauses():
    script = Script("...", (Mark("a", 0), Mark("b", 3)), pauses=(Pause(1, 0.5),))
    assert place_marks(script, (), 0.5) == {"a": 0.0, "b": 0.5}
