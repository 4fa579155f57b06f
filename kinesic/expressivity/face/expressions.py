"""What a face is asked to show, by lexeme, emotion or number of an action unit, and how it comes and goes in time."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path

import msgspec
import numpy as np

from kinesic.bml.block import Face
from kinesic.body.action_units import UNITS, FaceSide, channels, face_keys, unknown_unit
from kinesic.body.arrays import Floats
from kinesic.body.config import CONFIGS, ConfigError, read_toml
from kinesic.expressivity.lexicon.movement_words import NEGATIONS, amplitude_factor, movement_words
from kinesic.expressivity.lexicon.names import NAMES_KEPT, word_set
from kinesic.expressivity.lexicon.senses import Sense, nearest_sense, read_lexeme
from kinesic.expressivity.style.style import NEUTRAL, Expressivity
from kinesic.motion.easing import ease

EXPRESSIONS = CONFIGS / "faces" / "expressions.toml"

QUICKEST = 0.06  # [s] in which a muscle of the face can do anything
EXTENT_GAIN = 0.5  # more intensity of a spatial extent of 1, and less of -1
OVERSHOOT = 0.25  # of the intensity, by which a power of 1 goes over what it then holds
SETTLING = 0.35  # [s] from there to what is held
FADING = 0.4  # of the intensity, that a power of -1 loses while it holds
LONGEST_FADE = 2.0  # [s] that this takes
BRIDGED = 1.0  # [s] between two expressions, over which a fluidity of 1 leads from one into the other

_VAGUE = word_set(  # words that say what is shown only together with the others
    "raise lower open close up down high wide part pull press tight stretch blow kind content"
)
_FILLERS = word_set("face facial expression emotion look very really and in at with slow slowly fast quick")

_SIDES: Mapping[str, FaceSide] = {"left": "left", "right": "right"}


class ExpressionEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One expression of the file."""

    words: list[str]
    says: str
    units: dict[str, float]  # action unit -> intensity at full amount; above 1: full before the amount is
    flutter: float = 0.0  # [s] period in which it comes and goes; 0: it stays


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    expression: list[ExpressionEntry]


@dataclass(frozen=True)
class Expression:
    """What one behaviour shows at its peak."""

    units: Mapping[str, float]  # key of Command.face -> 0..1
    flutter: float = 0.0  # [s] period in which it comes and goes; 0: it stays
    unknown: tuple[str, ...] = ()  # lexemes that mean nothing here
    left_out: tuple[str, ...] = ()  # words of the others that mean nothing here


def find_expression(face: Face, *, path: Path = EXPRESSIONS) -> Expression:
    """Finds what a face behaviour shows.

    A lexeme is taken apart into words; the expression counts that most of them speak of, and what is negated is none.
    Words such as small and big, left and right change it. Of several lexemes the stronger intensity counts for each
    action unit.

    Args:
        face: lexemes, or an action unit by number; the amount is the intensity of the unit.
        path: of the file of expressions.

    Raises:
        ConfigError: the file is missing or wrong.
    """
    if face.action_unit is not None:
        if face.action_unit not in UNITS:
            return Expression({}, unknown=(str(face.action_unit),))
        return Expression(dict.fromkeys(channels(face.action_unit, face.side), _inside(face.amount)))
    units: dict[str, float] = {}
    flutter, unknown, left_out = 0.0, list[str](), list[str]()
    for lexeme in face.lexemes:
        found = _entry(lexeme, path)
        if found is None:
            unknown.append(lexeme)
            continue
        side = found.side if face.side == "both" else face.side
        for unit, full in found.entry.units.items():
            for channel in face_keys(unit) if side == "both" else channels(int(unit.lstrip("LR")), side):
                units[channel] = max(units.get(channel, 0.0), _inside(full * face.amount * found.scale))
        flutter = flutter or found.entry.flutter
        left_out += found.left_out
    return Expression(units, flutter, tuple(unknown), tuple(left_out))


@cache
def entries(path: Path = EXPRESSIONS) -> tuple[ExpressionEntry, ...]:
    """Reads all expressions of a file.

    Raises:
        ConfigError: the file is missing or wrong, or an action unit in it is unknown.
    """
    found = read_toml(path, _File).expression
    for number, entry in enumerate(found):
        for unit, full in entry.units.items():
            if not face_keys(unit):
                raise ConfigError(f"{path}: $.expression[{number}].units: {unknown_unit(unit)}")
            if full < 0.0:
                raise ConfigError(f"{path}: $.expression[{number}].units.{unit} is {full}, must be at least 0")
    return tuple(found)


@dataclass(frozen=True, eq=False)
class _Found:
    """The expression that a lexeme means."""

    entry: ExpressionEntry
    scale: float  # of its intensity
    side: FaceSide
    left_out: tuple[str, ...]  # words that it does not show


@lru_cache(maxsize=NAMES_KEPT)
def _entry(lexeme: str, path: Path) -> _Found | None:
    known, reading = entries(path), read_lexeme(lexeme)
    found = nearest_sense(reading.words, [Sense(tuple(entry.words), "face", entry.says) for entry in known])
    if found is None or NEGATIONS & {*reading.words}:
        return None
    index, meant = found
    others = [word for word in reading.words if word not in meant]
    sized = movement_words("_".join(others))
    left_out = tuple(
        word for word, size in zip(others, sized, strict=True) if word not in _FILLERS and size not in ("big", "small")
    )
    if left_out and {*meant} <= _VAGUE:
        return None
    return _Found(known[index], amplitude_factor(sized), _SIDES.get(reading.mode, "both"), left_out)


@dataclass(frozen=True)
class Envelope:
    """How an expression comes and goes; one that stays never relaxes."""

    start: float  # [s]
    peak: float  # [s]
    relax: float = np.inf  # [s]
    end: float = np.inf  # [s]

    @classmethod
    def of(cls, times: Mapping[str, float], *, stays: bool = False) -> "Envelope":
        """Makes the envelope of a face's sync points; ways that they leave no time for take `QUICKEST`.

        Args:
            times: start, attackPeak, relax and end, or of one that stays start and end [s].
            stays: whether it never goes back.
        """
        start = times["start"]
        if stays:
            return cls(start, max(times["end"], start + QUICKEST))
        peak = max(times["attackPeak"], start + QUICKEST)
        relax = max(times["relax"], peak)
        return cls(start, peak, relax, max(times["end"], relax + QUICKEST))

    def at(self, times: Floats, manner: Expressivity = NEUTRAL) -> Floats:
        """Gives (m,) shares of the intensity at (m,) times, 0..1 in a neutral manner.

        Every manner keeps the four times. Power brings the expression on early and lets it overshoot; weakness lets it
        come late and fade. Of a jerky one the ways begin and end abruptly. A wide one is more than asked, a tight less.

        Args:
            times: [s].
            manner: of the face; spatial extent, power and fluidity are used. What comes out may exceed 1.
        """
        shares = _way(_early((times - self.start) / (self.peak - self.start), manner.power), manner.fluidity)
        if not np.isinf(self.end):
            shares = np.minimum(shares, 1.0 - _way((times - self.relax) / (self.end - self.relax), manner.fluidity))
        return np.asarray((1.0 + EXTENT_GAIN * manner.spatial) * shares * self._level(times, manner.power))

    def _level(self, times: Floats, power: float) -> Floats | float:
        """(m,) what is held, as a share of what was asked."""
        if power > 0:
            return 1.0 + OVERSHOOT * power * (1.0 - ease("minimum_jerk", (times - self.peak) / SETTLING))
        holding = min(max(self.relax - self.peak, QUICKEST), LONGEST_FADE)
        return 1.0 + FADING * power * ease("minimum_jerk", (times - self.peak) / holding) if power else 1.0


def _early(shares: Floats, power: float) -> Floats:
    """Shares of the time of coming: a forceful expression comes early, a weak one late."""
    x = np.clip(shares, 0.0, 1.0)
    return 1.0 - (1.0 - x) ** (1.0 + power) if power > 0 else x ** (1.0 - power)


def _way(shares: Floats, fluidity: float) -> Floats:
    smooth = ease("minimum_jerk", shares)
    return smooth if fluidity >= 0 else smooth - fluidity * (ease("linear", shares) - smooth)


def _inside(value: float) -> float:
    return min(max(value, 0.0), 1.0)
