import pytest

from kinesic.speech.timings.reading import read_timed_words
from kinesic.speech.timings.timed_words import TimedSpan, TimingError

SUBRIP_FILE = (
    "1\r\n00:00:00,500 --> 00:00:02,000\r\n<i>Hello,</i>\r\nmy friend.\r\n\r\n"
    "2\r\n0:01:02,5 --> 0:01:03,000\r\n- Yes!\r\n"
)
WEBVTT_FILE = """WEBVTT

NOTE a remark

first
00:01.000 --> 00:03.000 align:start
<v Anna>Fish &amp; <00:01.500><c>chips</c> <00:02.250>please

00:05.000 --> 00:06.000
\u266a
"""


def test_each_subtitle_of_a_subrip_file_is_read_as_a_timed_phrase():
    assert read_timed_words(SUBRIP_FILE.encode()).words == (
        TimedSpan("Hello, my friend.", 0.5, 2.0),
        TimedSpan("Yes!", 62.5, 63.0),
    )


def test_words_of_webvtt_with_their_own_times_are_separate():
    timed = read_timed_words(WEBVTT_FILE.encode())
    spans = (TimedSpan("Fish &", 1.0, 1.5), TimedSpan("chips", 1.5, 2.25), TimedSpan("please", 2.25, 3.0))
    assert (timed.words, timed.file_format) == (spans, "WebVTT")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("1\n00:00:01,000 --> soon\nHi\n", "line 2: '00:00:01,000 --> soon' is no time of a cue; write"),
        ("1\n00:00:03,000 --> 00:00:02,000\nHi\n", "cue 1 'Hi' ends at 2 s, before its start at 3 s"),
        ("1\n99:00:03,000 --> 99:00:04,000\nHi\n", "cue 1 start is 356403; times are 0 to 1300"),
        ("WEBVTT\n\n", "no cue has text"),
        ("WEBVTT\n\n00:03.000 --> 00:04.000\na\n\n00:01.000 --> 00:02.000\nb\n", "cue 2 'b' starts at 1 s, before 'a'"),
    ],
)
def test_invalid_subtitles_are_refused_with_the_location_of_their_fault(content: str, message: str):
    with pytest.raises(TimingError, match=message):
        read_timed_words(content.encode())
