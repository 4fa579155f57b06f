import json

import pytest

from kinesic.speech.timings.reading import read_timed_words
from kinesic.speech.timings.timed_words import TimedSpan, TimingError

# words of a transcript with times [s]
HELLO_WORDS = [{"word": " Hello,", "start": 0.1, "end": 0.52}, {"word": " friend.", "start": 0.5, "end": 1.1}]


def read(file: object):
    return read_timed_words(json.dumps(file).encode(), source="w.json")


@pytest.mark.parametrize("file", [{"segments": [{"words": HELLO_WORDS}], "text": ""}, {"words": HELLO_WORDS}])
def test_whisper_words_of_segments_or_of_the_file_are_read_without_overlap(file: object):
    timed = read(file)
    assert timed.words == (TimedSpan("Hello,", 0.1, 0.5), TimedSpan("friend.", 0.5, 1.1))
    assert (timed.text, timed.file_format) == ("Hello, friend.", "Whisper JSON")


def test_whisper_segment_without_words_is_read_as_one_phrase():
    timed = read({"segments": [{"start": 0.5, "end": 2.0, "text": " Hello my friend."}]})
    assert timed.words == (TimedSpan("Hello my friend.", 0.5, 2.0),)


def test_whisper_word_without_times_is_joined_to_the_word_before_it():
    timed = read({"segments": [{"words": [{"word": "in", "start": 0.2, "end": 0.4}, {"word": "1999"}]}]})
    assert timed.words == (TimedSpan("in 1999", 0.2, 0.4),)


def test_spaces_and_names_of_sound_events_in_a_transcript_are_left_out():
    words = [
        {"text": "(laughs)", "start": 0.0, "end": 0.5, "type": "audio_event"},
        {"text": "Hi", "start": 0.6, "end": 0.8, "type": "word"},
        {"text": " ", "start": 0.8, "end": 0.9, "type": "spacing"},
    ]
    assert read({"words": words}).words == (TimedSpan("Hi", 0.6, 0.8),)


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ({"word": "a", "start": -1.0, "end": 1.0}, r"w\.json: words\[0\] start is -1; times are 0 to 1300"),
        ({"word": "a", "start": 2.0, "end": 1.0}, "'a' ends at 1 s, before its start at 2 s"),
        ({"word": "a", "start": 2, "end": 10**400}, "Number out of range"),
        (
            {"word": "a", "start": "soon", "end": 1.0},
            r"Expected `float \| null`, got `str` - at `\$\.words\[0\]\.start`",
        ),
    ],
)
def test_invalid_whisper_time_is_refused_with_its_location_or_word(word: object, message: str):
    with pytest.raises(TimingError, match=message):
        read({"words": [word]})


def test_whisper_words_in_wrong_order_are_refused_with_both_words():
    with pytest.raises(TimingError, match=r"words\[1\] 'Hello,' starts at 0.1 s, before 'friend.' at 0.5 s"):
        read({"words": HELLO_WORDS[::-1]})
