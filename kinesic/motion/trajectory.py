"""Motion as a function of time: uniform cubic B-splines, one per hinge, on a common grid of 10 ms.

A cubic B-spline and its derivatives lie in the convex hulls of their control points, so that limits on these points
hold at every instant (design, Certificate). Its jerk is constant between knots.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import State
from kinesic.kernels import Kernel, find_kernel

KERNEL: Kernel = find_kernel("kinesic.motion._kernel")  # which implementation runs

if KERNEL == "compiled":
    from kinesic.motion import _kernel

STEP = 0.01  # [s] between knots
EARLY = 1e-6  # steps by which a knot may be missed
SCALES = sealed([STEP**order for order in range(3)])  # of a derivative
FEWEST = 4  # control points of a motion: one piece
SAMPLES_PER_WINDOW = 4096  # times that are sampled together where not all that is sampled is kept


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Angles over time; at rest before its start and after its end.

    A plan's own time begins with its motion; what a server plays begins at a time of its clock.
    """

    controls: Floats  # (k + 3, n) [rad] control points of k pieces
    zero: float  # [s] time of the block's zero
    start: float = 0.0  # [s] time of the first knot

    def __getstate__(self) -> dict[str, object]:
        """What another process gets: derivatives are made anew there."""
        return {"controls": self.controls, "zero": self.zero, "start": self.start}

    @property
    def duration(self) -> float:
        """[s]."""
        return (len(self.controls) - 3) * STEP

    @property
    def end(self) -> float:
        """Time from which it rests [s]."""
        return self.start + self.duration

    def since(self, time: float) -> "Trajectory":
        """Returns the motion from the last knot before a time [s] on; one that is over stays where it ended."""
        knots = max(0, int((time - self.start) / STEP + EARLY))
        left = self.controls[knots:]
        if len(left) < FEWEST:
            left = np.repeat(self.controls[-1:], FEWEST, axis=0)
        return Trajectory(sealed(left), self.zero, self.start + knots * STEP)

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Angles, speeds and accelerations, each (m, n), at (m,) times."""
        local = times - self.start
        if KERNEL == "compiled":
            shape = len(times), self.controls.shape[1]
            angles, speeds, accelerations = (np.empty(shape) for _ in range(3))
            _kernel.sample(np.ascontiguousarray(self.controls), local / STEP, SCALES, angles, speeds, accelerations)
        else:
            angles, speeds, accelerations = (self._values(local, order) for order in range(3))
        still = (local < 0.0) | (local > self.duration)
        speeds[still] = 0.0
        accelerations[still] = 0.0
        return angles, speeds, accelerations

    def angles(self, times: Floats) -> Floats:
        """(m, n) at (m,) times: the first part of `sample` alone."""
        found = np.empty((len(times), self.controls.shape[1]))
        for rows in (slice(begin, begin + SAMPLES_PER_WINDOW) for begin in range(0, len(times), SAMPLES_PER_WINDOW)):
            found[rows] = self.sample(times[rows])[0]
        return found

    def at(self, time: float) -> State:
        """The state at one time [s]."""
        angles, speeds, accelerations = self.sample(np.array([time]))
        return State(sealed(angles[0]), sealed(speeds[0]), sealed(accelerations[0]))

    def jerks(self, times: Floats) -> Floats:
        """(m, n) [rad/s^3] at (m,) times; constant between knots."""
        local, pieces = times - self.start, len(self.controls) - 3
        found = self._derivatives[3][np.clip((local / STEP).astype(np.intp), 0, pieces - 1)]
        found[(local < 0.0) | (local > self.duration)] = 0.0
        return np.asarray(found)

    @cached_property
    def _derivatives(self) -> tuple[Floats, ...]:
        """Control points of the motion and of its three derivatives."""
        return tuple(sealed(np.diff(self.controls, order, axis=0) / STEP**order) for order in range(4))

    def _values(self, times: Floats, order: int) -> Floats:
        """(m, n) of one derivative at (m,) times [s] since the start."""
        piece, shares = spline_weights(times / STEP, len(self.controls) - 3, order)
        points = self._derivatives[order]
        values: Floats = shares[:, :1] * points[piece]
        for k in range(1, shares.shape[1]):
            values += shares[:, k : k + 1] * points[piece + k]
        return values


def spline_weights(
    places: Floats, pieces: int, order: int = 0
) -> tuple[np.ndarray[tuple[int], np.dtype[np.intp]], Floats]:
    """By which control points a spline is at some times, and with which shares.

    Args:
        places: (m,) in steps from the first knot; clipped to the spline.
        pieces: of the spline.
        order: of the derivative, 0 to 2: the shares are those of the derivative's own control points.

    Returns:
        (m,) index of the first control point and (m, 4 - order) shares, which sum to 1.
    """
    place = np.minimum(np.maximum(places, 0.0), pieces)
    piece = np.minimum(place.astype(np.intp), pieces - 1)
    u = place - piece
    v = 1.0 - u
    columns: tuple[Floats, ...]
    if order == 0:
        columns = (v**3 / 6, (3 * u**3 - 6 * u**2 + 4) / 6, (3 * v**3 - 6 * v**2 + 4) / 6, u**3 / 6)
    elif order == 1:
        columns = (v**2 / 2, 0.5 + u * v, u**2 / 2)
    else:
        columns = (v, u)
    shares = np.empty((len(piece), len(columns)))
    for k, column in enumerate(columns):  # in a third of the time of np.stack
        shares[:, k] = column
    return piece, shares


def stay(angles: Floats, duration: float = 0.1, *, start: float = 0.0) -> Trajectory:
    """Makes a motion that stays in one posture (n,) [rad] for a duration [s], from a start time [s] on."""
    return Trajectory(sealed(np.repeat(angles[None, :], round(duration / STEP) + 3, axis=0)), 0.0, start)
