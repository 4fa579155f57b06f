"""Hand targets with pointing and palm directions, moving the elbow if needed."""

from math import pi

import numpy as np
from msgspec.structs import replace

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.solve import Solution, solve

SATISFIED_ERROR = 1e-3  # [rad] sum of direction errors below which the elbow is not moved


def best_swivel(
    chain: Chain,
    reach: Reach,
    *,
    start: Floats,
    rest: Floats | None = None,
    max_swivel: float = pi,
) -> Solution:
    """Solve a hand target, swivelling the elbow if direction errors remain.

    Args:
        chain: the arm.
        reach: of its hand, in the frame of the chain's base; a given swivel is not changed.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.
        rest: (k,) [rad] preferred angles for redundant hinges.
        max_swivel: [rad] largest swivel change to either side.

    Returns:
        Solution with the smallest swivel change that satisfies pointing and palm; if there is none, the best compromise
        between errors and swivel change. Collar bone and hand stay as in the result of `solve`.

    Raises:
        ValueError: a shape is wrong or a number is not finite.
    """
    first = solve(chain, reach, start=start, rest=rest)
    if reach.swivel is not None or not first.reached or _direction_error(first) <= SATISFIED_ERROR:
        return first
    home = sealed(np.clip(chain.rest if rest is None else rest, chain.lower, chain.upper))
    pointing, palm = (None if direction is None else sealed(direction) for direction in (reach.pointing, reach.palm))
    angles, residual, pointing_error, palm_error = arm_of(chain).swing(
        sealed(reach.position), pointing, palm, home, first.angles, max_swivel
    )
    turned = replace(first, angles=angles, residual=residual, pointing_error=pointing_error, palm_error=palm_error)
    return turned if _direction_error(turned) < _direction_error(first) else first


def _direction_error(solution: Solution) -> float:
    """Return the sum of pointing and palm errors [rad]."""
    return (solution.pointing_error or 0.0) + (solution.palm_error or 0.0)
