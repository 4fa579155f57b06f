"""Sync points: constraints between them, planned times and warnings."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf
from typing import SupportsIndex, TypeVar, overload

import numpy as np

from kinesic.bml.block import Block, Notice, NoticeType, Precedence, SyncRef, TimedBehaviour, Timeline
from kinesic.bml.timing.constraints import find_equalities, get_point
from kinesic.body.arrays import Floats
from kinesic.body.config import suggestion
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.condition import Conditioned
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.keys import Bond, KeyPosture

SHIFT_TO_WARN = 0.010  # [s] larger shifts of a sync point are reported
MIN_REPORTED_SHORTENING = 0.1  # smallest reported shortening of a hand path / path length


@dataclass(frozen=True)
class SyncTime:
    """Sync point of a behaviour with its requested and planned time."""

    behaviour: str
    sync: str
    requested: float  # [s] block time
    planned: float  # [s] block time

    @property
    def asked(self) -> float:
        """Deprecated alias of `requested` [s]."""
        return self.requested

    @property
    def name(self) -> str:
        """Behaviour and sync point, such as `nod:stroke`."""
        return f"{self.behaviour}:{self.sync}"

    @property
    def is_stroke(self) -> bool:
        """Whether the sync point is a first or repeated stroke."""
        return self.sync == "stroke" or self.sync.startswith("stroke:")


T_co = TypeVar("T_co", bound=SyncTime, covariant=True)


class Syncs(tuple[T_co, ...]):
    """Sync points in planned order, accessible by name: `syncs["nod:stroke"]`."""

    __slots__ = ()

    @overload
    def __getitem__(self, place: SupportsIndex, /) -> T_co: ...
    @overload
    def __getitem__(self, place: slice, /) -> tuple[T_co, ...]: ...
    @overload
    def __getitem__(self, place: str, /) -> T_co: ...
    def __getitem__(self, place: SupportsIndex | slice | str, /) -> T_co | tuple[T_co, ...]:
        """Return a sync point by index or name, or a slice.

        Raises:
            KeyError: unknown name; the message suggests similar ones.
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
    """Find the precedence constraints between different behaviours.

    Coinciding points have a constraint in each direction. Constraints within a behaviour are left out, as its own time
    yields.
    """
    scheduled = {(timed.behaviour.id, sync) for timed in timeline.timed for sync in timed.times}
    results: list[Bond] = []
    for equality in find_equalities(timeline.block):
        results += [_bond(equality.left, equality.right), _bond(equality.right, equality.left)]
    for constraint in timeline.block.constraints:
        if isinstance(constraint, Precedence):
            results += [_bond(constraint.earlier, later) for later in constraint.later]
    return tuple(
        bond
        for bond in dict.fromkeys(results)
        if bond.earlier in scheduled and bond.later in scheduled and bond.earlier[0] != bond.later[0]
    )


def _bond(earlier: SyncRef, later: SyncRef) -> Bond:
    """Return the precedence constraint between two sync references."""
    before, after = get_point(earlier), get_point(later)
    return Bond((before.behaviour, before.sync), (after.behaviour, after.sync), earlier.offset - later.offset)


def list_keyed_syncs(frames: KeyFrames, motion: Conditioned) -> list[tuple[str, str, float, float]]:
    """List requested and planned times of all sync points in key frames.

    Rows are (behaviour, sync point, requested, planned), with block times [s].
    """
    at = dict(zip(motion.requested_times, motion.planned, strict=True))
    requested = {timed.behaviour.id: timed.times for timed in frames.timeline.timed}
    return [
        (behaviour, sync, requested[behaviour].get(sync, frame.time), float(at[frame.time]))
        for frame in frames.frames
        for behaviour, sync in frame.syncs
    ]


def find_planned_spans(planned: Iterable[tuple[str, float]]) -> dict[str, tuple[float, float]]:
    """Return each behaviour's first and last planned sync time [s].

    Args:
        planned: (behaviour, time) of its sync points.
    """
    results: dict[str, tuple[float, float]] = {}
    for behaviour, time in planned:
        first, last = results.get(behaviour, (time, time))
        results[behaviour] = (min(first, time), max(last, time))
    return results


def list_sync_times(frames: KeyFrames, motion: Conditioned) -> Syncs[SyncTime]:
    """Return the sync points of all performed behaviours in planned order."""
    moving = [SyncTime(*row) for row in list_keyed_syncs(frames, motion)]
    moving_ids = {sync.behaviour for sync in moving}
    still = [
        SyncTime(timed.behaviour.id, sync, time, time)
        for timed in frames.timeline.timed
        if timed.behaviour.id not in moving_ids and frames.outcomes[timed.behaviour.id].kind != "dropped"
        for sync, time in timed.times.items()
    ]
    return Syncs(sorted([*moving, *still], key=lambda sync: (sync.planned, sync.behaviour)))


def describe_shifts(
    block: Block, syncs: tuple[SyncTime, ...], frames: KeyFrames, motion: Conditioned, robot: Robot
) -> list[Notice]:
    """Return a warning for each shift of a behaviour beyond `SHIFT_TO_WARN`.

    Sync points of a behaviour at the same time, such as `stroke` and `strokeEnd` of a pose, share a warning.
    """
    names: dict[tuple[str, str, str], list[str]] = {}  # (behaviour, requested, planned and why) -> sync points
    for sync in syncs:
        if abs(sync.planned - sync.requested) > SHIFT_TO_WARN:
            met = find_limit_met(sync, frames, motion, robot)
            why = "" if met is None else f": {met.quantity} of {robot.skeleton.names[met.hinge]}"
            times = f"requested at {sync.requested:.3f} s", f"planned at {sync.planned:.3f} s{why}"
            names.setdefault((sync.behaviour, *times), []).append(sync.sync)
    results = []
    for (behaviour, requested, planned), shifted in names.items():
        text = f"{' and '.join(shifted)} {requested} {'is' if len(shifted) == 1 else 'are'} {planned}"
        results.append(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block.id}:{behaviour}", text))
    return results


def find_limit_met(sync: SyncTime, frames: KeyFrames, motion: Conditioned, robot: Robot) -> Bottleneck | None:
    """Return the binding limit nearest in time to a sync, or None.

    Limits of the behaviour's own hinges are preferred.
    """
    parts = frames.uses.get(sync.behaviour, frozenset())
    own_joints = {joint for part in parts for joint in robot.part_joints(part)}
    return motion.bottleneck_near(sync.requested, own_joints)


def describe_path_changes(
    block: Block, postures: Sequence[KeyPosture], frames: KeyFrames, motion: Conditioned, robot: Robot
) -> list[Notice]:
    """Return a warning for each shortened hand path.

    Paths shortened by up to a tenth are not reported.

    Args:
        block: being planned.
        postures: requested postures.
        frames: of the block.
        motion: planned motion.
        robot: with the hands.
    """
    arms = [robot.arm(side).joints[0] for side in robot.sides]
    if all(posture.is_exact or not any(posture.keyed[arm] for arm in arms) for posture in postures):
        return []
    requested_origins = robot.body_frames(np.array([posture.angles for posture in postures])).origins
    planned = robot.body_frames(motion.trajectory.sample(motion.planned + motion.trajectory.zero)[0]).origins
    results = []
    for timed in frames.timeline.timed:
        shortening, name = 0.0, timed.behaviour.id
        for side in robot.sides:
            if f"{side}_hand" in frames.uses.get(name, ()):
                rows = _on_path(postures, timed, robot, side)
                hand = robot.arm(side).wrist
                length = _length(requested_origins[rows, hand])
                shortening = max(shortening, 1.0 - _length(planned[rows, hand]) / length) if length else shortening
        if shortening > MIN_REPORTED_SHORTENING:
            text = f"its path is made {100 * shortening:.0f} % smaller: servos cannot follow it in its time"
            results.append(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block.id}:{name}", text))
    return results


def _on_path(postures: Sequence[KeyPosture], timed: TimedBehaviour, robot: Robot, side: Side) -> list[int]:
    """Return the key indices of a hand path during a stroke.

    The result is empty if the hand must pass exactly through all of them.
    """
    start, end = (timed.times.get(sync, inf) for sync in ("strokeStart", "strokeEnd"))
    arm = robot.arm(side).joints[0]
    rows = [k for k, posture in enumerate(postures) if posture.keyed[arm] and start <= posture.time <= end]
    return [] if all(postures[k].is_exact for k in rows) else rows


def _length(path: Floats) -> float:
    """Return the length [m] of a path (m, 3) [m]."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
