"""Compares a motion with its limits at 1 kHz."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import TINY, WIDTHS, grid
from kinesic.motion.trajectory import KERNEL, STEP, Trajectory, spline_weights

if KERNEL == "compiled":
    from kinesic.motion import _kernel

CHECK_RATE = 1000  # [Hz]
CHUNK = 128  # pieces at once, so that the arrays stay in the cache
INSTANTS = np.linspace(0.0, 1.0, round(CHECK_RATE * STEP) + 1)  # of every piece, the same as it is uniform
SHARES = tuple(spline_weights(INSTANTS, 1, order)[1] for order in range(3))  # (s, 4 - order) of the control points
QUANTITIES = ("position", "speed", "acceleration", "jerk", "duty")
SCALES = sealed([STEP**order for order in range(4)])  # of a derivative


@dataclass(frozen=True, eq=False)
class Peak:
    """The largest share of one limit that each hinge takes."""

    ratios: Floats  # (n,) of the limit
    time: float  # [s] performance time of the largest of all hinges

    @property
    def hinge(self) -> int:
        """Whose share is the largest."""
        return int(self.ratios.argmax())


@dataclass(frozen=True, eq=False)
class Peaks:
    """How near a motion comes to its limits."""

    shares: Mapping[str, Peak]  # position, speed, acceleration, jerk, duty
    rms_jerk: float  # [rad/s^3] over all hinges and the whole motion


def check_limits(trajectory: Trajectory, limits: Limits) -> Peaks:
    """Compares a motion with its limits.

    Position counts from the middle of the range, so that 1 is a stop; duty is what the drive needs at most for this
    speed and acceleration, whatever the posture, over what it may give.

    Args:
        trajectory: the motion.
        limits: of the same hinges.
    """
    pieces, hinges = len(trajectory.controls) - 3, len(limits.lower)
    if KERNEL == "compiled":
        return _search(trajectory.controls, limits)
    found: dict[str, Peak] = {}
    squares = 0.0
    for begin in range(0, pieces, CHUNK):
        points = [_derived(trajectory.controls[begin : begin + CHUNK + 3], order) for order in range(4)]
        squares += float(np.einsum("kn,kn->", points[3], points[3]))
        for name, values in _ratios(points, limits):
            found[name] = _larger(found.get(name), values, STEP * begin)
    return Peaks(MappingProxyType(found), float(np.sqrt(squares / pieces / hinges)))


def _search(controls: Floats, limits: Limits) -> Peaks:
    """Does the same with the kernel, which looks only at pieces that may hold a peak."""
    middle, half = (limits.upper + limits.lower) / 2, (limits.upper - limits.lower) / 2
    pulled, driven = limits.inertial / limits.duty, limits.viscous / limits.duty
    bounds = np.stack([middle, half, limits.speed, limits.acceleration, limits.jerk, pulled, driven])
    *rows, squares = _kernel.peaks(np.ascontiguousarray(controls), SCALES, bounds, SHARES)
    found: dict[str, Peak] = {}
    for name, ratios, pieces, instants in zip(QUANTITIES, *(row.reshape(-1, len(middle)) for row in rows), strict=True):
        worst = min(np.flatnonzero(ratios == ratios.max()), key=lambda hinge: pieces[hinge] // CHUNK)
        begin, instant = CHUNK * (int(pieces[worst]) // CHUNK), float(INSTANTS[int(instants[worst])])
        found[name] = Peak(sealed(ratios), STEP * begin + STEP * (int(pieces[worst]) - begin + instant))
    return Peaks(MappingProxyType(found), float(np.sqrt(squares / (len(controls) - 3) / len(middle))))


def find_beyond(controls: Floats, before: Floats, limits: Limits, hinges: Indices, *, full: float) -> Flags:
    """Finds where a motion breaks limits that another one keeps.

    Args:
        controls: (h, k) [rad] control points of some hinges.
        before: (h, k) [rad] those of the other motion.
        limits: of all hinges.
        hinges: (h,) which ones they are.
        full: share of a limit that counts as broken.

    Returns:
        (h, k) which control points take part in that.
    """
    found: Flags = np.zeros(controls.shape, dtype=np.bool_)
    if KERNEL == "compiled":
        now, then, bounds = (np.ascontiguousarray(each) for each in (controls, before, _bounds(limits)[:, hinges]))
        _kernel.beyond(now, then, SCALES[1:], bounds, full, found)
        return found
    own = grid(controls.shape[1] - 3, STEP)
    every = zip((1, *WIDTHS), own.shares(controls, limits, hinges), own.shares(before, limits, hinges), strict=True)
    for width, share, once in every:
        over = np.abs(share) > np.maximum(full, np.abs(once) + full - 1.0)
        for k in range(width):
            found[:, k : k + over.shape[1]] |= over
    return found


@lru_cache(maxsize=16)
def _bounds(limits: Limits) -> Floats:
    """(8, n) what the shares of limits are made of."""
    middle, half = (limits.upper + limits.lower) / 2, np.maximum(limits.upper - limits.lower, TINY) / 2
    rows = (limits.speed, limits.acceleration, limits.jerk, limits.inertial, limits.viscous)
    return sealed(np.stack([middle, half, *rows, grid(1, STEP).duty(limits)]))


def _derived(controls: Floats, order: int) -> Floats:
    points: Floats = np.diff(controls, order, axis=0) / STEP**order
    return points


def _ratios(points: list[Floats], limits: Limits) -> Iterator[tuple[str, Floats]]:
    """(s, k, n) each quantity over its limit, at s instants of k pieces.

    A spline of scaled control points is the scaled spline: what is scaled is short.
    """
    angles, speeds, accelerations, jerks = points
    middle, half = (limits.upper + limits.lower) / 2, (limits.upper - limits.lower) / 2
    yield "position", _instants((angles - middle) / half, 0)
    yield "speed", _instants(speeds / limits.speed, 1)
    yield "acceleration", _instants(accelerations / limits.acceleration, 2)
    yield "jerk", (jerks / limits.jerk)[None]
    duty = _instants(limits.inertial / limits.duty * accelerations, 2)
    duty += _instants(limits.viscous / limits.duty * speeds, 1)
    yield "duty", duty


def _instants(points: Floats, order: int) -> Floats:
    """(s, k, n) derivative of a spline at s instants of its k pieces, from its control points."""
    pieces = len(points) - 3 + order
    beside = np.stack([points[k : k + pieces] for k in range(4 - order)])
    values: Floats = SHARES[order] @ beside.reshape(4 - order, -1)
    return values.reshape(len(INSTANTS), pieces, -1)


def _larger(before: Peak | None, values: Floats, begin: float) -> Peak:
    """The larger of a peak and the ratios (s, k, n) that begin at a time [s]."""
    flat = values.reshape(len(values), -1)  # long rows, so that the reductions are fast
    edges = np.maximum(flat.max(axis=0), -flat.min(axis=0)).reshape(values.shape[1:])
    ratios = edges.max(axis=0)
    worst = int(ratios.argmax())
    if before is not None and before.ratios.max() >= ratios[worst]:
        return Peak(sealed(np.maximum(before.ratios, ratios)), before.time)
    piece = int(edges[:, worst].argmax())
    instant = INSTANTS[np.abs(values[:, piece, worst]).argmax()]
    both = ratios if before is None else np.maximum(before.ratios, ratios)
    return Peak(sealed(both), begin + STEP * (piece + float(instant)))
