"""Word senses of `configs/intents/senses/LANGUAGE`: words by meaning and syntax.

A sense lists words of one meaning. Its frame states the syntax in which the words have this meaning: `drop` as a verb
falls, but `a drop of water` does not.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import msgspec

from kinesic.body.config import CONFIGS, read_toml
from kinesic.intent.meaning.cues import PICTURE_INTENT, Cue, CueContext, CueEntry, CueKind, make_cue

FrameName = Literal[
    "verb", "deed", "degree", "attribute", "feeling", "avowal", "exclamation", "phrase", "literal", "noun", "order"
]

SENSE_FOLDER = CONFIGS / "intents" / "senses"  # folder with one folder of sense files per language


class _Sense(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    says: str
    words: str  # separated by commas; a word may be a pattern of several words
    frame: FrameName
    shows: str = ""
    certainty: float | None = None
    intent: str = PICTURE_INTENT
    where: CueContext | None = None
    not_after: str = ""
    not_before: str = ""
    near: str = ""
    not_near: str = ""


class _File(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    sense: list[_Sense]


@dataclass(frozen=True)
class Frame:
    """Syntax in which the words of a sense have their meaning."""

    kind: CueKind
    certainty: float  # 0..1 certainty of a sense whose file gives none
    pattern: str = "{}"  # pattern with a placeholder for a word
    after: str = ""  # words or @classes, one of which must precede
    before: str = ""  # words or @classes, one of which must follow
    not_after: str = ""
    not_before: str = ""
    where: CueContext = "any"


SYNTAX_FRAMES: Mapping[FrameName, Frame] = {
    "verb": Frame("word", 0.66, not_after="@determiner @possessor @adjective of"),  # moves, changes
    "deed": Frame("word", 0.66, before="@determiner @object", not_after="@determiner @possessor"),  # with an object
    "degree": Frame("word", 0.66, after="@copula @degree"),  # adjective after `is` or `so`
    "attribute": Frame("word", 0.66, before="@content"),  # adjective before a noun
    "feeling": Frame("feeling", 0.74, after="@copula @degree"),  # adjective of a person who feels it
    "avowal": Frame("feeling", 0.74),  # feeling or promise of the speaker, anywhere
    "exclamation": Frame("idiom", 0.74, pattern="^{}"),  # begins a clause
    "phrase": Frame("idiom", 0.66),  # fixed words, anywhere
    "literal": Frame("word", 0.66),  # words in their literal sense, anywhere
    "noun": Frame("word", 0.64, after="@determiner @possessor @adjective @number of"),
    "order": Frame("idiom", 0.72, pattern="^{}", not_before="@auxiliary"),  # imperative
}


def read_senses(folder: Path, irregular: Mapping[str, frozenset[str]]) -> Iterator[Cue]:
    """Yield the cues of all word senses of a language.

    Args:
        folder: with the files.
        irregular: irregular forms of verbs.

    Raises:
        ConfigError: a file is invalid.
    """
    for path in sorted(folder.glob("*.toml")):
        for sense in read_toml(path, _File).sense:
            yield make_cue(_frame_sense(sense), path, irregular)


def _frame_sense(sense: _Sense) -> CueEntry:
    """Convert a sense and its syntax frame to a cue entry."""
    frame = SYNTAX_FRAMES[sense.frame]
    words = (word.strip() for word in sense.words.replace("\n", " ").split(","))
    return CueEntry(
        says=sense.says,
        words="\n".join(frame.pattern.format(word) for word in words if word),
        shows=sense.shows,
        kind=frame.kind,
        certainty=frame.certainty if sense.certainty is None else sense.certainty,
        intent=sense.intent,
        where=sense.where or frame.where,
        after=frame.after,
        before=frame.before,
        not_after=f"{frame.not_after} {sense.not_after}",
        not_before=f"{frame.not_before} {sense.not_before}",
        near=sense.near,
        not_near=sense.not_near,
    )
