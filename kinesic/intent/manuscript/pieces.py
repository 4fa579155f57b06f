"""State of the text reader, and the result of each reading step."""

from dataclasses import dataclass, field
from typing import Literal

from kinesic.body.scripts import SENTENCE_STOPS

Place = Literal["text", "silent", "cue"]  # part of a text with subtitles in which a line begins
Mode = Literal["text", "thought", "code", "skipped", "other"]  # kind of text that the reader is in
END_OF_SENTENCE = SENTENCE_STOPS  # punctuation signs at the end of a sentence
LINE_PAUSE = 0.25  # [s] silence after a heading, list item or short line, in addition to punctuation
PARAGRAPH_PAUSE = 0.45  # [s] silence between paragraphs, in addition to that of punctuation
DIRECTED_PAUSE = 0.8  # [s] silence for a pause that a stage direction requests


@dataclass(frozen=True, eq=False)
class SubtitleState:
    """State of reading subtitles that arrive in parts."""

    rest: str = ""  # received text that waits for its continuation
    place: Place = "text"
    is_start: bool = True  # whether nothing but empty lines was received
    is_line_start: bool = True
    is_block_start: bool = True  # whether the preceding line is empty
    is_webvtt: bool = False  # whether the header of WebVTT was received
    has_words: bool = False  # whether the current cue has spoken words
    is_line_open: bool = False  # whether spoken words of a cue have no line end yet
    pause: float = 0.0  # [s] silence before the words of the current cue
    end: float | None = None  # [s] end of the current cue
    last_end: float | None = None  # [s] end of the last spoken cue


@dataclass(frozen=True, eq=False)
class Manuscript:
    """State of reading a text that arrives in parts."""

    rest: str = ""  # received text that waits for its continuation
    mode: Mode = "text"
    closing: str = ""  # text that ends the mode
    is_line_start: bool = True
    line_length: int = 0  # [characters] length of the line read so far
    is_block: bool = False  # whether the line is a heading, list item or table row, which ends a sentence
    stress: str = ""  # signs that opened the current emphasis; empty: no emphasis
    spoken: str = ""  # last characters of the spoken text
    speakers: frozenset[str] = frozenset()  # names of a dialogue, in capitals
    character: str = ""  # speaker whose lines are spoken, in capitals; empty: all speakers
    others: frozenset[str] = frozenset()  # speakers whose lines were left out, in capitals
    subtitles: SubtitleState = field(default_factory=SubtitleState)  # state of the preceding subtitle reader

    @property
    def waiting(self) -> str:
        """Received text that may be incomplete."""
        return self.rest + self.subtitles.rest

    def restarted(self) -> "Manuscript":
        """Return the initial state for the next text of a dialogue."""
        return Manuscript(speakers=self.speakers, character=self.character, others=self.others)


@dataclass(frozen=True, eq=False)
class SpokenText:
    """Spoken text with tags for pauses and directions, without other markup."""

    text: str
    warnings: tuple[str, ...] = ()  # one for each part of the written text that is not spoken


@dataclass(frozen=True, eq=False)
class Step:
    """Result of reading one word or markup: spoken text and state change."""

    length: int  # [characters] of the received text
    text: str = ""  # spoken text, with tags for directions and pauses
    warning: str = ""
    stress: str | None = None  # signs that opened the emphasis after this step; empty: no emphasis, None: unchanged
    mode: Mode = "text"  # kind of element that encloses the following text
    closing: str = ""  # text that ends this mode
    other: str = ""  # speaker in capitals whose following lines are left out
    is_block: bool = False  # whether this step makes the line a heading, list item or table row


def direct(words: str) -> str:
    """Return the XML tag of a stage direction."""
    safe = "".join(" " if character in "<>&\"'" else character for character in words)
    return f'<kinesic:act words="{" ".join(safe.split())}"/>'


def pause(seconds: float) -> str:
    """Return the XML tag of a pause [s]."""
    return f'<break time="{round(1000 * seconds)}ms"/>'
