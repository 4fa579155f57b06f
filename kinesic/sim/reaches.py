"""How far hinges move capsules: what bounds the distance of postures between measured ones."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, Indices
from kinesic.body.skeleton import Capsule, Segment, Skeleton
from kinesic.sim.kinematics import KERNEL

if KERNEL == "compiled":
    from kinesic.sim import _kernel

SHORTEST_REACH = 1e-9  # [m] of a reach that is not none
STRIP, PRODUCT = 128, 300_000  # postures at once, so that arrays stay in the cache; products that stay on one core


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
        reach[joints] += max(far, SHORTEST_REACH)
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


def suspects(angles: Floats, known: Indices, lowest: Floats, reaches: Floats, *, limit: float) -> Indices:
    """Finds postures between known ones that may be nearer to contact than a limit.

    Args:
        angles: (s, n) [rad] of all postures.
        known: (m,) which of them are known, never decreasing; none after the last is looked at.
        lowest: (p, m) [m] distance of each pair in the known ones, or less.
        reaches: (p, n) [m] by which each hinge brings a pair nearer at most, for each radian.
        limit: [m].
    """
    if KERNEL == "compiled":
        near = np.zeros(len(angles), dtype=np.bool_)
        _kernel.suspect(np.ascontiguousarray(angles), known, np.ascontiguousarray(lowest), reaches, limit, near)
        return np.flatnonzero(near)
    unknown = np.ones(known[-1] + 1, dtype=bool)
    unknown[known] = False
    between = np.flatnonzero(unknown)
    after = np.searchsorted(known, between)
    lowest = np.ascontiguousarray(lowest.T)  # whole rows are looked up faster
    near = np.empty(len(between), dtype=np.bool_)
    strip = max(1, min(STRIP, PRODUCT // reaches.size))
    for block in (slice(k, k + strip) for k in range(0, len(between), strip)):
        bounds = []
        for neighbour in (after[block], np.maximum(after[block] - 1, 0)):
            turned = np.abs(angles[between[block]] - angles[known[neighbour]])
            bounds.append(lowest[neighbour] - turned @ reaches.T)
        near[block] = np.maximum(*bounds).min(axis=1) < limit
    return between[near]
