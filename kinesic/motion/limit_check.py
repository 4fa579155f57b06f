"""Check of a motion against its limits at 1 kHz."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from kinesic._kernel import motion as kernel
from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import MIN_RANGE, grid
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory, spline_weights

CHECK_RATE = 1000  # [Hz] sampling rate of the limit check
INTERVALS_PER_GROUP = 128  # knot intervals per group; of equally large peaks, one in the earliest group is reported
SAMPLE_PARAMETERS = np.linspace(
    0.0, 1.0, round(CHECK_RATE * KNOT_INTERVAL) + 1
)  # sample times within a knot interval, 0 to 1
SAMPLE_WEIGHTS = tuple(
    spline_weights(SAMPLE_PARAMETERS, 1, order)[1] for order in range(3)
)  # weights (s, 4 - order) of the control points at the sample times, by order of the derivative
CHECKED_QUANTITIES = (  # limited quantities of a hinge, in the order of check results
    "position",
    "speed",
    "acceleration",
    "jerk",
    "duty",
)
DERIVATIVE_SCALES = sealed(  # [s^order] powers of the knot interval, which convert differences to derivatives
    [KNOT_INTERVAL**order for order in range(4)]
)


@dataclass(frozen=True, eq=False)
class Peak:
    """Largest ratio of each hinge's motion to one kind of limit."""

    ratios: Floats  # (n,) of the limit
    time: float  # [s] performance time of the largest of all hinges

    @property
    def hinge(self) -> int:
        """Index of the hinge with the largest ratio to the limit."""
        return int(self.ratios.argmax())


@dataclass(frozen=True, eq=False)
class Peaks:
    """Largest limit ratios of a motion, with its RMS jerk."""

    by_quantity: Mapping[str, Peak]  # position, speed, acceleration, jerk, duty
    rms_jerk: float  # [rad/s^3] over all hinges and the whole motion


def check_limits(trajectory: Trajectory, limits: Limits) -> Peaks:
    """Compute the largest ratios of a motion to its limits.

    The position ratio counts from the middle of the range, so that 1 is a mechanical stop. The duty ratio is the
    largest duty for this velocity and acceleration in any posture, relative to the permitted duty.

    Args:
        trajectory: the motion.
        limits: of the same hinges.
    """
    controls = trajectory.controls
    middle, half = (limits.upper + limits.lower) / 2, (limits.upper - limits.lower) / 2
    inertial_duty, viscous_duty = limits.inertial / limits.duty, limits.viscous / limits.duty
    bounds = np.stack([middle, half, limits.speed, limits.acceleration, limits.jerk, inertial_duty, viscous_duty])
    *rows, squares = kernel.peaks(np.ascontiguousarray(controls), DERIVATIVE_SCALES, bounds, SAMPLE_WEIGHTS)
    peaks: dict[str, Peak] = {}
    for name, ratios, pieces, samples in zip(
        CHECKED_QUANTITIES, *(row.reshape(-1, len(middle)) for row in rows), strict=True
    ):
        worst = min(np.flatnonzero(ratios == ratios.max()), key=lambda hinge: pieces[hinge] // INTERVALS_PER_GROUP)
        begin, sample = (
            INTERVALS_PER_GROUP * (int(pieces[worst]) // INTERVALS_PER_GROUP),
            float(SAMPLE_PARAMETERS[int(samples[worst])]),
        )
        peaks[name] = Peak(
            sealed(ratios), KNOT_INTERVAL * begin + KNOT_INTERVAL * (int(pieces[worst]) - begin + sample)
        )
    return Peaks(MappingProxyType(peaks), float(np.sqrt(squares / (len(controls) - 3) / len(middle))))


def find_beyond(controls: Floats, before: Floats, limits: Limits, hinges: Indices, *, full: float) -> Flags:
    """Flag control points that violate limits only in the changed motion.

    Args:
        controls: (h, k) [rad] control points of some hinges.
        before: (h, k) [rad] those of the other motion.
        limits: of all hinges.
        hinges: (h,) their indices.
        full: limit ratio that counts as violated.

    Returns:
        (h, k) whether each control point contributes to a violation.
    """
    violates: Flags = np.zeros(controls.shape, dtype=np.bool_)
    arrays = (controls, before, _bounds(limits)[:, hinges])
    current, previous, bounds = (np.ascontiguousarray(array) for array in arrays)
    kernel.beyond(current, previous, DERIVATIVE_SCALES[1:], bounds, full, violates)
    return violates


@lru_cache(maxsize=16)
def _bounds(limits: Limits) -> Floats:
    """Return each hinge's limits as rows for the compiled check, (8, n)."""
    middle, half = (limits.upper + limits.lower) / 2, np.maximum(limits.upper - limits.lower, MIN_RANGE) / 2
    rows = (limits.speed, limits.acceleration, limits.jerk, limits.inertial, limits.viscous)
    return sealed(np.stack([middle, half, *rows, grid(1, KNOT_INTERVAL).duty(limits)]))
