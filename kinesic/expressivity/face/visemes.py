"""Mouth motion in speech: phonemes as overlapping action units.

Each sound has a mouth shape that begins before the sound and outlasts it, the earliest for rounded lips; the strongest
counts for each action unit. The lip opening is determined for the mouth as a whole: sounds that need closed lips hold
them, and between them the lips stay within their velocity, so that a vowel between two such sounds opens as far as
time allows. The lips do not part while they are pressed.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import msgspec
import numpy as np

from kinesic.body.action_units import describe_unknown_unit, face_keys
from kinesic.body.arrays import Floats
from kinesic.body.config import CONFIGS, ConfigError, read_toml
from kinesic.body.utterance import STRESS_MARKS, VOWEL_LETTERS, Phoneme
from kinesic.expressivity.face.expressions import Envelope
from kinesic.expressivity.face.opening import BITE_OPENINGS, LIP_OPENINGS, limit_lip_opening, lip_opening

MOUTH_STEP = 0.005  # [s] time step of the mouth track
SHAPE_LEAD_TIME = 0.07  # [s] time from the start of a mouth shape to its sound
ROUND_LEAD_TIME = 0.12  # [s] time from the start of lip rounding to its sound
PRESS_TIME = 0.025  # [s] rise time of the lip press to its full intensity
RELEASE_TIME = 0.02  # [s] fall time of the lip press to zero intensity
RELEASE_ADVANCE = 0.028  # [s] advance of the lip release before the sound's end, as lips stick
# Shortest time of pressed lips [s]; with closing and opening they are visibly closed for 0.05 s, longer than a film
# frame.
MIN_PRESS_TIME = 0.015  # [s] shortest press of closed lips
ATTACK_FRACTION = 0.3  # fraction of a sound's duration after which its mouth shape is reached
SHAPE_LAG_TIME = 0.06  # [s] time from the end of a sound to the end of its mouth shape
VISEME_FILE = CONFIGS / "faces" / "visemes.toml"
SEAL_UNIT = "24"  # action unit that presses the lips together
INNER_UNITS = ("19", "32")  # action units that closed lips hide
VISEME_WINDOW = 0.4  # [s] time before the first and after the last sound that the mouth track covers
UNSTRESSED_OPENING = 0.55  # relative lip opening of an unstressed vowel
_LEAD_TIMES = {"18": ROUND_LEAD_TIME, "22": ROUND_LEAD_TIME}  # [s] by action unit, before the sound
NEUTRAL_VOWEL = "\N{LATIN SMALL LETTER SCHWA}"  # vowel whose mouth shape replaces unknown ones


class _Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML entry of sounds with the same mouth shape."""

    says: str
    sounds: str  # one letter per sound
    units: dict[str, float]  # action unit -> 0..1
    firm: bool = False  # whether the mouth shape limits the lip opening of neighbouring sounds


@dataclass(frozen=True, eq=False)
class Viseme:
    """Mouth shape of one sound."""

    units: Mapping[str, float]  # key of Command.face -> 0..1
    firm: bool  # whether the mouth shape limits the lip opening of neighbouring sounds


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    viseme: list[_Entry]


def viseme_of(sound: str) -> Viseme:
    """Return the mouth shape of a phonetic letter.

    An unknown one is a neutral vowel.
    """
    table = known_visemes()
    return table.get(sound, table[NEUTRAL_VOWEL])


@cache
def known_visemes(path: Path = VISEME_FILE) -> Mapping[str, Viseme]:
    """Read a viseme file and return mouth shapes by phonetic letter.

    Raises:
        ConfigError: the file is missing or invalid, or contains an unknown action unit.
    """
    units_by_letter: dict[str, Viseme] = {}
    for number, entry in enumerate(read_toml(path, _File).viseme):
        location = f"{path}: $.viseme[{number}].units"
        for unit, value in entry.units.items():
            if not face_keys(unit):
                raise ConfigError(f"{location}: {describe_unknown_unit(unit)}")
            if not 0.0 <= value <= 1.0:
                raise ConfigError(f"{location}.{unit} is {value}, must be from 0 to 1")
        units = {channel: value for unit, value in entry.units.items() for channel in face_keys(unit)}
        units_by_letter |= dict.fromkeys(entry.sounds, Viseme(units, entry.firm))
    return units_by_letter


def visemes(phonemes: Sequence[Phoneme], times: Floats, *, start: float = 0.0) -> Mapping[str, Floats]:
    """Compute the action units of the mouth for an utterance.

    Args:
        phonemes: of the utterance, in order.
        times: (m,) [s], increasing.
        start: of the utterance, on the same clock [s].

    Returns:
        Key of Command.face -> (m,) 0..1.
    """
    sounds = list(_sounds(phonemes))
    if not sounds or not len(times):
        return {}
    grid = _grid(sounds, times - start)
    track = _shapes(sounds, grid)
    largest_opening, largest_bite = np.full((2, len(grid)), np.inf)
    for sound in sounds:
        first, last = np.searchsorted(grid, sound.held)
        if sound.viseme.firm:
            np.minimum(largest_opening[first:last], lip_opening(sound.units), out=largest_opening[first:last])
        if SEAL_UNIT in sound.units:
            largest_bite[first:last] = 0.0
    limit_lip_opening(track, largest_opening, MOUTH_STEP)
    limit_lip_opening(track, largest_bite, MOUTH_STEP, openings=BITE_OPENINGS)
    if SEAL_UNIT in track:
        for channel in track.keys() & {*INNER_UNITS}:
            track[channel] = track[channel] * (1.0 - track[SEAL_UNIT])
    return {channel: np.interp(times, start + grid, row, left=0.0, right=0.0) for channel, row in track.items()}


@dataclass(frozen=True, eq=False)
class _Sound:
    """Spoken sound with its mouth shape and times."""

    viseme: Viseme
    begin: float  # [s] begin of the sound
    end: float  # [s] end of the sound
    strength: float  # factor on the lip opening

    @property
    def units(self) -> Mapping[str, float]:
        """Action units of the sound, with the lip opening scaled by stress.

        Key of Command.face -> 0..1.
        """
        full_units = self.viseme.units
        return {
            channel: min(value * self.strength, 1.0) if channel in LIP_OPENINGS else value
            for channel, value in full_units.items()
        }

    @property
    def held(self) -> tuple[float, float]:
        """Time span in which the mouth holds the sound's shape [s].

        Closed lips are held long enough to be visible on film.
        """
        if SEAL_UNIT not in self.viseme.units:
            return self.begin, self.end
        return min(self.begin, self.end - RELEASE_ADVANCE - MIN_PRESS_TIME), self.end - RELEASE_ADVANCE

    def course(self, channel: str) -> Envelope:
        """Return the intensity over time of one action unit of the sound.

        Lips that close are closed when the hold begins; other action units peak a little later.
        """
        begin, end = self.held
        if channel == SEAL_UNIT:
            return Envelope(begin - PRESS_TIME, begin, end, end + RELEASE_TIME)
        attack = min(begin + ATTACK_FRACTION * (end - begin), begin + SHAPE_LEAD_TIME)
        return Envelope(
            begin - _LEAD_TIMES.get(channel, SHAPE_LEAD_TIME),
            attack,
            max(end, attack),
            max(end, attack) + SHAPE_LAG_TIME,
        )


def _grid(sounds: Sequence[_Sound], times: Floats) -> Floats:
    """Return uniformly spaced times (n,) [s] that cover the mouth motion."""
    first = max(sounds[0].begin, times[0]) - VISEME_WINDOW
    last = min(sounds[-1].end, times[-1]) + VISEME_WINDOW
    return MOUTH_STEP * np.arange(np.floor(first / MOUTH_STEP), np.ceil(max(first, last) / MOUTH_STEP) + 1)


def _shapes(sounds: Iterable[_Sound], grid: Floats) -> dict[str, Floats]:
    """Merge all sounds into one intensity course per action unit, by maximum.

    Returns:
        Key of Command.face -> (n,) 0..1.
    """
    units_by_letter: dict[str, Floats] = {}
    for sound in sounds:
        for channel, intensity in sound.units.items():
            course = sound.course(channel)
            row = units_by_letter.setdefault(channel, np.zeros(len(grid)))
            first, last = np.searchsorted(grid, (course.start, course.end))
            np.maximum(row[first:last], intensity * course.at(grid[first:last]), out=row[first:last])
    return units_by_letter


def _sounds(phonemes: Sequence[Phoneme]) -> Iterator[_Sound]:
    """Split phonemes into their letters and yield each as a sound.

    Letters of a diphthong or affricate divide its time.
    """
    has_stress_marks = any(phoneme.symbol.startswith(STRESS_MARKS) for phoneme in phonemes)
    for phoneme in phonemes:
        letters = phoneme.letters
        begin, end = phoneme.articulation
        is_unstressed = (
            has_stress_marks and not phoneme.symbol.startswith(STRESS_MARKS) and letters[:1] in VOWEL_LETTERS
        )
        for k, letter in enumerate(letters):
            duration = (end - begin) / len(letters)
            strength = (UNSTRESSED_OPENING if is_unstressed else 1.0) * phoneme.opening
            yield _Sound(viseme_of(letter), begin + k * duration, begin + (k + 1) * duration, strength)
        if letters and SEAL_UNIT in viseme_of(letters[-1]).units and end < phoneme.end:  # a plosive opens the lips
            yield _Sound(viseme_of(NEUTRAL_VOWEL), end, phoneme.end, UNSTRESSED_OPENING)
