"""A hand's whole pose, position and orientation: the elbow's circle is searched, the rest is closed form.

The compiled kernel answers where there is one; what stands here is its specification. Once the forearm is in place
its twist and the wrist follow from the wanted orientation (three hinges through one point). The first posture that
violates no range is the answer; where the search meets none, Levenberg-Marquardt goes on from the best ones, then
from postures all over the ranges.
"""

from collections.abc import Iterator, Sequence
from itertools import islice
from math import dist

import numpy as np
from msgspec import Struct

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.compiled import KERNEL, arm_of
from kinesic.ik.arm.linkage import Link, Linkage, linkage_of
from kinesic.ik.arm.mirror import ACROSS, is_right, mirror_chain
from kinesic.ik.arm.orientation import orientation_of, product, shortest_turn, transposed
from kinesic.ik.arm.seeds import seeds
from kinesic.ik.arm.subproblems import first_of_two, turn_towards
from kinesic.ik.arm.swivel_search import MISS_COST, Cell, WristSolver, cells
from kinesic.ik.arm.wrist import HandDirection, orient
from kinesic.ik.box_lm import Box, ErrorFunction, descend
from kinesic.ik.scalar3 import (
    IDENTITY,
    Rotation,
    Vector,
    across,
    after,
    distance,
    minus,
    norm,
    plus,
    rotated,
    turned,
    unit,
    vector,
)
from kinesic.ik.solve import as_floats, three
from kinesic.kernels import Kernel

NEAR_ENOUGH = 1e-4  # [m] residual and ...
LIKE_ENOUGH = 1e-3  # ... [rad] turn at which the pose is held
PERFECT = 1e-6  # cost of a cell at which the search ends
TOLERANCE = 1e-7  # of the descent: arm lengths and rad together
ALIKE = 0.05  # [rad] distance of postures that need no second descent
CANDIDATES = 12  # cells that are refined, the best first
ORTHONORMAL = 1e-6  # how far R^T R may be from 1


class PoseSolution(Struct, frozen=True, eq=False):
    """The posture found for a pose. An unreachable one is an answer, not an error: read residual and turn."""

    angles: Floats  # (k,) [rad] inside the ranges
    residual: float  # [m] from the hand to the position that was asked
    turn: float  # [rad] between the hand's orientation and the one that was asked
    reached: bool  # within 0.1 mm and 1 mrad
    cells: int  # postures looked at
    rounds: int  # of the descents


def solve_pose(
    chain: Chain, position: Floats, rotation: Floats, *, start: Floats, kernel: Kernel = KERNEL
) -> PoseSolution:
    """Finds a posture that holds the hand in a pose.

    Args:
        chain: the arm.
        position: (3,) [m] of the wrist's centre, in the frame of the chain's base.
        rotation: (3, 3) of the last segment, in the frame of the chain's base.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.
        kernel: which implementation answers; "numpy" is the specification of the other.

    Returns:
        Angles inside the ranges, and what is left, measured on these angles.

    Raises:
        ValueError: a shape is wrong, a number is not finite, or the matrix is no rotation.
    """
    answer = arm_of(chain).pose(position, rotation, start) if kernel == "compiled" else None
    if answer is not None:
        return PoseSolution(*answer)
    place, frame = as_floats("position", position, (3,)), _checked(rotation)
    near = as_floats("start", start, chain.rest.shape)
    answer = arm_of(chain).pose(place, frame, near) if kernel == "compiled" else None
    return _specified(chain, place, frame, near) if answer is None else PoseSolution(*answer)


def hold_reach(chain: Chain, reach: Reach, *, start: Floats, kernel: Kernel = KERNEL) -> PoseSolution:
    """Finds a posture whose hand is in its place, points and faces as a reach asks, wherever its elbow has to go.

    Args:
        chain: the arm.
        reach: of its hand, with pointing and palm, in the frame of the chain's base. The palm is met as nearly as
            the pointing allows; a swivel is not heeded.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.
        kernel: which implementation answers; "numpy" is the specification of the other.

    Returns:
        Angles inside the ranges, and what is left, measured on these angles.

    Raises:
        ValueError: pointing or palm is missing or they are parallel; a shape is wrong or a number is not finite.
    """
    answer = arm_of(chain).hold(reach.position, reach.pointing, reach.palm, start) if kernel == "compiled" else None
    if answer is not None:
        return PoseSolution(*answer)
    if reach.pointing is None or reach.palm is None:
        missing = "pointing" if reach.pointing is None else "palm"
        raise ValueError(f"reach.{missing} is None; a pose needs pointing and palm (with one of them: best_swivel)")
    pointing, palm = (
        unit(vector(three(f"reach.{name}", direction)))
        for name, direction in (("pointing", reach.pointing), ("palm", reach.palm))
    )
    wanted = orientation_of(chain, pointing, palm)
    if wanted is None:
        raise ValueError(
            f"reach.pointing {list(pointing)} and reach.palm {list(palm)} are null or parallel; "
            "a palm faces aside from where its hand points, such as [1, 0, 0] and [0, 0, -1]"
        )
    return solve_pose(chain, reach.position, np.array(wanted).reshape(3, 3), start=start, kernel=kernel)


def _specified(chain: Chain, place: Floats, frame: Floats, start: Floats) -> PoseSolution:
    """The specification, of a right arm in the mirror."""
    near = np.clip(start, chain.lower, chain.upper)
    if is_right(chain):
        chain, place = mirror_chain(chain), place * ACROSS
        frame = ACROSS[:, None] * frame * ACROSS
    return _solved(linkage_of(chain), vector(place), _rotation(frame), tuple(near.tolist()))


def _solved(linkage: Linkage, target: Vector, wanted: Rotation, near: tuple[float, ...]) -> PoseSolution:
    """`solve_pose` for an arm on the left or in the middle."""

    def hand(frame: Rotation) -> tuple[tuple[float, ...], float]:
        return _wrist(linkage.links[-1], frame, wanted, near)

    seen: list[Cell] = []
    for cell in cells(linkage, target, hand, near=near):
        seen.append(cell)
        if cell.cost < PERFECT:
            break
    seen.sort(key=lambda cell: cell.cost)
    best, rounds = _solution(linkage, target, wanted, seen[0].angles), 0
    if seen[0].cost >= PERFECT:
        errors, box = _errors(linkage, target, wanted), _box(linkage, near)
        for begin in _beginnings(linkage, target, hand, seen):
            descent = descend(errors, np.array(begin), box, tolerance=TOLERANCE)
            rounds += descent.rounds
            found = _solution(linkage, target, wanted, descent.angles.tolist())
            best = min(best, found, key=lambda one: one.residual / linkage.farthest + one.turn)
            if best.reached:
                break
    return PoseSolution(best.angles, best.residual, best.turn, best.reached, len(seen), rounds)


def _beginnings(
    linkage: Linkage, target: Vector, hand: WristSolver, seen: Sequence[Cell]
) -> Iterator[tuple[float, ...]]:
    """Where descents begin: the cheapest cells that differ, then postures all over the ranges, the nearest first."""
    yield from (cell.angles for cell in islice(_distinct(seen), CANDIDATES))
    spread: list[tuple[float, tuple[float, ...]]] = []
    for seed in seeds(linkage):
        frame, points = linkage.walk(seed.angles, len(linkage.links) - 1)
        own, error = hand(frame)
        spread.append((error + MISS_COST * distance(points[-1], target) / linkage.farthest, seed.angles + own))
    yield from (angles for _, angles in sorted(spread, key=lambda each: each[0]))


def _distinct(seen: Sequence[Cell]) -> Iterator[Cell]:
    """The cells, without those like an earlier one: with the elbow straight all swivels are the same posture."""
    kept: list[Cell] = []
    for cell in seen:
        if all(dist(cell.angles, other.angles) > ALIKE for other in kept):
            kept.append(cell)
            yield cell


def _solution(linkage: Linkage, target: Vector, wanted: Rotation, angles: Sequence[float]) -> PoseSolution:
    rotation, points = linkage.walk(angles, len(linkage.links))
    residual, turn = distance(points[-2], target), norm(shortest_turn(rotation, wanted))
    return PoseSolution(sealed(angles), residual, turn, residual <= NEAR_ENOUGH and turn <= LIKE_ENOUGH, 0, 0)


def _wrist(link: Link, frame: Rotation, wanted: Rotation, near: Sequence[float]) -> tuple[tuple[float, ...], float]:
    """The hand's own angles, held in their ranges, and the turn that they leave [rad]."""
    now = near[link.first :]
    inner = product(transposed(frame), wanted)
    ways = _three_turns(link, inner, now) if len(link.pivots) == 3 else [_few_turns(link, frame, wanted, now)]
    held = [tuple(p.held(a, b) for p, a, b in zip(link.pivots, way, now, strict=True)) for way in ways]
    turns = [norm(shortest_turn(link.turn(IDENTITY, way), inner)) for way in held]
    best = min(range(len(held)), key=lambda k: (turns[k] > PERFECT and turns[k], _travel(held[k], now)))
    return held[best], turns[best]


def _three_turns(link: Link, wanted: Rotation, now: Sequence[float]) -> list[tuple[float, ...]]:
    """about(a1, q1) about(a2, q2) about(a3, q3) = R, both branches: where R takes a3 gives q1 and q2."""
    first, second, third = (pivot.axis for pivot in link.pivots)
    aside = unit(across((0.0, 0.0, 1.0) if abs(third[2]) < 0.9 else (1.0, 0.0, 0.0), third))
    tip, edge = rotated(wanted, third), rotated(wanted, aside)
    ways: list[tuple[float, ...]] = []
    for q1 in first_of_two(first, second, third, tip) or (now[0],):
        q2 = turn_towards(second, third, turned(tip, first, -q1))
        q2 = now[1] if q2 is None else q2
        q3 = turn_towards(third, aside, turned(turned(edge, first, -q1), second, -q2))
        ways.append((q1, q2, now[2] if q3 is None else q3))
    return ways


def _few_turns(link: Link, frame: Rotation, wanted: Rotation, now: Sequence[float]) -> tuple[float, ...]:
    """A wrist without three hinges comes as near as it can."""
    axes: tuple[Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    return orient(link, frame, [HandDirection("axis", axis, rotated(wanted, axis)) for axis in axes], now)


def _errors(linkage: Linkage, target: Vector, wanted: Rotation) -> ErrorFunction:
    """Six rows: position in arm lengths, orientation in rad."""
    size = linkage.farthest

    def errors(angles: Floats) -> tuple[Floats, Floats]:
        rotation, centre, axes = IDENTITY, linkage.origin, []
        for link in linkage.links:
            for k, pivot in enumerate(link.pivots, link.first):
                axes.append((*rotated(rotation, pivot.axis), *centre))
                rotation = after(rotation, pivot.axis, float(angles[k]))
            hand, centre = centre, plus(centre, rotated(rotation, link.bone))
        table = np.array(axes)
        moved = np.cross(table[:, :3], hand - table[:, 3:]) / size
        error = np.concatenate([np.array(minus(target, hand)) / size, shortest_turn(rotation, wanted)])
        return error, np.concatenate([moved, table[:, :3]], axis=1).T

    return errors


def _box(linkage: Linkage, near: Sequence[float]) -> Box:
    lower, upper = [pivot.lower for pivot in linkage.pivots], [pivot.upper for pivot in linkage.pivots]
    return Box(sealed(lower), sealed(upper), sealed(near), sealed(linkage.mobility))


def _travel(turns: Sequence[float], now: Sequence[float]) -> float:
    return sum(abs(turn - angle) for turn, angle in zip(turns, now, strict=True))


def _rotation(matrix: Floats) -> Rotation:
    a, b, c, d, e, f, g, h, i = matrix.ravel().tolist()
    return a, b, c, d, e, f, g, h, i


def _checked(rotation: Floats) -> Floats:
    matrix = as_floats("rotation", rotation, (3, 3))
    if np.abs(matrix.T @ matrix - np.eye(3)).max() > ORTHONORMAL or np.linalg.det(matrix) < 0.0:
        raise ValueError(
            f"rotation is {matrix.tolist()}; its columns must be perpendicular unit vectors, right-handed "
            f"(scipy.spatial.transform.Rotation.as_matrix gives such a one)"
        )
    return matrix
