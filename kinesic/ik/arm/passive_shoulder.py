"""Passive shoulder: a taut arm pulls the collar bone along (thesis 8.6).

The arm acts as a spring from shoulder to hand, the collar bone as a spring that draws the shoulder back to its rest.
The arm's force grows with its length and with the effort (the target's energy, Fig. 8.6). In balance, the shoulder has
moved by the fraction effort x length / reach towards the place where it helps most.
"""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.mirror import MIRROR_SIGNS, is_right, mirror_chain
from kinesic.ik.scalar3 import Vector, distance, minus, plus, scaled, unit, vector


def carry_shoulder(chain: Chain, target: Floats, effort: float) -> Floats:
    """Return the rest posture with the collar bone turned towards the target.

    Args:
        chain: the arm.
        target: (3,) [m] of the hand, in the frame of the chain's base.
        effort: 0 the shoulder stays .. 1 an outstretched arm takes it along as far as it helps.

    Returns:
        (k,) [rad] inside the ranges: the chain's rest, but for the collar bone.
    """
    if effort <= 0.0:
        return chain.rest
    if is_right(chain):
        return _carried(mirror_chain(chain), vector(target * MIRROR_SIGNS), effort)
    return _carried(chain, vector(target), effort)


def _carried(chain: Chain, target: Vector, effort: float) -> Floats:
    """Return rest angles [rad] with the collar bone turned towards the target."""
    linkage, rest = linkage_of(chain), chain.rest.tolist()
    shoulder = linkage.walk(rest, len(linkage.girdle))[1][-1]
    share = effort * min(1.0, distance(shoulder, target) / linkage.farthest)
    posture = np.array(chain.rest)
    line = unit(minus(target, linkage.origin))
    ends = [linkage.origin]
    for link in linkage.girdle:
        ends.append(plus(ends[-1], scaled(line, link.length)))
    angles, _ = arm_of(chain).extract(ends[1:], rest)  # with the shoulder as near to the target as it comes
    posture[: len(angles)] += share * (np.array(angles) - posture[: len(angles)])
    return sealed(posture)
