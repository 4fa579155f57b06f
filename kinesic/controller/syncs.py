"""When each sync point was asked for, and when it will be."""

from dataclasses import dataclass

from kinesic.bml.block import Block, Notice, NoticeType
from kinesic.body.robot import Robot
from kinesic.controller.condition import Conditioned
from kinesic.controller.retime import Pair
from kinesic.expressivity.keyframes import KeyFrames

SHIFT_TO_WARN = 0.010  # [s]


@dataclass(frozen=True)
class SyncTime:
    """One sync point of a moving behaviour: when it was asked for, and when it will be."""

    behaviour: str
    sync: str
    asked: float  # [s] block time
    planned: float  # [s] block time


def on_keys(frames: KeyFrames, motion: Conditioned) -> list[tuple[str, str, float, float]]:
    """(behaviour, sync, asked, planned) of every sync point that lies on a key."""
    at = dict(zip(motion.asked, motion.planned, strict=True))
    asked = {timed.behaviour.id: timed.times for timed in frames.timeline.timed}
    return [
        (behaviour, sync, asked[behaviour].get(sync, frame.time), float(at[frame.time]))
        for frame in frames.frames
        for behaviour, sync in frame.syncs
    ]


def sync_times(frames: KeyFrames, motion: Conditioned) -> tuple[SyncTime, ...]:
    """Every sync point of every performed behaviour, in planned order."""
    moving = [SyncTime(*row) for row in on_keys(frames, motion)]
    seen = {sync.behaviour for sync in moving}
    still = [
        SyncTime(timed.behaviour.id, sync, time, time)
        for timed in frames.timeline.timed
        if timed.behaviour.id not in seen and frames.outcomes[timed.behaviour.id].kind != "dropped"
        for sync, time in timed.times.items()
    ]
    return tuple(sorted([*moving, *still], key=lambda sync: (sync.planned, sync.behaviour)))


def shifts(block: Block, syncs: tuple[SyncTime, ...], motion: Conditioned, robot: Robot) -> list[Notice]:
    """A warning for each sync point that had to move."""
    return [
        Notice(
            NoticeType.IMPOSSIBLE_TO_SCHEDULE,
            f"{block.id}:{sync.behaviour}",
            f"{sync.sync} asked at {sync.asked:.3f} s is planned at {sync.planned:.3f} s{_why(sync, motion, robot)}",
        )
        for sync in syncs
        if abs(sync.planned - sync.asked) > SHIFT_TO_WARN
    ]


def _why(sync: SyncTime, motion: Conditioned, robot: Robot) -> str:
    """The limit that was met nearest to a sync point."""

    def away(pair: Pair) -> float:
        begin, end = motion.asked[list(pair)]
        return float(max(begin - sync.asked, sync.asked - end, 0.0))

    if not motion.bottlenecks:
        return ""
    nearest = motion.bottlenecks[min(motion.bottlenecks, key=away)]
    return f": {nearest.quantity} of {robot.skeleton.names[nearest.hinge]}"
