"""How a key of the motion is passed, and how the way to it is moved."""

from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.motion.easing import Easing

SOFTEST, STEEPEST = 1.0, 8.0


RANGES: Mapping[str, tuple[float, float]] = {
    "tension": (-1.0, 1.0),
    "continuity": (-1.0, 0.0),
    "bias": (-1.0, 1.0),
    "steepness": (SOFTEST, STEEPEST),
}
EVEN = 3.3  # steepness with which the linear easing has the peak speed of minimum jerk


@dataclass(frozen=True)
class Passage:
    """How one key is passed (Kochanek and Bartels 1984), and how the way to it is moved.

    Raises:
        ValueError: a number outside its range, which is named.
    """

    tension: float = 0.0  # -1 swings out .. 1 stops at the key
    continuity: float = 0.0  # -1 stops at the key .. 0 runs through; above 0 speeds would jump, which no servo can
    bias: float = 0.0  # -1 turns to the next key already .. 1 follows the way it came
    easing: Easing = "minimum_jerk"  # of the way to the key
    steepness: float = 4.0  # of that easing: 1 begins as softly as minimum jerk .. 8 nearly at once

    def __post_init__(self) -> None:
        for name, (least, most) in RANGES.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise ValueError(f"{name} is {value:g}, outside [{least:g}, {most:g}]")


PLAIN = Passage()
