"""Word times of ElevenLabs' JSON, which has the times of characters."""

from collections.abc import Iterator

import msgspec

from kinesic.speech.timings.timed_words import RawSpan, TimedWords, TimingError, check_spans


class _Alignment(msgspec.Struct):
    characters: list[str]
    character_start_times_seconds: list[float]  # [s]
    character_end_times_seconds: list[float]  # [s]


class _File(msgspec.Struct):
    alignment: _Alignment | None = None
    normalized_alignment: _Alignment | None = None


def read_elevenlabs(content: bytes) -> TimedWords:
    """Read the words of synthesised speech in ElevenLabs' JSON.

    Raises:
        TimingError: a time is invalid, or the lists differ in length.
        msgspec.DecodeError: the JSON has another structure.
    """
    file = msgspec.json.decode(content, type=_File)
    alignment = file.alignment or file.normalized_alignment
    if alignment is None:
        alignment = msgspec.json.decode(content, type=_Alignment)
    return TimedWords(check_spans(_join_characters(alignment)), file_format="ElevenLabs JSON")


def _join_characters(alignment: _Alignment) -> Iterator[RawSpan]:
    """Yield each word, with the times of its outer characters."""
    starts, ends = alignment.character_start_times_seconds, alignment.character_end_times_seconds
    characters = alignment.characters
    if not len(characters) == len(starts) == len(ends):
        counts = f"{len(characters)} characters, {len(starts)} start times and {len(ends)} end times"
        raise TimingError(f"alignment has {counts}; the three lists need the same length")
    first = 0
    for k in range(len(characters) + 1):
        if k == len(characters) or not characters[k].strip():
            if k > first:
                yield RawSpan(f"characters[{first}]", "".join(characters[first:k]), starts[first], ends[k - 1])
            first = k + 1
