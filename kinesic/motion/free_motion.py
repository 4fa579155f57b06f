"""Finds the motion of all hinges that is nearest to a desired one, whatever the limits, and what is beyond them.

Every hinge is cut where it rests; each segment is one banded solve. The compiled kernel does all of them in one call
(`kinesic/motion/kernel/free_motion.h`), which makes no object for those that keep the limits.
"""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import SMOOTHNESS
from kinesic.motion.keys import Keys
from kinesic.motion.segments import Cut, SplineSegment, segments
from kinesic.motion.spline_program import KERNEL, WITHIN, nearest_without_limits
from kinesic.motion.trajectory import STEP

if KERNEL == "compiled":
    from kinesic.motion import _kernel

CLOSENESS = sealed(
    [np.array([1.0, 4.0, 1.0]) / 6, np.sqrt(SMOOTHNESS) * np.array([1.0, -2.0, 1.0]) / STEP**2]
)  # (2, 3) stencils whose squares make up `Grid.closeness`

Beyond = list[tuple[float, SplineSegment]]  # share of the limit that a segment exceeds most, the segment


def find_free_motion(times: Floats, keys: Keys, limits: Limits, desired: Floats) -> tuple[Floats, Beyond]:
    """Finds the control points (k + 3, n) [rad], and the segments that exceed a limit, each with its share of it.

    Args:
        times: (m,) [s] of the keys.
        keys: that are passed.
        limits: of all hinges.
        desired: (k + 1, n) [rad] at the knots.
    """
    if KERNEL == "numpy":
        return _in_python(times, keys, limits, desired)
    places, controls = (times - times[0]) / STEP, np.empty((len(desired) + 2, desired.shape[1]))
    rows = np.array([*vars(limits).values()])
    found = _kernel.free_motion(
        places, keys.angles, keys.keyed, keys.firm, desired, rows, CLOSENESS, STEP, WITHIN, controls
    )
    return controls, [
        (share, SplineSegment.through(keys, hinge, places[keys.own[hinge]], Cut(*begin), Cut(*end), STEP))
        for share, hinge, begin, end in found
    ]


def _in_python(times: Floats, keys: Keys, limits: Limits, desired: Floats) -> tuple[Floats, Beyond]:
    controls, beyond = np.empty((len(desired) + 2, desired.shape[1])), []
    for segment in segments(times, keys, STEP):
        own = nearest_without_limits(segment, desired[segment.knots, segment.hinge])
        controls[segment.controls, segment.hinge] = own
        share = segment.grid.largest(own, limits, segment.hinge)
        if share > WITHIN:
            beyond.append((share, segment))
    return controls, beyond
