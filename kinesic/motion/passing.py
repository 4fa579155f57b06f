"""How hinges pass their keys: speeds of a Kochanek-Bartels spline, held back where nobody asks for a swing.

D. Kochanek and R. Bartels, Interpolating splines with local tension, continuity, and bias control, SIGGRAPH 1984.
Between uneven times the speed on each chord weighs as the time of the other, so that keys on a parabola are passed
along it: a circle through uneven keys strays by a tenth of what it does with the mean over both.
"""

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.motion.keys import HOLD, Waypoints

SWING = 0.05  # [rad] beyond its keys that any hinge may swing to pass them smoothly: what conditioning allows, too
BULGE = 5.0  # speed, in distance / duration, that a quintic may have beside a still key to swing out by the distance
BOW = 58.0  # acceleration, in distance / duration^2, that it may have for the same
HULL = 2.5  # speed, in distance / duration, that keeps the control points of a quintic within the distance
STEEPEST = 2.0  # speed, in shares of the slower chord, with which a hinge stays between its keys
BEND = 6.0  # acceleration, in distance / duration^2, with which a hinge comes to a key and turns back without a swing


def speeds(times: Floats, keys: Waypoints) -> Floats:
    """(k, h) [rad/s] at the keys of some hinges, at (k,) times that all of them have.

    Zero at the ends and beside holds. A speed that would carry the hinge beyond its keys by more than `SWING` is cut,
    unless the tension is negative: at -1 only the ends of the range cut it.
    """
    found = np.zeros_like(keys.angles)
    steps = np.diff(times)[:, None]
    ways = np.diff(keys.angles, axis=0)
    tension, bias = keys.tension[1:-1], keys.bias[1:-1]
    before, after = ways[:-1], ways[1:]
    earlier, later = before / steps[:-1] * steps[1:], after / steps[1:] * steps[:-1]
    free = _flow(keys) * ((1 + bias) * earlier + (1 - bias) * later) / (steps[:-1] + steps[1:])
    slower = np.minimum(np.abs(before) / steps[:-1], np.abs(after) / steps[1:])
    inside = np.where(before * after < 0.0, 0.0, STEEPEST * slower)
    smooth = BULGE * SWING / np.maximum(steps[:-1], steps[1:])
    below, above = keys.angles[1:-1] - keys.limits.lower, keys.limits.upper - keys.angles[1:-1]
    upward, downward = (
        HULL * np.minimum(ahead / steps[1:], behind / steps[:-1]) for ahead, behind in ((above, below), (below, above))
    )
    room = np.where(free > 0.0, upward, downward)
    kept = np.maximum(inside, np.minimum(smooth, room))
    bound = kept + np.maximum(-tension, 0.0) * np.maximum(room - kept, 0.0)
    found[1:-1] = np.where(_held(ways), 0.0, np.clip(free, -bound, bound))
    return found


def accelerations(times: Floats, keys: Waypoints, passed: Floats) -> Floats:
    """(k, h) [rad/s^2] at the keys: the middle of what cubics of these speeds would have before and after the key.

    So keys that lie on a smooth curve are passed along it. Zero at the ends, beside holds, and where a hinge stops.
    """
    found = np.zeros_like(passed)
    steps = np.diff(times)[:, None]
    ways = np.diff(keys.angles, axis=0)
    ends = (-6 * ways + steps * (2 * passed[:-1] + 4 * passed[1:])) / steps**2
    begins = (6 * ways - steps * (4 * passed[:-1] + 2 * passed[1:])) / steps**2
    bends = np.abs(ways) / steps**2
    longer = np.maximum(steps[:-1], steps[1:])
    bound = np.maximum(BEND * np.minimum(bends[:-1], bends[1:]), BOW * SWING / longer**2)
    middle = np.minimum(_flow(keys), 1.0) * (ends[:-1] + begins[1:]) / 2
    found[1:-1] = np.where(_held(ways), 0.0, np.clip(middle, -bound, bound))
    return found


def _flow(keys: Waypoints) -> Floats:
    """(k - 2, h) how much of its speed a hinge keeps at each inner key: 0 stops, 1 runs through."""
    return (1 - keys.tension[1:-1]) * (1 + keys.continuity[1:-1])


def _held(ways: Floats) -> Flags:
    """(k - 2, h) whether the hinge is still before or after each inner key."""
    still = np.abs(ways) < HOLD
    return np.asarray(still[:-1] | still[1:])
