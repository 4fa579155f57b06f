"""Sync points: what BML ties between them, when each of them will be, and warnings where that is not as asked."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf
from typing import SupportsIndex, TypeVar, overload

import numpy as np

from kinesic.bml.block import Block, Notice, NoticeType, Precedence, SyncRef, TimedBehaviour, Timeline
from kinesic.bml.timing.constraints import point_of, ties
from kinesic.body.arrays import Floats
from kinesic.body.config import suggestion
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.condition import Conditioned
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.keys import Bond, KeyPosture

SHIFT_TO_WARN = 0.010  # [s]
SMALLER_TO_WARN = 0.1  # share of the length of a path


@dataclass(frozen=True)
class SyncTime:
    """A sync point of a behaviour: when it was asked for, and when it will be."""

    behaviour: str
    sync: str
    asked: float  # [s] block time
    planned: float  # [s] block time

    @property
    def name(self) -> str:
        """Behaviour and sync point: `nod:stroke`."""
        return f"{self.behaviour}:{self.sync}"

    @property
    def is_stroke(self) -> bool:
        """Whether it is the stroke, the first or a repeated one."""
        return self.sync == "stroke" or self.sync.startswith("stroke:")


T_co = TypeVar("T_co", bound=SyncTime, covariant=True)


class Syncs(tuple[T_co, ...]):
    """Sync points in planned order; `syncs["nod:stroke"]` finds one by its name."""

    __slots__ = ()

    @overload
    def __getitem__(self, place: SupportsIndex, /) -> T_co: ...
    @overload
    def __getitem__(self, place: slice, /) -> tuple[T_co, ...]: ...
    @overload
    def __getitem__(self, place: str, /) -> T_co: ...
    def __getitem__(self, place: SupportsIndex | slice | str, /) -> T_co | tuple[T_co, ...]:
        """One by its place or its name, or a part of them.

        Raises:
            KeyError: no sync point has this name; names near to it are suggested.
        """
        if not isinstance(place, str):
            return super().__getitem__(place)
        for sync in self:
            if sync.name == place:
                return sync
        behaviour, _, point = place.partition(":")
        points = [sync.sync for sync in self if sync.behaviour == behaviour]
        if not points:
            behaviours = sorted({sync.behaviour for sync in self})
            raise KeyError(f"no behaviour {behaviour} has sync points{suggestion(behaviour, behaviours)}")
        raise KeyError(f"behaviour {behaviour} has no sync point {point}{suggestion(point, points)}")


def find_bonds(timeline: Timeline) -> tuple[Bond, ...]:
    """Finds the bonds between different behaviours: both ways for points that coincide, one for an order.

    What a behaviour asks of its own points is no bond: its own time gives way.
    """
    known = {(timed.behaviour.id, sync) for timed in timeline.timed for sync in timed.times}
    found: list[Bond] = []
    for tie in ties(timeline.block):
        found += [_bond(tie.left, tie.right), _bond(tie.right, tie.left)]
    for constraint in timeline.block.constraints:
        if isinstance(constraint, Precedence):
            found += [_bond(constraint.earlier, later) for later in constraint.later]
    return tuple(
        bond
        for bond in dict.fromkeys(found)
        if bond.earlier in known and bond.later in known and bond.earlier[0] != bond.later[0]
    )


def _bond(earlier: SyncRef, later: SyncRef) -> Bond:
    """time(earlier) + its offset <= time(later) + its offset."""
    before, after = point_of(earlier), point_of(later)
    return Bond((before.behaviour, before.sync), (after.behaviour, after.sync), earlier.offset - later.offset)


def on_keys(frames: KeyFrames, motion: Conditioned) -> list[tuple[str, str, float, float]]:
    """Lists (behaviour, sync, asked, planned) of every sync point that lies on a key."""
    at = dict(zip(motion.asked, motion.planned, strict=True))
    asked = {timed.behaviour.id: timed.times for timed in frames.timeline.timed}
    return [
        (behaviour, sync, asked[behaviour].get(sync, frame.time), float(at[frame.time]))
        for frame in frames.frames
        for behaviour, sync in frame.syncs
    ]


def planned_spans(planned: Iterable[tuple[str, float]]) -> dict[str, tuple[float, float]]:
    """Finds the first and last planned time [s] of each behaviour, from (behaviour, time) of its sync points."""
    found: dict[str, tuple[float, float]] = {}
    for behaviour, time in planned:
        low, high = found.get(behaviour, (time, time))
        found[behaviour] = (min(low, time), max(high, time))
    return found


def sync_times(frames: KeyFrames, motion: Conditioned) -> Syncs[SyncTime]:
    """Lists every sync point of every performed behaviour, in planned order."""
    moving = [SyncTime(*row) for row in on_keys(frames, motion)]
    seen = {sync.behaviour for sync in moving}
    still = [
        SyncTime(timed.behaviour.id, sync, time, time)
        for timed in frames.timeline.timed
        if timed.behaviour.id not in seen and frames.outcomes[timed.behaviour.id].kind != "dropped"
        for sync, time in timed.times.items()
    ]
    return Syncs(sorted([*moving, *still], key=lambda sync: (sync.planned, sync.behaviour)))


def shift_notices(
    block: Block, syncs: tuple[SyncTime, ...], frames: KeyFrames, motion: Conditioned, robot: Robot
) -> list[Notice]:
    """Warns of each sync point that had to move."""
    found = []
    for sync in syncs:
        if abs(sync.planned - sync.asked) > SHIFT_TO_WARN:
            met = limit_met(sync, frames, motion, robot)
            why = "" if met is None else f": {met.quantity} of {robot.skeleton.names[met.hinge]}"
            text = f"{sync.sync} asked at {sync.asked:.3f} s is planned at {sync.planned:.3f} s{why}"
            found.append(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block.id}:{sync.behaviour}", text))
    return found


def limit_met(sync: SyncTime, frames: KeyFrames, motion: Conditioned, robot: Robot) -> Bottleneck | None:
    """Finds the limit that was met nearest to a sync point, at best by a hinge of its own behaviour."""
    parts = frames.uses.get(sync.behaviour, frozenset())
    own = {joint for part in parts for joint in robot.part_joints(part)}
    return motion.bottleneck_near(sync.asked, own)


def path_notices(
    block: Block, postures: Sequence[KeyPosture], frames: KeyFrames, motion: Conditioned, robot: Robot
) -> list[Notice]:
    """Warns of each behaviour with a hand whose path is cut by more than a tenth.

    Args:
        block: that is planned.
        postures: that the motion was to pass.
        frames: of the block.
        motion: what became of them.
        robot: whose hands.
    """
    arms = [robot.arm(side).joints[0] for side in SIDES]
    if all(posture.firm or not any(posture.keyed[arm] for arm in arms) for posture in postures):
        return []
    asked = robot.body_frames(np.array([posture.angles for posture in postures])).origins
    planned = robot.body_frames(motion.trajectory.sample(motion.planned + motion.trajectory.zero)[0]).origins
    found = []
    for timed in frames.timeline.timed:
        cut, name = 0.0, timed.behaviour.id
        for side in SIDES:
            if f"{side}_hand" in frames.uses.get(name, ()):
                rows = _on_path(postures, timed, robot, side)
                hand = robot.arm(side).wrist
                whole = _length(asked[rows, hand])
                cut = max(cut, 1.0 - _length(planned[rows, hand]) / whole) if whole else cut
        if cut > SMALLER_TO_WARN:
            text = f"its path is made {100 * cut:.0f} % smaller: servos cannot follow it in its time"
            found.append(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block.id}:{name}", text))
    return found


def _on_path(postures: Sequence[KeyPosture], timed: TimedBehaviour, robot: Robot, side: Side) -> list[int]:
    """The keys of a hand on a path in a stroke, with those at its ends; none without a path."""
    start, end = (timed.times.get(sync, inf) for sync in ("strokeStart", "strokeEnd"))
    arm = robot.arm(side).joints[0]
    rows = [k for k, posture in enumerate(postures) if posture.keyed[arm] and start <= posture.time <= end]
    return [] if all(postures[k].firm for k in rows) else rows


def _length(path: Floats) -> float:
    """Of a path (m, 3) [m]."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
