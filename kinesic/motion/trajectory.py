"""Trajectories: joint motion as uniform cubic B-splines with 10 ms knots.

A cubic B-spline and its derivatives lie in the convex hulls of their control points, so that limits on these points
hold at every instant (design, Certificate). Its jerk is constant between knots.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic._kernel import motion as kernel
from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import State

KNOT_INTERVAL = 0.01  # [s] time between two knots
KNOT_TOLERANCE = 1e-6  # [knot intervals] smaller deviations of a time from its knot are ignored
REST_TOLERANCE = 1e-9  # [rad] smaller deviations from the last posture are rounding errors
DERIVATIVE_SCALES = sealed(  # [s^order] powers of the knot interval, which convert differences to derivatives
    [KNOT_INTERVAL**order for order in range(3)]
)
MIN_CONTROLS = 4  # number of control points of one knot interval
SAMPLES_PER_WINDOW = 4096  # times sampled at once, which bounds memory


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Joint angles over time, at rest before start and after end.

    A plan's own time begins with its motion; the time of a motion played by a server is its clock's.
    """

    controls: Floats  # (k + 3, n) [rad] control points of k pieces
    zero: float  # [s] time of the block's zero
    start: float = 0.0  # [s] time of the first knot

    def __getstate__(self) -> dict[str, object]:
        """Return the state for pickling, without cached derivatives."""
        return {"controls": self.controls, "zero": self.zero, "start": self.start}

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        return (len(self.controls) - 3) * KNOT_INTERVAL

    @property
    def end(self) -> float:
        """Performance time of the last knot [s], when motion has ended."""
        return self.start + self.duration

    @cached_property
    def rest_start(self) -> float:
        """Time from which the motion holds its last posture [s].

        It is earlier than the end after an interruption of a long motion.
        """
        moving = np.flatnonzero(np.abs(self.controls - self.controls[-1]).max(axis=1) > REST_TOLERANCE)
        return self.start + (moving[-1] + 1.0) * KNOT_INTERVAL if len(moving) else self.start

    def since(self, time: float) -> "Trajectory":
        """Return the motion that remains after a time.

        A finished motion holds its last posture.

        Args:
            time: [s].
        """
        knots = max(0, int((time - self.start) / KNOT_INTERVAL + KNOT_TOLERANCE))
        remaining = self.controls[knots:]
        if len(remaining) < MIN_CONTROLS:
            remaining = np.repeat(self.controls[-1:], MIN_CONTROLS, axis=0)
        return Trajectory(sealed(remaining), self.zero, self.start + knots * KNOT_INTERVAL)

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Return angles, velocities and accelerations (m, n) at times (m,) [s]."""
        local = times - self.start
        shape = len(times), self.controls.shape[1]
        angles, velocities, accelerations = (np.empty(shape) for _ in range(3))
        kernel.sample(
            np.ascontiguousarray(self.controls),
            local / KNOT_INTERVAL,
            DERIVATIVE_SCALES,
            angles,
            velocities,
            accelerations,
        )
        is_resting = (local < 0.0) | (local > self.duration)
        velocities[is_resting] = 0.0
        accelerations[is_resting] = 0.0
        return angles, velocities, accelerations

    def angles(self, times: Floats) -> Floats:
        """Return the angles (m, n) [rad] at times (m,) [s]."""
        angles = np.empty((len(times), self.controls.shape[1]))
        for rows in (slice(begin, begin + SAMPLES_PER_WINDOW) for begin in range(0, len(times), SAMPLES_PER_WINDOW)):
            angles[rows] = self.sample(times[rows])[0]
        return angles

    def at(self, time: float) -> State:
        """Return angles, velocities and accelerations at one time [s]."""
        angles, velocities, accelerations = self.sample(np.array([time]))
        return State(sealed(angles[0]), sealed(velocities[0]), sealed(accelerations[0]))

    def jerks(self, times: Floats) -> Floats:
        """Return the jerks (m, n) [rad/s^3] at times (m,) [s]."""
        local, pieces = times - self.start, len(self.controls) - 3
        jerks = self._jerks[np.clip((local / KNOT_INTERVAL).astype(np.intp), 0, pieces - 1)]
        jerks[(local < 0.0) | (local > self.duration)] = 0.0
        return np.asarray(jerks)

    @cached_property
    def _jerks(self) -> Floats:
        """Jerk of each knot interval, shape (k, n) [rad/s^3]."""
        return sealed(np.diff(self.controls, 3, axis=0) / KNOT_INTERVAL**3)


def spline_weights(
    places: Floats, pieces: int, order: int = 0
) -> tuple[np.ndarray[tuple[int], np.dtype[np.intp]], Floats]:
    """Return control point indices and weights of a spline or derivative.

    Args:
        places: (m,) knot positions, in steps from the first knot; clipped to the spline.
        pieces: number of knot intervals.
        order: of the derivative, 0 to 2; the weights are those of the derivative's control points.

    Returns:
        (m,) index of the first control point and (m, 4 - order) weights, which sum to 1.
    """
    clipped = np.minimum(np.maximum(places, 0.0), pieces)
    interval = np.minimum(clipped.astype(np.intp), pieces - 1)
    u = clipped - interval
    v = 1.0 - u
    columns: tuple[Floats, ...]
    if order == 0:
        columns = (v**3 / 6, (3 * u**3 - 6 * u**2 + 4) / 6, (3 * v**3 - 6 * v**2 + 4) / 6, u**3 / 6)
    elif order == 1:
        columns = (v**2 / 2, 0.5 + u * v, u**2 / 2)
    else:
        columns = (v, u)
    weights = np.empty((len(interval), len(columns)))
    for k, column in enumerate(columns):  # in a third of the time of np.stack
        weights[:, k] = column
    return interval, weights


def stay(angles: Floats, duration: float = 0.1, *, start: float = 0.0) -> Trajectory:
    """Make a motion that holds one posture.

    Args:
        angles: (n,) [rad].
        duration: [s].
        start: [s].
    """
    return Trajectory(sealed(np.repeat(angles[None, :], round(duration / KNOT_INTERVAL) + 3, axis=0)), 0.0, start)
