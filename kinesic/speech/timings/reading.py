"""Reading of word time files, whose content determines the format."""

import codecs
from pathlib import Path

import msgspec

from kinesic.body.config import ConfigError
from kinesic.files.input_file import open_regular
from kinesic.speech.timings.azure import read_azure
from kinesic.speech.timings.elan import read_elan
from kinesic.speech.timings.elevenlabs import read_elevenlabs
from kinesic.speech.timings.polly import read_polly
from kinesic.speech.timings.subtitles import read_subtitles
from kinesic.speech.timings.textgrid import read_textgrid
from kinesic.speech.timings.timed_words import TimedWords, TimingError
from kinesic.speech.timings.whisper import read_whisper

MAX_BYTES = 20_000_000  # [bytes] largest accepted file
# supported formats, for error messages
FORMAT_NAMES = "Whisper, ElevenLabs, Azure and Polly JSON, TextGrid, ELAN, SubRip and WebVTT"
_AZURE_KEYS = ("audiooffset", "audio_offset", "privaudiooffset")  # keys of an Azure event, in lower case


def read_words_file(path: Path) -> TimedWords:
    """Read a file with the times of words.

    Raises:
        TimingError: the file is missing, too large or invalid.
    """
    try:
        with open_regular(path) as file:
            content = file.read(MAX_BYTES + 1)
    except ConfigError as error:
        raise TimingError(str(error)) from None
    except OSError as error:
        raise TimingError(f"{path}: {error.strerror}") from None
    return read_timed_words(content, source=str(path))


def read_timed_words(content: bytes, *, source: str = "<words>") -> TimedWords:
    """Read word times in any supported format.

    Args:
        content: of the file.
        source: name of the file in messages.

    Raises:
        TimingError: the format is unknown, or the content is invalid.
    """
    if len(content) > MAX_BYTES:
        raise TimingError(f"{source} has more than {MAX_BYTES} bytes")
    try:
        timed = _read(content)
        if not timed.words and not timed.phonemes:
            raise TimingError(f"no word has a time ({timed.file_format})")
    except TimingError as error:
        raise TimingError(f"{source}: {error}") from None
    except RecursionError:
        raise TimingError(f"{source}: the JSON is nested too deeply") from None
    except msgspec.DecodeError as error:
        raise TimingError(f"{source}: {error}") from None
    return timed


def _read(content: bytes) -> TimedWords:
    start = content.removeprefix(codecs.BOM_UTF8).lstrip()[:200_000]
    if start.startswith((b"{", b"[")):
        return _read_json(_decode(content).encode())
    if start.startswith(b"<"):
        if b"<ANNOTATION_DOCUMENT" not in content and b"<!DOCTYPE" not in content:
            raise TimingError("the XML is no file of ELAN: it has no <ANNOTATION_DOCUMENT>")
        return read_elan(content)
    text = _decode(content)
    if "ooTextFile" in text[:200]:
        if "TextGrid" not in text[:400]:
            raise TimingError("the file of Praat is no TextGrid; save a TextGrid as text")
        return read_textgrid(text)
    if text.lstrip("\ufeff \r\n\t").startswith("WEBVTT") or "-->" in text:
        return read_subtitles(text)
    raise TimingError(
        f"the format is unknown; the formats are {FORMAT_NAMES}" if content.strip() else "the file is empty"
    )


def _read_json(content: bytes) -> TimedWords:
    if content.lstrip().startswith(b"["):
        return read_azure(content)
    first = content.strip().splitlines()[0]
    try:
        keys = {key.lower() for key in msgspec.json.decode(content, type=dict[str, msgspec.Raw])}
    except msgspec.DecodeError:
        keys = {key.lower() for key in msgspec.json.decode(first, type=dict[str, msgspec.Raw])}  # one object per line
    if {"time", "type"} <= keys:
        return read_polly(content)
    if not keys.isdisjoint(_AZURE_KEYS) or "events" in keys:
        return read_azure(content)
    if not keys.isdisjoint(("alignment", "normalized_alignment", "character_start_times_seconds")):
        return read_elevenlabs(content)
    if not keys.isdisjoint(("segments", "words")):
        return read_whisper(content)
    wanted = "segments, words, alignment, events or time"
    raise TimingError(f"the JSON has none of the keys {wanted}; the formats are {FORMAT_NAMES}")


def _decode(content: bytes) -> str:
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16", "replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise TimingError(f"byte {error.start} is not UTF-8; save the file as UTF-8") from None
