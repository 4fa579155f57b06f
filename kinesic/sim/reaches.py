"""Bounds of the motion of capsules per hinge rotation."""

from collections.abc import Sequence

import numpy as np

from kinesic._kernel import sim as kernel
from kinesic.body.arrays import Floats, Indices
from kinesic.body.skeleton import Capsule, Segment, Skeleton

MIN_REACH = 1e-9  # [m/rad] smallest reach of a hinge that moves a capsule; 0 marks hinges that do not move it


def compute_capsule_reach(skeleton: Skeleton, owner: int, capsule: Capsule) -> Floats:
    """Compute an upper bound of a capsule's motion per hinge angle.

    Args:
        skeleton: Skeleton with the capsule.
        owner: Index of the segment to which the capsule is fixed.
        capsule: Capsule in the frame of the segment.

    Returns:
        (n,) [m/rad], 0 for hinges that do not move it.
    """
    reach = np.zeros(len(skeleton.hinges))
    segment: Segment | None = skeleton.segments[owner]
    radius = max(float(np.linalg.norm(end)) for end in (capsule.start, capsule.end))
    while segment is not None:
        joints = list(skeleton.joints_of((segment.name,)))
        radius += 2 * sum(
            float(np.linalg.norm(skeleton.hinges[joint].at)) for joint in joints
        )  # joint axes need not pass through the segment's origin
        reach[joints] += max(radius, MIN_REACH)
        for coupling in (coupling for coupling in skeleton.couplings if coupling.segment == segment.name):
            reach[coupling.driver] += abs(coupling.ratio) * radius
        radius += float(np.linalg.norm(segment.origin_in_parent))
        segment = None if segment.parent is None else skeleton.segments[skeleton.segment(segment.parent)]
    return reach


def compute_pair_reaches(turned: Floats, pairs: Sequence[tuple[int, int]]) -> Floats:
    """Compute an upper bound of capsule pairs' relative motion per hinge angle.

    Only hinges that move one capsule of a pair relative to the other count.

    Args:
        turned: (c, n) [m/rad] reach of each capsule.
        pairs: Indices of the two capsules of each pair.

    Returns:
        (p, n) [m/rad].
    """
    first, second = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
    moved = turned > 0.0
    relative: Floats = np.where(moved[first] & moved[second], 0.0, turned[first] + turned[second])
    return relative


def suspects(angles: Floats, measured: Indices, lowest: Floats, reaches: Floats, *, limit: float) -> Indices:
    """Find unmeasured postures whose segment distances may be below a limit.

    Args:
        angles: (s, n) [rad] of all postures.
        measured: (m,) non-decreasing indices of measured postures; postures after the last one are ignored.
        lowest: (p, m) [m] distance of each pair in the measured postures, or a lower bound.
        reaches: (p, n) [m/rad] largest approach of each pair per angle of each hinge.
        limit: [m].
    """
    is_near = np.zeros(len(angles), dtype=np.bool_)
    kernel.suspect(np.ascontiguousarray(angles), measured, np.ascontiguousarray(lowest), reaches, limit, is_near)
    return np.flatnonzero(is_near)
