"""Search over the elbow swivel for palm and pointing, in outward steps."""

from collections.abc import Callable
from math import inf, pi

import numpy as np
from msgspec.structs import replace

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain, mirror_reach
from kinesic.ik.pointing import SATISFIED_ERROR, _direction_error
from kinesic.ik.scalar3 import Rotation, vector
from kinesic.ik.solve import Solution

from .shoulder_elbow import place_of
from .solve import hand_directions, solve
from .swivel import bisect_edge
from .swivel_search import Cell, cell_at, present_swivel
from .wrist import direction_errors, orient

Swing = tuple[Floats, float, float | None, float | None]  # angles, residual, errors of pointing and palm

SEARCH_STEPS = 12  # number of swivels tried on each side
SWIVEL_WEIGHT = 0.03  # pointing error [rad] traded per radian of swivel change
BISECTION_STEPS = 8  # number of bisection steps at the boundary
MAX_HAND_OFFSET = 1e-6  # [reach] largest displacement of the hand


def best_swivel(chain: Chain, reach: Reach, *, start: Floats, rest: Floats | None = None, max_swivel: float = pi):
    """Compute the result of `ik.pointing.best_swivel` for valid arguments."""
    first = solve(chain, reach, start=start, rest=rest)
    if reach.swivel is not None or not first.reached or _direction_error(first) <= SATISFIED_ERROR:
        return first
    home = sealed(np.clip(chain.rest if rest is None else rest, chain.lower, chain.upper))
    angles, residual, pointing_error, palm_error = _swing(chain, reach, home, first.angles, max_swivel)
    swung: Solution = replace(
        first, angles=angles, residual=residual, pointing_error=pointing_error, palm_error=palm_error
    )
    return swung if _direction_error(swung) < _direction_error(first) else first


def _swing(chain: Chain, reach: Reach, home: Floats, angles: Floats, max_swivel: float) -> Swing:
    """Search over the elbow swivel from a solved posture [rad]."""
    if is_right(chain):
        chain, reach = mirror_chain(chain), mirror_reach(reach)
    linkage, directions, near = linkage_of(chain), hand_directions(chain, reach), angles.tolist()
    last = linkage.links[-1]

    def hand(frame: Rotation) -> tuple[tuple[float, ...], float]:
        own = orient(last, frame, directions, home[last.first :].tolist())
        return own, sum(direction_errors(last.turn(frame, own), directions).values())

    place, begin = place_of(linkage, near, vector(reach.position)), present_swivel(linkage, near)
    result = _search_swivel(
        linkage, lambda offset: cell_at(linkage, place, begin + offset, hand, near=near), max_swivel
    )
    frame = linkage.walk(result.angles, len(linkage.links) - 1)[0]
    errors = direction_errors(last.turn(frame, result.angles[last.first :]), directions)
    return sealed(result.angles), result.miss, errors.get("pointing"), errors.get("palm")


def _search_swivel(linkage: Linkage, at: Callable[[float], Cell], max_swivel: float) -> Cell:
    """Return the smallest sufficient swivel change, or the best compromise."""

    def fits(cell: Cell) -> bool:
        return cell.miss <= MAX_HAND_OFFSET * linkage.farthest and cell.error <= SATISFIED_ERROR

    best, least = at(0.0), inf
    for step in range(SEARCH_STEPS + 1):
        for side in (1.0, -1.0):
            outside, offset = side * (step - 1) * max_swivel / SEARCH_STEPS, side * step * max_swivel / SEARCH_STEPS
            cell = at(offset)
            if cell.miss > MAX_HAND_OFFSET * linkage.farthest:
                continue
            if fits(cell):
                return bisect_edge(at, outside, offset, cell, fits=fits, rounds=BISECTION_STEPS)
            price = cell.error + SWIVEL_WEIGHT * abs(offset)
            if price < least:
                best, least = cell, price
    return best
