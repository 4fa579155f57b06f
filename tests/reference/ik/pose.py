"""Search over swivel and collar bone for a hand pose."""

from collections.abc import Iterator, Sequence
from itertools import islice
from math import dist, pi

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.ik.angles import arctangent
from kinesic.ik.arm.linkage import Link, Linkage, linkage_of
from kinesic.ik.arm.mirror import MIRROR_SIGNS, is_right, mirror_chain
from kinesic.ik.arm.orientation import product, transposed
from kinesic.ik.arm.seeds import seeds
from kinesic.ik.arm.subproblems import first_of_two, turn_towards
from kinesic.ik.box_lm import Box, ErrorFunction, descend
from kinesic.ik.pose import PoseSolution
from kinesic.ik.scalar3 import (
    IDENTITY_ROTATION,
    Rotation,
    Vector,
    across,
    after,
    distance,
    minus,
    norm,
    plus,
    rotated,
    scaled,
    turned,
    unit,
    vector,
)

from .swivel_search import MISS_COST, Cell, WristSolver, cells
from .wrist import HandDirection, orient

POSITION_TOLERANCE = 1e-4  # [m] largest position error of a solved pose
ROTATION_TOLERANCE = 1e-3  # [rad] largest rotation error of a solved pose
PERFECT_COST = 1e-6  # cost below which the search ends
TOLERANCE = 1e-7  # error [arm lengths, rad] below which the descent ends
SAME_POSTURE_DISTANCE = 0.05  # [rad] distance below which postures count as equal
MAX_CANDIDATES = 12  # largest number of postures that are refined


def solve_pose(chain: Chain, position: Floats, rotation: Floats, *, start: Floats) -> PoseSolution:
    """Compute the result of `ik.pose.solve_pose` for valid arguments."""
    near = np.clip(start, chain.lower, chain.upper)
    if is_right(chain):
        chain, position = mirror_chain(chain), position * MIRROR_SIGNS
        rotation = MIRROR_SIGNS[:, None] * rotation * MIRROR_SIGNS
    return _solved(linkage_of(chain), vector(position), _rotation(rotation), tuple(near.tolist()))


def _solved(linkage: Linkage, target: Vector, wanted: Rotation, near: tuple[float, ...]) -> PoseSolution:
    """Solve a pose for an arm on the left or in the middle."""

    def hand(frame: Rotation) -> tuple[tuple[float, ...], float]:
        return _wrist(linkage.links[-1], frame, wanted, near)

    seen: list[Cell] = []
    for cell in cells(linkage, target, hand, near=near):
        seen.append(cell)
        if cell.cost < PERFECT_COST:
            break
    seen.sort(key=lambda cell: cell.cost)
    best, rounds = _solution(linkage, target, wanted, seen[0].angles), 0
    if seen[0].cost >= PERFECT_COST:
        errors, box = _errors(linkage, target, wanted), _box(linkage, near)
        for begin in _beginnings(linkage, target, hand, seen):
            descent = descend(errors, np.array(begin), box, tolerance=TOLERANCE)
            rounds += descent.rounds
            result = _solution(linkage, target, wanted, descent.angles.tolist())
            best = min(best, result, key=lambda one: one.residual / linkage.farthest + one.turn)
            if best.reached:
                break
    return PoseSolution(best.angles, best.residual, best.turn, best.reached, len(seen), rounds)


def _beginnings(
    linkage: Linkage, target: Vector, hand: WristSolver, seen: Sequence[Cell]
) -> Iterator[tuple[float, ...]]:
    """Yield start postures for the pose search.

    Those of cheap search cells come before the seeds of IK.
    """
    yield from (cell.angles for cell in islice(_distinct(seen), MAX_CANDIDATES))
    spread: list[tuple[float, tuple[float, ...]]] = []
    for seed in seeds(linkage):
        frame, points = linkage.walk(seed.angles, len(linkage.links) - 1)
        own, error = hand(frame)
        spread.append((error + MISS_COST * distance(points[-1], target) / linkage.farthest, seed.angles + own))
    yield from (angles for _, angles in sorted(spread, key=lambda each: each[0]))


def _distinct(seen: Sequence[Cell]) -> Iterator[Cell]:
    """Yield postures that differ from all earlier ones."""
    kept: list[Cell] = []
    for cell in seen:
        if all(dist(cell.angles, other.angles) > SAME_POSTURE_DISTANCE for other in kept):
            kept.append(cell)
            yield cell


def _solution(linkage: Linkage, target: Vector, wanted: Rotation, angles: Sequence[float]) -> PoseSolution:
    rotation, points = linkage.walk(angles, len(linkage.links))
    residual, turn = distance(points[-2], target), norm(shortest_turn(rotation, wanted))
    return PoseSolution(
        sealed(angles), residual, turn, residual <= POSITION_TOLERANCE and turn <= ROTATION_TOLERANCE, 0, 0
    )


def _wrist(link: Link, frame: Rotation, wanted: Rotation, near: Sequence[float]) -> tuple[tuple[float, ...], float]:
    """Return the angles of the hand's hinges and the remaining rotation error [rad]."""
    now = near[link.first :]
    inner = product(transposed(frame), wanted)
    ways = _three_turns(link, inner, now) if len(link.pivots) == 3 else [_few_turns(link, frame, wanted, now)]
    held = [tuple(p.bring_into_range(a, b) for p, a, b in zip(link.pivots, way, now, strict=True)) for way in ways]
    turns = [norm(shortest_turn(link.turn(IDENTITY_ROTATION, way), inner)) for way in held]
    best = min(range(len(held)), key=lambda k: (turns[k] > PERFECT_COST and turns[k], _travel(held[k], now)))
    return held[best], turns[best]


def _three_turns(link: Link, wanted: Rotation, now: Sequence[float]) -> list[tuple[float, ...]]:
    """Return both solutions of three hinge angles that compose a rotation."""
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
    """Return the best angles of a wrist with fewer than three hinges."""
    axes: tuple[Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    return orient(link, frame, [HandDirection("axis", axis, rotated(wanted, axis)) for axis in axes], now)


def _errors(linkage: Linkage, target: Vector, wanted: Rotation) -> ErrorFunction:
    """Return the error function: position in arm lengths, orientation in rad."""
    size = linkage.farthest

    def errors(angles: Floats) -> tuple[Floats, Floats]:
        rotation, centre, axes = IDENTITY_ROTATION, linkage.origin, []
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


def shortest_turn(present: Rotation, wanted: Rotation) -> Vector:
    """Return the shortest rotation vector between two orientations [rad]."""
    a, b, c, d, e, f, g, h, i = product(wanted, transposed(present))
    axis, twice_cosine = (h - f, c - g, d - b), a + e + i - 1.0
    twice_sine = norm(axis)
    if twice_sine < 1e-12 and twice_cosine < 0.0:
        widest = max(range(3), key=lambda k: (a, e, i)[k])
        return scaled(unit(((a + 1.0, b, c), (d, e + 1.0, f), (g, h, i + 1.0))[widest]), pi)
    return scaled(axis, arctangent(twice_sine, twice_cosine) / twice_sine if twice_sine > 0.0 else 0.5)
