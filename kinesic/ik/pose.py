"""A hand's whole pose, position and orientation: the elbow's circle is searched, the rest is closed form.

Once the forearm is in place its twist and the wrist follow from the wanted orientation (three hinges through one
point). The first posture that violates no range is the answer; where the search meets none, Levenberg-Marquardt
goes on from the best ones.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from math import atan2, dist

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.ik.arm.linkage import Link, Linkage, linkage_of
from kinesic.ik.arm.mirror import ACROSS, is_right, mirror_chain
from kinesic.ik.arm.subproblems import first_of_two, turn_towards
from kinesic.ik.arm.swivel_search import Cell, cells
from kinesic.ik.arm.wrist import HandDirection, orient
from kinesic.ik.box_lm import Box, Errors, descend
from kinesic.ik.scalar3 import (
    IDENTITY,
    Rotation,
    Vector,
    across,
    after,
    distance,
    minus,
    plus,
    rotated,
    turned,
    unit,
    vector,
)
from kinesic.ik.solve import as_floats

NEAR_ENOUGH = 1e-4  # [m] residual and ...
LIKE_ENOUGH = 1e-3  # ... [rad] turn at which the pose is held
PERFECT = 1e-6  # cost of a cell at which the search ends
TOLERANCE = 1e-7  # of the descent: arm lengths and rad together
ALIKE = 0.05  # [rad] distance of postures that need no second descent
CANDIDATES = 12  # cells that are refined, the best first
ORTHONORMAL = 1e-6  # how far R^T R may be from 1


@dataclass(frozen=True, eq=False)
class PoseSolution:
    """The posture found for a pose. An unreachable one is an answer, not an error: read residual and turn."""

    angles: Floats  # (k,) [rad] inside the ranges
    residual: float  # [m] from the hand to the position that was asked
    turn: float  # [rad] between the hand's orientation and the one that was asked
    reached: bool  # within 0.1 mm and 1 mrad
    cells: int  # postures looked at
    rounds: int  # of the descents


def solve_pose(chain: Chain, position: Floats, rotation: Floats, *, start: Floats) -> PoseSolution:
    """Finds a posture that holds the hand in a pose.

    Args:
        chain: the arm.
        position: (3,) [m] of the wrist's centre, in the frame of the chain's base.
        rotation: (3, 3) of the last segment, in the frame of the chain's base.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.

    Returns:
        Angles inside the ranges, and what is left, measured on these angles.

    Raises:
        ValueError: a shape is wrong, a number is not finite, or the matrix is no rotation.
    """
    place, frame = as_floats("position", position, (3,)), _checked(rotation)
    if is_right(chain):
        chain, place = mirror_chain(chain), place * ACROSS
        frame = ACROSS[:, None] * frame * ACROSS
    near = np.clip(as_floats("start", start, chain.rest.shape), chain.lower, chain.upper)
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
        for cell in islice(_distinct(seen), CANDIDATES):
            descent = descend(errors, np.array(cell.angles), box, tolerance=TOLERANCE)
            rounds += descent.rounds
            found = _solution(linkage, target, wanted, descent.angles.tolist())
            best = min(best, found, key=lambda one: one.residual / linkage.farthest + one.turn)
            if best.reached:
                break
    return PoseSolution(best.angles, best.residual, best.turn, best.reached, len(seen), rounds)


def _distinct(seen: Sequence[Cell]) -> Iterator[Cell]:
    """The cells, without those like an earlier one: with the elbow straight all swivels are the same posture."""
    kept: list[Cell] = []
    for cell in seen:
        if all(dist(cell.angles, other.angles) > ALIKE for other in kept):
            kept.append(cell)
            yield cell


def _solution(linkage: Linkage, target: Vector, wanted: Rotation, angles: Sequence[float]) -> PoseSolution:
    rotation, points = linkage.walk(angles, len(linkage.links))
    residual, turn = distance(points[-2], target), float(np.linalg.norm(_turn(rotation, wanted)))
    return PoseSolution(sealed(angles), residual, turn, residual <= NEAR_ENOUGH and turn <= LIKE_ENOUGH, 0, 0)


def _wrist(link: Link, frame: Rotation, wanted: Rotation, near: Sequence[float]) -> tuple[tuple[float, ...], float]:
    """The hand's own angles, held in their ranges, and the turn that they leave [rad]."""
    now = near[link.first :]
    inner = _product(_transposed(frame), wanted)
    ways = _three_turns(link, inner, now) if len(link.pivots) == 3 else [_few_turns(link, frame, wanted, now)]
    held = [tuple(p.held(a, b) for p, a, b in zip(link.pivots, way, now, strict=True)) for way in ways]
    turns = [float(np.linalg.norm(_turn(link.turn(IDENTITY, way), inner))) for way in held]
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


def _errors(linkage: Linkage, target: Vector, wanted: Rotation) -> Errors:
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
        error = np.concatenate([np.array(minus(target, hand)) / size, _turn(rotation, wanted)])
        return error, np.concatenate([moved, table[:, :3]], axis=1).T

    return errors


def _box(linkage: Linkage, near: Sequence[float]) -> Box:
    lower, upper = [pivot.lower for pivot in linkage.pivots], [pivot.upper for pivot in linkage.pivots]
    return Box(sealed(lower), sealed(upper), sealed(near), sealed(linkage.mobility))


def _turn(present: Rotation, wanted: Rotation) -> Floats:
    """(3,) [rad] the shortest turn from one orientation to another: axis times angle, in the base."""
    a, b, c, d, e, f, g, h, i = _product(wanted, _transposed(present))
    axis, twice_cosine = np.array([h - f, c - g, d - b]), a + e + i - 1.0
    twice_sine = float(np.linalg.norm(axis))
    if twice_sine < 1e-12 and twice_cosine < 0.0:
        widest = max(range(3), key=lambda k: (a, e, i)[k])
        return np.pi * np.array(unit(((a + 1.0, b, c), (d, e + 1.0, f), (g, h, i + 1.0))[widest]))
    return axis * (atan2(twice_sine, twice_cosine) / twice_sine if twice_sine > 0.0 else 0.5)


def _travel(turns: Sequence[float], now: Sequence[float]) -> float:
    return sum(abs(turn - angle) for turn, angle in zip(turns, now, strict=True))


def _product(left: Rotation, right: Rotation) -> Rotation:
    a, b, c = (rotated(left, column) for column in (right[0::3], right[1::3], right[2::3]))
    return a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]


def _transposed(r: Rotation) -> Rotation:
    return r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]


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
