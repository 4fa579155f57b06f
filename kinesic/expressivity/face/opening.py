"""How far the lips are apart: as fast as lips can, and no further than the sounds between which they move allow."""

from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats

OPENING: Mapping[str, float] = {
    "25": 0.0049,
    "26": 0.0195,
    "22": 0.0108,
    "19": 0.008,
}  # [m] of the lips, by action unit
FASTEST = 0.2  # [m/s] of one lip from the other
GATHERING = 0.04  # [s] in which they come to it
NARROW_REACH = 0.2  # [s] from a narrow mouth, within which that tells how far it opens
SMOOTH = 0.02  # [s] to either side, over which an open mouth is rounded off


def opening(units: Mapping[str, float]) -> float:
    """Adds up how far action units of the face part the lips [m].

    Args:
        units: key of Command.face -> 0..1.
    """
    return sum(OPENING.get(channel, 0.0) * value for channel, value in units.items())


def limit_opening(shown: dict[str, Floats], most: Floats, step: float) -> None:
    """Lets a mouth open and close as lips do, in place: all that parts them is lessened by the same share.

    Args:
        shown: key of Command.face -> (n,) 0..1.
        most: (n,) [m] that the lips may be apart.
        step: [s] from one of n times to the next.
    """
    parting = OPENING.keys() & shown.keys()
    wished = np.zeros(len(most))
    for channel in sorted(parting):
        wished += OPENING[channel] * shown[channel]
    allowed = _reachable(np.minimum(wished, most), step)
    allowed = np.minimum(allowed, _rounded(allowed, step))
    share = np.divide(allowed, wished, out=np.ones(len(most)), where=wished > 0.0)
    for channel in parting:
        shown[channel] = shown[channel] * share


def _reachable(most: Floats, step: float) -> Floats:
    """(n,) [m] that is never more than `most`, nor farther than lips come from one time to another."""
    found = most.copy()
    for k in range(1, round(NARROW_REACH / step) + 1):
        away = k * step
        way = FASTEST * (away - GATHERING / 2 if away > GATHERING else away * away / (2 * GATHERING))
        np.minimum(found[k:], most[:-k] + way, out=found[k:])
        np.minimum(found[:-k], most[k:] + way, out=found[:-k])
    return found


def _rounded(opened: Floats, step: float) -> Floats:
    """(n,) a moving average."""
    reach = round(SMOOTH / step)
    weights = np.hanning(2 * reach + 3)[1:-1]
    padded = np.pad(opened, reach, mode="edge")
    return np.convolve(padded, weights / weights.sum(), mode="valid")
