"""Conflicts of a new block with other blocks' speech and body parts."""

from collections.abc import Mapping
from dataclasses import replace

from kinesic.bml.block import Composition, Interrupt, Notice, NoticeType
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.busy_hands import BusyHand
from kinesic.realizer.occupancy import Occupancy
from kinesic.realizer.request import PLANNING_TIME, TimedRequest
from kinesic.realizer.running_block import PlayingSpeech, RunningBlock
from kinesic.realizer.scene import Scene

Interruptions = Mapping[tuple[str, str], float]  # (block, behaviour) -> global time [s] of the interruption
TimedBlock = RunningBlock | TimedRequest


def interrupted_by(action: Interrupt, running: RunningBlock) -> frozenset[str]:
    """Return the ids of a block's behaviours that an interrupt stops."""
    return (frozenset(action.include) or frozenset(running.times)) & running.times.keys() - frozenset(action.exclude)


def planned_interruptions(scene: Scene, coming: TimedBlock) -> Interruptions:
    """Return the earliest interruption time [s] of each (block, behaviour) pair.

    Running blocks and the new block may interrupt.
    """
    interruptions: dict[tuple[str, str], float] = {}
    blocks: tuple[TimedBlock, ...] = (*scene.playing, coming)
    for by in blocks:
        for behaviour in by.block.behaviours:
            action = behaviour.action
            target = scene.find(action.target) if isinstance(action, Interrupt) else None
            if isinstance(action, Interrupt) and target is not None and behaviour.id in by.times:
                time = by.zero + by.times[behaviour.id]["start"]
                for id in interrupted_by(action, target):
                    interruptions[target.id, id] = min(time, interruptions.get((target.id, id), time))
    return interruptions


def occupancy_of_others(scene: Scene, coming: TimedBlock) -> tuple[Occupancy, ...]:
    """Return the occupancies of other blocks, cut at planned interruptions."""
    ends = {f"{block}:{id}": time for (block, id), time in planned_interruptions(scene, coming).items()}
    return tuple(
        _until(entry, ends[entry.behaviour]) if entry.behaviour in ends else entry for entry in scene.occupancy
    )


def with_busy_hands(scene: Scene, request: TimedRequest) -> TimedRequest:
    """Add the hands used by other blocks to a request.

    Planning then uses the free hands.

    The start time is uncertain by the planning time. The result is unchanged for a block that replaces or interrupts
    others, because their hands are free then, and for a preplanned block, whose start time is unknown.
    """
    order, zero = request.block.order, request.zero
    if request.block.composition is Composition.REPLACE or order.preplanned:
        return request
    busy_hands = [
        BusyHand(side, entry.ready - zero - PLANNING_TIME, entry.relax - zero, entry.behaviour)
        for entry in occupancy_of_others(scene, request)
        if entry.relax > zero + request.timeline.start and entry.behaviour.partition(":")[0] not in order.interrupts
        for side in SIDES
        if f"{side}_hand" in entry.roles
    ]
    return replace(request, busy_hands=tuple(busy_hands))


def drop_overlapping_speech(scene: Scene, coming: RunningBlock) -> tuple[RunningBlock, tuple[Notice, ...]]:
    """Drop a new block's speech that overlaps other speech, with notices."""
    ends = planned_interruptions(scene, coming)
    overlaps: dict[str, PlayingSpeech] = {}
    for speech in coming.speeches:
        for other in scene.speeches:
            until = min(other.end, ends.get((other.block, other.behaviour), other.end))
            if other.block != coming.id and speech.begin < until and other.begin < speech.end:
                overlaps[speech.behaviour] = other
    notices = tuple(
        Notice(
            NoticeType.IMPOSSIBLE_TO_SCHEDULE,
            f"{coming.id}:{id}",
            f"left out: {other.block}:{other.behaviour} speaks until {other.end:.2f} s; APPEND would wait for it",
        )
        for id, other in overlaps.items()
    )
    return coming.without(frozenset(overlaps)), notices


def _until(occupancy: Occupancy, time: float) -> Occupancy:
    relax = min(occupancy.relax, max(time, occupancy.begin))
    return replace(occupancy, ready=min(occupancy.ready, relax), relax=relax)
