"""Tells what conditioning changed: which sync points moved, which limit moved them, and what the strokes lost."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import PartName
from kinesic.controller.arrival import HANDS, measure_stretch, part_paths
from kinesic.controller.performance import Performance, Reference
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime, limit_met

STROKE = ("strokeStart", "strokeEnd")
PATH_RATE = 100  # [Hz]
LOSS_TO_TELL = 0.05  # share of a stroke's speed or path
DEVIATION_TO_TELL = 1.0  # [deg]
POSTURES_PER_WINDOW = 1024  # postures that are looked at together
MOST_DEVIATIONS = 3  # hinges that are named
LEAST_SEEN = {"m": 0.01, "m/s": 0.05, "deg": 1.0, "deg/s": 5.0}  # below which nobody sees a stroke


@dataclass(frozen=True)
class Moved:
    """Sync points of one behaviour that moved together, away from where they were asked."""

    syncs: tuple[str, ...]
    asked: float  # [s] block time of the first
    planned: float  # [s] block time of the first
    hinge: str  # whose limit was met; empty when none is known
    quantity: str  # of that limit
    ratio: float  # by which the time was too short

    @property
    def milliseconds(self) -> int:
        """By how much it moved."""
        return round(1000 * (self.planned - self.asked))


@dataclass(frozen=True)
class Loss:
    """A quantity of a stroke as it was asked and as it is planned."""

    part: PartName
    quantity: str
    unit: str
    asked: float
    planned: float

    @property
    def share(self) -> float:
        """Share of what was asked that is gone; negative when there is more."""
        return 1.0 - self.planned / self.asked if self.asked else 0.0


@dataclass(frozen=True)
class HingeDeviation:
    """A hinge that moves otherwise than desired, between its keys."""

    hinge: str
    degrees: float  # root mean square over the whole motion


@dataclass(frozen=True)
class ChangedBehaviour:
    """One behaviour that could not be performed as asked."""

    behaviour: str
    moved: tuple[Moved, ...]
    losses: tuple[Loss, ...]
    stroke: bool  # whether it has one

    @property
    def shift(self) -> float:
        """[s] of the sync point that moved most."""
        return max((abs(moved.planned - moved.asked) for moved in self.moved), default=0.0)


# Of a plan, for all twins that perform it.
_TOLD: WeakKeyDictionary[Reference, tuple[ChangedBehaviour, ...]] = WeakKeyDictionary()


def story(performance: Performance) -> tuple[ChangedBehaviour, ...]:
    """Finds behaviours with a moved sync point, or a stroke that lost more than 5 %; the largest shift first."""
    reference = performance.reference
    if reference not in _TOLD:
        _TOLD[reference] = _tell(reference)
    return _TOLD[reference]


def _tell(reference: Reference) -> tuple[ChangedBehaviour, ...]:
    plan = reference.plan
    desired, behaviours = _desired_paths(plan), dict[str, list[SyncTime]]()
    for sync in plan.syncs:
        behaviours.setdefault(sync.behaviour, []).append(sync)
    found = []
    for name, syncs in behaviours.items():
        moved = _together(_moved(sync, plan) for sync in syncs if abs(sync.planned - sync.asked) > SHIFT_TO_WARN)
        parts = sorted(plan.keyframes.uses.get(name, frozenset()) & set(reference.paths))
        core = _core(syncs)
        if core and plan.trajectory.zero + core[1].planned > reference.times[-1]:
            parts = []  # somebody stopped it before: the plan lost nothing
        losses = tuple(loss for part in parts if core for loss in _losses(part, core, desired, reference))
        if moved or losses:
            found.append(ChangedBehaviour(name, moved, losses, stroke=core is not None))
    return tuple(sorted(found, key=lambda changed: -changed.shift))


def find_deviations(performance: Performance) -> tuple[HingeDeviation, ...]:
    """Finds the hinges whose way differs most from the desired one."""
    names, lost = performance.plan.setup.robot.skeleton.names, np.degrees(performance.plan.motion.lost)
    order = np.argsort(-lost)[:MOST_DEVIATIONS]
    return tuple(HingeDeviation(names[hinge], float(lost[hinge])) for hinge in order if lost[hinge] > DEVIATION_TO_TELL)


@dataclass(frozen=True, eq=False)
class _DesiredPaths:
    """Where each part was to be, at block times."""

    times: Floats  # (m,) [s]
    paths: Mapping[PartName, Floats]  # (m, 3)


def _desired_paths(plan: Plan) -> _DesiredPaths:
    motion = plan.desired
    times = np.arange(int(np.ceil(motion.duration * PATH_RATE)) + 1) / PATH_RATE
    windows = (times[begin : begin + POSTURES_PER_WINDOW] for begin in range(0, len(times), POSTURES_PER_WINDOW))
    parts = [part_paths(motion.angles(some), plan.setup.robot) for some in windows]
    return _DesiredPaths(
        times - motion.zero, {part: np.concatenate([some[part] for some in parts]) for part in parts[0]}
    )


def _moved(sync: SyncTime, plan: Plan) -> Moved:
    met = limit_met(sync, plan.keyframes, plan.motion, plan.setup.robot)
    if met is None:
        return Moved((sync.sync,), sync.asked, sync.planned, "", "", 0.0)
    name = plan.setup.robot.skeleton.names[met.hinge]
    return Moved((sync.sync,), sync.asked, sync.planned, name, met.quantity, met.ratio)


def _together(moved: Iterable[Moved]) -> tuple[Moved, ...]:
    """Neighbours that moved equally far for the same reason as one."""
    found: list[Moved] = []
    for one in moved:
        last = found[-1] if found else None
        if last and (last.hinge, last.quantity, last.milliseconds) == (one.hinge, one.quantity, one.milliseconds):
            found[-1] = replace(last, syncs=(*last.syncs, *one.syncs))
        else:
            found.append(one)
    return tuple(found)


def _core(syncs: list[SyncTime]) -> tuple[SyncTime, SyncTime] | None:
    """First and last sync point of the stroke; None for a behaviour without one."""
    known = {sync.sync: sync for sync in syncs}
    if STROKE[0] in known and STROKE[1] in known:
        return known[STROKE[0]], known[STROKE[1]]
    return None


def _losses(
    part: PartName, core: tuple[SyncTime, SyncTime], desired: _DesiredPaths, reference: Reference
) -> Iterator[Loss]:
    zero = reference.plan.trajectory.zero
    asked = measure_stretch(desired.times, desired.paths[part], core[0].asked, core[1].asked)
    planned = measure_stretch(reference.times, reference.paths[part], zero + core[0].planned, zero + core[1].planned)
    unit, scale = ("m", 1.0) if part in HANDS else ("deg", float(np.degrees(1.0)))
    for k, (quantity, per) in enumerate((("speed", "/s"), ("path", ""))):
        loss = Loss(part, quantity, unit + per, scale * asked[k], scale * planned[k])
        if loss.share > LOSS_TO_TELL and loss.asked > LEAST_SEEN[loss.unit]:
            yield loss
