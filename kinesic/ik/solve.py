"""Joint angles for a reach: clamp, masses, hinges, polish, wrist (thesis 7.3).

An unreachable target is a result with a residual: the arm points at it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import acos

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.linkage import Linkage, linkage_of
from kinesic.ik.mirror import is_right, mirrored_chain, mirrored_place, mirrored_reach
from kinesic.ik.place import Bend, Place, bent, place_of, placed
from kinesic.ik.polish import polish
from kinesic.ik.seeds import nearest
from kinesic.ik.vectors import distance, dot, rotated, unit, vector
from kinesic.ik.wrist import Wish, orient

REACHED = 1e-3  # [m] residual at which the hand is there
STALLED = 2e-5  # [m] from the clamped target: further away the arm begins again elsewhere
RESTARTS = 8
GIRDLE_MOBILITY = 0.1  # the collar bone moves late


@dataclass(frozen=True, eq=False)
class Solution:
    """An unreachable goal is an answer, not an error: read the residual."""

    angles: Floats  # (k,) [rad] inside the ranges
    residual: float  # [m] from the hand to the position that was asked
    pointing_error: float | None  # [rad] None where no pointing was asked
    palm_error: float | None  # [rad] None where no palm was asked
    reached: bool  # residual within 1 mm
    iterations: int  # of masses and of polish, all attempts together
    target: Floats  # (3,) [m] after clamping to the reach, in the base


def solve(
    chain: Chain, reach: Reach, *, start: Floats, rest: Floats | None = None, mobility: Floats | None = None
) -> Solution:
    """Finds the posture of an arm for a hand.

    Args:
        chain: the arm.
        reach: of its hand, in the frame of the chain's base.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.
        rest: (k,) [rad] of whatever the reach leaves open; the chain's own by default.
        mobility: (k,) how readily each hinge helps where closed forms do not suffice; the girdle 0.1, others 1.

    Returns:
        Angles inside the ranges and what is left of the reach, measured on these angles.

    Raises:
        ValueError: a shape is wrong or a number is not finite.
    """
    _finite("reach.position", reach.position, 3)
    _check(reach)
    if is_right(chain):
        chain, reach = mirrored_chain(chain), mirrored_reach(reach)
        solution = _solved(chain, reach, start, rest, mobility)
        return replace(solution, target=mirrored_place(solution.target))
    return _solved(chain, reach, start, rest, mobility)


def _solved(chain: Chain, reach: Reach, start: Floats, rest: Floats | None, mobility: Floats | None) -> Solution:
    """`solve` for an arm on the left or in the middle."""
    linkage = linkage_of(chain)
    near = _posture(chain, "start", start)
    home = _posture(chain, "rest", chain.rest if rest is None else rest)
    asked = vector(reach.position)
    ease = _mobility(linkage, chain, mobility)
    place = placed(linkage, asked, near=near, rest=home)
    bend = _found(linkage, place, near=near, home=home, ease=ease, swivel=reach.swivel)
    frame, points = linkage.walk(bend.angles, len(linkage.links) - 1)
    wishes = _wishes(chain, linkage, reach)
    angles = bend.angles + orient(linkage.links[-1], frame, wishes, home[len(bend.angles) :])
    hand = linkage.walk(angles, len(linkage.links))[0]
    residual = distance(points[-1], asked)
    errors = {wish.name: acos(max(-1.0, min(1.0, dot(rotated(hand, wish.own), wish.wanted)))) for wish in wishes}
    return Solution(
        sealed(angles),
        residual,
        errors.get("pointing"),
        errors.get("palm"),
        residual <= REACHED,
        place.iterations + bend.iterations,
        sealed(place.target),
    )


def _found(
    linkage: Linkage,
    place: Place,
    *,
    near: Sequence[float],
    home: Sequence[float],
    ease: Sequence[float],
    swivel: float | None,
) -> Bend:
    """Closed forms first; where they miss, polish, from other postures if need be."""
    first = bent(linkage, place, near=near, swivel=swivel)
    if first.exact:
        return first
    beginnings = [first.angles, *(seed.angles for seed in nearest(linkage, place.target, RESTARTS))]
    best, least, iterations = first, float("inf"), first.iterations
    for beginning in beginnings:
        polished = polish(linkage, place.target, beginning, posture=home, mobility=ease)
        iterations += polished.rounds
        if polished.miss < least:
            best, least = Bend(polished.angles, False, iterations), polished.miss
        if least < STALLED:
            break
    if least >= STALLED:
        return Bend(best.angles, False, iterations)
    again = place_of(linkage, best.angles, linkage.hand(best.angles))
    second = bent(linkage, again, near=best.angles, swivel=swivel)
    return Bend(second.angles if second.exact else best.angles, second.exact, iterations + second.iterations)


def _wishes(chain: Chain, linkage: Linkage, reach: Reach) -> list[Wish]:
    """What the hand's direction and palm should look at."""
    wishes = []
    if reach.pointing is not None:
        wishes.append(Wish("pointing", linkage.links[-1].along, unit(vector(reach.pointing))))
    if reach.palm is not None:
        wishes.append(Wish("palm", unit(vector(chain.palm)), unit(vector(reach.palm))))
    return wishes


def _mobility(linkage: Linkage, chain: Chain, given: Floats | None) -> Sequence[float]:
    if given is not None:
        return [float(ease) for ease in _finite("mobility", given, len(chain.rest))]
    girdle = linkage.links[-3].first
    return [GIRDLE_MOBILITY if k < girdle else 1.0 for k in range(len(chain.rest))]


def _posture(chain: Chain, name: str, angles: Floats) -> tuple[float, ...]:
    """Plain angles inside the ranges."""
    return tuple(np.clip(_finite(name, angles, len(chain.rest)), chain.lower, chain.upper).tolist())


def _check(reach: Reach) -> None:
    """Refuses directions that are none."""
    for name, direction in (("pointing", reach.pointing), ("palm", reach.palm)):
        if direction is not None and not np.linalg.norm(_finite(f"reach.{name}", direction, 3)) > 0.0:
            raise ValueError(f"reach.{name} is the null vector; give a direction such as [1, 0, 0], or None")
    if reach.swivel is not None:
        _finite("reach.swivel", np.array([reach.swivel]), 1)


def _finite(name: str, values: Floats, size: int) -> Floats:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (size,):
        raise ValueError(f"{name} has shape {array.shape}; it needs {size} numbers, shape ({size},)")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is {array.tolist()}; every number must be finite")
    return array
