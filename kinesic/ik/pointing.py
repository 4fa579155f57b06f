"""Pointing and palm where the swivel is free: the elbow swings as far as the hand's directions need it."""

from collections.abc import Callable
from math import inf, pi

import numpy as np
from msgspec.structs import replace

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.compiled import KERNEL, arm_of
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain, mirror_reach
from kinesic.ik.arm.shoulder_elbow import place_of
from kinesic.ik.arm.swivel import bisect_edge
from kinesic.ik.arm.swivel_search import Cell, cell_at, present_swivel
from kinesic.ik.arm.wrist import direction_errors, orient
from kinesic.ik.scalar3 import Rotation, vector
from kinesic.ik.solve import Solution, hand_directions, solve
from kinesic.kernels import Kernel

Swing = tuple[Floats, float, float | None, float | None]  # angles, residual, errors of pointing and palm

SATISFIED = 1e-3  # [rad] errors of all directions together that need no search
SEARCH_STEPS = 12  # of the search to either side
PRICE = 0.03  # [rad] of error that a radian of swing has to win
BISECTIONS = 8
OFF = 1e-6  # of the reach: a swing that takes the hand farther off its place does not count


def best_swivel(
    chain: Chain,
    reach: Reach,
    *,
    start: Floats,
    rest: Floats | None = None,
    widest: float = pi,
    kernel: Kernel = KERNEL,
) -> Solution:
    """Solves a reach; where the wrist cannot give the hand its directions, the elbow swings aside.

    Args:
        chain: the arm.
        reach: of its hand, in the frame of the chain's base; with a swivel of its own nothing is searched.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.
        rest: (k,) [rad] of whatever the reach leaves open.
        widest: [rad] that the elbow swings, to either side.
        kernel: which implementation answers; "numpy" is the specification of the other.

    Returns:
        The smallest swing that satisfies pointing and palm; where none does, the one whose errors are least for
        its width. Collar bone and hand stay where `solve` puts them.

    Raises:
        ValueError: a shape is wrong or a number is not finite.
    """
    first = solve(chain, reach, start=start, rest=rest, kernel=kernel)
    if reach.swivel is not None or not first.reached or _left(first) <= SATISFIED:
        return first
    home = sealed(np.clip(chain.rest if rest is None else rest, chain.lower, chain.upper))
    swing = _compiled if kernel == "compiled" else _specified
    angles, residual, pointing_error, palm_error = swing(chain, reach, home, first.angles, widest)
    swung = replace(first, angles=angles, residual=residual, pointing_error=pointing_error, palm_error=palm_error)
    return swung if _left(swung) < _left(first) else first


def _compiled(chain: Chain, reach: Reach, home: Floats, angles: Floats, widest: float) -> Swing:
    pointing, palm = (None if direction is None else sealed(direction) for direction in (reach.pointing, reach.palm))
    return arm_of(chain).swing(sealed(reach.position), pointing, palm, home, angles, widest)


def _specified(chain: Chain, reach: Reach, home: Floats, angles: Floats, widest: float) -> Swing:
    """From a solved posture [rad], with a hand that rests at `home` [rad]."""
    if is_right(chain):
        chain, reach = mirror_chain(chain), mirror_reach(reach)
    linkage, directions, near = linkage_of(chain), hand_directions(chain, reach), angles.tolist()
    last = linkage.links[-1]

    def hand(frame: Rotation) -> tuple[tuple[float, ...], float]:
        own = orient(last, frame, directions, home[last.first :].tolist())
        return own, sum(direction_errors(last.turn(frame, own), directions).values())

    place, begin = place_of(linkage, near, vector(reach.position)), present_swivel(linkage, near)
    found = _swung(linkage, lambda offset: cell_at(linkage, place, begin + offset, hand, near=near), widest)
    frame = linkage.walk(found.angles, len(linkage.links) - 1)[0]
    errors = direction_errors(last.turn(frame, found.angles[last.first :]), directions)
    return sealed(found.angles), found.miss, errors.get("pointing"), errors.get("palm")


def _swung(linkage: Linkage, at: Callable[[float], Cell], widest: float) -> Cell:
    """The smallest swing that satisfies, looked for outward; else the best for its width [rad]."""

    def fits(cell: Cell) -> bool:
        return cell.miss <= OFF * linkage.farthest and cell.error <= SATISFIED

    best, least = at(0.0), inf
    for step in range(SEARCH_STEPS + 1):
        for side in (1.0, -1.0):
            outside, offset = side * (step - 1) * widest / SEARCH_STEPS, side * step * widest / SEARCH_STEPS
            cell = at(offset)
            if cell.miss > OFF * linkage.farthest:
                continue
            if fits(cell):
                return bisect_edge(at, outside, offset, cell, fits=fits, rounds=BISECTIONS)
            price = cell.error + PRICE * abs(offset)
            if price < least:
                best, least = cell, price
    return best


def _left(solution: Solution) -> float:
    """Errors of all directions together [rad]."""
    return (solution.pointing_error or 0.0) + (solution.palm_error or 0.0)
