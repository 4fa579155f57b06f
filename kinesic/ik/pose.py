"""Full hand poses (position and orientation), searched over elbow swivels.

Once the forearm is in place, its twist and the wrist follow from the given orientation (three hinges through one
point). The first posture that violates no range is the answer. If the search finds none, Levenberg-Marquardt goes on
from its best postures, then from postures all over the ranges.
"""

import numpy as np
from msgspec import Struct

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.arm.orientation import orientation_of
from kinesic.ik.scalar3 import unit, vector
from kinesic.ik.solve import as_floats, as_triple

ORTHONORMAL_TOLERANCE = 1e-6  # largest accepted entry of |R^T R - 1| for a rotation matrix R
MAX_GIRDLE_HINGES = 3  # largest number of collar-bone hinges that the kernel supports


class PoseSolution(Struct, frozen=True, eq=False):
    """Solution of a hand pose, with position and orientation errors."""

    angles: Floats  # (k,) [rad] inside the ranges
    residual: float  # [m] from the hand to the requested position
    turn: float  # [rad] between the hand's orientation and the requested one
    reached: bool  # within 0.1 mm and 1 mrad
    cells: int  # evaluated postures
    rounds: int  # total number of Levenberg-Marquardt iterations


def solve_pose(chain: Chain, position: Floats, rotation: Floats, *, start: Floats) -> PoseSolution:
    """Solve for a full hand pose: position and orientation.

    Args:
        chain: the arm.
        position: (3,) [m] of the wrist's centre, in the frame of the chain's base.
        rotation: (3, 3) of the last segment, in the frame of the chain's base.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.

    Returns:
        Angles inside the ranges, and the remaining errors of these angles.

    Raises:
        ValueError: a shape is wrong, a number is not finite, the matrix is no rotation, or the collar bone has more
            than three hinges.
    """
    answer = arm_of(chain).pose(position, rotation, start)
    if answer is None:  # the kernel rejects other types and invalid values
        checked_position, checked_rotation = as_floats("position", position, (3,)), _checked(rotation)
        answer = arm_of(chain).pose(checked_position, checked_rotation, as_floats("start", start, chain.rest.shape))
    if answer is None:
        raise ValueError(f"chain {chain.name} has more than {MAX_GIRDLE_HINGES} hinges before its shoulder")
    return PoseSolution(*answer)


def hold_reach(chain: Chain, reach: Reach, *, start: Floats) -> PoseSolution:
    """Solve for a hand position with pointing and palm directions.

    Args:
        chain: the arm.
        reach: of its hand, with pointing and palm, in the frame of the chain's base. The palm is met as nearly as
            the pointing allows; a swivel is ignored.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.

    Returns:
        Angles inside the ranges, and the remaining errors of these angles.

    Raises:
        ValueError: pointing or palm is missing or they are parallel; a shape is wrong or a number is not finite.
    """
    answer = arm_of(chain).hold(reach.position, reach.pointing, reach.palm, start)
    if answer is not None:
        return PoseSolution(*answer)
    if reach.pointing is None or reach.palm is None:
        missing = "pointing" if reach.pointing is None else "palm"
        raise ValueError(f"reach.{missing} is None; a pose needs pointing and palm (with one of them: best_swivel)")
    pointing, palm = (
        unit(vector(as_triple(f"reach.{name}", direction)))
        for name, direction in (("pointing", reach.pointing), ("palm", reach.palm))
    )
    target_rotation = orientation_of(chain, pointing, palm)
    if target_rotation is None:
        raise ValueError(
            f"reach.pointing {list(pointing)} and reach.palm {list(palm)} are null or parallel; "
            "give directions that are not parallel, such as [1, 0, 0] and [0, 0, -1]"
        )
    return solve_pose(chain, reach.position, np.array(target_rotation).reshape(3, 3), start=start)


def _checked(rotation: Floats) -> Floats:
    matrix = as_floats("rotation", rotation, (3, 3))
    if np.abs(matrix.T @ matrix - np.eye(3)).max() > ORTHONORMAL_TOLERANCE or np.linalg.det(matrix) < 0.0:
        raise ValueError(
            f"rotation is {matrix.tolist()}; its columns must be perpendicular unit vectors, right-handed "
            f"(kinesic.body.rotation.vector_to_rotation makes such a matrix)"
        )
    return matrix
