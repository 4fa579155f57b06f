"""Watches what follow errors leave of the clearance: time slows where it goes, and the performance ends before contact.

What hinges stray from the plan is expected to come again, this way or that, as late arms swing past: the errors
measured of late are added to the postures that come, and taken from them, and the clearance of these is measured. While
it is ample, time runs as planned; then it runs slower, which makes errors smaller, as servos lag in proportion to their
speed; what is left of them when time has crept for a while is the sag of a soft servo, which keeps its sign. Where even
creeping does not help, it is over; likewise, at once, where the measured posture itself has come too near.
"""

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.robot import Robot

LOOK = 0.05  # [s] between two looks
FORESIGHT = 0.3  # [s] that postures are looked at before they come: slowing takes as long
MEMORY = 1.0  # [s] for which an error is expected to come again
EASY, TOUCH = 0.9, 0.4  # of the clearance that a robot asks for: where slowing begins, and where time only creeps
RESERVE = 0.3  # of that clearance, where it ends at once: a quarter of it stays
CREEP = 0.02  # pace of a performance that waits for its errors to become smaller
SETTLED = 0.3  # [s] of creeping, after which servos do not swing any more
LONGEST_CREEP = 2.0  # [s] of creeping, after which it ends: errors are forgotten sooner
_COMING, _LATE = round(FORESIGHT / LOOK), round(MEMORY / LOOK)  # looks
_SKIPPED = 2  # looks from one error to the next that counts, as they change slowly


@dataclass(frozen=True)
class ClearanceWatch:
    """What was seen of late, and what follows from it."""

    strayed: tuple[Floats, ...] = ()  # (n,) [rad] measured less planned at the last looks, the latest last
    swung: tuple[Floats, ...] = ()  # (n,) [rad] of the same looks, 0 where servos do not swing
    room: float = inf  # [m] clearance foreseen
    pace: float = 1.0  # seconds of the performance per second
    crept: float = 0.0  # [s] since it has crept
    near: bool = False  # whether what is measured has come into the reserve

    @property
    def over(self) -> bool:
        """Whether the reserve is gone, or waiting was in vain: the performance is to end."""
        return self.near or self.crept >= LONGEST_CREEP


def look_ahead(
    watch: ClearanceWatch, coming: Floats, strayed: Floats, distances: Distances, *, least: float
) -> ClearanceWatch:
    """Looks ahead, once in `LOOK` seconds.

    Args:
        watch: before.
        coming: (k, n) [rad] planned postures of the next `FORESIGHT` seconds, the present one first.
        strayed: (n,) [rad] measured less planned now; NaN where a servo did not answer.
        distances: of the robot.
        least: [m] clearance that the robot asks for.
    """
    here = sealed(np.nan_to_num(strayed))
    late = (*watch.strayed, here)[-1 - _LATE :]
    swung = (*watch.swung, sealed(np.where(watch.crept < SETTLED, here, 0.0)))[-1 - _LATE :]
    errors = np.concatenate([np.array(late[::-_SKIPPED]), -np.array(swung[::-_SKIPPED])])
    expected = (coming[:, None] + errors).reshape(-1, len(strayed))
    rooms = distances.clearance(expected).distances
    room, present = float(rooms.min()), float(rooms[0])
    pace = pace_for(room, least)
    crept = watch.crept + LOOK if pace <= CREEP else 0.0
    near = present < RESERVE * least
    return replace(watch, strayed=late, swung=swung, room=room, pace=pace, crept=crept, near=near)


def pace_for(room: float, least: float) -> float:
    """Finds the pace, at most 1, for a clearance [m] that is foreseen, where a robot asks for one [m]."""
    return min(1.0, max(CREEP, (room / least - TOUCH) / (EASY - TOUCH)))


def coming_times(time: float, end: float) -> Floats:
    """Lists the performance times [s] at which a look ahead measures, from now on to the end of the motion at most."""
    return sealed(np.minimum(time + LOOK * np.arange(_COMING + 1), end))


def foresee(planned: Floats, measured: Floats, distances: Distances, *, every: int) -> Floats:
    """Measures what the errors of a whole performance would have left of its clearance.

    Args:
        planned: (m, n) [rad].
        measured: (m, n) [rad] at the same times.
        distances: of the robot.
        every: so many samples a posture and an error are looked at.

    Returns:
        (k,) [m] for each posture looked at: the least, with any error of the last `MEMORY` seconds, this way or that;
        where that cannot be the least of all, only a bound from below, which is no lower than the least of all.
    """
    postures = planned[::every]
    strayed = measured[::every] - postures
    lags = range(0, min(round(MEMORY / (_SKIPPED * LOOK)) + 1, len(postures)), _SKIPPED)
    most = np.zeros_like(strayed)
    for lag in lags:
        most[lag:] = np.maximum(most[lag:], np.abs(strayed[: len(postures) - lag]))
    rooms = distances.bounds(postures, most)  # no room is smaller: what stays above a measured one need not be measured
    nearest = np.array([rooms.argmin()])
    rooms[nearest] = _rooms_at(nearest, postures, strayed, lags, distances)
    nearer = np.flatnonzero(rooms < rooms[nearest])
    if nearer.size:
        rooms[nearer] = _rooms_at(nearer, postures, strayed, lags, distances)
    return rooms


def _rooms_at(asked: Indices, postures: Floats, strayed: Floats, lags: range, distances: Distances) -> Floats:
    """(a,) [m] the least clearance at some of the postures (k, n), with the errors (k, n) of the looks before."""
    pairs = [(row, row - lag) for row in asked for lag in lags if lag <= row]
    rows, sources = np.array(pairs, dtype=np.intp).T
    expected = [postures[rows] + way * strayed[sources] for way in (1.0, -1.0)]
    found = distances.clearance(np.concatenate(expected)).distances.reshape(2, -1).min(axis=0)
    return np.minimum.reduceat(found, np.flatnonzero(np.diff(rows, prepend=-1)))


def slows(rooms: Floats, robot: Robot) -> bool:
    """Whether any of (k,) foreseen clearances [m] asks for slower time."""
    return bool(rooms.min() < EASY * robot.least_clearance)
