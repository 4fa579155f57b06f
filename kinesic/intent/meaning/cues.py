"""Cues of `configs/intents/cues/LANGUAGE`: words with the gestures that show them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import msgspec

from kinesic.body.config import CONFIGS, ConfigError, read_toml
from kinesic.expressivity.lexicon.word_stems import word_stem
from kinesic.intent.intents import ChosenHand
from kinesic.intent.meaning.patterns import Pattern, read_pattern, spell_out

CueKind = Literal[
    "idiom", "word", "feeling", "question"
]  # idiom: fixed words; word: literal; feeling: only where felt; question: asked words
CueContext = Literal["any", "statement", "question", "exclamation", "talk"]  # talk: between speaker and listener

CUE_FOLDER = CONFIGS / "intents" / "cues"  # folder with one folder of cue files per language
PICTURE_INTENT = "picture"  # intent of a gesture that depicts the meaning of words
# Certainty of a cue whose file entry gives none, by kind of cue.
DEFAULT_CERTAINTIES: Mapping[CueKind, float] = {"idiom": 0.8, "word": 0.7, "feeling": 0.75, "question": 0.65}


class CueEntry(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """Cue as written in a file."""

    says: str
    words: str  # word patterns, one in each line
    shows: str = ""
    kind: CueKind = "idiom"
    certainty: float | None = None
    intent: str = PICTURE_INTENT
    where: CueContext = "any"
    hand: ChosenHand = ""
    after: str = ""
    before: str = ""
    not_after: str = ""
    not_before: str = ""
    near: str = ""
    not_near: str = ""


class _File(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    cue: list[CueEntry]


@dataclass(frozen=True, eq=False)
class Cue:
    """Word patterns that call for a gesture, or that forbid one."""

    says: str  # meaning, for people
    patterns: tuple[Pattern, ...]
    shows: tuple[str, ...]  # equally fitting gestures; empty: nothing is shown here
    kind: CueKind
    certainty: float  # 0..1 certainty that the gesture fits
    intent: str  # behaviour set for face and head; `picture`: only the gesture is shown
    where: CueContext
    after: frozenset[str] = frozenset()  # words or @classes, one of which must precede; empty: any
    before: frozenset[str] = frozenset()  # words or @classes, one of which must follow; empty: any
    not_after: frozenset[str] = frozenset()
    not_before: frozenset[str] = frozenset()
    near: frozenset[str] = frozenset()  # stems of words, one of which must stand in the same sentence; empty: any
    not_near: frozenset[str] = frozenset()  # stems of words that must not stand in the same sentence
    hand: ChosenHand = ""  # hand that shows the cue, for pairs such as `on the one hand, on the other hand`


def read_cues(folder: Path, irregular: Mapping[str, frozenset[str]]) -> list[Cue]:
    """Read all cue files of a language.

    Args:
        folder: with the files.
        irregular: irregular forms of verbs.

    Raises:
        ConfigError: a file is invalid.
    """
    paths = sorted(folder.glob("*.toml"))
    return [make_cue(entry, path, irregular) for path in paths for entry in read_toml(path, _File).cue]


def make_cue(entry: CueEntry, path: Path, irregular: Mapping[str, frozenset[str]]) -> Cue:
    """Convert an entry of a cue file to a cue.

    Args:
        entry: as written.
        path: of its file.
        irregular: irregular forms of verbs.

    Raises:
        ConfigError: the entry is invalid.
    """
    certainty = DEFAULT_CERTAINTIES[entry.kind] if entry.certainty is None else entry.certainty
    if not 0.0 <= certainty <= 1.0:
        raise ConfigError(f"{path}: certainty of the cue that {entry.says} is {certainty}; 0 to 1 is possible")
    try:
        written = [read_pattern(line, irregular) for line in entry.words.splitlines() if line.strip()]
    except ValueError as fault:
        raise ConfigError(f"{path}: {fault}") from fault
    return Cue(
        says=entry.says,
        patterns=(*written, *filter(None, map(spell_out, written))),
        shows=tuple(entry.shows.split()),
        kind=entry.kind,
        certainty=certainty,
        intent=entry.intent,
        where=entry.where,
        after=frozenset(entry.after.split()),
        before=frozenset(entry.before.split()),
        not_after=frozenset(entry.not_after.split()),
        not_before=frozenset(entry.not_before.split()),
        near=frozenset(map(word_stem, entry.near.split())),
        not_near=frozenset(map(word_stem, entry.not_near.split())),
        hand=entry.hand,
    )
