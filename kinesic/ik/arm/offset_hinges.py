"""Arms whose hinges of one joint do not meet in one point: solved as if they did, then polished on the true arm.

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
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.multistart import approach
from kinesic.ik.arm.wrist import orient
from kinesic.ik.scalar3 import distance, dot, rotated, vector
from kinesic.ik.solve import REACHED, Solution, hand_directions, solve

SHORT = 0.2  # of the longest bone: a shorter one within the arm is an offset inside a joint


def nominal(chain: Chain) -> Chain:
    """Gives all hinges of a joint one centre.

    Args:
        chain: the true arm.

    Returns:
        A chain with the same hinges in the same order. A joint with a short bone is joined to the next one; the
        part of the short bone along its neighbours' bones stays. The same chain where no bone is short.
    """
    short = SHORT * float(chain.lengths.max())
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
    """Solves a reach as `solve` does, for an arm whose hinges need not meet.

    Args:
        chain: the true arm, joints with offsets written as two joints with a short bone between them.
        reach: of its hand, in the frame of the chain's base.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.

    Returns:
        Angles inside the ranges and what is left of the reach, measured on the true arm.

    Raises:
        ValueError: a shape is wrong or a number is not finite.
        ConfigError: the nominal arm is none that the solver takes.
    """
    ideal = accept_chain(nominal(chain))
    guess = solve(ideal, reach, start=start)
    linkage, target = linkage_of(chain), vector(reach.position)
    mobility = linkage_of(ideal).mobility
    polished = approach(linkage, target, guess.angles.tolist(), posture=chain.rest.tolist(), mobility=mobility)
    moving = polished.angles
    frame, points = linkage.walk(moving, len(linkage.links) - 1)
    directions = hand_directions(chain, reach)
    angles = (*moving, *orient(linkage.links[-1], frame, directions, chain.rest.tolist()[len(moving) :]))
    hand = linkage.walk(angles, len(linkage.links))[0]
    errors = {
        direction.name: acos(max(-1.0, min(1.0, dot(rotated(hand, direction.own), direction.wanted))))
        for direction in directions
    }
    residual = distance(points[-1], target)
    return structs.replace(
        guess,
        angles=sealed(angles),
        residual=residual,
        pointing_error=errors.get("pointing"),
        palm_error=errors.get("palm"),
        reached=residual <= REACHED,
        iterations=guess.iterations + polished.rounds,
    )
