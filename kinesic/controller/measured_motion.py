"""A measured motion as a function of time, as a planned one is."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats


@dataclass(frozen=True, eq=False)
class Motion:
    """What was measured, as a function of performance time."""

    times: Floats  # (m,) [s] increasing
    angles: Floats  # (m, n) [rad]
    speeds: Floats  # (m, n) [rad/s]

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.times[-1])

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Angles, speeds and accelerations, each (k, n), at (k,) times; between measurements on straight lines."""
        rows = (self.angles, self.speeds, np.gradient(self.speeds, self.times, axis=0))
        angles, speeds, accelerations = (
            np.stack([np.interp(times, self.times, column) for column in row.T], axis=1) for row in rows
        )
        return angles, speeds, accelerations
