"""Held postures of gaze shifts, head directions and posture shifts.

Each of them holds a value that does not depend on what came before.

Looks and postures are two roles of the trunk, and their values add up. Of each role the last behaviour holds its own
value, so that the trunk always ends at rest plus one value of each role. Where a block is laid over a running motion,
`held_ramps` takes out of the sum of both motions whatever another behaviour of the same role has superseded.
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
from kinesic.motion.trajectory import STEP
from kinesic.planning.quick_plan import quintic_duration
from kinesic.planning.setup import Setup
from kinesic.realizer.occupancy import ARMS, STILL, Occupancy, Overlay, Role, arm_hinges

HELD_ROLES: tuple[Role, ...] = ("look", "trunk")
GIVING_WAY = 1.5  # times the minimum time, in which a held posture gives way
END_TOLERANCE = np.radians(1.0)  # [rad] from where a behaviour would end alone, beyond which its sender is warned

_Source = Literal["running", "performed", "left out"]


@dataclass(frozen=True, eq=False)
class HeldRamp:
    """A smooth step of the trunk to another sum of held values."""

    change: Floats  # (n,) [rad]
    begin: float  # [s]
    end: float  # [s]

    def at(self, count: int, lead: int) -> Floats:
        """Sample the step at control points, (count, n) [rad].

        Args:
            count: of control points.
            lead: knots by which the first of them is early.
        """
        times = np.asarray((np.arange(count) - lead) * STEP, dtype=np.float64)
        return rise(times, self.begin, self.end)[:, None] * self.change


def rise(times: Floats, begin: float, end: float) -> Floats:
    """Return a smooth step from 0 to 1 between two times [s].

    Args:
        times: (m,) [s] at which the step is sampled.
        begin: [s] until which it is 0.
        end: [s] from which it is 1.
    """
    return minimum_jerk((times - begin) / max(end - begin, STEP))


def trunk_hinges(robot: Robot) -> Flags:
    """Return the hinges (n,) that belong to no arm."""
    found = np.ones(len(robot.skeleton.hinges), dtype=np.bool_)
    for role in ARMS:
        found[list(arm_hinges(role, robot))] = False
    return found


def last_held(role: Role, occupancy: Iterable[Occupancy], hinges: Flags) -> Floats:
    """Return the last held value (n,) [rad] of a role."""
    last = max((each for each in occupancy if each.holds(role)), key=lambda each: each.end, default=None)
    return np.zeros(len(hinges)) if last is None or last.offset is None else np.where(hinges, last.offset, 0.0)


def held_posture(occupancy: Sequence[Occupancy], robot: Robot) -> Floats:
    """Return the final angles (n,) [rad] of the trunk, with resting arms."""
    skeleton, hinges = robot.skeleton, trunk_hinges(robot)
    total = skeleton.rest + sum((last_held(role, occupancy, hinges) for role in HELD_ROLES), np.zeros(len(hinges)))
    return np.asarray(np.clip(total, skeleton.lower, skeleton.upper))


def lacking_change(controls: Floats, occupancy: Sequence[Occupancy], robot: Robot) -> Floats:
    """Return the offset (n,) [rad] from the final to the held posture.

    Args:
        controls: (k + 3, n) [rad] of the motion.
        occupancy: of all that it does.
        robot: whose trunk counts; the change of the arms is 0.
    """
    return np.where(trunk_hinges(robot), held_posture(occupancy, robot) - controls[-1], 0.0)


def lead_to_held(controls: Floats, occupancy: Sequence[Occupancy], robot: Robot) -> Floats:
    """Add a step that ends a motion in the held posture.

    The step comes with the last behaviour that holds.

    Args:
        controls: (k + 3, n) [rad] from whose first knot the occupancies count.
        occupancy: of all that the motion does.
        robot: whose trunk is changed.
    """
    change = lacking_change(controls, occupancy, robot)
    if np.abs(change).max() <= STILL:
        return controls
    holding = [each for each in occupancy if any(each.holds(role) for role in HELD_ROLES)]
    if not holding:
        return np.asarray(controls + change)
    last = max(holding, key=lambda each: each.end)
    return np.asarray(controls + HeldRamp(change, last.begin, last.ready).at(len(controls), lead=3))


def taking_over(performed: Sequence[Occupancy], others: Sequence[Occupancy], robot: Robot) -> list[Occupancy]:
    """Add the hinges of superseded behaviours to those that supersede them."""
    hinges = trunk_hinges(robot)
    return [
        replace(each, hinges=np.any([each.hinges, *(hinges & other.hinges for other in _same(each, others))], axis=0))
        for each in performed
    ]


def _same(each: Occupancy, others: Sequence[Occupancy]) -> list[Occupancy]:
    return [other for other in others if any(other.holds(role) for role in each.roles & set(HELD_ROLES))]


def end_warnings(
    controls: Floats, performed: Sequence[Occupancy], others: Sequence[Occupancy], robot: Robot
) -> list[tuple[str, str]]:
    """Name behaviours whose held posture exceeds a joint's range.

    Args:
        controls: (k + 3, n) [rad] of the merged motion.
        performed: behaviours of the block.
        others: what else the motion does.
        robot: whose trunk counts.
    """
    holding = [each for each in performed if any(each.holds(role) for role in HELD_ROLES)]
    if not holding:
        return []
    hinges, everything = trunk_hinges(robot), (*others, *performed)
    total = robot.skeleton.rest + sum(last_held(role, everything, hinges) for role in HELD_ROLES)
    away = np.where(hinges, np.abs(controls[-1] - total), 0.0)
    worst = int(away.argmax())
    if away[worst] <= END_TOLERANCE:
        return []
    joint = robot.skeleton.names[worst]
    far = f"{np.degrees(away[worst]):.0f} deg"
    text = f"ends {far} from where it would end alone: with what others hold, {joint} is beyond its range"
    return [(each.behaviour, text) for each in holding[-1:]]


def held_ramps(work: Overlay, setup: Setup, limits: Limits) -> list[HeldRamp]:
    """Find the steps that remove superseded held values.

    Args:
        work: the block and the running motion.
        setup: the robot.
        limits: of its hinges.
    """
    hinges = trunk_hinges(setup.robot)
    stated = [last_held(role, work.holding, hinges) for role in HELD_ROLES]
    unexplained = np.where(hinges, work.base[-1] - setup.robot.skeleton.rest - sum(stated), 0.0)  # as limits cut sums
    found: list[HeldRamp] = []
    for role in HELD_ROLES:
        if any(role in each.roles for each in (*work.performed, *work.dropped)):
            found += _Succession(work, role, hinges, unexplained, limits).ramps()
            unexplained = np.zeros(len(hinges))
    return found


@dataclass(frozen=True, eq=False)
class _Succession:
    """Succession of behaviours of one role, in both motions."""

    work: Overlay
    role: Role
    hinges: Flags  # (n,) of the trunk
    unexplained: Floats  # (n,) [rad] beyond the values that the running motion's behaviours hold
    limits: Limits

    def ramps(self) -> list[HeldRamp]:
        """List the steps, behaviour by behaviour.

        The sum of both motions shows the values of both sides. After a behaviour that holds, only its value is to show;
        during one that goes back, nothing that the other side holds. One that begins before another has gone back takes
        over from it.
        """
        shown = {"running": self._value_before, "own": np.zeros(len(self.hinges))}
        desired, level = shown["running"], np.zeros(len(self.hinges))
        found: list[HeldRamp] = []
        back: HeldRamp | None = None  # after a behaviour that goes back
        for each, source in self._behaviours:
            if back is not None and each.begin >= back.end:
                found, level = [*found, back], level + back.change
            back = None
            side = "running" if source == "running" else "own"
            if each.offset is not None:
                shown[side] = self._value(each)
                desired = desired if source == "left out" else shown[side]
                steady = desired - shown["running"] - shown["own"]
                found, level = [*found, self._step(each, source, steady - level)], steady
            elif source != "left out":
                steady = desired - shown["running"] - shown["own"]
                during = -shown["own" if source == "running" else "running"]
                found, level = [*found, self._step(each, source, during - level)], during
                back = self._step_back(each, steady - level)
        return found if back is None else [*found, back]

    @cached_property
    def _running(self) -> list[Occupancy]:
        """Behaviours of the running motion, in order."""
        return sorted((each for each in self.work.holding if self.role in each.roles), key=_order)

    @cached_property
    def _behaviours(self) -> list[tuple[Occupancy, _Source]]:
        """Behaviours in order, from the first of the block on."""
        own: list[tuple[Occupancy, _Source]] = [(each, "performed") for each in self.work.performed]
        own += [(each, "left out") for each in self.work.dropped]
        own = [(each, source) for each, source in own if self.role in each.roles]
        first = min(each.ready for each, _ in own)
        coming: list[tuple[Occupancy, _Source]] = [(each, "running") for each in self._running if each.ready >= first]
        return sorted((*own, *coming), key=lambda pair: _order(pair[0]))

    @cached_property
    def _value_before(self) -> Floats:
        """Value (n,) [rad] that the running motion holds when the block begins."""
        coming = {id(each) for each, _ in self._behaviours}
        before = [each for each in self._running if each.offset is not None and id(each) not in coming]
        if before:
            return self._value(before[-1])
        return self.unexplained if not any(each.stays for each in self._running) else np.zeros(len(self.hinges))

    def _value(self, each: Occupancy) -> Floats:
        """Value (n,) [rad] that a behaviour shows while it holds."""
        value = np.zeros(len(self.hinges)) if each.offset is None else np.where(self.hinges, each.offset, 0.0)
        holding = [other for other in self._running if other.stays]
        return value + self.unexplained if holding and each is holding[-1] else value

    def _step(self, each: Occupancy, source: _Source, change: Floats) -> HeldRamp:
        """Step that a behaviour makes when it comes."""
        begin = each.begin if source != "running" else max(each.begin, self._begin)
        return HeldRamp(change, begin, max(each.ready, begin + self._least(change)))

    def _step_back(self, each: Occupancy, change: Floats) -> HeldRamp:
        """Step that a behaviour makes when it goes back."""
        return HeldRamp(change, min(each.relax, each.end - self._least(change)), each.end)

    @cached_property
    def _begin(self) -> float:
        """Time [s] at which the block first needs the role."""
        return min(each.begin for each, source in self._behaviours if source != "running")

    def _least(self, change: Floats) -> float:
        """Shortest time [s] in which a held posture gives way."""
        return GIVING_WAY * max(quintic_duration(float(way), self.limits, hinge) for hinge, way in enumerate(change))


def _order(each: Occupancy) -> tuple[float, float, float]:
    return each.ready, each.relax, each.end
