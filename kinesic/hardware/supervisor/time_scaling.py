"""Performance time as the supervisor's own clock lets it run: at full speed, slower, or not at all."""

from dataclasses import dataclass
from math import sqrt


@dataclass(frozen=True)
class TimeScale:
    """Where time is, and how fast it runs."""

    time: float = 0.0  # [s]
    scale: float = 0.0  # seconds of it per second

    @property
    def still(self) -> bool:
        """Whether it stands."""
        return self.scale <= 0.0


def advance_time(tempo: TimeScale, seconds: float, *, wanted: float, end: float, slow: float) -> TimeScale:
    """Time a moment later: its scale changes evenly, and it comes to a stop at the end of what is known.

    Args:
        tempo: now.
        seconds: that pass.
        wanted: scale, 0..1.
        end: [s] beyond which time cannot run.
        slow: [s] from full speed to a stop, and back.
    """
    left = max(0.0, end - tempo.time)
    # the scale from which, after this moment, it can still stop evenly: scale^2 * slow / 2 is the way that this takes
    after = max(0.0, left - tempo.scale * seconds / 2)
    allowed = min(wanted, 1.0, (sqrt(seconds**2 / 4 + 2 * slow * after) - seconds / 2) / slow)
    change = seconds / slow
    scale = max(0.0, tempo.scale - change, min(allowed, tempo.scale + change))
    way = (tempo.scale + scale) / 2 * seconds
    return TimeScale(tempo.time + left, 0.0) if way >= left else TimeScale(tempo.time + way, scale)
