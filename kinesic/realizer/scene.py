"""The state of a realizer as a frozen value: what is performed and what waits at one moment."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kinesic.bml.composition import BlockState
from kinesic.bml.timing.constraints import Point
from kinesic.body.arrays import Flags
from kinesic.motion.trajectory import Trajectory, stay
from kinesic.planning.setup import Setup
from kinesic.realizer.feedback import ScheduledFeedback
from kinesic.realizer.occupancy import Occupancy, settle_occupancy
from kinesic.realizer.request import SceneContext, TimedRequest
from kinesic.realizer.running_block import EndedBlock, PlayingSpeech, RunningBlock

PAST_KEPT = 0.5  # [s] of the past that the motion keeps
LONGEST_PAST = 2.0  # [s] of the past beyond which it is cut away
SOON = 0.05  # [s] before it may start a block is merged into what still plays
BLOCKS_KEPT = 32  # blocks that are over and can be referred to


@dataclass(frozen=True, eq=False)
class Scene:
    """All blocks that are not over, the motion that performs them, and their feedback; times are global seconds."""

    setup: Setup
    motion: Trajectory
    blocks: tuple[RunningBlock, ...] = ()  # in the order in which they came
    agenda: tuple[ScheduledFeedback, ...] = ()  # feedback to come, in order of time
    said: tuple[ScheduledFeedback, ...] = ()  # feedback to be sent now; the next `advance` takes it away
    ended: tuple[EndedBlock, ...] = ()  # the last blocks that are over
    replans: tuple[TimedRequest, ...] = ()  # blocks to be planned anew, each plan for `improve_block`
    ahead: float = 0.0  # [s] the motion is handed over so early: changes begin no sooner
    lasting: tuple[Occupancy, ...] = ()  # of blocks that are over, what stays: the last gaze shift and posture
    idle: RunningBlock | None = None  # idle motion since the last block was over
    runs: int = 0  # running blocks so far: the number of the last one

    @classmethod
    def of(cls, setup: Setup, now: float = 0.0, *, character: str | None = None, ahead: float = 0.0) -> "Scene":
        """Makes a scene at rest, without blocks.

        Args:
            setup: robot, style and all else that planning is given.
            now: [s] global time.
            character: who performs here: blocks for others are refused. None: who the setup says, if anybody.
            ahead: [s] by which the motion is handed over before it is performed.
        """
        setup = setup if character is None else replace(setup, character=character)
        return cls(setup, stay(setup.robot.skeleton.rest, start=now), ahead=ahead)

    @cached_property
    def _by_id(self) -> dict[str, RunningBlock]:
        return {each.id: each for each in self.blocks}

    def find(self, id: str) -> RunningBlock | None:
        """Finds a block that is not over; None where there is none of this id."""
        return self._by_id.get(id)

    @property
    def states(self) -> dict[str, BlockState]:
        """State of each block that is not over, in the order in which they came."""
        return {each.id: each.state for each in self.blocks}

    @property
    def playing(self) -> tuple[RunningBlock, ...]:
        """Blocks that have begun and are not over."""
        return tuple(each for each in self.blocks if each.state.is_playing)

    @property
    def occupancy(self) -> tuple[Occupancy, ...]:
        """Which hinges all behaviours occupy, each under the name `block:behaviour`."""
        return self.occupancy_without(None)

    def occupancy_without(self, block: str | None) -> tuple[Occupancy, ...]:
        """Which hinges the behaviours of all blocks but one occupy."""
        playing = (
            replace(need, behaviour=f"{each.id}:{need.behaviour}")
            for each in self.blocks
            if each.id != block
            for need in each.occupancy
        )
        return (*self.lasting, *playing)

    @property
    def speeches(self) -> tuple[PlayingSpeech, ...]:
        """All speech of blocks that play, past and to come."""
        return tuple(spoken for each in self.playing for spoken in each.speeches)

    def context(self, now: float) -> SceneContext:
        """Tells a block that is requested now [s] of the others, as `read_request` takes it."""
        times: dict[Point, float] = {}
        for ended in self.ended:
            times |= ended.points
        for each in self.blocks:
            times |= each.points
        return SceneContext(
            now,
            self.states,
            {each.id: each.relax for each in self.blocks},
            {each.id: each.end for each in self.blocks},
            times,
        )

    def earliest_start(self, running: RunningBlock) -> float:
        """When the last of the blocks that a block waits for lets it start [s]; -inf where none is left."""
        latest = -np.inf
        for id, until in running.waits.items():
            other = self.find(id)
            if other is not None:
                latest = max(latest, other.relax if until == "relax" else other.end)
        return latest

    def _next_look(self, running: RunningBlock) -> float:
        """Finds when to see whether a block may start [s]; infinite while a block that it waits for waits itself."""
        if running.state is not BlockState.LURKING:
            return np.inf
        for id in reversed(running.waits):  # the last that came has its turn last
            other = self.find(id)
            if other is not None and not other.state.is_playing:
                return np.inf
        return self.earliest_start(running) - self.ahead - SOON

    def may_start(self, running: RunningBlock, now: float) -> bool:
        """Whether a block that waits may start now [s]."""
        return self._next_look(running) <= now

    @property
    def next_time(self) -> float:
        """When `advance` will have something to do [s]; infinite when nothing is awaited."""
        feedback = self.agenda[0].time if self.agenda else np.inf
        return min([feedback, *map(self._next_look, self.blocks)])

    def first_change(self, now: float) -> float:
        """Time from which the motion may change [s]."""
        return max(self.motion.start, now + self.ahead)

    def say(self, *messages: ScheduledFeedback) -> "Scene":
        """Adds feedback that is to be sent now."""
        return replace(self, said=(*self.said, *messages))

    def with_block(self, running: RunningBlock) -> "Scene":
        """Puts a block in the place of its earlier version, or behind all others."""
        if self.find(running.id) is None:
            return replace(self, blocks=(*self.blocks, running))
        return replace(self, blocks=tuple(running if each.id == running.id else each for each in self.blocks))

    def without_block(self, running: RunningBlock, state: BlockState) -> "Scene":
        """Takes out a block that is over, and remembers in which state it ended."""
        ended = EndedBlock(running.id, state, running.points)
        return replace(
            self,
            lasting=settle_occupancy((*self.lasting, *running.occupancy)) if state is BlockState.DONE else self.lasting,
            blocks=tuple(each for each in self.blocks if each.id != running.id),
            replans=tuple(request for request in self.replans if request.block.id != running.id),
            ended=(*(each for each in self.ended if each.id != ended.id), ended)[-BLOCKS_KEPT:],
        )

    def hinges_of(self, occupancy: Iterable[Occupancy]) -> Flags:
        """Which hinges (n,) some behaviours move."""
        hinges = np.zeros(len(self.setup.limits.lower), dtype=np.bool_)
        for each in occupancy:
            hinges |= each.hinges
        return hinges


def forget_past(scene: Scene, now: float) -> Scene:
    """Cuts the past of the motion away, once there is enough of it."""
    if now - scene.motion.start < LONGEST_PAST:
        return scene
    blocks = tuple(each.since(now - PAST_KEPT) for each in scene.blocks)
    idle = None if scene.idle is None else scene.idle.since(now - PAST_KEPT)
    return replace(scene, motion=scene.motion.since(now - PAST_KEPT), blocks=blocks, idle=idle)
