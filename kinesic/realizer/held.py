"""Held postures of gaze shifts, head directions and posture shifts.

Each behaviour of these types holds a value that does not depend on earlier behaviours.

Gaze (role `look`) and posture (role `trunk`) are trunk offsets that add up. In each role the last behaviour determines
the held offset, so that the trunk always ends at rest plus one offset per role. When a block is merged into a running
motion, `held_ramps` removes superseded offsets of the same role from the sum of both motions.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.planning.quick_plan import compute_quintic_duration
from kinesic.planning.setup import Setup
from kinesic.realizer.occupancy import (
    ARM_ROLES,
    MOTION_TOLERANCE,
    Occupancy,
    Overlay,
    Role,
    arm_hinges,
    end_time,
    sort_by_time,
)

HELD_ROLES: tuple[Role, ...] = ("look", "trunk")  # gaze and trunk posture, which are held after a behaviour ends
STEP_DURATION_FACTOR = 1.5  # duration of a change of the held posture / minimum duration
HELD_POSTURE_TOLERANCE = np.radians(1.0)  # [rad] deviation from a held posture above which the client is warned

_Source = Literal["running", "block"]


@dataclass(frozen=True, eq=False)
class HeldRamp:
    """Smooth transition of the trunk between two held postures."""

    change: Floats  # (n,) [rad] offset at the end of the ramp
    begin: float  # [s]
    end: float  # [s]

    def at(self, count: int, lead: int) -> Floats:
        """Sample the ramp's offsets at control points, (count, n) [rad].

        Args:
            count: number of control points.
            lead: number of knots before the start of the motion.
        """
        times = np.asarray((np.arange(count) - lead) * KNOT_INTERVAL, dtype=np.float64)
        return smooth_step(times, self.begin, self.end)[:, None] * self.change


def smooth_step(times: Floats, begin: float, end: float) -> Floats:
    """Return a smooth step from 0 to 1 between two times [s].

    Args:
        times: (m,) [s] at which the step is sampled.
        begin: [s] start of the step.
        end: [s] end of the step.
    """
    return minimum_jerk((times - begin) / max(end - begin, KNOT_INTERVAL))


def trunk_hinges(robot: Robot) -> Flags:
    """Return a mask (n,) of the hinges outside of both arms."""
    hinges = np.ones(len(robot.skeleton.hinges), dtype=np.bool_)
    for role in ARM_ROLES:
        hinges[list(arm_hinges(role, robot))] = False
    return hinges


def last_held(role: Role, occupancy: Iterable[Occupancy], hinges: Flags) -> Floats:
    """Return the last held trunk offset (n,) [rad] of a role.

    It is zero for hinges outside of `hinges`.

    Of occupancies with the same end, the last one counts.
    """
    holding = sort_by_time((entry for entry in occupancy if entry.holds(role)), end_time)
    last = holding[-1].offset if holding else None
    return np.zeros(len(hinges)) if last is None else np.where(hinges, last, 0.0)


def held_posture(occupancy: Sequence[Occupancy], robot: Robot) -> Floats:
    """Return the rest posture plus held gaze and trunk offsets, (n,) [rad]."""
    skeleton, hinges = robot.skeleton, trunk_hinges(robot)
    total = skeleton.rest + sum((last_held(role, occupancy, hinges) for role in HELD_ROLES), np.zeros(len(hinges)))
    return np.asarray(np.clip(total, skeleton.lower, skeleton.upper))


def offset_to_held_posture(controls: Floats, occupancy: Sequence[Occupancy], robot: Robot) -> Floats:
    """Return the offset (n,) [rad] from motion end to held posture.

    Args:
        controls: (k + 3, n) [rad] control points of the motion.
        occupancy: occupancies of all its behaviours.
        robot: robot; the offset is 0 for its arms.
    """
    return np.where(trunk_hinges(robot), held_posture(occupancy, robot) - controls[-1], 0.0)


def add_step_to_held_posture(controls: Floats, occupancy: Sequence[Occupancy], robot: Robot) -> Floats:
    """Add a smooth step to a motion, up to the held posture.

    The step coincides with the last holding behaviour; without one, the whole motion is shifted.

    Args:
        controls: (k + 3, n) [rad] control points; occupancy times count from their first knot.
        occupancy: occupancies of all behaviours of the motion.
        robot: robot whose trunk is changed.
    """
    change = offset_to_held_posture(controls, occupancy, robot)
    if np.abs(change).max() <= MOTION_TOLERANCE:
        return controls
    holding = [entry for entry in occupancy if any(entry.holds(role) for role in HELD_ROLES)]
    if not holding:
        return np.asarray(controls + change)
    last = max(holding, key=lambda entry: entry.end)
    return np.asarray(controls + HeldRamp(change, last.begin, last.ready).at(len(controls), lead=3))


def with_superseded_hinges(
    performed: Sequence[Occupancy], others: Sequence[Occupancy], robot: Robot
) -> list[Occupancy]:
    """Add the trunk hinges of superseded behaviours to the superseding ones."""
    hinges = trunk_hinges(robot)
    return [
        replace(
            entry,
            hinges=np.any([entry.hinges, *(hinges & other.hinges for other in _superseded(entry, others))], axis=0),
        )
        for entry in performed
    ]


def _superseded(entry: Occupancy, others: Sequence[Occupancy]) -> list[Occupancy]:
    return [other for other in others if any(other.holds(role) for role in entry.roles & set(HELD_ROLES))]


def end_warnings(
    controls: Floats, performed: Sequence[Occupancy], others: Sequence[Occupancy], robot: Robot
) -> list[tuple[str, str]]:
    """Return warnings on held postures that exceed a joint's range.

    Args:
        controls: (k + 3, n) [rad] control points of the merged motion.
        performed: behaviours of the block.
        others: other behaviours of the motion.
        robot: robot whose trunk is checked.
    """
    holding = [entry for entry in performed if any(entry.holds(role) for role in HELD_ROLES)]
    if not holding:
        return []
    hinges, everything = trunk_hinges(robot), (*others, *performed)
    total = robot.skeleton.rest + sum(last_held(role, everything, hinges) for role in HELD_ROLES)
    away = np.where(hinges, np.abs(controls[-1] - total), 0.0)
    worst = int(away.argmax())
    if away[worst] <= HELD_POSTURE_TOLERANCE:
        return []
    joint = robot.skeleton.names[worst]
    far = f"{np.degrees(away[worst]):.0f} deg"
    text = f"ends {far} off its held posture: with the postures of other behaviours, {joint} would exceed its range"
    return [(entry.behaviour, text) for entry in holding[-1:]]


def held_ramps(work: Overlay, setup: Setup, limits: Limits) -> list[HeldRamp]:
    """Return the trunk ramps that remove angles held by superseded behaviours.

    Args:
        work: block and running motion.
        setup: setup with the robot.
        limits: limits of its hinges.
    """
    hinges = trunk_hinges(setup.robot)
    stated = [last_held(role, work.holding, hinges) for role in HELD_ROLES]
    # The remainder stems from sums that were cut by limits.
    unexplained = np.where(hinges, work.base[-1] - setup.robot.skeleton.rest - sum(stated), 0.0)
    ramps: list[HeldRamp] = []
    for role in HELD_ROLES:
        if any(role in entry.roles for entry in work.performed):
            ramps += _Succession(work, role, hinges, unexplained, limits).ramps()
            unexplained = np.zeros(len(hinges))
    return ramps


@dataclass(frozen=True, eq=False)
class _Succession:
    """Successive gaze or posture behaviours, with the trunk ramps between them."""

    work: Overlay
    role: Role
    hinges: Flags  # (n,) trunk hinges
    unexplained: Floats  # (n,) [rad] end of the running motion minus the sum of all held offsets
    limits: Limits

    def ramps(self) -> list[HeldRamp]:
        """Return the trunk ramps between held offsets, in behaviour order.

        The sum of both motions contains the held values of both. After a holding behaviour only its value may remain;
        during a returning behaviour, no value of the other motion. A behaviour that begins before another has returned
        takes over from it.
        """
        shown = {"running": self._value_before, "block": np.zeros(len(self.hinges))}
        desired, level = shown["running"], np.zeros(len(self.hinges))
        steps: list[HeldRamp] = []
        back: HeldRamp | None = None  # ramp after a returning behaviour
        for entry, source in self._behaviours:
            if back is not None and entry.begin >= back.end:
                steps, level = [*steps, back], level + back.change
            back = None
            if entry.offset is not None:
                desired = shown[source] = self._value(entry)
                steady = desired - shown["running"] - shown["block"]
                steps, level = [*steps, self._step(entry, source, steady - level)], steady
            else:
                steady = desired - shown["running"] - shown["block"]
                during = -shown["block" if source == "running" else "running"]
                steps, level = [*steps, self._step(entry, source, during - level)], during
                back = self._step_back(entry, steady - level)
        return steps if back is None else [*steps, back]

    @cached_property
    def _running(self) -> list[Occupancy]:
        """Running behaviours with this role, sorted by time."""
        return sort_by_time((entry for entry in self.work.holding if self.role in entry.roles), _times)

    @cached_property
    def _behaviours(self) -> list[tuple[Occupancy, _Source]]:
        """Running and new behaviours with their sources, sorted by time.

        New behaviours follow running ones of the same time. Running behaviours that are ready before the block's first
        behaviour are left out.
        """
        block_behaviours: list[tuple[Occupancy, _Source]] = [
            (entry, "block") for entry in self.work.performed if self.role in entry.roles
        ]
        first = min(entry.ready for entry, _ in block_behaviours)
        coming: list[tuple[Occupancy, _Source]] = [
            (entry, "running") for entry in self._running if entry.ready >= first
        ]
        return sort_by_time((*coming, *block_behaviours), lambda pair: _times(pair[0]))

    @cached_property
    def _value_before(self) -> Floats:
        """Trunk offset (n,) [rad] held by the running motion at block start."""
        coming = {id(entry) for entry, _ in self._behaviours}
        before = [entry for entry in self._running if entry.offset is not None and id(entry) not in coming]
        if before:
            return self._value(before[-1])
        return self.unexplained if not any(entry.is_held for entry in self._running) else np.zeros(len(self.hinges))

    def _value(self, entry: Occupancy) -> Floats:
        """Return the trunk offset (n,) [rad] that a behaviour holds."""
        value = np.zeros(len(self.hinges)) if entry.offset is None else np.where(self.hinges, entry.offset, 0.0)
        holding = [other for other in self._running if other.is_held]
        return value + self.unexplained if holding and entry is holding[-1] else value

    def _step(self, entry: Occupancy, source: _Source, change: Floats) -> HeldRamp:
        """Return the ramp to a held trunk posture as a behaviour starts."""
        begin = entry.begin if source != "running" else max(entry.begin, self._begin)
        return HeldRamp(change, begin, max(entry.ready, begin + self._least(change)))

    def _step_back(self, entry: Occupancy, change: Floats) -> HeldRamp:
        """Return the ramp from a held trunk posture as a behaviour ends."""
        return HeldRamp(change, min(entry.relax, entry.end - self._least(change)), entry.end)

    @cached_property
    def _begin(self) -> float:
        """Start [s] of the block's first behaviour with this role."""
        return min(entry.begin for entry, source in self._behaviours if source != "running")

    def _least(self, change: Floats) -> float:
        """Return the minimum duration [s] of a transition between held postures."""
        return STEP_DURATION_FACTOR * max(
            compute_quintic_duration(float(angle), self.limits, hinge) for hinge, angle in enumerate(change)
        )


def _times(entry: Occupancy) -> tuple[float, float, float]:
    return entry.ready, entry.relax, entry.end
