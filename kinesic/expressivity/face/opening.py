"""Limits on lip opening from lip velocity and neighbouring sounds."""

from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats

LIP_OPENINGS: Mapping[str, float] = {
    "25": 0.0049,
    "26": 0.0195,
    "22": 0.0108,
    "19": 0.008,
}  # [m] distance between the lips by action unit, at full intensity
# [m] distance from the teeth to the upper lip by action unit (32: lip bite), at full intensity.
BITE_OPENINGS: Mapping[str, float] = {"32": 0.0035}
MAX_LIP_VELOCITY = 0.2  # [m/s] largest velocity of one lip relative to the other
ACCELERATION_TIME = 0.04  # [s] time in which lips accelerate from rest to their largest velocity
CONSTRAINT_WINDOW = 0.2  # [s] time before and after a narrow mouth shape during which the lip opening is limited
SMOOTHING_WINDOW = 0.02  # [s] half width of the moving average of the lip opening


def lip_opening(units: Mapping[str, float]) -> float:
    """Return the distance between the lips for given action units [m].

    Args:
        units: key of Command.face -> 0..1.
    """
    return sum(LIP_OPENINGS.get(channel, 0.0) * value for channel, value in units.items())


def limit_lip_opening(
    track: dict[str, Floats], largest: Floats, step: float, *, openings: Mapping[str, float] = LIP_OPENINGS
) -> None:
    """Limit the lip opening of a face track, in place.

    All action units that part the lips are scaled by the same factor.

    Args:
        track: key of Command.face -> (n,) 0..1.
        largest: (n,) largest lip opening [m].
        step: time step [s].
        openings: lip opening [m] by action unit, at full intensity.
    """
    opening_units = openings.keys() & track.keys()
    if not opening_units:
        return
    requested = np.zeros(len(largest))
    for channel in sorted(opening_units):
        requested += openings[channel] * track[channel]
    allowed = _reachable(np.minimum(requested, largest), step)
    allowed = np.minimum(allowed, _rounded(allowed, step))
    factor = np.divide(allowed, requested, out=np.ones(len(largest)), where=requested > 0.0)
    for channel in opening_units:
        track[channel] = track[channel] * factor


def _reachable(largest: Floats, step: float) -> Floats:
    """Reduce a lip opening (n,) [m] until its velocity obeys `MAX_LIP_VELOCITY`."""
    reachable = largest.copy()
    for k in range(1, round(CONSTRAINT_WINDOW / step) + 1):
        interval = k * step
        distance = MAX_LIP_VELOCITY * (
            interval - ACCELERATION_TIME / 2
            if interval > ACCELERATION_TIME
            else interval * interval / (2 * ACCELERATION_TIME)
        )
        np.minimum(reachable[k:], largest[:-k] + distance, out=reachable[k:])
        np.minimum(reachable[:-k], largest[k:] + distance, out=reachable[:-k])
    return reachable


def _rounded(lip_openings: Floats, step: float) -> Floats:
    """Smooth a lip opening over time (n,) by a moving average."""
    reach = round(SMOOTHING_WINDOW / step)
    weights = np.hanning(2 * reach + 3)[1:-1]
    padded = np.pad(lip_openings, reach, mode="edge")
    return np.convolve(padded, weights / weights.sum(), mode="valid")
