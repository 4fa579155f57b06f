"""What a block meets when it begins: speech and parts of the body that are busy, unless they are interrupted before."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Protocol

from kinesic.bml.block import Block, Composition, Interrupt, Notice, NoticeType
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.coarticulation import Engaged
from kinesic.realizer.feedback import Times
from kinesic.realizer.occupancy import Occupancy
from kinesic.realizer.request import LEAD, TimedRequest
from kinesic.realizer.running_block import PlayingSpeech, RunningBlock
from kinesic.realizer.scene import Scene

Cuts = Mapping[tuple[str, str], float]  # block and behaviour -> [s] global time at which it will be interrupted


class IncomingBlock(Protocol):
    """A block that has times."""

    @property
    def block(self) -> Block:
        """What was asked."""

    @property
    def zero(self) -> float:
        """Global time of its time 0 [s]."""

    @property
    def times(self) -> Times:
        """Of its sync points, block time [s]."""


def interrupted_by(action: Interrupt, staged: RunningBlock) -> frozenset[str]:
    """The behaviours of a block that an interrupt stops."""
    return (frozenset(action.include) or frozenset(staged.times)) & staged.times.keys() - frozenset(action.exclude)


def planned_interruptions(scene: Scene, coming: IncomingBlock) -> Cuts:
    """What blocks that play, and one that comes, are going to interrupt."""
    found: dict[tuple[str, str], float] = {}
    blocks: tuple[IncomingBlock, ...] = (*scene.playing, coming)
    for by in blocks:
        for behaviour in by.block.behaviours:
            action = behaviour.action
            target = scene.find(action.target) if isinstance(action, Interrupt) else None
            if isinstance(action, Interrupt) and target is not None and behaviour.id in by.times:
                time = by.zero + by.times[behaviour.id]["start"]
                for id in interrupted_by(action, target):
                    found[target.id, id] = min(time, found.get((target.id, id), time))
    return found


def occupancy_of_others(scene: Scene, coming: IncomingBlock) -> tuple[Occupancy, ...]:
    """What other blocks need of the body, each as long as it will be let."""
    ends = {f"{block}:{id}": time for (block, id), time in planned_interruptions(scene, coming).items()}
    return tuple(_until(each, ends[each.behaviour]) if each.behaviour in ends else each for each in scene.busy)


def among(scene: Scene, asked: TimedRequest) -> TimedRequest:
    """The block with the hands that others need meanwhile, as far as one can tell before it is planned.

    It may begin later than expected by the time to plan it. One that takes the place of others, or stops them, finds
    their hands free; when one begins that waits to be activated, nobody knows.
    """
    succession, zero = asked.block.succession, asked.zero
    if asked.block.composition is Composition.REPLACE or succession.preplanned:
        return asked
    engaged = [
        Engaged(side, each.ready - zero - LEAD, each.relax - zero, each.behaviour)
        for each in occupancy_of_others(scene, asked)
        if each.relax > zero + asked.timeline.start and each.behaviour.partition(":")[0] not in succession.interrupts
        for side in SIDES
        if f"{side}_hand" in each.roles
    ]
    return replace(asked, engaged=tuple(engaged))


def silence_overlap(scene: Scene, coming: RunningBlock) -> tuple[RunningBlock, tuple[Notice, ...]]:
    """The block without speech that would be said while another one speaks, and what is to be told of it."""
    ends = planned_interruptions(scene, coming)
    met: dict[str, PlayingSpeech] = {}
    for own in coming.speeches:
        for other in scene.speeches:
            until = min(other.end, ends.get((other.block, other.behaviour), other.end))
            if other.block != coming.id and own.begin < until and other.begin < own.end:
                met[own.behaviour] = other
    notices = tuple(
        Notice(
            NoticeType.IMPOSSIBLE_TO_SCHEDULE,
            f"{coming.id}:{id}",
            f"left out: {other.block}:{other.behaviour} speaks until {other.end:.2f} s; APPEND would wait for it",
        )
        for id, other in met.items()
    )
    return coming.without(frozenset(met)), notices


def _until(busy: Occupancy, time: float) -> Occupancy:
    relax = min(busy.relax, max(time, busy.begin))
    return replace(busy, ready=min(busy.ready, relax), relax=relax)
