"""Statistics of captured gestures from `configs/captured_gestures.toml`."""

from collections.abc import Mapping
from functools import cache

import msgspec

from kinesic.body.config import CONFIGS, read_toml


class CapturedTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Statistics of captured human gestures by name of the measure."""

    arm: float  # [m] length from shoulder to wrist
    percentiles: Mapping[str, tuple[float, float, float, float, float]]  # 5th, 25th, 50th, 75th and 95th
    values: Mapping[str, tuple[float, ...]]  # one value per gesture, in ascending order


@cache
def read_captured_table() -> CapturedTable:
    """Read the supplied statistics of captured gestures.

    Raises:
        ConfigError: the table is missing or invalid.
    """
    return read_toml(CONFIGS / "captured_gestures.toml", CapturedTable)
