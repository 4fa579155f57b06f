"""Requirements for recognisable gestures, from `configs/legibility.toml`."""

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
    "ahead",  # almost an arm's length in front of the chest, on the midline
    "between chin and other palm",
]


class PlaceTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of a body part near which a hand must be."""

    part: Literal["palm", "tips"]  # part of the hand: palm or fingertips
    at: BodyPlace
    within: float  # [m] largest distance of this part from `at`
    when: Literal["strokeStart", "stroke"] = "stroke"


class AlikeTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of gestures that may look alike, with the reason."""

    gestures: tuple[str, ...]
    why: str


class LegibilityTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of requirements on hand positions and distinct gestures."""

    places: Mapping[str, PlaceTable]  # required position of a hand, by gesture
    shoulders: Mapping[str, float]  # [deg] smallest elevation of the shoulder, by gesture
    alike: tuple[AlikeTable, ...]

    def may_be_alike(self, a: str, b: str) -> bool:
        """Return whether two gestures are allowed to look alike."""
        return any(a in group.gestures and b in group.gestures for group in self.alike)


@cache
def legibility_table() -> LegibilityTable:
    """Read the built-in legibility requirements.

    Raises:
        ConfigError: it is missing or invalid.
    """
    return read_toml(CONFIGS / "legibility.toml", LegibilityTable)
