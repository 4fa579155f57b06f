"""How far hinges move capsules: what bounds the distance of postures between measured ones."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.skeleton import Capsule, Segment, Skeleton

SHORTEST = 1e-9  # [m] of a reach that is not none


def capsule_reach(skeleton: Skeleton, owner: int, capsule: Capsule) -> Floats:
    """Finds how far a capsule's axis moves at most per angle of each hinge.

    Args:
        skeleton: that has the capsule.
        owner: the segment that it is fixed to.
        capsule: in the segment.

    Returns:
        (n,) [m], 0 for hinges that do not move it.
    """
    reach = np.zeros(len(skeleton.hinges))
    segment: Segment | None = skeleton.segments[owner]
    far = max(float(np.linalg.norm(end)) for end in (capsule.start, capsule.end))
    while segment is not None:
        joints = list(skeleton.joints_of((segment.name,)))
        far += 2 * sum(float(np.linalg.norm(skeleton.hinges[joint].at)) for joint in joints)  # they may miss its origin
        reach[joints] += max(far, SHORTEST)
        for coupling in (each for each in skeleton.couplings if each.segment == segment.name):
            reach[coupling.driver] += abs(coupling.ratio) * far
        far += float(np.linalg.norm(segment.origin_in_parent))
        segment = None if segment.parent is None else skeleton.segments[skeleton.segment(segment.parent)]
    return reach


def reaches_of_pairs(turned: Floats, pairs: Sequence[tuple[int, int]]) -> Floats:
    """Finds how far from each hinge the axis of a pair's capsule can be that it turns against the other one.

    Args:
        turned: (c, n) [m] the reach of each capsule.
        pairs: of capsules.

    Returns:
        (p, n) [m].
    """
    first, second = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
    moved = turned > 0.0
    apart: Floats = np.where(moved[first] & moved[second], 0.0, turned[first] + turned[second])
    return apart
