"""Enumeration of arm postures with the hand at its target.

With the wrist's centre on its target they decide everything else, so a search over them is a search over all postures.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import pi, sqrt

from kinesic.ik.arm.linkage import Linkage, Pivot
from kinesic.ik.arm.swivel import swivel_of
from kinesic.ik.scalar3 import Rotation, Vector, distance

from .hinges import extract
from .shoulder_elbow import NATURAL_SWIVEL, ShoulderPlace, place_of
from .swivel import elbow_at

SWIVEL_STEPS = 24  # number of swivels on the circle of elbow positions
GIRDLE_STEPS = 5  # number of values over the range of each collar-bone hinge, in addition to the current value
MISS_COST = 10.0  # [rad / arm length] cost of the hand's distance from its target

WristSolver = Callable[
    [Rotation], tuple[tuple[float, ...], float]
]  # forearm's frame -> hand's own angles, their error [rad]


@dataclass(frozen=True)
class Cell:
    """Posture of the whole arm within its ranges."""

    angles: tuple[float, ...]  # [rad] angles of all hinges
    miss: float  # [m] distance of the hand from its target
    error: float  # [rad] error of the hand's direction or orientation
    cost: float  # weighted sum of both errors; 0 without error


def cells(
    linkage: Linkage, target: Vector, hand: WristSolver, *, near: Sequence[float], girdle: bool = True
) -> Iterator[Cell]:
    """Yield postures with the hand at its target, nearest first.

    Args:
        linkage: the arm.
        target: [m] of the wrist's centre, in the base.
        hand: turns the hand once the forearm is in place.
        near: [rad] the present posture, inside the ranges.
        girdle: whether the collar bone moves too.

    Yields:
        `SWIVEL_STEPS` postures for each place of the shoulder. A stopped hinge shows as a miss.
    """
    begin = present_swivel(linkage, near)
    for angles in _girdles(linkage, near) if girdle else [tuple(near)]:
        place = place_of(linkage, angles, target)
        for offset in _outward():
            yield cell_at(linkage, place, begin + offset, hand, near=angles)


def cell_at(linkage: Linkage, place: ShoulderPlace, swivel: float, hand: WristSolver, *, near: Sequence[float]) -> Cell:
    """Return the posture of one swivel [rad]."""
    elbow = elbow_at(linkage, place.shoulder, place.target, swivel)
    extracted = extract(linkage, (*place.girdle, elbow, place.target), near)
    frame, points = linkage.walk(extracted.angles, len(linkage.links) - 1)
    own, error = hand(frame)
    miss = distance(points[-1], place.target)
    return Cell(extracted.angles + own, miss, error, error + MISS_COST * miss / linkage.farthest)


def present_swivel(linkage: Linkage, near: Sequence[float]) -> float:
    """Return the swivel [rad] of a posture, or the natural swivel."""
    swivel = swivel_of(linkage, linkage.walk(near, len(linkage.links) - 1)[1][-3:])
    return NATURAL_SWIVEL if swivel is None else swivel


def _outward() -> Iterator[float]:
    """Yield swivel offsets [rad] of growing size and alternating sign."""
    step = 2.0 * pi / SWIVEL_STEPS
    return ((k + 1) // 2 * (step if k % 2 else -step) for k in range(SWIVEL_STEPS))


def _girdles(linkage: Linkage, near: Sequence[float]) -> list[tuple[float, ...]]:
    """Return postures with different collar-bone angles, the nearest first."""
    pivots = [pivot for link in linkage.girdle for pivot in link.pivots]
    grid = [_steps(pivot, angle) for pivot, angle in zip(pivots, near, strict=False)]
    ways = sorted(product(*grid), key=lambda way: _apart(way, near))
    return [(*way, *near[len(way) :]) for way in ways]


def _apart(one: Sequence[float], other: Sequence[float]) -> float:
    """Return the distance [rad] of two postures, rounded as in the kernel."""
    total = 0.0
    for a, b in zip(one, other, strict=False):
        total += (a - b) * (a - b)
    return sqrt(total)


def _steps(pivot: Pivot, angle: float) -> list[float]:
    width = (pivot.upper - pivot.lower) / (GIRDLE_STEPS - 1)
    return [angle, *(pivot.lower + k * width for k in range(GIRDLE_STEPS))]
