"""Named points in the world from a file: `name = [x, y, z]` in metres, x forward, y left, z up."""

from collections.abc import Mapping
from pathlib import Path

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import read


def read_targets(path: Path) -> Mapping[str, Floats]:
    """Reads a targets file.

    Raises:
        ConfigError: the file is missing or wrong.
    """
    return {name: sealed(point) for name, point in read(path, dict[str, tuple[float, float, float]]).items()}
