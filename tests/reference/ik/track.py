"""Tracker whose steps are computed in Python."""

from collections.abc import Sequence
from math import exp

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain, mirror_place
from kinesic.ik.scalar3 import Vector, distance, dot, minus, norm, plus, scaled, vector
from kinesic.ik.track import Tracker as CompiledTracker

from .polish import HandSlope, columns, polish_step
from .shoulder_elbow import MAX_STRETCH_RATIO, nearest_girdle

MAX_ITERATIONS = 8  # largest number of iterations per step
TOLERANCE = 1e-8  # [arm lengths] largest remaining distance
ERROR_DAMPING = 0.3  # lambda^2 = ERROR_DAMPING e^2 + MIN_DAMPING size^2 (after Sugihara)
MIN_DAMPING = 1e-7  # damping at zero error
SOFT_FRACTION = 0.05  # last fraction of the reach, approached asymptotically: a straight elbow turns infinitely fast


class Tracker(CompiledTracker):
    """Tracker that computes each step in Python instead of the kernel."""

    def __init__(self, chain: Chain, **options) -> None:
        super().__init__(chain, **options)
        self._follow = Ticks(chain).track


class Ticks:
    """Steps of the tracker for one arm."""

    def __init__(self, chain: Chain) -> None:
        self._right = is_right(chain)
        self._linkage = linkage_of(mirror_chain(chain) if self._right else chain)
        self._rest = np.clip(chain.rest, chain.lower, chain.upper).tolist()

    def track(self, target: Floats, pull: float, parts: int, angles: Floats) -> float:
        """Advance the angles in place by one control period, and return the residual [m]."""
        place = np.asarray(target, dtype=np.float64)
        asked = vector(mirror_place(place) if self._right else place)
        goal, now = soften_target(self._linkage, asked, self._rest), angles.tolist()
        origin, error = self._linkage.hand(now) if parts > 1 else goal, (0.0, 0.0, 0.0)
        for part in range(1, parts + 1):
            between = plus(origin, scaled(minus(goal, origin), part / parts))
            now, error = _moved(self._linkage, between, pull, self._rest, now)
        angles[:] = now
        return norm(plus(minus(asked, goal), error))


def soften_target(linkage: Linkage, target: Vector, rest: Sequence[float]) -> Vector:
    """Move a target smoothly inside the reach.

    With w = SOFT_FRACTION D, its distance d from the shoulder becomes s + w (1 - exp((s - d) / w)) beyond s = D - w,
    equal in value and slope at s, and never more than the reach.

    Args:
        linkage: the arm.
        target: [m] in the base.
        rest: [rad] at which the girdle stays if it can.

    Returns:
        [m] the target itself in easy reach.
    """
    width = SOFT_FRACTION * linkage.farthest
    begin = MAX_STRETCH_RATIO * linkage.farthest - width
    if distance(linkage.walk(rest, len(linkage.girdle))[1][-1], target) <= begin:
        return target
    shoulder = nearest_girdle(linkage, target, rest)[-1]
    d = distance(shoulder, target)
    if d <= begin:
        return target
    return plus(shoulder, scaled(minus(target, shoulder), (begin + width * (1.0 - exp((begin - d) / width))) / d))


def _moved(
    linkage: Linkage, target: Vector, pull: float, rest: Sequence[float], angles: Sequence[float]
) -> tuple[list[float], Vector]:
    """Return the angles after one step, and the error [m]."""
    own = linkage.links[-1].first
    wrist = [angle + pull * (home - angle) for angle, home in zip(angles[own:], rest[own:], strict=True)]
    now, size = list(angles[:own]), linkage.farthest
    hand, moves = columns(linkage, now)
    error = minus(target, hand)
    for _ in range(MAX_ITERATIONS):
        damping = ERROR_DAMPING * dot(error, error) + MIN_DAMPING * size * size
        pulls = [pull * (home - angle) for home, angle in zip(rest, now, strict=False)]
        now, pull = polish_step(linkage, now, error, HandSlope(moves, pulls, linkage.mobility, damping)), 0.0
        hand, moves = columns(linkage, now)
        error = minus(target, hand)
        if norm(error) <= TOLERANCE * size:
            break
    return now + wrist, error
