"""Quadratic and linear programs for one segment's control points.

The control points of one hinge depend on their neighbours alone, so that every program is a band: an interior point
method in the compiled kernel (`kinesic/motion/kernel`) takes time in proportion to the length.
"""

from dataclasses import dataclass

import numpy as np

from kinesic._kernel import motion as kernel
from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import ACCELERATION_WEIGHT
from kinesic.motion.keys import Keys
from kinesic.motion.segments import RestPoint, SplineSegment
from kinesic.motion.trajectory import KNOT_INTERVAL

KEPT_RATIO = 1.0 + 1e-9  # largest limit ratio of a motion that keeps its limits
FEASIBLE_RELAXATION = 1e-6  # largest relaxation of a feasible segment, the tolerance of PIQP
EASY_RELAXATION = -0.2  # relaxation (< 0: tighter limits) at which the search ends, as a motion surely exists

CLOSENESS_STENCILS = sealed(
    [np.array([1.0, 4.0, 1.0]) / 6, np.sqrt(ACCELERATION_WEIGHT) * np.array([1.0, -2.0, 1.0]) / KNOT_INTERVAL**2]
)  # (2, 3) stencils whose squares make up `Grid.closeness_bands`

ExceedingSegments = list[tuple[float, SplineSegment]]  # largest limit ratio, segment


@dataclass(frozen=True, eq=False)
class Relaxation:
    """Motion with the smallest violation of a segment's limits.

    Gaps longer by a fraction s permit velocities higher by s, accelerations and duty by 2 s, and jerks by 3 s.
    """

    controls: Floats  # (k + 3,) [rad]
    amount: float  # s, to be added to the limits
    fixed_multipliers: Floats  # (m,) of the fixed equations
    limit_multipliers: Floats  # (r,) of the free rows of limits


def nearest_motion(segment: SplineSegment, desired: Floats, limits: Limits) -> Floats | None:
    """Return control points nearest to desired motion within limits, or None.

    The optimum without limits is one banded solve; where it keeps the limits it is the optimum with them, too.

    Args:
        segment: of k pieces.
        desired: (k + 1,) [rad] at its knots.
        limits: of all hinges.

    Returns:
        None when the hinge cannot pass its keys in these times.
    """
    controls = nearest_without_limits(segment, desired)
    if segment.grid.largest_limit_ratio(controls, limits, segment.hinge) <= KEPT_RATIO:
        return controls
    return nearest_within_limits(segment, desired, limits)


def nearest_without_limits(segment: SplineSegment, desired: Floats) -> Floats:
    """Return control points nearest to a desired motion, without limits.

    Of shape (k + 3,) [rad].
    """
    if segment.is_still:
        return np.full(segment.grid.size, segment.start)
    return _minimise(segment, segment.grid.closeness_bands, _linear_part(segment, desired))


def smoothest(segment: SplineSegment) -> Floats:
    """Return control points (k + 3,) [rad] with least acceleration and jerk."""
    return _minimise(segment, segment.grid.calmness_bands, np.zeros(segment.grid.size))


def nearest_within_limits(segment: SplineSegment, desired: Floats, limits: Limits) -> Floats | None:
    """Return control points nearest to a desired motion within limits, or None."""
    corridor = segment.corridor(limits, desired)
    grid, fixed = segment.grid, segment.fixed
    stencils = grid.stencils(limits, segment.hinge)
    objective = grid.closeness_bands, _linear_part(segment, desired)
    return kernel.nearest(fixed.first, fixed.weights, fixed.values, *objective, stencils, *corridor)


def find_free_motion(times: Floats, keys: Keys, limits: Limits, desired: Floats) -> tuple[Floats, ExceedingSegments]:
    """Return unlimited control points (k + 3, n), and segments beyond limits.

    Args:
        times: (m,) [s] of the keys.
        keys: of the motion.
        limits: of all hinges.
        desired: (k + 1, n) [rad] at the knots.
    """
    places, controls = (times - times[0]) / KNOT_INTERVAL, np.empty((len(desired) + 2, desired.shape[1]))
    rows = np.array([*vars(limits).values()])
    exceeding = kernel.free_motion(
        places,
        keys.angles,
        keys.keyed,
        keys.is_exact,
        desired,
        rows,
        CLOSENESS_STENCILS,
        KNOT_INTERVAL,
        KEPT_RATIO,
        controls,
    )
    return controls, [
        (
            ratio,
            SplineSegment.through(
                keys, hinge, places[keys.exact_rows[hinge]], RestPoint(*begin), RestPoint(*end), KNOT_INTERVAL
            ),
        )
        for ratio, hinge, begin, end in exceeding
    ]


def can_pass(segment: SplineSegment, desired: Floats, limits: Limits) -> bool:
    """Return whether any motion within limits exists for a segment."""
    relaxation = relax_limits(segment, limits, desired=desired, easy=EASY_RELAXATION, target=FEASIBLE_RELAXATION)
    return relaxation is not None and relaxation.amount <= FEASIBLE_RELAXATION


def relax_limits(
    segment: SplineSegment,
    limits: Limits,
    *,
    easy: float,
    target: float = -np.inf,
    desired: Floats | None = None,
) -> Relaxation | None:
    """Return the smallest relaxation that makes a segment feasible.

    Args:
        segment: of k pieces.
        limits: of all hinges.
        easy: relaxation, mostly below 0, that need not be lower.
        target: relaxation at which the search may end, with meaningless multipliers.
        desired: (k + 1,) [rad] at its knots, a motion that widens the corridor of the hinge.

    Returns:
        None when the program cannot be solved.
    """
    corridor, fixed = segment.corridor(limits, desired), segment.fixed
    stencils = segment.grid.stencils(limits, segment.hinge)
    result = kernel.relax(fixed.first, fixed.weights, fixed.values, stencils, *corridor, easy, target)
    return None if result is None else Relaxation(*result)


def _minimise(segment: SplineSegment, quadratic: Floats, linear: Floats) -> Floats:
    """Minimise a banded quadratic form under the segment's fixed equations."""
    fixed = segment.fixed
    return kernel.smooth(fixed.first, fixed.weights, fixed.values, quadratic, linear)


def _linear_part(segment: SplineSegment, desired: Floats) -> Floats:
    """Return the linear cost term of a desired motion.

    Args:
        segment: of k knot intervals.
        desired: (k + 1,) [rad].

    Returns:
        (k + 3,) over the control points.
    """
    return np.convolve(desired, [1 / 6, 4 / 6, 1 / 6])
