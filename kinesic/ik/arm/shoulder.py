"""The passive shoulder: the arm pulls the collar bone along, the harder the more effort it is moved with (thesis 8.6).

The arm is a spring from shoulder to hand, the collar bone a spring that draws the shoulder back to its rest. The
arm's force grows with its length and with the effort (the target's energy, Fig. 8.6); where both balance, the shoulder
has gone the share effort x length / reach of its way to where it helps most.
"""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.ik.arm.hinges import extract
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.mirror import ACROSS, is_right, mirror_chain
from kinesic.ik.scalar3 import Vector, distance, minus, plus, scaled, unit, vector


def carry_shoulder(chain: Chain, target: Floats, effort: float) -> Floats:
    """The posture that the collar bone rests in while its hand is at a target.

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
        return _carried(mirror_chain(chain), vector(target * ACROSS), effort)
    return _carried(chain, vector(target), effort)


def _carried(chain: Chain, target: Vector, effort: float) -> Floats:
    """`carry_shoulder` for an arm on the left or in the middle."""
    linkage, rest = linkage_of(chain), chain.rest.tolist()
    ends = [linkage.origin]
    line = unit(minus(target, linkage.origin))
    for link in linkage.girdle:
        ends.append(plus(ends[-1], scaled(line, link.length)))
    shoulder = linkage.walk(rest, len(linkage.girdle))[1][-1]
    share = effort * min(1.0, distance(shoulder, target) / linkage.farthest)
    posture = np.array(chain.rest)
    helpful = np.array(extract(linkage, ends[1:], rest).angles)
    posture[: len(helpful)] += share * (helpful - posture[: len(helpful)])
    return sealed(posture)
