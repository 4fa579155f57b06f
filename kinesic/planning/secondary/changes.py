"""Changes that are laid on a motion together, each as much as limits allow it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import WIDTHS
from kinesic.motion.limit_check import find_beyond
from kinesic.motion.trajectory import EARLY, FEWEST, STEP, Trajectory
from kinesic.planning.secondary.swells import CONTROL_LEAD, MotionChange

FULL_LIMIT = 1.0 + 1e-9  # share of a limit
MOST_CONTROLS = max(WIDTHS)  # control points that one limit depends on
LESS = 0.4  # of a change that hinders, before it is left out
NO_ROWS = sealed([])


def lessened(amounts: Floats, less: Flags) -> Floats:
    """Takes from (c,) amounts where there is to be less: first a part, then the rest."""
    return np.where(less, np.where(amounts == 1.0, LESS, 0.0), amounts)


@dataclass(frozen=True, eq=False)
class _Cells:
    """The amounts that changes add to single control points, sorted by change."""

    change: Indices  # (p,) whose it is
    hinge: Indices  # (p,)
    row: Indices  # (p,) of the control point
    added: Floats  # (p,) [rad]


@dataclass(frozen=True, eq=False)
class Changes:
    """All changes of a motion, each worked out once, however often they are added to it with other amounts."""

    motion: Trajectory  # at rest before its start and after its end
    every: Sequence[MotionChange]  # they begin no sooner than the motion

    @cached_property
    def moved(self) -> Flags:
        """(c, n) which hinges each moves."""
        found: Flags = np.zeros((len(self.every), self.motion.controls.shape[1]), dtype=np.bool_)
        changes, hinges, _ = self._parts.T
        found[changes, hinges] = True
        return found

    @cached_property
    def _parts(self) -> Indices:
        """(h, 3) every hinge of every change: change, hinge, and how many control points the change moves."""
        counts = (self._spans[:, 1] - self._spans[:, 0]).tolist()
        rows = ((k, hinge, counts[k]) for k, change in enumerate(self.every) for hinge in change.hinges)
        return np.array([*rows], dtype=np.intp).reshape(-1, 3)

    @cached_property
    def _cells(self) -> _Cells:
        """The amounts that all changes add at full size."""
        change, hinge, count = self._parts.T
        row = np.arange(count.sum()) + np.repeat(self._spans[change, 0] - (np.cumsum(count) - count), count)
        added = np.concatenate([NO_ROWS, *(own.ravel(order="F") for own in self._rows)])
        return _Cells(np.repeat(change, count), np.repeat(hinge, count), row, added)

    @cached_property
    def _spans(self) -> Indices:
        """(c, 2) the first control point that each moves, and the one after the last."""
        (begins, ends), start = self._times.T, self.motion.start
        first = np.maximum(FEWEST - 1, ((begins - start) / STEP).astype(np.intp))  # before it the motion is at rest
        last = np.minimum(np.ceil((ends - start) / STEP) + CONTROL_LEAD, self._sizes - FEWEST + 1).astype(np.intp)
        return np.stack([first, np.maximum(first, last)], axis=1)

    @cached_property
    def _times(self) -> Floats:
        """(c, 2) [s] when each begins, and when it is over."""
        return np.array([(change.begin, change.end) for change in self.every]).reshape(-1, 2)

    @cached_property
    def _sizes(self) -> Floats:
        """(c,) how many control points there are where each is over."""
        beyond = np.ceil((self._times[:, 1] - self.motion.end) / STEP - EARLY)
        return len(self.motion.controls) + np.maximum(0.0, beyond)

    @cached_property
    def _rows(self) -> Sequence[Floats]:
        """The (r, h) [rad] by which each change moves its control points."""
        times: Floats = np.asarray(self.motion.start + (np.arange(self._alone.shape[1]) - CONTROL_LEAD) * STEP)
        spans = self._spans.tolist()
        return [change.added(times[first:last]) for change, (first, last) in zip(self.every, spans, strict=True)]

    def _whole_size(self, amounts: Floats) -> int:
        """Counts the control points of the motion with changes of these amounts (c,)."""
        return int(self._sizes[amounts > 0.0].max(initial=len(self.motion.controls)))

    def _window(self, amounts: Floats, changed: Flags) -> slice:
        """Control points that limits have to be looked at after some changes (c,): elsewhere all is as it was."""
        size, (first, last) = self._whole_size(amounts), self._spans[changed].T
        return slice(max(0, min(int(first.min()), size) - MOST_CONTROLS), min(int(last.max()) + MOST_CONTROLS, size))

    @cached_property
    def _alone(self) -> Floats:
        """(n, k) [rad] the motion alone, which rests on after its end until all changes are over."""
        own = self.motion.controls.T
        beyond = self._whole_size(np.ones(len(self.every))) - own.shape[1]
        return np.hstack([own, np.repeat(own[:, -1:], beyond, axis=1)])

    def _laid(self, amounts: Floats) -> Floats:
        """(n, k) [rad] the same with so much (c,) of each change."""
        columns, cells = self._alone.copy(), self._cells
        np.add.at(columns.reshape(-1), self._places, amounts[cells.change] * cells.added)
        return columns

    @cached_property
    def _places(self) -> Indices:
        """(p,) where each cell is in what `_laid` returns, when it is flat."""
        return np.asarray(self._cells.hinge * self._alone.shape[1] + self._cells.row)

    def added(self, amounts: Floats) -> Trajectory:
        """The motion with so much (c,) of each change; it goes on until the last of them is over."""
        controls = self._laid(amounts)[:, : self._whole_size(amounts)].T
        return Trajectory(sealed(np.ascontiguousarray(controls)), self.motion.zero, self.motion.start)

    def within_limits(self, amounts: Floats, changed: Flags, limits: Limits) -> Floats:
        """Finds how much of each change hinges can follow: of given amounts (c,), some of which changed.

        A limit that the motion alone breaks is no reason against what leaves it as it is. Wherever else a limit is
        broken, all changes of the control points on which it depends become less, so that none is broken in the end.
        """
        while np.any(changed):
            hinges, window = np.flatnonzero(self.moved[changed].any(axis=0)), self._window(amounts, changed)
            broken = np.zeros(self._alone.shape, dtype=np.bool_)
            laid, alone = (every[hinges, window] for every in (self._laid(amounts), self._alone))
            broken[hinges, window] = find_beyond(laid, alone, limits, hinges, full=FULL_LIMIT)
            met = self._cells.change[broken.reshape(-1)[self._places]]
            changed = (np.bincount(met, minlength=len(amounts)) > 0) & (amounts > 0.0)
            amounts = lessened(amounts, changed)
        return amounts
