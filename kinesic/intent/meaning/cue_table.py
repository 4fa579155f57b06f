"""Cues of a language, indexed by the words with which they begin."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import msgspec

from kinesic.body.config import read_toml
from kinesic.intent.meaning.cues import CUE_FOLDER, Cue, read_cues
from kinesic.intent.meaning.patterns import Pattern
from kinesic.intent.meaning.senses import SENSE_FOLDER, read_senses

IRREGULAR_VERBS = "irregular.toml"  # file of irregular verb forms, for all languages


class _Verbs(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    verbs: dict[str, dict[str, str]]  # language -> verb -> irregular forms


@dataclass(frozen=True, eq=False)
class CueTable:
    """All cues of a language, by the words with which they begin."""

    cues: tuple[Cue, ...]
    starts: Mapping[str, tuple[tuple[Cue, Pattern], ...]]  # word, stem (`wav~`), `#` or `_` -> cues

    @cached_property
    def gestures(self) -> Mapping[str, tuple[str, ...]]:
        """Gestures of all cues, grouped by the cues' meaning (`is large`)."""
        shown = dict[str, dict[str, None]]()
        for cue in self.cues:
            shown.setdefault(cue.says, {}).update(dict.fromkeys(cue.shows))
        return {says: tuple(names) for says, names in shown.items()}


NO_CUES = CueTable((), {})  # cue table of a language without cue files


@lru_cache(maxsize=16)
def load_cues(language: str) -> CueTable:
    """Return all gesture cues of a language, possibly none.

    Raises:
        ConfigError: a file is invalid.
    """
    folder = _find_folder(CUE_FOLDER, language)
    return NO_CUES if folder is None else _index(read_cues(folder, _read_irregular(folder.name)))


@lru_cache(maxsize=16)
def load_senses(language: str) -> CueTable:
    """Return all word senses of a language as cues, possibly none.

    Raises:
        ConfigError: a file is invalid.
    """
    folder = _find_folder(SENSE_FOLDER, language)
    return NO_CUES if folder is None else _index(read_senses(folder, _read_irregular(folder.name)))


def _find_folder(parent: Path, language: str) -> Path | None:
    """Find the folder of a language, or return None.

    The folders are listed, because a language tag may contain a path.
    """
    folders = {folder.name: folder for folder in sorted(parent.iterdir()) if folder.is_dir()}
    return folders.get(language.partition("-")[0])


@lru_cache(maxsize=16)
def _read_irregular(language: str) -> Mapping[str, frozenset[str]]:
    verbs = read_toml(CUE_FOLDER / IRREGULAR_VERBS, _Verbs).verbs.get(language, {})
    return {verb: frozenset(forms.split()) for verb, forms in verbs.items()}


def _index(cues: Iterable[Cue]) -> CueTable:
    """Index cues by the words with which their patterns begin."""
    listed, starts = tuple(cues), dict[str, list[tuple[Cue, Pattern]]]()
    for cue in listed:
        for pattern in cue.patterns:
            for word in pattern.first_words:
                starts.setdefault(word, []).append((cue, pattern))
    return CueTable(listed, {word: tuple(found) for word, found in starts.items()})
