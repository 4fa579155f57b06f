"""Finds speech and parts of the body that other blocks occupy when a block begins, unless it interrupts them."""

from collections.abc import Mapping
from dataclasses import replace

from kinesic.bml.block import Composition, Interrupt, Notice, NoticeType
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.engaged import Engaged
from kinesic.realizer.occupancy import Occupancy
from kinesic.realizer.request import LEAD, TimedRequest
from kinesic.realizer.running_block import PlayingSpeech, RunningBlock
from kinesic.realizer.scene import Scene

Interruptions = Mapping[tuple[str, str], float]  # block and behaviour -> [s] global time at which it is interrupted
TimedBlock = RunningBlock | TimedRequest


def interrupted_by(action: Interrupt, running: RunningBlock) -> frozenset[str]:
    """Names the behaviours of a block that an interrupt stops."""
    return (frozenset(action.include) or frozenset(running.times)) & running.times.keys() - frozenset(action.exclude)


def planned_interruptions(scene: Scene, coming: TimedBlock) -> Interruptions:
    """Finds the behaviours that blocks that play, and one that comes, are going to interrupt."""
    found: dict[tuple[str, str], float] = {}
    blocks: tuple[TimedBlock, ...] = (*scene.playing, coming)
    for by in blocks:
        for behaviour in by.block.behaviours:
            action = behaviour.action
            target = scene.find(action.target) if isinstance(action, Interrupt) else None
            if isinstance(action, Interrupt) and target is not None and behaviour.id in by.times:
                time = by.zero + by.times[behaviour.id]["start"]
                for id in interrupted_by(action, target):
                    found[target.id, id] = min(time, found.get((target.id, id), time))
    return found


def occupancy_of_others(scene: Scene, coming: TimedBlock) -> tuple[Occupancy, ...]:
    """Finds which hinges other blocks occupy, each until it is interrupted."""
    ends = {f"{block}:{id}": time for (block, id), time in planned_interruptions(scene, coming).items()}
    return tuple(_until(each, ends[each.behaviour]) if each.behaviour in ends else each for each in scene.occupancy)


def with_engaged_hands(scene: Scene, request: TimedRequest) -> TimedRequest:
    """Adds to a request the hands that other blocks need meanwhile, so that planning takes the free one.

    The block may begin later than expected by the time to plan it. One that takes the place of others, or stops them,
    finds their hands free; nobody knows when a block begins that waits to be activated.
    """
    succession, zero = request.block.succession, request.zero
    if request.block.composition is Composition.REPLACE or succession.preplanned:
        return request
    engaged = [
        Engaged(side, each.ready - zero - LEAD, each.relax - zero, each.behaviour)
        for each in occupancy_of_others(scene, request)
        if each.relax > zero + request.timeline.start and each.behaviour.partition(":")[0] not in succession.interrupts
        for side in SIDES
        if f"{side}_hand" in each.roles
    ]
    return replace(request, engaged=tuple(engaged))


def silence_overlap(scene: Scene, coming: RunningBlock) -> tuple[RunningBlock, tuple[Notice, ...]]:
    """Leaves out speech of a block that would sound while another block speaks, and says so in notices."""
    ends = planned_interruptions(scene, coming)
    overlaps: dict[str, PlayingSpeech] = {}
    for own in coming.speeches:
        for other in scene.speeches:
            until = min(other.end, ends.get((other.block, other.behaviour), other.end))
            if other.block != coming.id and own.begin < until and other.begin < own.end:
                overlaps[own.behaviour] = other
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
