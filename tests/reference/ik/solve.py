"""Solver of one arm: clamp, spring masses, hinge angles, correction, wrist (thesis 7.3)."""

from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.angles import arccosine
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain, mirror_place, mirror_reach
from kinesic.ik.scalar3 import Vector, distance, dot, rotated, unit, vector
from kinesic.ik.solve import REACHED_DISTANCE, Solution

from . import multistart
from .nearest import finish
from .shoulder_elbow import Bend, ShoulderPlace, bend_elbow, place_of, place_shoulder
from .wrist import HandDirection, orient


def solve(chain: Chain, reach: Reach, *, start: Floats, rest: Floats | None = None, mobility: Floats | None = None):
    """Compute the result of `ik.solve.solve` for valid arguments."""
    rest = chain.rest if rest is None else rest
    if is_right(chain):
        solution = _solved(mirror_chain(chain), mirror_reach(reach), start, rest, mobility)
        return replace(solution, target=mirror_place(solution.target))
    return _solved(chain, reach, start, rest, mobility)


def _solved(chain: Chain, reach: Reach, start: Floats, rest: Floats, mobility: Floats | None) -> Solution:
    """Solve the target of an arm on the left or in the middle."""
    linkage = linkage_of(chain)
    near, home = (tuple(np.clip(angles, chain.lower, chain.upper).tolist()) for angles in (start, rest))
    ease = linkage.mobility if mobility is None else mobility.tolist()
    place = place_shoulder(linkage, vector(reach.position), near=near, rest=home)
    bend = _found(linkage, place, near=near, home=home, ease=ease, swivel=reach.swivel)
    solution = _with_wrist(chain, reach, bend.angles, home, place.iterations + bend.iterations, place.target)
    if not solution.reached:
        solution = _finished(chain, reach, home, solution)
    return replace(solution, pulled_in=float(np.abs(start - np.array(near)).max(initial=0.0)))


def _with_wrist(
    chain: Chain, reach: Reach, bent_angles: Sequence[float], rest: Sequence[float], iterations: int, target: Vector
) -> Solution:
    """Return the solution with the hand oriented, for a solved arm."""
    linkage, asked = linkage_of(chain), vector(reach.position)
    frame, points = linkage.walk(bent_angles, len(linkage.links) - 1)
    directions = hand_directions(chain, reach)
    angles = (*bent_angles, *orient(linkage.links[-1], frame, directions, rest[len(bent_angles) :]))
    hand = linkage.walk(angles, len(linkage.links))[0]
    residual = distance(points[-1], asked)
    errors = {
        direction.name: arccosine(max(-1.0, min(1.0, dot(rotated(hand, direction.own), direction.wanted))))
        for direction in directions
    }
    pointing_error, palm_error = errors.get("pointing"), errors.get("palm")
    reached = residual <= REACHED_DISTANCE
    return Solution(sealed(angles), residual, pointing_error, palm_error, reached, iterations, sealed(target), 0.0)


def _finished(chain: Chain, reach: Reach, home: Sequence[float], answer: Solution) -> Solution:
    """Return the nearest posture to an unreachable target.

    Which side of the body the arm goes was judged by the clamped target; behind the back the asked one may lie nearer
    to the other side, so seeds are tried once more on that.
    """
    elsewhere = np.array(answer.angles)
    multistart.reach(chain, np.array(reach.position, dtype=np.float64), elsewhere)
    linkage = linkage_of(chain)
    kept = tuple(answer.angles.tolist()[: linkage.links[-1].first])
    best = finish(linkage, vector(reach.position), (kept, elsewhere.tolist()))
    if best.angles == kept:
        return answer
    done = _with_wrist(chain, reach, best.angles, home, answer.iterations + best.rounds, vector(answer.target))
    return replace(done, target=answer.target)


def _found(
    linkage: Linkage,
    place: ShoulderPlace,
    *,
    near: Sequence[float],
    home: Sequence[float],
    ease: Sequence[float],
    swivel: float | None,
) -> Bend:
    """Solve the arm in closed form, and correct it numerically if it misses."""
    first = bend_elbow(linkage, place, near=near, swivel=swivel)
    if first.exact:
        return first
    best = multistart.approach(linkage, place.target, first.angles, posture=home, mobility=ease)
    iterations = first.iterations + best.rounds
    if best.miss >= multistart.STALL_DISTANCE:
        return Bend(best.angles, False, iterations)
    again = place_of(linkage, best.angles, linkage.hand(best.angles))
    second = bend_elbow(linkage, again, near=best.angles, swivel=swivel)
    return Bend(second.angles if second.exact else best.angles, second.exact, iterations + second.iterations)


def hand_directions(chain: Chain, reach: Reach) -> list[HandDirection]:
    """Return the requested hand directions with their targets."""
    along = unit(vector(chain.joints[-1].bone))
    pairs = (("pointing", along, reach.pointing), ("palm", unit(vector(chain.palm)), reach.palm))
    return [HandDirection(name, own, unit(vector(wanted))) for name, own, wanted in pairs if wanted is not None]
