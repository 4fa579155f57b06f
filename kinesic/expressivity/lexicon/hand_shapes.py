"""Hand shapes and motions of fingers, as `configs/hands.toml` has them: for any hand, in shares of what it can do."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, get_args

import msgspec

from kinesic.body.config import CONFIGS, ConfigError, read_toml

Finger = Literal["thumb", "index", "middle", "ring", "pinky"]
FINGERS: tuple[Finger, ...] = get_args(Finger)
Five = tuple[float, float, float, float, float]  # thumb .. little finger
NO_FINGERS: Five = (0.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class HandShape:
    """How the fingers are held."""

    name: str
    says: str  # in words
    straight: Five  # 0 closed .. 1 straight
    apart: float = 0.0  # fingers, -1 crossed .. 0 side by side .. 1 as far as they go
    across: float = 0.0  # the thumb, 0 beside the palm .. 1 opposite to the fingers
    plain: bool = False  # whether a hand without fingers comes near to it
    meets: tuple[Finger, ...] = ()  # fingers whose tips meet the thumb's


@dataclass(frozen=True)
class FingerMotion:
    """What fingers do while a stroke lasts: they leave the hand's shape and come back, again and again."""

    name: str
    says: str  # in words
    rate: float  # [Hz]
    bend: Five = NO_FINGERS  # by how much of its way each finger closes; below 0 it opens
    later: Five = NO_FINGERS  # [quarters of a turn] when each does so
    apart: float = 0.0  # by how much the fingers go apart; below 0 together


class _ShapeTable(msgspec.Struct, forbid_unknown_fields=True):
    says: str
    straight: Five
    apart: float = 0.0
    across: float = 0.0
    plain: bool = False
    meets: tuple[Finger, ...] = ()
    aliases: tuple[str, ...] = ()


class _MotionTable(msgspec.Struct, forbid_unknown_fields=True):
    says: str
    rate: float
    bend: Five = NO_FINGERS
    later: Five = NO_FINGERS
    apart: float = 0.0


class _HandsFile(msgspec.Struct, forbid_unknown_fields=True):
    shapes: dict[str, _ShapeTable]
    motions: dict[str, _MotionTable]


@lru_cache(maxsize=1)
def _file() -> _HandsFile:
    return read_toml(CONFIGS / "hands.toml", _HandsFile)


@lru_cache(maxsize=1)
def hand_shapes() -> Mapping[str, HandShape]:
    """Reads all shapes by their names.

    Raises:
        ConfigError: the file of shapes is wrong.
    """
    return {
        name: HandShape(name, table.says, table.straight, table.apart, table.across, table.plain, table.meets)
        for name, table in _file().shapes.items()
    }


@lru_cache(maxsize=1)
def finger_motions() -> Mapping[str, FingerMotion]:
    """Reads all motions of fingers by their names.

    Raises:
        ConfigError: the file of shapes is wrong.
    """
    return {name: FingerMotion(name, **msgspec.structs.asdict(table)) for name, table in _file().motions.items()}


@lru_cache(maxsize=1)
def _names() -> Mapping[str, str]:
    found: dict[str, str] = {}
    for name, table in _file().shapes.items():
        for alias in (name, *table.aliases):
            if alias in found:
                raise ConfigError(f"{CONFIGS / 'hands.toml'}: {alias} names {found[alias]} and {name}, must name one")
            found[alias] = name
    return found


def find_shape(name: str) -> HandShape | None:
    """Finds a shape by its name here or in another system, in any case; None when nobody knows it."""
    known = _names().get(name.strip().lower().replace("-", "_").replace(" ", "_"))
    return None if known is None else hand_shapes()[known]
