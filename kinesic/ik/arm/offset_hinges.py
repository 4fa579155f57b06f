"""Arms with offset joint axes: nominal solution, then numerical correction.

Such a joint is described as two, with a short bone between them. Closed forms need one centre: the nominal arm
leaves the short bones out. What that moves the hand is small, and Levenberg-Marquardt removes it.
"""

from dataclasses import replace
from math import acos

import numpy as np
from msgspec import structs

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.accepts import accept_chain
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain, mirror_place, mirror_reach
from kinesic.ik.arm.multistart import approach
from kinesic.ik.arm.seeds import seeds
from kinesic.ik.scalar3 import distance, dot, rotated, unit, vector
from kinesic.ik.solve import REACHED_DISTANCE, Solution, solve

OFFSET_BONE_RATIO = 0.2  # bones shorter than this fraction of the longest count as joint offsets


def nominal(chain: Chain) -> Chain:
    """Return the chain with each joint's hinge axes moved to one centre.

    Args:
        chain: the true arm.

    Returns:
        A chain with the same hinges in the same order. A joint with a short bone is joined to the next one; the
        part of the short bone along its neighbours' bones stays. The same chain where no bone is short.
    """
    short = OFFSET_BONE_RATIO * float(chain.lengths.max())
    joints = [chain.joints[0]]
    for joint in chain.joints[1:]:
        before = joints[-1]
        if before.hinges and float(np.linalg.norm(before.bone)) < short:
            along = joint.bone / np.linalg.norm(joint.bone)
            bone = sealed(joint.bone + along * (along @ before.bone))
            joints[-1] = replace(joint, hinges=(*before.hinges, *joint.hinges), bone=bone)
        else:
            joints.append(joint)
    return chain if len(joints) == len(chain.joints) else replace(chain, joints=tuple(joints))


def solve_offset(chain: Chain, reach: Reach, *, start: Floats) -> Solution:
    """Solve a hand target for an arm with offset joint axes.

    Args:
        chain: the true arm, joints with offsets written as two joints with a short bone between them.
        reach: of its hand, in the frame of the chain's base.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.

    Returns:
        Angles inside the ranges and the remaining errors of the true arm.

    Raises:
        ValueError: a shape is wrong or a number is not finite.
        ConfigError: the solver does not accept the nominal arm.
    """
    if is_right(chain):
        solution = _solve_left(mirror_chain(chain), mirror_reach(reach), start)
        return structs.replace(solution, target=mirror_place(solution.target))
    return _solve_left(chain, reach, start)


def _solve_left(chain: Chain, reach: Reach, start: Floats) -> Solution:
    ideal = accept_chain(nominal(chain))
    guess = solve(ideal, reach, start=start)
    arm, linkage, target, rest = arm_of(chain), linkage_of(chain), vector(reach.position), chain.rest.tolist()
    mobility = linkage_of(ideal).mobility
    moving, rounds = approach(arm, seeds(linkage), target, guess.angles.tolist(), posture=rest, mobility=mobility)
    frame, points = linkage.walk(moving, len(linkage.links) - 1)
    directions = [  # in the hand, and in the base
        (unit(vector(inward)), unit(vector(outward)))
        for inward, outward in ((chain.joints[-1].bone, reach.pointing), (chain.palm, reach.palm))
        if outward is not None
    ]
    wrist = arm.orient(
        frame, [hand_direction for hand_direction, _ in directions], [aim for _, aim in directions], rest[len(moving) :]
    )
    angles = (*moving, *wrist)
    hand = linkage.walk(angles, len(linkage.links))[0]
    errors = iter(
        [acos(max(-1.0, min(1.0, dot(rotated(hand, hand_direction), aim)))) for hand_direction, aim in directions]
    )
    residual = distance(points[-1], target)
    return structs.replace(
        guess,
        angles=sealed(angles),
        residual=residual,
        pointing_error=None if reach.pointing is None else next(errors),
        palm_error=None if reach.palm is None else next(errors),
        reached=residual <= REACHED_DISTANCE,
        iterations=guess.iterations + rounds,
    )
