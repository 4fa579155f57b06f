"""Hand shapes and finger motions of `configs/hands.toml`, relative to finger ranges."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, get_args

import msgspec

from kinesic.body.config import CONFIGS, ConfigError, read_toml

Finger = Literal["thumb", "index", "middle", "ring", "pinky"]
Surface = Literal["palm", "thumb", "index", "middle", "ring", "pinky"]  # palm, or tip of a finger
FINGER_NAMES: tuple[Finger, ...] = get_args(Finger)
Five = tuple[float, float, float, float, float]  # thumb .. little finger
NO_FINGERS: Five = (0.0, 0.0, 0.0, 0.0, 0.0)  # value 0 for each finger: no bend or no delay


@dataclass(frozen=True)
class HandShape:
    """Finger positions of a named hand shape."""

    name: str
    says: str  # description
    straight: Five  # extension of each finger, 0 closed .. 1 straight
    apart: float = 0.0  # spread of the fingers, -1 crossed .. 0 parallel .. 1 widest
    across: float = 0.0  # opposition of the thumb, 0 next to the palm .. 1 opposite to the fingers
    plain: bool = False  # whether a hand without fingers resembles the hand shape
    meets: tuple[Finger, ...] = ()  # fingers whose tips meet the thumb's tip


@dataclass(frozen=True)
class FingerMotion:
    """Periodic finger motion around the hand shape during a stroke."""

    name: str
    says: str  # description
    rate: float  # [Hz] frequency of the finger motion
    bend: Five = NO_FINGERS  # closing of each finger / finger range; below 0 the finger opens
    later: Five = NO_FINGERS  # [quarter periods] delay of each finger
    apart: float = 0.0  # change of the finger spread; below 0 the fingers close up


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
    """Return all hand shapes by name.

    Raises:
        ConfigError: the file of hand shapes is invalid.
    """
    return {
        name: HandShape(name, table.says, table.straight, table.apart, table.across, table.plain, table.meets)
        for name, table in _file().shapes.items()
    }


@lru_cache(maxsize=1)
def finger_motions() -> Mapping[str, FingerMotion]:
    """Return all finger motions by name.

    Raises:
        ConfigError: the file of hand shapes is invalid.
    """
    return {name: FingerMotion(name, **msgspec.structs.asdict(table)) for name, table in _file().motions.items()}


@lru_cache(maxsize=1)
def _names() -> Mapping[str, str]:
    shape_names: dict[str, str] = {}
    for name, table in _file().shapes.items():
        for alias in (name, *table.aliases):
            if alias in shape_names:
                raise ConfigError(
                    f"{CONFIGS / 'hands.toml'}: {alias} names {shape_names[alias]} and {name}, must name one"
                )
            shape_names[alias] = name
    return shape_names


def find_shape(name: str) -> HandShape | None:
    """Find a hand shape by name or alias, ignoring case.

    Returns:
        None for an unknown name.
    """
    shape_name = _names().get(name.strip().lower().replace("-", "_").replace(" ", "_"))
    return None if shape_name is None else hand_shapes()[shape_name]
