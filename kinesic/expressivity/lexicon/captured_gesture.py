"""Captured gestures of the lexicon: TOML header, motion and stroke keys."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

import msgspec

from kinesic.body.robot import Side
from kinesic.expressivity.lexicon.captured_form import captured_keys, check_markers
from kinesic.expressivity.lexicon.form import StrokeKey
from kinesic.expressivity.lexicon.gesture_motion import GestureMotion, read_gesture_motion

CARD_FILE = "card.toml"  # name of the file that describes a folder of shared gestures
HandName = Literal["left", "right", "both"]
HAND_SIDES: Mapping[HandName, tuple[Side, ...]] = {"left": ("l",), "right": ("r",), "both": ("l", "r")}


class MotionTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of a captured motion."""

    file: str  # name of the .npz file next to the TOML file
    hand: HandName  # hands that take part
    markers: dict[str, float]  # [s] times of start, ready, strokeStart, stroke, strokeEnd, relax and end
    found: bool = False  # true: the markers were estimated from the motion, not read from the capture file
    like: str = ""  # gesture of kinesic with the same meaning; empty: unknown
    source: str = ""  # origin of the capture
    licence: str = ""  # licence of the capture


@dataclass(frozen=True, eq=False)
class GestureCapture:
    """Captured motion of a lexicon gesture, with its markers and origin."""

    id: str
    motion: GestureMotion
    table: MotionTable

    @property
    def markers(self) -> Mapping[str, float]:
        """Times of the markers in the motion [s]."""
        return self.table.markers

    @property
    def sides(self) -> tuple[Side, ...]:
        """Hands that take part."""
        return HAND_SIDES[self.table.hand]

    @cached_property
    def keys(self) -> tuple[StrokeKey, ...]:
        """Stroke keys with captured paths between them."""
        return captured_keys(self.motion, self.markers, self.sides)


def read_captured(id: str, table: MotionTable, folder: Path) -> GestureCapture:
    """Read the motion of a captured gesture.

    Args:
        id: name of the gesture.
        table: its header.
        folder: of the motion file.

    Raises:
        ConfigError: the motion is missing, outside the folder, or invalid.
        ValueError: a marker or hand is invalid.
    """
    motion = read_gesture_motion(folder, table.file)
    check_markers(table.markers, float(motion.times[-1]))
    gesture = GestureCapture(id, motion, table)
    if missing := [side for side in gesture.sides if side not in motion.hands]:
        raise ValueError(f"{table.file} has no motion of hand {missing[0]!r}")
    return gesture
