"""Joint angles for a reach: clamp, masses, hinges, polish, wrist (thesis 7.3).

An unreachable target is a result with a residual: the arm points at it. The compiled kernel answers where there is
one; what stands here is its specification, and the answer where there is none.
"""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.angles import arccosine
from kinesic.ik.arm import multistart
from kinesic.ik.arm.compiled import KERNEL, arm_of
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain, mirror_place, mirror_reach
from kinesic.ik.arm.nearest import finish
from kinesic.ik.arm.shoulder_elbow import Bend, ShoulderPlace, bend_elbow, place_of, place_shoulder
from kinesic.ik.arm.wrist import HandDirection, orient
from kinesic.ik.scalar3 import Vector, distance, dot, rotated, unit, vector
from kinesic.kernels import Kernel

REACHED = 1e-3  # [m] residual at which the hand is there


class Solution(Struct, frozen=True, eq=False):
    """The posture found for a reach. An unreachable goal is an answer, not an error: read the residual."""

    angles: Floats  # (k,) [rad] inside the ranges
    residual: float  # [m] from the hand to the position that was asked
    pointing_error: float | None  # [rad] None where no pointing was asked
    palm_error: float | None  # [rad] None where no palm was asked
    reached: bool  # residual within 1 mm
    iterations: int  # of masses and of polish, all attempts together
    target: Floats  # (3,) [m] after clamping to the reach, in the base
    pulled_in: float  # [rad] by which a hinge of the start lay outside its range, at most


def solve(
    chain: Chain,
    reach: Reach,
    *,
    start: Floats,
    rest: Floats | None = None,
    mobility: Floats | None = None,
    kernel: Kernel = KERNEL,
) -> Solution:
    """Finds the posture of an arm for a hand.

    Args:
        chain: the arm.
        reach: of its hand, in the frame of the chain's base.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.
        rest: (k,) [rad] of whatever the reach leaves open; the chain's own by default.
        mobility: (k,) how readily each hinge helps where closed forms do not suffice; the girdle 0.1, others 1.
        kernel: which implementation answers; "numpy" is the specification of the other.

    Returns:
        Angles inside the ranges and what is left of the reach, measured on these angles.

    Raises:
        ValueError: a shape is wrong or a number is not finite; or the chain is no arm.
    """
    answer = _compiled(chain, reach, start, rest, mobility) if kernel == "compiled" else None
    return _examined(chain, reach, start, rest, mobility, kernel) if answer is None else answer


def _compiled(
    chain: Chain, reach: Reach, start: Floats, rest: Floats | None, mobility: Floats | None
) -> Solution | None:
    """The kernel's answer; None where the question is not made of finite float64 arrays of the right size."""
    answer = arm_of(chain).solve(reach.position, reach.pointing, reach.palm, reach.swivel, start, rest, mobility)
    return None if answer is None else Solution(*answer)


def _examined(
    chain: Chain, reach: Reach, start: Floats, rest: Floats | None, mobility: Floats | None, kernel: Kernel
) -> Solution:
    """Answers a question that is refused in words, or first brought to its form."""
    reach = _checked(reach)
    start = as_floats("start", start, (len(chain.rest),))
    rest = chain.rest if rest is None else as_floats("rest", rest, (len(chain.rest),))
    mobility = None if mobility is None else as_floats("mobility", mobility, (len(chain.rest),))
    if kernel == "compiled":
        answer = _compiled(chain, reach, start, rest, mobility)
        if answer is not None:
            return answer
    if is_right(chain):
        solution = _solved(mirror_chain(chain), mirror_reach(reach), start, rest, mobility)
        return replace(solution, target=mirror_place(solution.target))
    return _solved(chain, reach, start, rest, mobility)


def _solved(chain: Chain, reach: Reach, start: Floats, rest: Floats, mobility: Floats | None) -> Solution:
    """The specification, for an arm on the left or in the middle."""
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
    """An arm bent to its place [rad], its hand turned, and what is left of the reach."""
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
    reached = residual <= REACHED
    return Solution(sealed(angles), residual, pointing_error, palm_error, reached, iterations, sealed(target), 0.0)


def _finished(chain: Chain, reach: Reach, home: Sequence[float], answer: Solution) -> Solution:
    """Out of reach: the last steps to the nearest that the hand can come, where they win something.

    Which side of the body the arm goes was judged by the clamped target; behind the back the asked one may lie nearer
    to the other side, so seeds are tried once more on that.
    """
    elsewhere = np.array(answer.angles)
    multistart.reach(chain, np.array(reach.position, dtype=np.float64), elsewhere, kernel="numpy")
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
    """Closed forms first; where they miss, polish, from other postures if need be."""
    first = bend_elbow(linkage, place, near=near, swivel=swivel)
    if first.exact:
        return first
    best = multistart.approach(linkage, place.target, first.angles, posture=home, mobility=ease)
    iterations = first.iterations + best.rounds
    if best.miss >= multistart.STALLED:
        return Bend(best.angles, False, iterations)
    again = place_of(linkage, best.angles, linkage.hand(best.angles))
    second = bend_elbow(linkage, again, near=best.angles, swivel=swivel)
    return Bend(second.angles if second.exact else best.angles, second.exact, iterations + second.iterations)


def hand_directions(chain: Chain, reach: Reach) -> list[HandDirection]:
    """Lists the hand's directions that a reach asks for, and where they should look."""
    along = unit(vector(chain.joints[-1].bone))
    pairs = (("pointing", along, reach.pointing), ("palm", unit(vector(chain.palm)), reach.palm))
    return [HandDirection(name, own, unit(vector(wanted))) for name, own, wanted in pairs if wanted is not None]


def _checked(reach: Reach) -> Reach:
    position = as_floats("reach.position", reach.position, (3,))
    pointing, palm = (
        None if direction is None else _direction(name, direction)
        for name, direction in (("reach.pointing", reach.pointing), ("reach.palm", reach.palm))
    )
    swivel = None if reach.swivel is None else float(as_floats("reach.swivel", np.array([reach.swivel]), (1,))[0])
    return Reach(position, pointing, palm, swivel)


def _direction(name: str, values: Floats) -> Floats:
    direction = as_floats(name, values, (3,))
    if not np.linalg.norm(direction) > 0.0:
        raise ValueError(f"{name} is the null vector; give a direction such as [1, 0, 0], or None")
    return direction


def as_floats(name: str, values: Floats, shape: tuple[int, ...]) -> Floats:
    """Checks that an array has a shape and finite numbers.

    Returns:
        The values as contiguous float64.

    Raises:
        ValueError: the shape is wrong or a number is not finite.
    """
    array = np.asarray(values, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}; it needs shape {shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is {array.tolist()}; every number must be finite")
    return np.ascontiguousarray(array)


def three(name: str, values: Floats) -> Floats:
    """Checks that an array is three finite numbers.

    Returns:
        (3,) float64.

    Raises:
        ValueError: it is not three finite numbers.
    """
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name} is {array.tolist()}; it needs three finite numbers")
    return array
