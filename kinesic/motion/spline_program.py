"""Solves the programs of a segment: the motion nearest to a desired one, and the least relaxation of its limits.

The control points of one hinge depend on their neighbours alone, so that every program is a band: an interior point
method in the compiled kernel (`kinesic/motion/kernel`) takes time in proportion to the length. Without a compiler
CasADi's PIQP solves the same (`piqp`).
"""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.kernels import Kernel, find_kernel
from kinesic.motion import piqp
from kinesic.motion.bspline import SMOOTHNESS
from kinesic.motion.keys import Keys
from kinesic.motion.segments import Cut, SplineSegment, segments
from kinesic.motion.trajectory import STEP

KERNEL: Kernel = find_kernel("kinesic.motion._kernel")  # which implementation runs
WITHIN = 1.0 + 1e-9  # share of a limit that counts as kept
NO_MORE = 1e-6  # relaxation that counts as none, as precise as PIQP
EASIER = -0.2  # relaxation that need not be lower, where 0 is enough: room in which the search ends early

CLOSENESS = sealed(
    [np.array([1.0, 4.0, 1.0]) / 6, np.sqrt(SMOOTHNESS) * np.array([1.0, -2.0, 1.0]) / STEP**2]
)  # (2, 3) stencils whose squares make up `Grid.closeness`

Beyond = list[tuple[float, SplineSegment]]  # share of the limit that a segment exceeds most, the segment

if KERNEL == "compiled":
    from kinesic.motion import _kernel


@dataclass(frozen=True, eq=False)
class Relaxation:
    """The motion that exceeds the limits of a segment least.

    Gaps longer by a share s let speeds be higher by s, accelerations and duty by 2 s, and jerks by 3 s.
    """

    controls: Floats  # (k + 3,) [rad]
    amount: float  # s, to be added to the limits
    ties: Floats  # (m,) multipliers of what is fixed
    pulls: Floats  # (r,) multipliers of the rows of limits that leave a choice


def nearest_motion(segment: SplineSegment, desired: Floats, limits: Limits) -> Floats | None:
    """Finds the control points (k + 3,) [rad] of a segment that are nearest to a desired motion.

    The optimum without limits is one banded solve; where it keeps the limits it is the optimum with them, too.

    Args:
        segment: of k pieces.
        desired: (k + 1,) [rad] at its knots.
        limits: of all hinges.

    Returns:
        None when the hinge cannot pass its keys in these times.
    """
    controls = nearest_without_limits(segment, desired)
    if segment.grid.largest(controls, limits, segment.hinge) <= WITHIN:
        return controls
    return nearest_within_limits(segment, desired, limits)


def nearest_without_limits(segment: SplineSegment, desired: Floats) -> Floats:
    """Finds the control points (k + 3,) [rad] nearest to a desired motion, whatever the limits are."""
    if segment.still:
        return np.full(segment.grid.size, segment.start)
    return _smooth(segment, segment.grid.closeness_bands, _pull(segment, desired))


def smoothest(segment: SplineSegment) -> Floats:
    """Finds the control points (k + 3,) [rad] of the way through the keys with the least acceleration and jerk."""
    return _smooth(segment, segment.grid.calmness_bands, np.zeros(segment.grid.size))


def nearest_within_limits(segment: SplineSegment, desired: Floats, limits: Limits) -> Floats | None:
    """Finds the same as `nearest_motion` where the optimum without limits is known to exceed them."""
    corridor = segment.corridor(limits, desired)
    if KERNEL == "numpy":
        return piqp.nearest_within_limits(segment, _pull(segment, desired), limits, corridor)
    grid, fixed = segment.grid, segment.fixed
    stencils = grid.stencils(limits, segment.hinge)
    wish = grid.closeness_bands, _pull(segment, desired)
    return _kernel.nearest(fixed.first, fixed.shares, fixed.values, *wish, stencils, *corridor)


def find_free_motion(times: Floats, keys: Keys, limits: Limits, desired: Floats) -> tuple[Floats, Beyond]:
    """Finds the control points (k + 3, n) [rad], and the segments that exceed a limit, each with its share of it.

    Args:
        times: (m,) [s] of the keys.
        keys: that are passed.
        limits: of all hinges.
        desired: (k + 1, n) [rad] at the knots.
    """
    if KERNEL == "numpy":
        return _find_in_python(times, keys, limits, desired)
    places, controls = (times - times[0]) / STEP, np.empty((len(desired) + 2, desired.shape[1]))
    rows = np.array([*vars(limits).values()])
    found = _kernel.free_motion(
        places, keys.angles, keys.keyed, keys.firm, desired, rows, CLOSENESS, STEP, WITHIN, controls
    )
    return controls, [
        (share, SplineSegment.through(keys, hinge, places[keys.own[hinge]], Cut(*begin), Cut(*end), STEP))
        for share, hinge, begin, end in found
    ]


def _find_in_python(times: Floats, keys: Keys, limits: Limits, desired: Floats) -> tuple[Floats, Beyond]:
    controls, beyond = np.empty((len(desired) + 2, desired.shape[1])), []
    for segment in segments(times, keys, STEP):
        own = nearest_without_limits(segment, desired[segment.knots, segment.hinge])
        controls[segment.controls, segment.hinge] = own
        share = segment.grid.largest(own, limits, segment.hinge)
        if share > WITHIN:
            beyond.append((share, segment))
    return controls, beyond


def can_pass(segment: SplineSegment, desired: Floats, limits: Limits) -> bool:
    """Tells whether `nearest_within_limits` would find a motion, in a third of its time."""
    found = relax_limits(segment, limits, desired=desired, easy=EASIER, target=NO_MORE)
    return found is not None and found.amount <= NO_MORE


def relax_limits(
    segment: SplineSegment,
    limits: Limits,
    *,
    easy: float,
    target: float = -np.inf,
    desired: Floats | None = None,
) -> Relaxation | None:
    """Finds the least relaxation of a segment's limits with which it can be passed.

    Args:
        segment: of k pieces.
        limits: of all hinges.
        easy: relaxation, mostly below 0, that need not be lower.
        target: relaxation at which the search may end, with multipliers that tell nothing.
        desired: (k + 1,) [rad] at its knots, a motion as far as which the hinge may swing, beyond its keys.

    Returns:
        None when the program cannot be solved.
    """
    corridor, fixed = segment.corridor(limits, desired), segment.fixed
    if KERNEL == "numpy":
        found = piqp.relax_limits(segment, limits, corridor, easy)
    else:
        stencils = segment.grid.stencils(limits, segment.hinge)
        found = _kernel.relax(fixed.first, fixed.shares, fixed.values, stencils, *corridor, easy, target)
    return None if found is None else Relaxation(*found)


def _smooth(segment: SplineSegment, form: Floats, pull: Floats) -> Floats:
    """Optimum of a quadratic form, given by its bands, under what is fixed."""
    if KERNEL == "numpy":
        return piqp.smooth(segment, form, pull)
    fixed = segment.fixed
    return _kernel.smooth(fixed.first, fixed.shares, fixed.values, form, pull)


def _pull(segment: SplineSegment, desired: Floats) -> Floats:
    """Spreads a desired motion (k + 1,) [rad] to (k + 3,) control points: the linear part of the distance from it."""
    return np.convolve(desired, [1 / 6, 4 / 6, 1 / 6])
