"""Action units (FACS), the elementary movements of a face.

The numbers and names are those of the Facial Action Coding System (P. Ekman, W. V. Friesen and J. C. Hager, 2002;
thesis 4.3.1). A key of `Command.face` is the number of a unit, after an L or R for one side: `L12` pulls the left
corner of the mouth, `26` drops the jaw. A number alone means both sides.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians
from types import MappingProxyType
from typing import Literal

FaceSide = Literal["left", "right", "both"]

MAX_EYE_YAW = radians(35)  # [rad] rotation of an eye to either side at full intensity
MAX_EYE_ELEVATION = radians(25)  # [rad] upward rotation of an eye at full intensity
MAX_EYE_DEPRESSION = radians(30)  # [rad] downward rotation of an eye at full intensity
MAX_EYE_CONVERGENCE = radians(15)  # [rad] inward rotation of each eye at full intensity of unit 66


@dataclass(frozen=True)
class ActionUnit:
    """One elementary movement of the face."""

    number: int
    name: str
    sided: bool = True  # whether the left and the right side move independently


ACTION_UNITS: Mapping[int, ActionUnit] = MappingProxyType(  # supported action units by FACS number
    {
        unit.number: unit
        for unit in (
            ActionUnit(1, "inner brow raiser"),
            ActionUnit(2, "outer brow raiser"),
            ActionUnit(4, "brow lowerer"),
            ActionUnit(5, "upper lid raiser"),
            ActionUnit(6, "cheek raiser"),
            ActionUnit(7, "lid tightener"),
            ActionUnit(9, "nose wrinkler"),
            ActionUnit(10, "upper lip raiser"),
            ActionUnit(11, "nasolabial deepener"),
            ActionUnit(12, "lip corner puller"),
            ActionUnit(13, "sharp lip puller"),
            ActionUnit(14, "dimpler"),
            ActionUnit(15, "lip corner depressor"),
            ActionUnit(16, "lower lip depressor"),
            ActionUnit(17, "chin raiser", sided=False),
            ActionUnit(18, "lip pucker", sided=False),
            ActionUnit(19, "tongue show", sided=False),
            ActionUnit(20, "lip stretcher"),
            ActionUnit(22, "lip funneler", sided=False),
            ActionUnit(23, "lip tightener", sided=False),
            ActionUnit(24, "lip presser", sided=False),
            ActionUnit(25, "lips part", sided=False),
            ActionUnit(26, "jaw drop", sided=False),
            ActionUnit(27, "mouth stretch", sided=False),
            ActionUnit(28, "lip suck", sided=False),
            ActionUnit(29, "jaw thrust", sided=False),
            ActionUnit(30, "jaw sideways"),
            ActionUnit(32, "lip bite", sided=False),
            ActionUnit(34, "cheek puff", sided=False),
            ActionUnit(43, "eye closure"),
            ActionUnit(45, "blink"),
            ActionUnit(46, "wink"),
            ActionUnit(61, "eyes turn left", sided=False),
            ActionUnit(62, "eyes turn right", sided=False),
            ActionUnit(63, "eyes up", sided=False),
            ActionUnit(64, "eyes down", sided=False),
            ActionUnit(66, "cross-eye", sided=False),
        )
    }
)


def unit_channels(number: int, side: FaceSide = "both") -> tuple[str, ...]:
    """List the keys of `Command.face` that move one action unit.

    Args:
        number: a key of `ACTION_UNITS`.
        side: the moving side; a unit without sides moves as a whole.
    """
    if not ACTION_UNITS[number].sided:
        return (str(number),)
    return {"left": (f"L{number}",), "right": (f"R{number}",), "both": (f"L{number}", f"R{number}")}[side]


def face_keys(unit: str) -> tuple[str, ...]:
    """List the `Command.face` keys of a unit such as `12` or `L12`.

    Users write a side and a number, or a number alone for both sides.

    Returns:
        An empty tuple for an unknown unit.
    """
    if unit in FACE_CHANNELS:
        return (unit,)
    number = int(unit) if unit.isascii() and unit.isdigit() and len(unit) <= 2 else 0
    return unit_channels(number) if number in ACTION_UNITS else ()


def describe_unknown_unit(unit: str) -> str:
    """Return the error message for an unknown action unit, with valid numbers."""
    if unit[:1] in ("L", "R") and face_keys(unit[1:]):
        return f"no action unit {unit}: {ACTION_UNITS[int(unit[1:])].name} has no sides; write {unit[1:]}"
    sided = ", ".join(str(number) for number, unit_data in ACTION_UNITS.items() if unit_data.sided)
    whole = ", ".join(str(number) for number, unit_data in ACTION_UNITS.items() if not unit_data.sided)
    return f"no action unit {unit}; known: {sided} (on one side: L or R before it), {whole}"


# all keys of `Command.face`
FACE_CHANNELS: tuple[str, ...] = tuple(channel for number in ACTION_UNITS for channel in unit_channels(number))
