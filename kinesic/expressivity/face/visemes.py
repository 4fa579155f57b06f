"""What lips and jaw do in speech: phonemes become action units that run into one another.

Each sound has a shape of the mouth that begins before the sound and outlasts it, lips that round longest before; the
strongest counts for each action unit. How far the lips are apart is settled for the mouth as a whole: sounds that need
them close hold them so, and on the way from and to them they go no faster than lips do, so that a vowel between two of
them opens as far as there is time for. Nothing parts the lips while they are pressed.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import msgspec
import numpy as np

from kinesic.body.action_units import face_keys, unknown_unit
from kinesic.body.arrays import Floats
from kinesic.body.config import CONFIGS, ConfigError, read_toml
from kinesic.body.utterance import STRESSES, VOWELS, Phoneme
from kinesic.expressivity.face.expressions import Envelope
from kinesic.expressivity.face.opening import OPENING, limit_opening, opening

MOUTH_STEP = 0.005  # [s] in which the mouth is worked out
LEAD = 0.07  # [s] before a sound, when its shape begins
ROUND_LEAD = 0.12  # [s] the same of lips that round
SEAL_LEAD, SEAL_LAG = 0.025, 0.03  # [s] in which closed lips are pressed together before, and let go after
SOONER = 0.028  # [s] before they are heard to open, when closed lips let go: soft ones stick together at first
SHORTEST_PRESS = (
    0.015  # [s] that they are pressed at least; to be seen closed takes them 0.05, more than a picture of a film
)
ATTACK = 0.3  # share of a sound after which its shape is reached
LAG = 0.06  # [s] after a sound, when its shape is gone
VISEMES = CONFIGS / "faces" / "visemes.toml"
SEAL = "24"  # the action unit that closes the lips
BEHIND = ("19", "32")  # what must not be seen through closed lips
VISEME_REACH = 0.4  # [s] round a time, within which sounds may decide what is shown
UNSTRESSED = 0.55  # of the opening of a vowel without stress
_LEADS = {"18": ROUND_LEAD, "22": ROUND_LEAD}
NEUTRAL = "\N{LATIN SMALL LETTER SCHWA}"


class _Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Sounds that look alike."""

    says: str
    sounds: str  # one letter each
    units: dict[str, float]  # action unit -> 0..1
    firm: bool = False  # whether neighbours open the mouth no further


@dataclass(frozen=True, eq=False)
class Viseme:
    """What the mouth does for one sound."""

    units: Mapping[str, float]  # key of Command.face -> 0..1
    firm: bool  # whether neighbours open the mouth no further while it sounds


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    viseme: list[_Entry]


def viseme_of(sound: str) -> Viseme:
    """Looks up what the mouth does for one sound, by its letter; an unknown one is a neutral vowel."""
    known = known_visemes()
    return known.get(sound, known[NEUTRAL])


@cache
def known_visemes(path: Path = VISEMES) -> Mapping[str, Viseme]:
    """Reads a file of visemes, by letters of the phonetic alphabet.

    Raises:
        ConfigError: the file is missing or wrong, or an action unit in it is unknown.
    """
    found: dict[str, Viseme] = {}
    for number, entry in enumerate(read_toml(path, _File).viseme):
        place = f"{path}: $.viseme[{number}].units"
        for unit, value in entry.units.items():
            if not face_keys(unit):
                raise ConfigError(f"{place}: {unknown_unit(unit)}")
            if not 0.0 <= value <= 1.0:
                raise ConfigError(f"{place}.{unit} is {value}, must be from 0 to 1")
        units = {channel: value for unit, value in entry.units.items() for channel in face_keys(unit)}
        found |= dict.fromkeys(entry.sounds, Viseme(units, entry.firm))
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
    sounds = list(_sounds(phonemes))
    if not sounds or not len(times):
        return {}
    grid = _grid(sounds, times - start)
    shown = _shapes(sounds, grid)
    most = np.full(len(grid), np.inf)
    for sound in sounds:
        if sound.viseme.firm:
            first, last = np.searchsorted(grid, sound.held)
            np.minimum(most[first:last], opening(sound.units), out=most[first:last])
    limit_opening(shown, most, MOUTH_STEP)
    if SEAL in shown:
        for channel in shown.keys() & {*BEHIND}:
            shown[channel] = shown[channel] * (1.0 - shown[SEAL])
    return {channel: np.interp(times, start + grid, row, left=0.0, right=0.0) for channel, row in shown.items()}


@dataclass(frozen=True, eq=False)
class _Sound:
    """One letter that is said."""

    viseme: Viseme
    begin: float  # [s]
    end: float  # [s]
    strength: float  # of what opens the mouth

    @property
    def units(self) -> Mapping[str, float]:
        """Key of Command.face -> 0..1."""
        whole = self.viseme.units
        return {channel: value * self.strength if channel in OPENING else value for channel, value in whole.items()}

    @property
    def held(self) -> tuple[float, float]:
        """[s] when the mouth holds its shape; closed lips so long that a film shows them."""
        if SEAL not in self.viseme.units:
            return self.begin, self.end
        return min(self.begin, self.end - SOONER - SHORTEST_PRESS), self.end - SOONER

    def course(self, channel: str) -> Envelope:
        """How one action unit comes and goes: lips that close have when it begins, others come a little later."""
        begin, end = self.held
        if channel == SEAL:
            return Envelope(begin - SEAL_LEAD, begin, end, end + SEAL_LAG)
        attack = min(begin + ATTACK * (end - begin), begin + LEAD)
        return Envelope(begin - _LEADS.get(channel, LEAD), attack, max(end, attack), max(end, attack) + LAG)


def _grid(sounds: Sequence[_Sound], times: Floats) -> Floats:
    """(n,) [s] steps of the utterance that decide what is shown at some times of it."""
    first = max(sounds[0].begin, times[0]) - VISEME_REACH
    last = min(sounds[-1].end, times[-1]) + VISEME_REACH
    return MOUTH_STEP * np.arange(np.floor(first / MOUTH_STEP), np.ceil(max(first, last) / MOUTH_STEP) + 1)


def _shapes(sounds: Iterable[_Sound], grid: Floats) -> dict[str, Floats]:
    """Key of Command.face -> (n,) what sounds show; of those that overlap the stronger counts."""
    found: dict[str, Floats] = {}
    for sound in sounds:
        for channel, intensity in sound.units.items():
            course = sound.course(channel)
            row = found.setdefault(channel, np.zeros(len(grid)))
            first, last = np.searchsorted(grid, (course.start, course.end))
            np.maximum(row[first:last], intensity * course.at(grid[first:last]), out=row[first:last])
    return found


def _sounds(phonemes: Sequence[Phoneme]) -> Iterator[_Sound]:
    """Yields single letters; those of a diphthong or an affricate share its time."""
    tells_stress = any(phoneme.symbol.startswith(STRESSES) for phoneme in phonemes)
    for phoneme in phonemes:
        letters = phoneme.letters
        begin, end = phoneme.made
        weak = tells_stress and not phoneme.symbol.startswith(STRESSES) and letters[:1] in VOWELS
        for k, letter in enumerate(letters):
            share = (end - begin) / len(letters)
            strength = UNSTRESSED if weak else 1.0
            yield _Sound(viseme_of(letter), begin + k * share, begin + (k + 1) * share, strength)
        if letters and SEAL in viseme_of(letters[-1]).units and end < phoneme.end:  # what bursts opens the lips
            yield _Sound(viseme_of(NEUTRAL), end, phoneme.end, UNSTRESSED)
