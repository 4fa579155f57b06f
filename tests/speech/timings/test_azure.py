import json

import pytest

from kinesic.speech.timings.reading import read_timed_words
from kinesic.speech.timings.timed_words import TimedSpan, TimingError

WORD_EVENTS = [  # word boundary events, with offsets in ticks
    {"audioOffset": 500_000, "duration": 2_500_000, "text": "Hello", "boundaryType": "Word"},
    {"audioOffset": 3_000_000, "duration": 500_000, "text": ",", "boundaryType": "Punctuation"},
    {"audioOffset": 4_000_000, "duration": 4_000_000, "text": "friend", "boundaryType": "WordBoundary.Word"},
]
HELLO_WORDS = (TimedSpan("Hello", 0.05, 0.3), TimedSpan("friend", 0.4, 0.8))  # the words of the events, with times [s]


def rename(event: dict[str, object], prefix: str) -> dict[str, object]:
    return {prefix + key[0].upper() + key[1:]: value for key, value in event.items()}


@pytest.mark.parametrize(
    "content",
    [
        json.dumps(WORD_EVENTS),
        json.dumps({"events": WORD_EVENTS}),
        "\n".join(map(json.dumps, WORD_EVENTS)),
        json.dumps([rename(event, "priv") for event in WORD_EVENTS]),
        json.dumps([rename(event, "") for event in WORD_EVENTS]),
    ],
)
def test_azure_word_boundaries_in_ticks_are_read_from_lists_and_lines(content: str):
    words = read_timed_words(content.encode()).words
    assert [word.text for word in words] == ["Hello", "friend"]
    for word, expected in zip(words, HELLO_WORDS, strict=True):
        assert (word.start, word.end) == pytest.approx((expected.start, expected.end))


def test_azure_word_boundaries_of_batch_synthesis_are_read_in_milliseconds():
    events = [{"Text": "the", "AudioOffset": 38, "Duration": 153}, {"Text": "fox", "AudioOffset": 201, "Duration": 326}]
    words = read_timed_words(json.dumps(events).encode()).words
    assert [word.start for word in words] == pytest.approx([0.038, 0.201])


def test_azure_viseme_event_becomes_a_phoneme_that_lasts_until_the_next_event():
    events = [{"audioOffset": 1_000_000 * k, "visemeId": n} for k, n in enumerate((0, 21, 2, 0))]
    (closed, opened) = read_timed_words(json.dumps(events).encode()).phonemes
    assert (closed.symbol, closed.start, closed.end) == ("p", pytest.approx(0.1), pytest.approx(0.2))
    assert (opened.symbol, opened.end) == ("\u0251", pytest.approx(0.3))


@pytest.mark.parametrize(
    ("event", "message"),
    [
        ({"audioOffset": "soon", "text": "a"}, "event 1 audiooffset is 'soon'; it must be a number"),
        ({"audioOffset": 0, "visemeId": 99}, "event 1 visemeId is 99; visemes are 0 to 21"),
        ({"audioOffset": 10**18, "text": "a"}, "event 1 start is '10{18}'; times are 0 to 13000000000"),
    ],
)
def test_invalid_azure_event_is_refused_with_its_number(event: object, message: str):
    with pytest.raises(TimingError, match=message):
        read_timed_words(json.dumps([event]).encode())
