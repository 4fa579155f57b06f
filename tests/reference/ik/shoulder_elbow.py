"""Positions of shoulder and elbow for a target, before limits."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, pi, remainder, tau

from kinesic.ik.angles import arccosine, cosine_sine
from kinesic.ik.arm.linkage import Linkage
from kinesic.ik.arm.swivel import swivel_of
from kinesic.ik.scalar3 import Vector, clamp_to_reach, distance, minus, plus, scaled, unit

from .hinges import Extraction, extract
from .masses import MAX_ITERATIONS, SWIVEL_ITERATIONS, settle_masses
from .swivel import bisect_edge, elbow_at, elbow_radius

MAX_STRETCH_RATIO = 0.9999  # [reach] distance to which targets out of reach are clamped
TAUT_RATIO = 0.97  # [reach] distance beyond which the shoulder moves towards the target
EXACT_MISS = 1e-6  # [reach] largest hand error of a posture that counts as exact
NATURAL_SWIVEL = 0.35  # [rad] swivel of a relaxed elbow, slightly away from the body
NATURAL_SWIVEL_WEIGHT = 0.5  # fraction of the change towards the natural swivel if none is requested
SEARCH_STEPS = 12  # number of swivels tried on each side of the desired swivel
BISECTION_STEPS = 6  # number of bisection steps at the boundary
MIN_CIRCLE_RATIO = 1e-3  # [reach] radius of the elbow's circle below which it has no side
EQUAL_MISS = 1e-9  # [reach] hand errors that differ by less count as equal


@dataclass(frozen=True)
class ShoulderPlace:
    """Shoulder position from which a target is within reach."""

    girdle: tuple[Vector, ...]  # [m] ends of the bones between base and shoulder; empty without collar bone
    shoulder: Vector  # [m] shoulder position
    target: Vector  # [m] target of the hand
    iterations: int  # number of relaxation iterations


def place_shoulder(linkage: Linkage, target: Vector, *, near: Sequence[float], rest: Sequence[float]) -> ShoulderPlace:
    """Return the shoulder position for a target (thesis 8.6).

    Args:
        linkage: the arm.
        target: [m] of the hand, in the base.
        near: [rad] angles to stay close to where there is a choice.
        rest: [rad] at which the collar bone stays if it can.

    Returns:
        Place, its target clamped to what the arm reaches from the most helpful shoulder.
    """
    reach = linkage.farthest
    resting = linkage.walk(rest, len(linkage.girdle))[1]
    if distance(resting[-1], target) <= TAUT_RATIO * reach:
        return _place(resting, target, 0)
    nearer = nearest_girdle(linkage, target, near)
    if distance(nearer[-1], target) > MAX_STRETCH_RATIO * reach:
        return _place(nearer, clamp_to_reach(target, nearer[-1], MAX_STRETCH_RATIO * reach), 0)
    upper, fore = TAUT_RATIO * linkage.links[-3].length, TAUT_RATIO * linkage.links[-2].length
    elbow = plus(resting[-1], scaled(unit(minus(target, resting[-1])), upper))
    lengths = (*(link.length for link in linkage.girdle), upper, fore)
    settled = settle_masses((*resting, elbow, target), lengths, target)
    ends = settled.points[1:-2]
    pulled = linkage.walk(extract(linkage, ends, near).angles, len(ends))[1]
    return _place(pulled, target, settled.iterations)


def place_of(linkage: Linkage, angles: Sequence[float], target: Vector) -> ShoulderPlace:
    """Return the shoulder position in a posture [rad]."""
    return _place(linkage.walk(angles, len(linkage.girdle))[1], target, 0)


def gap(linkage: Linkage, target: Vector) -> float:
    """Return the least possible distance [m] of the shoulder from a target."""
    return distance(nearest_girdle(linkage, target, [pivot.rest for pivot in linkage.pivots])[-1], target)


def nearest_girdle(linkage: Linkage, target: Vector, near: Sequence[float]) -> list[Vector]:
    """Return joint positions [m] of the collar bone with the shoulder nearest to a target."""
    return linkage.walk(_nearest_girdle_angles(linkage, target, near), len(linkage.girdle))[1]


def _nearest_girdle_angles(linkage: Linkage, target: Vector, near: Sequence[float]) -> tuple[float, ...]:
    """Return collar-bone angles [rad] that bring the shoulder nearest to a target."""
    line = unit(minus(target, linkage.origin))
    ends = [linkage.origin]
    for link in linkage.girdle:
        ends.append(plus(ends[-1], scaled(line, link.length)))
    return extract(linkage, ends[1:], near).angles


def _place(points: Sequence[Vector], target: Vector, iterations: int) -> ShoulderPlace:
    return ShoulderPlace(tuple(points[1:]), points[-1], target, iterations)


@dataclass(frozen=True)
class Bend:
    """Angles of an arm whose shoulder position is given."""

    angles: tuple[float, ...]  # [rad] angles of all hinges except those of the hand
    exact: bool  # whether the hand is at the target
    iterations: int  # number of relaxation iterations


def bend_elbow(linkage: Linkage, place: ShoulderPlace, *, near: Sequence[float], swivel: float | None) -> Bend:
    """Return the posture that reaches the target nearest to the desired swivel.

    Args:
        linkage: the arm.
        place: of shoulder and target.
        near: [rad] angles to stay close to.
        swivel: [rad] wished; None: between the swivel to which the masses swing from `near`, and the natural one.

    Returns:
        The nearest exact posture, or the one with the smallest miss.
    """
    elbow = linkage.walk(near, len(linkage.links) - 2)[1][-1]
    lengths = (linkage.links[-3].length, linkage.links[-2].length)
    radius = elbow_radius(linkage, place.shoulder, place.target)
    point = radius == 0.0  # the arm is too short: all swivels are one, whatever the masses say
    rounds = 0 if point else MAX_ITERATIONS if radius <= MIN_CIRCLE_RATIO * linkage.farthest else SWIVEL_ITERATIONS
    settled = settle_masses((place.shoulder, elbow, place.target), lengths, place.target, rounds=rounds)
    present = swivel_of(linkage, settled.points)
    if present is None:
        present = NATURAL_SWIVEL
    wish = (
        present + NATURAL_SWIVEL_WEIGHT * remainder(NATURAL_SWIVEL - present, tau)
        if swivel is None
        else remainder(swivel, tau)
    )
    towards = 1.0 if remainder(present - wish, tau) >= 0.0 else -1.0

    def at(offset: float) -> Extraction:
        elbow = elbow_at(linkage, place.shoulder, place.target, wish + offset)
        return extract(linkage, (*place.girdle, elbow, place.target), near)

    span = distance(place.shoulder, place.target)
    least = inf if point else _least_miss(linkage, span) + EQUAL_MISS * linkage.farthest
    result, exact = _nearest_exact(at, towards, EXACT_MISS * linkage.farthest, least)
    return Bend(result.angles, exact, settled.iterations)


def _nearest_exact(
    at: Callable[[float], Extraction], towards: float, tolerance: float, least: float
) -> tuple[Extraction, bool]:
    """Search outward from a swivel for the first posture that reaches the target."""

    def fits(posture: Extraction) -> bool:
        return posture.miss <= tolerance

    best = at(0.0)
    if fits(best):
        return best, True
    for step in range(1, SEARCH_STEPS + 1):
        for side in (towards, -towards):
            if best.miss <= least:
                return best, False
            result = at(side * step * pi / SEARCH_STEPS)
            if fits(result):
                outside, inside = side * (step - 1) * pi / SEARCH_STEPS, side * step * pi / SEARCH_STEPS
                return bisect_edge(at, outside, inside, result, fits=fits, rounds=BISECTION_STEPS), True
            best = min(best, result, key=lambda candidate: candidate.miss)
    return best, False


def _least_miss(linkage: Linkage, span: float) -> float:
    """Return the least possible hand error for a hand distance [m].

    An elbow that cannot bend enough leaves the hand off by a chord of the forearm's circle. To leave the elbow's circle
    takes the elbow farther away than it brings the hand nearer, as the hand is nearer to the shoulder.
    """
    upper, fore = linkage.links[-3].length, linkage.links[-2].length
    if not abs(upper - fore) < span < linkage.closest <= upper:
        return 0.0
    asked, bent = (
        arccosine((upper * upper + fore * fore - far * far) / (2.0 * upper * fore)) for far in (span, linkage.closest)
    )
    return 2.0 * fore * cosine_sine(0.5 * (bent - asked))[1]
