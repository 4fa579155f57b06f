"""Word times of Whisper's JSON.

Also OpenAI's `verbose_json`, WhisperX, and ElevenLabs' lists of transcribed words.
"""

from collections.abc import Iterator

import msgspec

from kinesic.speech.timings.timed_words import RawSpan, TimedWords, check_spans


class _Word(msgspec.Struct):
    start: float | None = None  # [s] start of the word; WhisperX omits the start of numbers
    end: float | None = None  # [s]
    word: str = ""
    text: str = ""
    type: str = "word"


class _Segment(msgspec.Struct):
    start: float = 0.0  # [s]
    end: float | None = None  # [s]
    text: str = ""
    words: list[_Word] = []


class _File(msgspec.Struct):
    segments: list[_Segment] = []
    words: list[_Word] = []


def read_whisper(content: bytes) -> TimedWords:
    """Read the words of a transcript in Whisper's JSON.

    Segments without words count as phrases. A word without a time belongs to the preceding word.

    Raises:
        TimingError: a time is invalid.
        msgspec.DecodeError: the JSON has another structure.
    """
    return TimedWords(check_spans(_list_spans(msgspec.json.decode(content, type=_File))), file_format="Whisper JSON")


def _list_spans(file: _File) -> Iterator[RawSpan]:
    if file.words or not file.segments:
        yield from _list_words(file.words, "words")
        return
    for k, segment in enumerate(file.segments):
        if segment.words:
            yield from _list_words(segment.words, f"segments[{k}].words")
        else:
            yield RawSpan(f"segments[{k}]", segment.text, segment.start, segment.end)


def _list_words(words: list[_Word], place: str) -> Iterator[RawSpan]:
    waiting: RawSpan | None = None
    for k, word in enumerate(words):
        text = word.word or word.text
        if word.type != "word":  # a space, or a sound such as laughter
            continue
        if word.start is not None:
            if waiting is not None:
                yield waiting
            waiting = RawSpan(f"{place}[{k}]", text, word.start, word.end)
        elif waiting is not None:
            waiting = RawSpan(waiting.place, f"{waiting.text} {text}", waiting.start, word.end or waiting.end)
    if waiting is not None:
        yield waiting
