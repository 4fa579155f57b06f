"""Targets of gaze and pointing: a name that the robot or the user knows, or three coordinates.

The user's names come from a file, `name = [x, y, z]` in metres, x forward, y left, z up.
"""

from collections.abc import Mapping
from math import isfinite
from pathlib import Path

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import read_toml, suggestion


def read_targets(path: Path) -> Mapping[str, Floats]:
    """Reads a targets file.

    Raises:
        ConfigError: the file is missing or wrong.
    """
    return {name: sealed(point) for name, point in read_toml(path, dict[str, tuple[float, float, float]]).items()}


def find_target(text: str, targets: Mapping[str, Floats]) -> Floats | None:
    """(3,) [m] in the world of a target: its name in any case, or "x y z" in metres; None when it is neither.

    A part of somebody, such as `user:l_wrist`, is where the whole is, unless it has a place of its own.
    """
    if text in targets:
        return targets[text]
    folded = {name.lower(): place for name, place in targets.items()}
    name = text.strip().lower()
    for whole in (name, name.partition(":")[0]):
        if whole in folded:
            return folded[whole]
    try:
        numbers = [float(part) for part in text.replace(",", " ").split()]
    except ValueError:
        return None
    return sealed(numbers) if len(numbers) == 3 and all(map(isfinite, numbers)) else None


def unknown(text: str, targets: Mapping[str, Floats]) -> str:
    """What is wrong with a target, and what would have worked."""
    return f'there is no target {text}{suggestion(text, list(targets))}, or "x y z" in metres'
