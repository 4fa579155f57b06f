"""Sum of secondary motion offsets, scaled down to fit the limits."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import STENCIL_WIDTHS
from kinesic.motion.limit_check import find_beyond
from kinesic.motion.trajectory import KNOT_INTERVAL, KNOT_TOLERANCE, MIN_CONTROLS, Trajectory
from kinesic.planning.secondary.offset_bumps import CONTROL_LEAD, MotionChange

FULL_LIMIT = 1.0 + 1e-9  # motion value / limit above which the limit counts as violated; above 1 because of rounding
MAX_LIMIT_CONTROLS = max(STENCIL_WIDTHS)  # largest number of control points on which one limit depends
REDUCED_AMOUNT = 0.4  # amount to which a secondary motion beyond limits is reduced, before the motion is dropped
EMPTY_ROW = sealed([])  # empty array for concatenation if there are no offsets


def reduce_amounts(amounts: Floats, reduced: Flags) -> Floats:
    """Reduce flagged amounts (c,) from 1 to `REDUCED_AMOUNT`, then to 0."""
    return np.where(reduced, np.where(amounts == 1.0, REDUCED_AMOUNT, 0.0), amounts)


@dataclass(frozen=True, eq=False)
class _Cells:
    """Contributions of the offsets to single control points, sorted by offset."""

    change: Indices  # (p,) index of the offset
    hinge: Indices  # (p,) index of the hinge
    row: Indices  # (p,) index of the control point
    added: Floats  # (p,) [rad] contribution to the control point


@dataclass(frozen=True, eq=False)
class Changes:
    """Offsets of secondary motion, computed once and scaled by adjustable amounts."""

    motion: Trajectory  # at rest before its start and after its end
    offsets: Sequence[MotionChange]  # offsets that start no earlier than the motion

    @cached_property
    def moved(self) -> Flags:
        """Whether each offset moves each hinge, (c, n)."""
        moved: Flags = np.zeros((len(self.offsets), self.motion.controls.shape[1]), dtype=np.bool_)
        changes, hinges, _ = self._parts.T
        moved[changes, hinges] = True
        return moved

    @cached_property
    def _parts(self) -> Indices:
        """Offset index, hinge index and control point count, (h, 3).

        There is one row for each hinge that an offset moves.
        """
        counts = (self._spans[:, 1] - self._spans[:, 0]).tolist()
        rows = ((k, hinge, counts[k]) for k, change in enumerate(self.offsets) for hinge in change.hinges)
        return np.array([*rows], dtype=np.intp).reshape(-1, 3)

    @cached_property
    def _cells(self) -> _Cells:
        """Contributions of all offsets at full amount to single control points."""
        change, hinge, count = self._parts.T
        row = np.arange(count.sum()) + np.repeat(self._spans[change, 0] - (np.cumsum(count) - count), count)
        added = np.concatenate([EMPTY_ROW, *(columns_of_motion.ravel(order="F") for columns_of_motion in self._rows)])
        return _Cells(np.repeat(change, count), np.repeat(hinge, count), row, added)

    @cached_property
    def _spans(self) -> Indices:
        """Control-point range (c, 2) of each offset, end excluded."""
        (begins, ends), start = self._times.T, self.motion.start
        first = np.maximum(
            MIN_CONTROLS - 1, ((begins - start) / KNOT_INTERVAL).astype(np.intp)
        )  # before, the motion is at rest
        last = np.minimum(
            np.ceil((ends - start) / KNOT_INTERVAL) + CONTROL_LEAD, self._sizes - MIN_CONTROLS + 1
        ).astype(np.intp)
        return np.stack([first, np.maximum(first, last)], axis=1)

    @cached_property
    def _times(self) -> Floats:
        """Start and end of each offset, (c, 2) [s]."""
        return np.array([(change.begin, change.end) for change in self.offsets]).reshape(-1, 2)

    @cached_property
    def _sizes(self) -> Floats:
        """Number of control points (c,) that the motion needs for each offset."""
        beyond = np.ceil((self._times[:, 1] - self.motion.end) / KNOT_INTERVAL - KNOT_TOLERANCE)
        return len(self.motion.controls) + np.maximum(0.0, beyond)

    @cached_property
    def _rows(self) -> Sequence[Floats]:
        """Angles (r, h) [rad] that each offset adds to control points."""
        times: Floats = np.asarray(
            self.motion.start + (np.arange(self._original_controls.shape[1]) - CONTROL_LEAD) * KNOT_INTERVAL
        )
        spans = self._spans.tolist()
        return [change.added(times[first:last]) for change, (first, last) in zip(self.offsets, spans, strict=True)]

    def _whole_size(self, amounts: Floats) -> int:
        """Return the number of control points of the motion with scaled offsets.

        Args:
            amounts: (c,) scale of each offset; only positive ones lengthen the motion.
        """
        return int(self._sizes[amounts > 0.0].max(initial=len(self.motion.controls)))

    def _window(self, amounts: Floats, changed: Flags) -> slice:
        """Return the control points to recheck after some offsets were rescaled."""
        size, (first, last) = self._whole_size(amounts), self._spans[changed].T
        return slice(
            max(0, min(int(first.min()), size) - MAX_LIMIT_CONTROLS), min(int(last.max()) + MAX_LIMIT_CONTROLS, size)
        )

    @cached_property
    def _original_controls(self) -> Floats:
        """Spline control points (n, k) [rad] of the motion without offsets.

        The last one is repeated until all changes are over.
        """
        columns_of_motion = self.motion.controls.T
        beyond = self._whole_size(np.ones(len(self.offsets))) - columns_of_motion.shape[1]
        return np.hstack([columns_of_motion, np.repeat(columns_of_motion[:, -1:], beyond, axis=1)])

    def _summed_controls(self, amounts: Floats) -> Floats:
        """Return the spline control points (n, k) [rad] with scaled offsets added.

        Args:
            amounts: (c,) of each change.
        """
        columns, cells = self._original_controls.copy(), self._cells
        np.add.at(columns.reshape(-1), self._flat_indices, amounts[cells.change] * cells.added)
        return columns

    @cached_property
    def _flat_indices(self) -> Indices:
        """Flat index of each contribution in the control-point array, (p,)."""
        return np.asarray(self._cells.hinge * self._original_controls.shape[1] + self._cells.row)

    def added(self, amounts: Floats) -> Trajectory:
        """Return the motion plus the offsets scaled by amounts (c,).

        It lasts until the last of them is over.
        """
        controls = self._summed_controls(amounts)[:, : self._whole_size(amounts)].T
        return Trajectory(sealed(np.ascontiguousarray(controls)), self.motion.zero, self.motion.start)

    def within_limits(self, amounts: Floats, changed: Flags, limits: Limits) -> Floats:
        """Reduce the offsets' amounts (c,) until the motion keeps its limits.

        A limit that the motion alone violates does not count against changes that leave it unchanged. All changes of
        the control points of a violated limit are reduced together.

        Args:
            amounts: (c,) of each change.
            changed: (c,) whether an amount is new.
            limits: of the hinges.
        """
        while np.any(changed):
            hinges, window = np.flatnonzero(self.moved[changed].any(axis=0)), self._window(amounts, changed)
            violated = np.zeros(self._original_controls.shape, dtype=np.bool_)
            summed, original = (
                offsets[hinges, window] for offsets in (self._summed_controls(amounts), self._original_controls)
            )
            violated[hinges, window] = find_beyond(summed, original, limits, hinges, full=FULL_LIMIT)
            violating = self._cells.change[violated.reshape(-1)[self._flat_indices]]
            changed = (np.bincount(violating, minlength=len(amounts)) > 0) & (amounts > 0.0)
            amounts = reduce_amounts(amounts, changed)
        return amounts
