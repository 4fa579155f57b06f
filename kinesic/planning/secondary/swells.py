"""Swells: hinges that go a little away from where a motion has them, and come back, beneath all that it does.

A swell begins and ends at nothing, smooth up to the acceleration, so that the sum with a motion passes every key
outside of it as before, and no key at another time.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import grid
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import FEWEST, STEP, Trajectory

FULL = 1.0 + 1e-9  # share of a limit
AHEAD = 1  # knots by which a control point lies before the one where it counts most


@dataclass(frozen=True, eq=False)
class Swell:
    """What some hinges do for a while; times [s] are those of the motion beneath which it lies."""

    begin: float
    peak: float
    end: float
    away: Floats  # (n,) [rad] by which each hinge is away at the peak

    def later(self, seconds: float) -> "Swell":
        """Shifts all its times by some seconds."""
        return Swell(self.begin + seconds, self.peak + seconds, self.end + seconds, self.away)

    def spans(self, times: Floats) -> Flags:
        """(m,) whether it is under way at times (m,) [s]."""
        return np.asarray((times > self.begin) & (times < self.end))

    def share(self, times: Floats) -> Floats:
        """(m,) share of the way out at times (m,) [s]."""
        rising = minimum_jerk((times - self.begin) / (self.peak - self.begin))
        return np.asarray(rising - minimum_jerk((times - self.peak) / (self.end - self.peak)))


def add_swells(motion: Trajectory, swells: Iterable[tuple[Swell, float]]) -> Trajectory:
    """Adds swells to a motion, which goes on until the last of them is over.

    Args:
        motion: at rest before its start and after its end.
        swells: which, and how much of each; they begin no sooner than the motion.
    """
    wanted = [(swell, amount) for swell, amount in swells if amount > 0.0]
    last = max((swell.end for swell, _ in wanted), default=motion.end)
    more = max(0, ceil((last - motion.end) / STEP))
    controls = np.vstack([motion.controls, np.repeat(motion.controls[-1:], more, axis=0)])
    for swell, amount in wanted:
        first = max(FEWEST - 1, int((swell.begin - motion.start) / STEP))  # before it the motion is at rest
        rows = slice(first, min(ceil((swell.end - motion.start) / STEP) + AHEAD, len(controls) - FEWEST + 1))
        times: Floats = motion.start + (np.arange(rows.start, rows.stop, dtype=np.float64) - AHEAD) * STEP
        controls[rows] += amount * swell.share(times)[:, None] * swell.away
    return Trajectory(sealed(controls), motion.zero, motion.start)


def exceeded(motion: Trajectory, laid: Trajectory, limits: Limits) -> Flags:
    """Finds at which knots (k,) of a motion with swells which hinges (n,) break a limit that the motion alone keeps.

    Args:
        motion: alone.
        laid: with swells.
        limits: of all hinges.
    """
    own = grid(len(laid.controls) - FEWEST + 1, STEP)
    alone = np.vstack([motion.controls, np.repeat(motion.controls[-1:], own.size - len(motion.controls), axis=0)])
    beyond: Flags = np.zeros((own.pieces + 1, alone.shape[1]), dtype=np.bool_)
    for hinge in np.flatnonzero(np.any(laid.controls != alone, axis=0)).tolist():
        shares = own.shares(laid.controls[:, hinge], limits, hinge)
        if max(float(np.abs(share).max()) for share in shares) <= FULL:
            continue
        for share, before in zip(shares, own.shares(alone[:, hinge], limits, hinge), strict=True):
            over = np.flatnonzero(np.abs(share) > np.maximum(FULL, np.abs(before) + FULL - 1.0))
            beyond[np.minimum(over, own.pieces), hinge] = True
    return beyond
