"""What easings change of the ways between keys: as much as is asked, as far as the limits allow.

All hinges with the same keys are eased alike, so that a hand keeps its path; a steepness that one of them cannot follow
is lowered for all.
"""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.easing import OVERSHOOT, Easing, softened
from kinesic.motion.keys import EASINGS, SMOOTHEST, Waypoints
from kinesic.motion.passage import EVEN, SOFTEST

GRADE = 0.25  # of the steepness
LEAST_OVERSHOOT = 0.02  # of a way; with less room OutQuart takes the place of OutBack
FINEST = 0.01  # of a way, steps of the overshoot
ROUNDING = 1e-6  # of such a step
ROOM = 3.0  # times the limits that an eased way may take: what is beyond them is rounded off without leaving the path


def changes(left: Floats, states: Floats, steps: Floats, keys: Waypoints) -> Floats:
    """(3, k, h, p) what easings add to angles, speeds and accelerations along k ways of h hinges.

    Args:
        left: (k, h) [rad] of each way, what is eased.
        states: (3, k, h, p) angles, speeds and accelerations without easings, at even shares of each way.
        steps: (k,) [s] of the ways.
        keys: (k + 1, h) at their ends.
    """
    found = np.zeros_like(states)
    room = np.where(left > 0.0, keys.limits.upper - keys.angles[1:], keys.angles[1:] - keys.limits.lower)
    shares = np.minimum(OVERSHOOT, room / np.maximum(np.abs(left), 1e-9))
    moved = (keys.easing[1:] != SMOOTHEST) & (left != 0.0)
    for k in np.flatnonzero(moved.any(axis=1)):
        hinges = np.flatnonzero(moved[k])
        scales = left[k, hinges] / (steps[k] ** np.arange(3))[:, None]
        asked = [
            (*_easing(EASINGS[keys.easing[k + 1, hinge]], shares[k, hinge]), float(keys.steepness[k + 1, hinge]))
            for hinge in hinges
        ]
        limits = keys.limits.part(hinges)
        for added in _offers(asked):
            eased = states[:, k, hinges] + scales[:, :, None] * added
            if _allowed(eased, limits):
                found[:, k, hinges] = scales[:, :, None] * added
                break
    return found


def _easing(easing: Easing, room: float) -> tuple[Easing, float]:
    """An easing and its overshoot, where there is room for a share of the way."""
    if easing == "out_back" and room < LEAST_OVERSHOOT:
        return "out_quart", OVERSHOOT
    return easing, FINEST * int(room / FINEST + ROUNDING) if easing == "out_back" else OVERSHOOT


def _offers(asked: list[tuple[Easing, float, float]]) -> Iterator[Floats]:
    """(3, h, p) what the easings of some hinges add to minimum jerk, from as steep as is asked to ever softer."""
    steepest = max(steepness for _, _, steepness in asked)
    for softer in np.arange(0.0, steepest - SOFTEST, GRADE):
        yield np.stack([_change(*row[:2], max(row[2] - softer, SOFTEST)) for row in asked], axis=1)


@lru_cache(maxsize=4096)
def _change(easing: Easing, overshoot: float, steepness: float) -> Floats:
    """(3, p) what an easing adds to minimum jerk, its speed and its acceleration."""
    if steepness <= (EVEN if easing == "linear" else SOFTEST):
        easing, steepness = "minimum_jerk", SOFTEST
    return sealed((softened(easing, steepness, overshoot) - softened("minimum_jerk", SOFTEST))[:, :-1])


def _allowed(states: Floats, limits: Limits) -> bool:
    """Whether (3, h, p) angles, speeds and accelerations of hinges keep the limits of speed, acceleration and duty."""
    _, speeds, accelerations = np.abs(states).max(axis=2)
    pulling = limits.inertial[:, None] * states[2] + limits.viscous[:, None] * states[1]
    duties = np.abs(pulling).max(axis=1)
    return bool(
        np.all(speeds <= ROOM * limits.speed)
        and np.all(accelerations <= ROOM * limits.acceleration)
        and np.all(duties <= ROOM * limits.duty)
    )
