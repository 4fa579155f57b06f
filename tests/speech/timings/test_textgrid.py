import codecs

import pytest

from kinesic.speech.timings.reading import read_timed_words
from kinesic.speech.timings.timed_words import TimedSpan, TimingError

# TextGrid in Praat's long text format
LONG_FORMAT = """File type = "ooTextFile"
Object class = "TextGrid"

xmin = 0
xmax = 1.5
tiers? <exists>
size = 2
item []:
    item [1]:
        class = "IntervalTier"
        name = "words"
        xmin = 0
        xmax = 1.5
        intervals: size = 3
        intervals [1]:
            xmin = 0
            xmax = 0.25
            text = ""
        intervals [2]:
            xmin = 0.25
            xmax = 0.75
            text = "say ""hi"" 2"
        intervals [3]:
            xmin = 0.75
            xmax = 1.5
            text = "sil"
    item [2]:
        class = "IntervalTier"
        name = "phones"
        xmin = 0
        xmax = 1.5
        intervals: size = 2
        intervals [1]:
            xmin = 0.25
            xmax = 0.5
            text = "HH"
        intervals [2]:
            xmin = 0.5
            xmax = 0.75
            text = "OW1"
"""
# TextGrid in Praat's short text format
SHORT_FORMAT = """File type = "ooTextFile"
Object class = "TextGrid"

0
1.5
<exists>
2
"IntervalTier"
"Anna - words"
0
1.5
1
0.25
0.75
"hello"
"TextTier"
"clicks"
0
1.5
1
0.5
"click"
"""


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_textgrid_in_long_format_gives_words_and_phonemes_of_named_tiers(encoding: str):
    timed = read_timed_words(LONG_FORMAT.encode(encoding))
    assert timed.words == (TimedSpan('say "hi" 2', 0.25, 0.75),)
    assert [(p.symbol, p.start, p.end) for p in timed.phonemes] == [("h", 0.25, 0.5), ("\u02c8o\u028a", 0.5, 0.75)]


def test_textgrid_in_short_format_is_read_without_the_speaker_in_tier_names():
    timed = read_timed_words(codecs.BOM_UTF8 + SHORT_FORMAT.encode())
    assert (timed.words, timed.phonemes) == ((TimedSpan("hello", 0.25, 0.75),), ())


def test_first_textgrid_tier_with_text_gives_the_words_if_no_tier_is_named_words():
    timed = read_timed_words(SHORT_FORMAT.replace("Anna - words", "speech").encode())
    assert timed.words == (TimedSpan("hello", 0.25, 0.75),)


@pytest.mark.parametrize("length", range(60, len(LONG_FORMAT) - 8, 29))
def test_truncated_textgrid_file_is_refused(length: int):
    with pytest.raises(TimingError, match=r"cut off|must be|no tier|no TextGrid"):
        read_timed_words(LONG_FORMAT[:length].encode())


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("xmin = 0.5", 'xmin = "x"', r"line 38: the start of tier 'phones' 2 is .*; it must be a number"),
        ("xmin = 0.5", "xmin = nan", "tier 'phones' 2 start is nan"),
        ("xmin = 0.5", "xmin = 0.1", "tier 'phones' 2 '.*' starts at 0.1 s, before"),
        ("size = 3", "size = 1e9", "line 14: the size of tier 'words' is '1e9'; it must be a whole number from 0 to"),
        ("size = 2\nitem", "size = 2.5\nitem", "the number of tiers is '2.5'"),
    ],
)
def test_invalid_textgrid_value_is_refused_with_its_location(old: str, new: str, message: str):
    assert old in LONG_FORMAT
    with pytest.raises(TimingError, match=message):
        read_timed_words(LONG_FORMAT.replace(old, new).encode())


def test_praat_file_of_another_kind_is_refused():
    with pytest.raises(TimingError, match="no TextGrid"):
        read_timed_words(b'File type = "ooTextFile"\nObject class = "PitchTier"\n\n0\n1\n0\n')
