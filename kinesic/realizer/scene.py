"""Immutable state of the realizer: running and waiting blocks at one time."""

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
from kinesic.realizer.follow_steps import FOLLOWING_PREFIX, FollowedFace, FollowStep
from kinesic.realizer.foreign_sound import ForeignSound
from kinesic.realizer.occupancy import Occupancy, settle_occupancy
from kinesic.realizer.request import SceneContext, TimedRequest
from kinesic.realizer.running_block import EndedBlock, PlayingSpeech, RunningBlock

KEPT_PAST_DURATION = 0.5  # [s] duration of past motion that is kept
MAX_PAST_DURATION = 2.0  # [s] duration of past motion above which the past is truncated
MERGE_LEAD_TIME = 0.05  # [s] time before the start of a waiting block at which the block is merged
MAX_ENDED_BLOCKS = 32  # number of ended blocks to which later blocks may still refer


@dataclass(frozen=True, eq=False)
class Scene:
    """Immutable realizer state: active blocks, their motion and feedback.

    Times are global seconds.
    """

    setup: Setup
    motion: Trajectory
    blocks: tuple[RunningBlock, ...] = ()  # in order of arrival
    agenda: tuple[ScheduledFeedback, ...] = ()  # future feedback, sorted by time
    outgoing_feedback: tuple[ScheduledFeedback, ...] = ()  # feedback to send now; cleared by the next `advance`
    ended: tuple[EndedBlock, ...] = ()  # most recently ended blocks
    replans: tuple[TimedRequest, ...] = ()  # blocks to be replanned; each plan goes to `improve_block`
    ahead: float = 0.0  # [s] by which motion is sent in advance; no change begins before the sent motion ends
    lasting: tuple[Occupancy, ...] = ()  # last posture of each role that an ended block still holds
    idle: RunningBlock | None = None  # idle motion since the last block ended
    following: tuple[FollowStep, ...] = ()  # steps of gaze following that may not have ended
    followed_face: FollowedFace | None = None  # eyes and expression of a robot that follows people
    foreign_sound: ForeignSound | None = None  # speech sound of a client, which the robot performs
    runs: int = 0  # number of the block added last; blocks are numbered from 1

    @classmethod
    def of(cls, setup: Setup, now: float = 0.0, *, character: str | None = None, ahead: float = 0.0) -> "Scene":
        """Create a resting scene without blocks.

        Args:
            setup: setup for planning.
            now: global time [s].
            character: performing character; blocks for others are refused. None uses the character of the setup.
            ahead: time [s] by which the motion is sent in advance.
        """
        setup = setup if character is None else replace(setup, character=character)
        return cls(setup, stay(setup.robot.skeleton.rest, start=now), ahead=ahead)

    @cached_property
    def _by_id(self) -> dict[str, RunningBlock]:
        return {active.id: active for active in self.blocks}

    def find(self, id: str) -> RunningBlock | None:
        """Return an active block by its id, or None."""
        return self._by_id.get(id)

    @property
    def states(self) -> dict[str, BlockState]:
        """State of each active block, in order of arrival."""
        return {active.id: active.state for active in self.blocks}

    @property
    def playing(self) -> tuple[RunningBlock, ...]:
        """Blocks that have begun and not ended."""
        return tuple(active for active in self.blocks if active.state.is_playing)

    @property
    def follows(self) -> bool:
        """Whether the head follows people and may move without a block."""
        return any(entry.behaviour.startswith(FOLLOWING_PREFIX) for entry in self.lasting)

    @property
    def occupancy(self) -> tuple[Occupancy, ...]:
        """Occupancies of all behaviours, each named `block:behaviour`."""
        return self.occupancy_without(None)

    def occupancy_without(self, block: str | None) -> tuple[Occupancy, ...]:
        """Return the occupancies of all blocks except one, ended blocks included."""
        playing = (
            replace(need, behaviour=f"{active.id}:{need.behaviour}")
            for active in self.blocks
            if active.id != block
            for need in active.occupancy
        )
        return (*self.lasting, *playing)

    @property
    def speeches(self) -> tuple[PlayingSpeech, ...]:
        """Past and future speech of running blocks."""
        return tuple(spoken for active in self.playing for spoken in active.speeches)

    def context(self, now: float) -> SceneContext:
        """Return the context for `read_request` at a time [s]."""
        times: dict[Point, float] = {}
        for ended in self.ended:
            times |= ended.points
        for active in self.blocks:
            times |= active.points
        return SceneContext(
            now,
            self.states,
            {active.id: active.relax for active in self.blocks},
            {active.id: active.end for active in self.blocks},
            times,
        )

    def earliest_start(self, running: RunningBlock) -> float:
        """Return the earliest start [s] of a waiting block.

        -inf without dependencies.
        """
        latest = -np.inf
        for id, until in running.waits.items():
            other = self.find(id)
            if other is not None:
                latest = max(latest, other.relax if until == "relax" else other.end)
        return latest

    def _next_start_check(self, running: RunningBlock) -> float:
        """Return the earliest merge time [s] of a waiting block.

        Infinity if its dependencies wait themselves.
        """
        if running.state is not BlockState.LURKING:
            return np.inf
        for id in reversed(running.waits):  # most recent dependency first
            other = self.find(id)
            if other is not None and not other.state.is_playing:
                return np.inf
        return self.earliest_start(running) - self.ahead - MERGE_LEAD_TIME

    def may_start(self, running: RunningBlock, now: float) -> bool:
        """Return whether a waiting block may be merged at a time [s].

        Blocks are merged shortly before their motion starts.
        """
        return self._next_start_check(running) <= now

    @property
    def next_time(self) -> float:
        """Next time [s] at which `advance` has an effect.

        Infinity if there is none.
        """
        feedback = self.agenda[0].time if self.agenda else np.inf
        return min([feedback, *map(self._next_start_check, self.blocks)])

    def first_change(self, now: float) -> float:
        """Return the earliest time [s] at which the motion may change."""
        return max(self.motion.start, now + self.ahead)

    def with_feedback(self, *messages: ScheduledFeedback) -> "Scene":
        """Add feedback to be sent now."""
        return replace(self, outgoing_feedback=(*self.outgoing_feedback, *messages))

    def with_block(self, running: RunningBlock) -> "Scene":
        """Replace a block by a new version, or append it."""
        if self.find(running.id) is None:
            return replace(self, blocks=(*self.blocks, running))
        return replace(self, blocks=tuple(running if active.id == running.id else active for active in self.blocks))

    def without_block(self, running: RunningBlock, state: BlockState) -> "Scene":
        """Remove an ended block and record its final state."""
        ended = EndedBlock(running.id, state, running.points)
        return replace(
            self,
            lasting=settle_occupancy((*self.lasting, *running.occupancy)) if state is BlockState.DONE else self.lasting,
            blocks=tuple(active for active in self.blocks if active.id != running.id),
            replans=tuple(request for request in self.replans if request.block.id != running.id),
            ended=(*(active for active in self.ended if active.id != ended.id), ended)[-MAX_ENDED_BLOCKS:],
        )

    def hinges_of(self, occupancy: Iterable[Occupancy]) -> Flags:
        """Return the hinges (n,) that the given occupancies move."""
        hinges = np.zeros(len(self.setup.limits.lower), dtype=np.bool_)
        for active in occupancy:
            hinges |= active.hinges
        return hinges


def forget_past(scene: Scene, now: float) -> Scene:
    """Remove past motion older than KEPT_PAST_DURATION once it exceeds MAX_PAST_DURATION."""
    if now - scene.motion.start < MAX_PAST_DURATION:
        return scene
    blocks = tuple(active.since(now - KEPT_PAST_DURATION) for active in scene.blocks)
    idle = None if scene.idle is None else scene.idle.since(now - KEPT_PAST_DURATION)
    return replace(scene, motion=scene.motion.since(now - KEPT_PAST_DURATION), blocks=blocks, idle=idle)
