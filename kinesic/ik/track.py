"""Follows a moving target, tick after tick: warm, without leaps, and home again after every lap.

Each tick polishes the angles of the last one: no masses, no closed forms, no other postures, whose branches would make
the arm leap. What the hand leaves open is drawn to rest with a time constant, so that a closed path of the hand is a
closed path of the arm.
"""

from collections.abc import Iterable, Iterator, Sequence
from math import ceil, exp, isfinite

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.ik.arm.compiled import KERNEL, arm_of
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain, mirror_place
from kinesic.ik.arm.polish import HandSlope, columns, polish_step
from kinesic.ik.arm.shoulder_elbow import STRETCH, nearest_girdle
from kinesic.ik.scalar3 import Vector, distance, dot, minus, norm, plus, scaled, vector
from kinesic.kernels import Kernel

LONGEST_STEP = (
    0.005  # [s] that one step of the way takes; a longer tick takes several, so that its length does not matter
)
RAMP = 4.0  # time constants until the pull has its full strength: nothing starts with a jerk
ROUNDS = 8
TOLERANCE = 1e-8  # of the arm's length
DAMPING = 0.3  # lambda^2 = DAMPING e^2 + LEAST_DAMPING size^2 (after Sugihara)
LEAST_DAMPING = 1e-7
SOFT = 0.05  # the last part of the reach, given out ever more slowly: a straight elbow turns infinitely fast


class Tracker:
    """An arm that follows a moving target, one tick at a time.

    Attributes:
        residual: [m] from the hand to the last target.
    """

    def __init__(
        self,
        chain: Chain,
        *,
        period: float,
        start: Floats | None = None,
        posture_seconds: float = 0.25,
        kernel: Kernel = KERNEL,
    ) -> None:
        """Puts the arm where it starts.

        Args:
            chain: the arm.
            period: [s] between two steps.
            start: (k,) [rad] clipped to the ranges; the chain's rest by default.
            posture_seconds: [s] time constant of the pull to rest; infinite for none.
            kernel: which implementation answers.

        Raises:
            ValueError: a time is not positive, or the start no posture.
        """
        if not (0.0 < period < np.inf and posture_seconds > 0.0):
            raise ValueError(f"period is {period} s and posture_seconds {posture_seconds} s; both must be positive")
        angles = np.array(chain.rest if start is None else start, dtype=np.float64)
        if angles.shape != chain.rest.shape or not np.isfinite(angles).all():
            raise ValueError(f"start is {angles.tolist()}; it needs {len(chain.rest)} finite numbers")
        self.residual = 0.0
        self._angles: Floats = np.clip(angles, chain.lower, chain.upper)
        self._parts = max(1, ceil(period / LONGEST_STEP - 1e-9))
        self._pull = 1.0 - exp(-period / self._parts / posture_seconds)
        self._strength, self._growth = 0.0, period / (RAMP * posture_seconds)
        self._follow = arm_of(chain).track if kernel == "compiled" else _Specification(chain).track

    def step(self, target: Floats) -> Floats:
        """Takes one tick.

        Args:
            target: (3,) [m] of the hand, in the frame of the chain's base. In the last twentieth of the reach the hand
                stays behind it, further and further.

        Returns:
            (k,) [rad] inside the ranges.

        Raises:
            ValueError: the target is not three finite numbers.
        """
        self.residual = self._follow(target, self._pull * self._strength, self._parts, self._angles)
        if self._strength < 1.0:
            self._strength = min(1.0, self._strength + self._growth)
        return self._angles.copy()


def track(
    chain: Chain,
    targets: Iterable[Floats],
    *,
    period: float,
    start: Floats | None = None,
    posture_seconds: float = 0.25,
    kernel: Kernel = KERNEL,
) -> Iterator[Floats]:
    """Follows targets that come one after another; each is answered before the next is asked for.

    Args:
        chain: the arm.
        targets: (3,) [m] each, of the hand in the frame of the chain's base, one per period.
        period: [s] between two targets.
        start: (k,) [rad] clipped to the ranges; the chain's rest by default.
        posture_seconds: [s] time constant of the pull to rest; infinite for none.
        kernel: which implementation answers.

    Returns:
        (k,) [rad] for each target, inside the ranges.

    Raises:
        ValueError: a time is not positive, the start no posture, or a target not three finite numbers.
    """
    tracker = Tracker(chain, period=period, start=start, posture_seconds=posture_seconds, kernel=kernel)
    return map(tracker.step, targets)


class _Specification:
    """A tracker in Python that does what the kernel's does."""

    def __init__(self, chain: Chain) -> None:
        self._right = is_right(chain)
        self._linkage = linkage_of(mirror_chain(chain) if self._right else chain)
        self._rest = np.clip(chain.rest, chain.lower, chain.upper).tolist()

    def track(self, target: Floats, pull: float, parts: int, angles: Floats) -> float:
        """One tick, in place; the residual [m]."""
        place = np.asarray(target, dtype=np.float64)
        if place.shape != (3,) or not all(map(isfinite, place)):
            raise ValueError("the target needs three finite numbers in a float64 array")
        asked = vector(mirror_place(place) if self._right else place)
        goal, now = soften_target(self._linkage, asked, self._rest), angles.tolist()
        origin, error = self._linkage.hand(now) if parts > 1 else goal, (0.0, 0.0, 0.0)
        for part in range(1, parts + 1):
            between = plus(origin, scaled(minus(goal, origin), part / parts))
            now, error = _moved(self._linkage, between, pull, self._rest, now)
        angles[:] = now
        return norm(plus(minus(asked, goal), error))


def soften_target(linkage: Linkage, target: Vector, rest: Sequence[float]) -> Vector:
    """Draws a target softly inside the reach.

    Beyond s = (1 - SOFT) D its distance d from the shoulder becomes s + w (1 - exp((s - d) / w)), w = SOFT D: equal
    in value and slope at s, and never more than the reach.

    Args:
        linkage: the arm.
        target: [m] in the base.
        rest: [rad] at which the girdle stays if it can.

    Returns:
        [m] the target itself in easy reach.
    """
    width = SOFT * linkage.farthest
    begin = STRETCH * linkage.farthest - width
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
    """The angles with the hand on the target, drawn to rest by the share `pull`; and what the hand misses [m]."""
    own = linkage.links[-1].first
    wrist = [angle + pull * (home - angle) for angle, home in zip(angles[own:], rest[own:], strict=True)]
    now, size = list(angles[:own]), linkage.farthest
    hand, moves = columns(linkage, now)
    error = minus(target, hand)
    for _ in range(ROUNDS):
        damping = DAMPING * dot(error, error) + LEAST_DAMPING * size * size
        pulls = [pull * (home - angle) for home, angle in zip(rest, now, strict=False)]
        now, pull = polish_step(linkage, now, error, HandSlope(moves, pulls, linkage.mobility, damping)), 0.0
        hand, moves = columns(linkage, now)
        error = minus(target, hand)
        if norm(error) <= TOLERANCE * size:
            break
    return now + wrist, error
