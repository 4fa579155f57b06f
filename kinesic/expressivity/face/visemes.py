"""What lips and jaw do in speech: phonemes become action units that run into one another.

Each sound has a shape of the mouth that begins before the sound and outlasts it, lips that round longest before; the
strongest counts for each action unit. Sounds that close the lips are kept closed: nothing that would part the lips
may do so while they are pressed.
"""

import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path

import msgspec
import numpy as np

from kinesic.body.action_units import face_keys, unknown_unit
from kinesic.body.arrays import Floats
from kinesic.body.config import CONFIGS, ConfigError, read_toml
from kinesic.body.utterance import Phoneme
from kinesic.expressivity.face.expressions import Envelope

LEAD = 0.07  # [s] before a sound, when its shape begins
ROUND_LEAD = 0.12  # [s] the same of lips that round
SEAL_LEAD = 0.05  # [s] the same of lips that close: they do it fast
ATTACK = 0.3  # share of a sound after which its shape is reached
LAG = 0.06  # [s] after a sound, when its shape is gone
VISEMES = CONFIGS / "faces" / "visemes.toml"
SEAL = "24"  # the action unit that closes the lips
PARTING: Mapping[str, float] = {"25": 1.0, "26": 0.6, "22": 0.7, "19": 1.0, "32": 1.0}  # what closed lips hold back
_LEADS = {"18": ROUND_LEAD, "22": ROUND_LEAD, SEAL: SEAL_LEAD}
NEUTRAL = "\N{LATIN SMALL LETTER SCHWA}"


class _Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Sounds that look alike."""

    says: str
    sounds: str  # one letter each
    units: dict[str, float]  # action unit -> 0..1


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    viseme: list[_Entry]


def shape_of(sound: str) -> Mapping[str, float]:
    """Looks up the mouth's shape for one sound, a letter of the phonetic alphabet: keys of Command.face and 0..1.

    A letter that is not known is a neutral vowel.
    """
    known = shapes()
    return known.get(sound, known[NEUTRAL])


@cache
def shapes(path: Path = VISEMES) -> Mapping[str, Mapping[str, float]]:
    """Reads a file of visemes: letter of the phonetic alphabet -> key of Command.face -> 0..1.

    Raises:
        ConfigError: the file is missing or wrong, or an action unit in it is unknown.
    """
    found: dict[str, Mapping[str, float]] = {}
    for number, entry in enumerate(read_toml(path, _File).viseme):
        place = f"{path}: $.viseme[{number}].units"
        for unit, value in entry.units.items():
            if not face_keys(unit):
                raise ConfigError(f"{place}: {unknown_unit(unit)}")
            if not 0.0 <= value <= 1.0:
                raise ConfigError(f"{place}.{unit} is {value}, must be from 0 to 1")
        shape = {channel: value for unit, value in entry.units.items() for channel in face_keys(unit)}
        found |= dict.fromkeys(entry.sounds, shape)
    return found


def visemes(phonemes: Sequence[Phoneme], times: Floats, *, start: float = 0.0) -> Mapping[str, Floats]:
    """Moves the mouth for an utterance.

    Args:
        phonemes: of the utterance, in order.
        times: (m,) [s] at which the mouth is asked for, increasing.
        start: [s] of the utterance, on the same clock.

    Returns:
        Key of Command.face -> (m,) 0..1.
    """
    found: dict[str, Floats] = {}
    for sound, begin, end in _sounds(phonemes):
        for channel, intensity in shape_of(sound).items():
            course = _course(channel, start + begin, start + end)
            row = found.setdefault(channel, np.zeros(len(times)))
            first, last = np.searchsorted(times, (course.start, course.end))
            np.maximum(row[first:last], intensity * course.at(times[first:last]), out=row[first:last])
    if SEAL in found:
        for channel in PARTING.keys() & found.keys():
            found[channel] *= 1.0 - PARTING[channel] * found[SEAL]
    return found


def _course(channel: str, begin: float, end: float) -> Envelope:
    """Times one sound: lips that close have closed when it begins, others come a little later."""
    attack = begin if channel == SEAL else min(begin + ATTACK * (end - begin), begin + LEAD)
    return Envelope(begin - _LEADS.get(channel, LEAD), attack, end, end + LAG)


def _sounds(phonemes: Iterable[Phoneme]) -> Iterator[tuple[str, float, float]]:
    """Yields single letters with begin and end [s]; the letters of a diphthong or an affricate share its time."""
    for phoneme in phonemes:
        letters = _letters(phoneme.symbol)
        for k, letter in enumerate(letters):
            share = phoneme.duration / len(letters)
            yield letter, phoneme.start + k * share, phoneme.start + (k + 1) * share


def _letters(symbol: str) -> str:
    """The letters of a symbol, without stress, length, tone and diacritics."""
    plain = unicodedata.normalize("NFD", symbol.casefold())
    return "".join(letter for letter in plain if unicodedata.category(letter) in ("Ll", "Lo"))
