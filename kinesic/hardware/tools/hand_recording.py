"""Table of joint angles while a person moves the robot."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats

TIME_COLUMN = "time_s"  # name of the first column


@dataclass(frozen=True, eq=False)
class HandSample:
    """Joint angles of the robot at one time."""

    time: float  # [s] since the first sample
    angles: Floats  # (n,) [rad] in joint order


def write_recording(hinges: Sequence[str], samples: Sequence[HandSample]) -> str:
    """Return the recorded joint angles [deg] as comma-separated values with a header."""
    header = [TIME_COLUMN, *(f"{hinge}_deg" for hinge in hinges)]
    rows = ([f"{sample.time:.3f}", *(f"{angle:.3f}" for angle in np.degrees(sample.angles))] for sample in samples)
    return "".join(f"{','.join(row)}\n" for row in (header, *rows))
