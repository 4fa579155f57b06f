"""Changes that are laid on a motion together, each as much as limits allow it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import ceil

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import WIDTHS, grid
from kinesic.motion.trajectory import EARLY, FEWEST, STEP, Trajectory
from kinesic.planning.secondary.swells import AHEAD, Change

FULL = 1.0 + 1e-9  # share of a limit
WIDEST = max(WIDTHS)  # control points that one limit depends on
LESS = 0.4  # of a change that hinders, before it is left out


def lessened(amounts: Floats, less: Flags) -> Floats:
    """Takes from (c,) amounts where there is to be less: first a part, then the rest."""
    return np.where(less, np.where(amounts == 1.0, LESS, 0.0), amounts)


@dataclass(frozen=True, eq=False)
class _Part:
    """What one change adds to the control points of one hinge."""

    change: int
    rows: slice
    added: Floats  # (r,) [rad]


@dataclass(frozen=True, eq=False)
class Changes:
    """All changes of a motion, each worked out once, however often they are added to it with other amounts."""

    motion: Trajectory  # at rest before its start and after its end
    every: Sequence[Change]  # they begin no sooner than the motion

    @cached_property
    def moved(self) -> Flags:
        """(c, n) which hinges each moves."""
        found: Flags = np.zeros((len(self.every), self.motion.controls.shape[1]), dtype=np.bool_)
        for row, change in zip(found, self.every, strict=True):
            row[list(change.hinges)] = True
        return found

    @cached_property
    def _parts(self) -> Mapping[int, Sequence[_Part]]:
        """Of each hinge that is moved, in the order of the changes."""
        found: dict[int, list[_Part]] = {}
        for k, (change, (rows, added)) in enumerate(zip(self.every, self._rows, strict=True)):
            for hinge, column in zip(change.hinges, added.T, strict=True):
                found.setdefault(hinge, []).append(_Part(k, rows, column))
        return found

    @cached_property
    def _spans(self) -> Indices:
        """(c, 2) the first control point that each moves, and the one after the last."""
        return np.array([(rows.start, rows.stop) for rows, _ in self._rows], dtype=np.intp)

    @cached_property
    def _rows(self) -> Sequence[tuple[slice, Floats]]:
        """The control points that each moves, and by how much (r, h) [rad]."""
        return [self._moved_rows(change) for change in self.every]

    def _moved_rows(self, change: Change) -> tuple[slice, Floats]:
        """What `_rows` has of one."""
        start = self.motion.start
        first = max(FEWEST - 1, int((change.begin - start) / STEP))  # before it the motion is at rest
        last = min(ceil((change.end - start) / STEP) + AHEAD, self._size(change.end) - FEWEST + 1)
        times = np.asarray(start + (np.arange(first, last) - AHEAD) * STEP, dtype=np.float64)
        return slice(first, last), change.added(times)

    def _size(self, end: float) -> int:
        """How many control points there are where the last change is over at an end [s]."""
        return len(self.motion.controls) + max(0, ceil((end - self.motion.end) / STEP - EARLY))

    def _whole_size(self, amounts: Floats) -> int:
        """How many there are with so much (c,) of each."""
        ends = (each.end for each, amount in zip(self.every, amounts.tolist(), strict=True) if amount)
        return self._size(max(ends, default=self.motion.end))

    def _window(self, amounts: Floats, changed: Flags) -> slice:
        """Control points that limits have to be looked at after some changes (c,): elsewhere all is as it was."""
        size, (first, last) = self._whole_size(amounts), self._spans[changed].T
        return slice(max(0, min(int(first.min()), size) - WIDEST), min(int(last.max()) + WIDEST, size))

    def _alone(self, hinges: Indices, window: slice) -> Floats:
        """(h, k) [rad] some control points of some hinges in the motion alone, which rests on after its end."""
        own = self.motion.controls.T[hinges]
        beyond = max(0, window.stop - max(own.shape[1], window.start))
        return np.hstack([own[:, window], np.repeat(own[:, -1:], beyond, axis=1)])

    def _laid(self, hinges: Indices, amounts: Floats, window: slice) -> Floats:
        """(h, k) [rad] the same with so much (c,) of each change."""
        columns, much, first = self._alone(hinges, window), amounts.tolist(), window.start
        for hinge, column in zip(hinges.tolist(), columns, strict=True):
            for part in self._parts.get(hinge, ()):
                begin, end = max(part.rows.start, first), min(part.rows.stop, window.stop)
                if begin < end and (amount := much[part.change]):
                    column[begin - first : end - first] += amount * part.added[begin - part.rows.start :][: end - begin]
        return columns

    def added(self, amounts: Floats) -> Trajectory:
        """The motion with so much (c,) of each change; it goes on until the last of them is over."""
        every = np.arange(self.motion.controls.shape[1])
        controls = self._laid(every, amounts, slice(0, self._whole_size(amounts))).T
        return Trajectory(sealed(np.ascontiguousarray(controls)), self.motion.zero, self.motion.start)

    def within_limits(self, amounts: Floats, changed: Flags, limits: Limits) -> Floats:
        """Finds how much of each change hinges can follow: of given amounts (c,), some of which changed.

        A limit that the motion alone breaks is no reason against what leaves it as it is. Wherever else a limit is
        broken, all changes of the control points on which it depends become less, so that none is broken in the end.
        """
        while np.any(changed):
            hinges, window = np.flatnonzero(self.moved[changed].any(axis=0)), self._window(amounts, changed)
            broken = _broken(self._laid(hinges, amounts, window), self._alone(hinges, window), limits, hinges)
            changed = np.zeros(len(amounts), dtype=np.bool_)
            for hinge, flags in broken.items():
                for part in self._parts[hinge]:
                    begin, end = (max(0, row - window.start) for row in (part.rows.start, part.rows.stop))
                    changed[part.change] |= bool(amounts[part.change] and flags[begin:end].any())
            amounts = lessened(amounts, changed)
        return amounts


def _broken(laid: Floats, alone: Floats, limits: Limits, hinges: Indices) -> dict[int, Flags]:
    """Finds hinges that break a limit which the motion alone keeps, and (k,) which control points take part in that."""
    own = grid(laid.shape[1] - FEWEST + 1, STEP)
    every = own.shares(laid, limits, hinges)
    found: dict[int, Flags] = {}
    for row in np.flatnonzero(np.max([np.abs(share).max(axis=1) for share in every], axis=0) > FULL).tolist():
        flags: Flags = np.zeros(laid.shape[1], dtype=np.bool_)
        before = own.shares(alone[row], limits, int(hinges[row]))
        for width, share, once in zip((1, *WIDTHS), every, before, strict=True):
            over = np.flatnonzero(np.abs(share[row]) > np.maximum(FULL, np.abs(once) + FULL - 1.0))
            flags[over[:, None] + np.arange(width)] = True
        if flags.any():
            found[int(hinges[row])] = flags
    return found
