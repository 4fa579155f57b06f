"""What a face is asked to show: lexemes by their meaning, emotions, and action units by number."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import msgspec

from kinesic.bml.block import Face
from kinesic.body.action_units import UNITS, FaceSide, channels, face_keys, unknown_unit
from kinesic.body.config import CONFIGS, ConfigError, read_toml
from kinesic.expressivity.head import amplitude_factor
from kinesic.expressivity.lexicon.synonyms import Sense, nearest_sense, read_lexeme

EXPRESSIONS = CONFIGS / "faces" / "expressions.toml"

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


def expression(face: Face, *, path: Path = EXPRESSIONS) -> Expression:
    """What a face behaviour shows.

    A lexeme is taken apart into words; the expression counts that most of them speak of. Words such as small and big,
    left and right change it. Of several lexemes the stronger intensity counts for each action unit.

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
    flutter, unknown = 0.0, []
    for lexeme in face.lexemes:
        found = _entry(lexeme, path)
        if found is None:
            unknown.append(lexeme)
            continue
        entry, scale, side = found
        for unit, full in entry.units.items():
            for channel in _sided(unit, side if face.side == "both" else face.side):
                units[channel] = max(units.get(channel, 0.0), _inside(full * face.amount * scale))
        flutter = flutter or entry.flutter
    return Expression(units, flutter, tuple(unknown))


@cache
def entries(path: Path = EXPRESSIONS) -> tuple[ExpressionEntry, ...]:
    """All expressions of a file.

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


@cache
def _entry(lexeme: str, path: Path) -> tuple[ExpressionEntry, float, FaceSide] | None:
    """The expression that a lexeme means, a factor on its intensity, and the side it names."""
    known, reading = entries(path), read_lexeme(lexeme)
    found = nearest_sense(reading.words, [Sense(tuple(entry.words), "face", entry.says) for entry in known])
    return (
        None if found is None else (known[found[0]], amplitude_factor(reading.words), _SIDES.get(reading.mode, "both"))
    )


def _sided(unit: str, side: FaceSide) -> tuple[str, ...]:
    """Keys of Command.face for a unit of the file, on one side when the lexeme names it."""
    return face_keys(unit) if side == "both" else channels(int(unit.lstrip("LR")), side)


def _inside(value: float) -> float:
    return min(max(value, 0.0), 1.0)
