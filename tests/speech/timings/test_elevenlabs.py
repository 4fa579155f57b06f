import json

import pytest

from kinesic.speech.timings.reading import read_timed_words
from kinesic.speech.timings.timed_words import TimedSpan, TimingError

CHARACTER_TIMES = {  # characters of two words with their times [s]
    "characters": list("Hi you "),
    "character_start_times_seconds": [0.0, 0.1, 0.2, 0.4, 0.5, 0.6, 0.7],
    "character_end_times_seconds": [0.1, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8],
}


@pytest.mark.parametrize("file", [{"audio_base64": "", "alignment": CHARACTER_TIMES}, CHARACTER_TIMES])
def test_timed_characters_of_elevenlabs_are_joined_to_words(file: object):
    timed = read_timed_words(json.dumps(file).encode())
    assert timed.words == (TimedSpan("Hi", 0.0, 0.2), TimedSpan("you", 0.4, 0.7))


def test_elevenlabs_lists_of_different_lengths_are_refused_with_their_lengths():
    file = {"alignment": CHARACTER_TIMES | {"character_end_times_seconds": [0.1]}}
    with pytest.raises(TimingError, match="7 characters, 7 start times and 1 end times"):
        read_timed_words(json.dumps(file).encode())


def test_missing_elevenlabs_list_is_refused_with_its_name():
    with pytest.raises(TimingError, match="character_end_times_seconds"):
        read_timed_words(json.dumps({"alignment": {"characters": [], "character_start_times_seconds": []}}).encode())
