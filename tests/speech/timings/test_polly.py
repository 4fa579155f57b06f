import pytest

from kinesic.speech.timings.reading import read_timed_words
from kinesic.speech.timings.timed_words import TimedSpan, TimingError

# speech marks of a sentence, with words and visemes
SPEECH_MARKS = b"""{"time":0,"type":"sentence","start":0,"end":16,"value":"Thin shoe. Yes."}
{"time":6,"type":"word","start":0,"end":4,"value":"Thin"}
{"time":6,"type":"viseme","value":"T"}
{"time":100,"type":"viseme","value":"i"}
{"time":200,"type":"viseme","value":"t"}
{"time":300,"type":"word","start":5,"end":9,"value":"shoe"}
{"time":300,"type":"viseme","value":"S"}
{"time":400,"type":"viseme","value":"u"}
{"time":600,"type":"viseme","value":"sil"}
{"time":1500,"type":"word","start":11,"end":14,"value":"Yes"}
{"time":1500,"type":"viseme","value":"i"}
{"time":1900,"type":"viseme","value":"sil"}
"""


def test_polly_words_end_at_the_next_word_or_at_a_silence():
    words = read_timed_words(SPEECH_MARKS).words
    assert words == (TimedSpan("Thin", 0.006, 0.3), TimedSpan("shoe", 0.3, 0.6), TimedSpan("Yes", 1.5, 1.9))


def test_polly_visemes_become_phonemes_and_silences_are_omitted():
    phonemes = read_timed_words(SPEECH_MARKS).phonemes
    assert [sound.symbol for sound in phonemes] == ["\u03b8", "i", "t", "\u0283", "u", "i"]
    assert (phonemes[4].start, phonemes[4].end) == pytest.approx((0.4, 0.6))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (b'{"time":-5,"type":"word","value":"a"}', "line 1 time is -5; times are 0 to 1300000"),
        (b'{"time":5,"type":"word","value":"a"}\n{"time":', "line 2: Input data was truncated"),
        (b'{"time":9,"type":"word","value":"a"}\n{"time":5,"type":"word","value":"b"}', "line 2 'b' starts at 0.005 s"),
    ],
)
def test_invalid_polly_line_is_refused_with_its_number(line: bytes, message: str):
    with pytest.raises(TimingError, match=message):
        read_timed_words(line)
