"""Effects of motion limits on behaviours: shifted sync points and weaker strokes."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import PartName
from kinesic.metrics.arrival import HAND_PARTS, compute_part_paths, measure_stretch
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime, find_limit_met

STROKE_SYNCS = ("strokeStart", "strokeEnd")  # first and last sync point of a stroke
PATH_RATE = 100  # [Hz] sampling rate of desired hand paths
MIN_REPORTED_LOSS = 0.05  # smallest reported loss, as a fraction of a stroke's speed or path
MIN_REPORTED_DEVIATION = 1.0  # [deg] smallest reported RMS deviation of a hinge
POSTURES_PER_WINDOW = 1024  # postures evaluated at once; more need more memory
MAX_REPORTED_HINGES = 3  # deviating hinges listed in a report
MIN_VISIBLE_STROKE = {
    "m": 0.01,
    "m/s": 0.05,
    "deg": 1.0,
    "deg/s": 5.0,
}  # unit -> smallest visible path or speed of a stroke, in this unit


@dataclass(frozen=True)
class SyncShift:
    """Consecutive sync points of a behaviour that shifted by the same time.

    The fields are keys of report.json.
    """

    syncs: tuple[str, ...]
    asked: float  # [s] requested block time of the first sync point
    planned: float  # [s] planned block time of the first sync point
    hinge: str  # limiting hinge; empty if unknown
    quantity: str  # limited quantity
    ratio: float  # required / available time

    @property
    def milliseconds(self) -> int:
        """Planned minus requested time [ms]."""
        return round(1000 * (self.planned - self.asked))


@dataclass(frozen=True)
class StrokeLoss:
    """Peak speed or path length of a stroke, requested and planned.

    The fields are keys of report.json.
    """

    part: PartName
    quantity: str
    unit: str
    asked: float  # requested value
    planned: float

    @property
    def fraction(self) -> float:
        """Lost fraction of the requested speed or length, negative for a gain."""
        return 1.0 - self.planned / self.asked if self.asked else 0.0


@dataclass(frozen=True)
class HingeDeviation:
    """RMS deviation of a hinge's planned motion from the desired one."""

    hinge: str
    degrees: float  # RMS over the motion [deg]


@dataclass(frozen=True)
class ChangedBehaviour:
    """Behaviour that motion limits shifted or weakened."""

    behaviour: str
    moved: tuple[SyncShift, ...]
    losses: tuple[StrokeLoss, ...]
    stroke: bool  # whether the behaviour has a stroke

    @property
    def shift(self) -> float:
        """Largest shift of a sync point [s]."""
        return max((abs(moved.planned - moved.asked) for moved in self.moved), default=0.0)


def find_changes(plan: Plan, times: Floats, paths: Mapping[PartName, Floats]) -> tuple[ChangedBehaviour, ...]:
    """Find behaviours with a shifted sync point or a weaker stroke.

    A stroke is weaker if it lost more than 5 % of its speed or path. The largest shift comes first.

    Args:
        plan: to be compared with its requested motion.
        times: (m,) [s] performance time of the commands.
        paths: planned paths of the parts at these times.
    """
    desired, behaviours = _desired_paths(plan), dict[str, list[SyncTime]]()
    reference, zero = _Paths(times, paths), plan.trajectory.zero
    for sync in plan.syncs:
        behaviours.setdefault(sync.behaviour, []).append(sync)
    changes = []
    for name, syncs in behaviours.items():
        moved = _merge_shifts(
            _sync_shift(sync, plan) for sync in syncs if abs(sync.planned - sync.requested) > SHIFT_TO_WARN
        )
        parts = sorted(plan.keyframes.uses.get(name, frozenset()) & set(paths))
        bounds = _find_stroke_bounds(syncs)
        if bounds and zero + bounds[1].planned > times[-1]:
            parts = []  # a run that stopped before the stroke says nothing about its plan
        losses = tuple(loss for part in parts if bounds for loss in _losses(part, bounds, desired, reference, zero))
        if moved or losses:
            changes.append(ChangedBehaviour(name, moved, losses, stroke=bounds is not None))
    return tuple(sorted(changes, key=lambda changed: -changed.shift))


def find_deviations(plan: Plan) -> tuple[HingeDeviation, ...]:
    """Find the hinges whose planned motion deviates most from the desired one.

    At most `MAX_REPORTED_HINGES` are returned, each above `MIN_REPORTED_DEVIATION`.
    """
    names, lost = plan.setup.robot.skeleton.names, np.degrees(plan.motion.rms_distances)
    order = np.argsort(-lost)[:MAX_REPORTED_HINGES]
    return tuple(
        HingeDeviation(names[hinge], float(lost[hinge])) for hinge in order if lost[hinge] > MIN_REPORTED_DEVIATION
    )


@dataclass(frozen=True, eq=False)
class _Paths:
    """Paths of hands, head and torso over time."""

    times: Floats  # (m,) [s]
    paths: Mapping[PartName, Floats]  # (m, 3)


def _desired_paths(plan: Plan) -> _Paths:
    motion = plan.desired
    times = np.arange(int(np.ceil(motion.duration * PATH_RATE)) + 1) / PATH_RATE
    windows = (times[begin : begin + POSTURES_PER_WINDOW] for begin in range(0, len(times), POSTURES_PER_WINDOW))
    parts = [compute_part_paths(motion.angles(window), plan.setup.robot) for window in windows]
    return _Paths(times - motion.zero, {part: np.concatenate([window[part] for window in parts]) for part in parts[0]})


def _sync_shift(sync: SyncTime, plan: Plan) -> SyncShift:
    limit = find_limit_met(sync, plan.keyframes, plan.motion, plan.setup.robot)
    if limit is None:
        return SyncShift((sync.sync,), sync.requested, sync.planned, "", "", 0.0)
    name = plan.setup.robot.skeleton.names[limit.hinge]
    return SyncShift((sync.sync,), sync.requested, sync.planned, name, limit.quantity, limit.ratio)


def _merge_shifts(moved: Iterable[SyncShift]) -> tuple[SyncShift, ...]:
    """Merge the shifts of consecutive sync points if size and limit agree."""
    changes: list[SyncShift] = []
    for shift in moved:
        last = changes[-1] if changes else None
        if last and (last.hinge, last.quantity, last.milliseconds) == (shift.hinge, shift.quantity, shift.milliseconds):
            changes[-1] = replace(last, syncs=(*last.syncs, *shift.syncs))
        else:
            changes.append(shift)
    return tuple(changes)


def _find_stroke_bounds(syncs: list[SyncTime]) -> tuple[SyncTime, SyncTime] | None:
    """Return first and last sync point of a behaviour's stroke, or None."""
    sync_by_name = {sync.sync: sync for sync in syncs}
    if STROKE_SYNCS[0] in sync_by_name and STROKE_SYNCS[1] in sync_by_name:
        return sync_by_name[STROKE_SYNCS[0]], sync_by_name[STROKE_SYNCS[1]]
    return None


def _losses(
    part: PartName, bounds: tuple[SyncTime, SyncTime], desired: _Paths, reference: _Paths, zero: float
) -> Iterator[StrokeLoss]:
    requested = measure_stretch(desired.times, desired.paths[part], bounds[0].requested, bounds[1].requested)
    planned = measure_stretch(
        reference.times, reference.paths[part], zero + bounds[0].planned, zero + bounds[1].planned
    )
    unit, scale = ("m", 1.0) if part in HAND_PARTS else ("deg", float(np.degrees(1.0)))
    for k, (quantity, per) in enumerate((("speed", "/s"), ("path", ""))):
        loss = StrokeLoss(part, quantity, unit + per, scale * requested[k], scale * planned[k])
        if loss.fraction > MIN_REPORTED_LOSS and loss.asked > MIN_VISIBLE_STROKE[loss.unit]:
            yield loss
