"""Word and viseme times of Azure's speech synthesis events."""

from collections.abc import Iterator, Mapping, Sequence
from statistics import median

import msgspec

from kinesic.body.utterance import Phoneme
from kinesic.speech.timings.timed_words import (
    RawSpan,
    TimedSpan,
    TimedWords,
    TimingError,
    check_spans,
    make_phonemes,
    shorten,
)

TICKS_PER_SECOND = 1e7  # [1/s] units of time of Azure's speech SDK
BATCH_UNITS_PER_SECOND = 1e3  # [1/s] units of time of Azure's batch synthesis
MIN_WORD_TICKS = 10_000  # [ticks] 1 ms: with a smaller median duration of words, a file is in milliseconds
VISEME_SOUNDS = (  # sound of each viseme by its number; the first is silence
    "", "ə", "ɑ", "ɔ", "ɛ", "ɚ", "i", "u", "o", "aʊ", "ɔɪ", "aɪ", "h", "r", "l", "s", "ʃ", "θ", "f", "t", "k", "p",  # noqa: RUF001 - phonetic letters
)  # fmt: skip

_Event = Mapping[str, object]


def read_azure(content: bytes) -> TimedWords:
    """Read word and viseme times from Azure events in JSON.

    Keys are read as each SDK writes them: `audioOffset`, `AudioOffset`, `audio_offset`, `privAudioOffset`.

    Raises:
        TimingError: a time or viseme is invalid.
        msgspec.DecodeError: the content is not JSON of this structure.
    """
    events = [{_plain_key(key): value for key, value in event.items()} for event in _list_events(content)]
    words = [
        (f"event {k + 1}", event)
        for k, event in enumerate(events)
        if "text" in event and str(event.get("boundarytype", "word")).lower().endswith("word")
    ]
    durations = [_number(event, "duration", place) for place, event in words if "duration" in event]
    in_batch = bool(durations) and median(durations) < MIN_WORD_TICKS
    per_second = BATCH_UNITS_PER_SECOND if in_batch else TICKS_PER_SECOND
    rows = [_make_span(place, str(event["text"]), event) for place, event in words]
    return TimedWords(check_spans(rows, per_second=per_second), _read_visemes(events), "Azure events")


def _list_events(content: bytes) -> Sequence[_Event]:
    if content.lstrip().startswith(b"["):
        return msgspec.json.decode(content, type=list[dict[str, object]])
    try:
        whole = msgspec.json.decode(content, type=dict[str, object])
    except msgspec.DecodeError:
        return msgspec.json.Decoder(dict[str, object]).decode_lines(content)
    return msgspec.convert(whole.get("events", [whole]), type=list[dict[str, object]])


def _plain_key(key: str) -> str:
    return key.removeprefix("priv").replace("_", "").lower()


def _number(event: _Event, key: str, place: str) -> float:
    value = event.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TimingError(f"{place} {key} is {shorten(str(value))}; it must be a number")
    return value


def _make_span(place: str, text: str, event: _Event) -> RawSpan:
    start = _number(event, "audiooffset", place)
    return RawSpan(place, text, start, start + _number(event, "duration", place) if "duration" in event else None)


def _read_visemes(events: Sequence[_Event]) -> tuple[Phoneme, ...]:
    spans = check_spans(_list_visemes(events), per_second=TICKS_PER_SECOND)
    return make_phonemes(
        TimedSpan(VISEME_SOUNDS[int(span.text)], span.start, span.end)
        for span in spans[:-1]  # the last one has no end: it is the closing silence
        if VISEME_SOUNDS[int(span.text)]
    )


def _list_visemes(events: Sequence[_Event]) -> Iterator[RawSpan]:
    for k, event in enumerate(events):
        if "visemeid" in event:
            place = f"event {k + 1}"
            number = _number(event, "visemeid", place)
            if number not in range(len(VISEME_SOUNDS)):
                raise TimingError(f"{place} visemeId is {number:g}; visemes are 0 to {len(VISEME_SOUNDS) - 1}")
            yield RawSpan(place, str(int(number)), _number(event, "audiooffset", place))
