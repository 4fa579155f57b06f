"""Facial expressions by lexeme, emotion or action unit, and their time course."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path

import msgspec
import numpy as np

from kinesic.bml.block import Face
from kinesic.body.action_units import ACTION_UNITS, FaceSide, describe_unknown_unit, face_keys, unit_channels
from kinesic.body.arrays import Floats
from kinesic.body.config import CONFIGS, ConfigError, read_toml
from kinesic.expressivity.lexicon.movement_words import NEGATION_WORDS, amplitude_factor, movement_words
from kinesic.expressivity.lexicon.names import NAME_CACHE_SIZE, word_set
from kinesic.expressivity.lexicon.senses import Sense, nearest_sense, read_lexeme
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY, Expressivity
from kinesic.motion.easing import ease

EXPRESSION_FILE = CONFIGS / "faces" / "expressions.toml"

MIN_RISE_TIME = 0.06  # [s] shortest rise or decay of an expression, set by facial muscles
EXTENT_GAIN = 0.5  # relative increase of the intensity at a spatial extent of 1, decrease at -1
OVERSHOOT_RATIO = 0.25  # overshoot / held intensity at a power of 1
SETTLING_TIME = 0.35  # [s] time from the overshoot to the held intensity
FADE_RATIO = 0.4  # fraction of the intensity lost during the hold at a power of -1
MAX_FADE_TIME = 2.0  # [s] longest duration of the fading during the hold
MAX_BRIDGED_GAP = 1.0  # [s] longest gap between two expressions that are joined at a fluidity of 1

_VAGUE_WORDS = word_set(  # words that identify an expression only together with other words
    "raise lower open close up down high wide part pull press tight stretch blow kind content"
)
_FILLER_WORDS = word_set("face facial expression emotion look very really and in at with slow slowly fast quick")

_FACE_SIDES: Mapping[str, FaceSide] = {"left": "left", "right": "right"}


class ExpressionEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML entry of one facial expression."""

    words: list[str]
    says: str
    units: dict[str, float]  # action unit -> intensity at full amount; above 1 it saturates earlier
    flutter: float = 0.0  # [s] period of the intensity modulation; 0: constant intensity


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    expression: list[ExpressionEntry]


@dataclass(frozen=True)
class Expression:
    """Facial expression: action units at its peak."""

    units: Mapping[str, float]  # key of Command.face -> 0..1
    flutter: float = 0.0  # [s] period of the intensity modulation; 0: constant intensity
    unknown: tuple[str, ...] = ()  # requested lexemes that match no expression
    left_out: tuple[str, ...] = ()  # words without effect in lexemes that match an expression


def find_expression(face: Face, *, path: Path = EXPRESSION_FILE) -> Expression:
    """Return the action units of a face behaviour.

    A lexeme is split into words; the expression that matches most of them counts, and a negated lexeme has none. Words
    such as small and big, left and right modify it. Of several lexemes the stronger intensity counts for each action
    unit.

    Args:
        face: lexemes, or an action unit by number; the amount is the intensity of the unit.
        path: of the file of expressions.

    Raises:
        ConfigError: the file is missing or invalid.
    """
    if face.action_unit is not None:
        if face.action_unit not in ACTION_UNITS:
            return Expression({}, unknown=(str(face.action_unit),))
        return Expression(dict.fromkeys(unit_channels(face.action_unit, face.side), _clip_unit(face.amount)))
    units: dict[str, float] = {}
    flutter, unknown, left_out = 0.0, list[str](), list[str]()
    for lexeme in face.lexemes:
        match = _entry(lexeme, path)
        if match is None:
            unknown.append(lexeme)
            continue
        side = match.side if face.side == "both" else face.side
        for unit, full_intensity in match.entry.units.items():
            for channel in face_keys(unit) if side == "both" else unit_channels(int(unit.lstrip("LR")), side):
                units[channel] = max(units.get(channel, 0.0), _clip_unit(full_intensity * face.amount * match.scale))
        flutter = flutter or match.entry.flutter
        left_out += match.left_out
    return Expression(units, flutter, tuple(unknown), tuple(left_out))


@cache
def entries(path: Path = EXPRESSION_FILE) -> tuple[ExpressionEntry, ...]:
    """Read all facial expressions of a TOML file.

    Raises:
        ConfigError: the file is missing or invalid, or contains an unknown action unit.
    """
    match = read_toml(path, _File).expression
    for number, entry in enumerate(match):
        for unit, full_intensity in entry.units.items():
            if not face_keys(unit):
                raise ConfigError(f"{path}: $.expression[{number}].units: {describe_unknown_unit(unit)}")
            if full_intensity < 0.0:
                raise ConfigError(
                    f"{path}: $.expression[{number}].units.{unit} is {full_intensity}, must be at least 0"
                )
    return tuple(match)


@dataclass(frozen=True, eq=False)
class _LexemeMatch:
    """Expression that matches a lexeme, with its scale and unmatched words."""

    entry: ExpressionEntry
    scale: float  # factor on the intensity
    side: FaceSide
    left_out: tuple[str, ...]  # words that the expression does not show


@lru_cache(maxsize=NAME_CACHE_SIZE)
def _entry(lexeme: str, path: Path) -> _LexemeMatch | None:
    all_entries, reading = entries(path), read_lexeme(lexeme)
    match = nearest_sense(reading.words, [Sense(tuple(entry.words), "face", entry.says) for entry in all_entries])
    if match is None or NEGATION_WORDS & {*reading.words}:
        return None
    index, matched_words = match
    other_words = [word for word in reading.words if word not in matched_words]
    standard_words = movement_words("_".join(other_words))
    left_out = tuple(
        word
        for word, size in zip(other_words, standard_words, strict=True)
        if word not in _FILLER_WORDS and size not in ("big", "small")
    )
    if left_out and {*matched_words} <= _VAGUE_WORDS:
        return None
    return _LexemeMatch(
        all_entries[index], amplitude_factor(standard_words), _FACE_SIDES.get(reading.mode, "both"), left_out
    )


@dataclass(frozen=True)
class Envelope:
    """Start, peak, relaxation and end times of an expression [s].

    It rises from `start` to `peak`, and decays from `relax` to `end`. The last two are infinite if it stays.
    """

    start: float  # [s] start of the rise
    peak: float  # [s] end of the rise
    relax: float = np.inf  # [s] start of the decay
    end: float = np.inf  # [s] end of the decay

    @classmethod
    def of(cls, times: Mapping[str, float], *, stays: bool = False) -> "Envelope":
        """Create the envelope from the sync points of a face behaviour.

        Phases without time take `MIN_RISE_TIME`.

        Args:
            times: start, attackPeak, relax and end, or start and end of an expression that stays [s].
            stays: whether it never decays.
        """
        start = times["start"]
        if stays:
            return cls(start, max(times["end"], start + MIN_RISE_TIME))
        peak = max(times["attackPeak"], start + MIN_RISE_TIME)
        relax = max(times["relax"], peak)
        return cls(start, peak, relax, max(times["end"], relax + MIN_RISE_TIME))

    def at(self, times: Floats, manner: Expressivity = NEUTRAL_EXPRESSIVITY) -> Floats:
        """Return the intensity at (m,) times as fractions (m,) of the peak.

        Every expressivity keeps the four times, and neutral expressivity stays within 0..1. Power lets the expression
        rise early and overshoot; weakness lets it rise late and fade. Jerky ones begin and end abruptly. Wide ones
        exceed the requested intensity, tight ones fall below it.

        Args:
            times: [s].
            manner: expressivity of the face; spatial extent, power and fluidity are used. The result may exceed 1.
        """
        fractions = _ease_with_fluidity(
            _warp_rise((times - self.start) / (self.peak - self.start), manner.power), manner.fluidity
        )
        if not np.isinf(self.end):
            fractions = np.minimum(
                fractions, 1.0 - _ease_with_fluidity((times - self.relax) / (self.end - self.relax), manner.fluidity)
            )
        return np.asarray((1.0 + EXTENT_GAIN * manner.spatial) * fractions * self._level(times, manner.power))

    def _level(self, times: Floats, power: float) -> Floats | float:
        """Return the factor (m,) on the intensity for overshoot or fading.

        A single 1 at a power of 0.
        """
        if power > 0:
            return 1.0 + OVERSHOOT_RATIO * power * (1.0 - ease("minimum_jerk", (times - self.peak) / SETTLING_TIME))
        holding = min(max(self.relax - self.peak, MIN_RISE_TIME), MAX_FADE_TIME)
        return 1.0 + FADE_RATIO * power * ease("minimum_jerk", (times - self.peak) / holding) if power else 1.0


def _warp_rise(fractions: Floats, power: float) -> Floats:
    """Return the intensities 0..1 of a rising expression at time fractions 0..1.

    Power makes the expression rise early, weakness late.
    """
    x = np.clip(fractions, 0.0, 1.0)
    return 1.0 - (1.0 - x) ** (1.0 + power) if power > 0 else x ** (1.0 - power)


def _ease_with_fluidity(fractions: Floats, fluidity: float) -> Floats:
    smooth = ease("minimum_jerk", fractions)
    return smooth if fluidity >= 0 else smooth - fluidity * (ease("linear", fractions) - smooth)


def _clip_unit(value: float) -> float:
    return min(max(value, 0.0), 1.0)
