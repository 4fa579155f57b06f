"""What captured gestures measure: percentiles and values of `configs/captured_gestures.toml`."""

from collections.abc import Mapping
from functools import cache

import msgspec

from kinesic.body.config import CONFIGS, read_toml


class CapturedTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Statistics of gestures that people made, by the names of `ROWS`."""

    arm: float  # [m] shoulder to wrist
    percentiles: Mapping[str, tuple[float, float, float, float, float]]  # 5, 25, 50, 75, 95
    values: Mapping[str, tuple[float, ...]]  # of each gesture, in ascending order


@cache
def captured_table() -> CapturedTable:
    """Reads the table that comes with kinesic.

    Raises:
        ConfigError: it is missing or wrong.
    """
    return read_toml(CONFIGS / "captured_gestures.toml", CapturedTable)
