"""What gestures must show to be understood: `configs/legibility.toml`."""

from collections.abc import Mapping
from functools import cache
from typing import Literal

import msgspec

from kinesic.body.config import CONFIGS, read_toml

BodyPlace = Literal[
    "mouth",
    "nose",
    "chin",
    "cheek",
    "ear",
    "temple",
    "eye",
    "forehead",
    "hair",
    "throat",
    "chest",
    "belly",
    "hip",
    "other shoulder",
    "other forearm",
    "other wrist",
    "other palm",
    "ahead",  # almost an arm's length before the chest, on the midline
    "between chin and other palm",
]


class PlaceTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where a hand is seen."""

    part: Literal["palm", "tips"]  # of the hand
    at: BodyPlace
    within: float  # [m]
    when: Literal["strokeStart", "stroke"] = "stroke"


class AlikeTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Gestures that may look alike."""

    gestures: tuple[str, ...]
    why: str


class LegibilityTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All that is asked of gestures."""

    places: Mapping[str, PlaceTable]  # by gesture
    shoulders: Mapping[str, float]  # [deg] that they rise at least, by gesture
    alike: tuple[AlikeTable, ...]

    def may_be_alike(self, a: str, b: str) -> bool:
        """Whether nothing is lost where two gestures look alike."""
        return any(a in group.gestures and b in group.gestures for group in self.alike)


@cache
def legibility_table() -> LegibilityTable:
    """Reads the table that comes with kinesic.

    Raises:
        ConfigError: it is missing or wrong.
    """
    return read_toml(CONFIGS / "legibility.toml", LegibilityTable)
