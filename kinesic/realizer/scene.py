"""What is performed and what waits, at one moment: the state of a realizer as a frozen value."""

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
from kinesic.realizer.running_block import EndedBlocks, PlayingSpeech, RunningBlock

KEPT = 0.5  # [s] of the past that the motion keeps
LONGEST_PAST = 2.0  # [s] after which it is cut away
SOON = 0.05  # [s] before its turn a block is laid over what still plays
REMEMBERED = 32  # blocks that are over and can be referred to


@dataclass(frozen=True, eq=False)
class Scene:
    """All blocks that are not over, the motion that performs them, and what will be told."""

    setup: Setup
    motion: Trajectory
    blocks: tuple[RunningBlock, ...] = ()  # in the order in which they came
    agenda: tuple[ScheduledFeedback, ...] = ()  # feedback to come, in order of time
    said: tuple[ScheduledFeedback, ...] = ()  # feedback to be sent now; the next `advance` takes it away
    past: tuple[EndedBlocks, ...] = ()  # the last blocks that are over
    wishes: tuple[TimedRequest, ...] = ()  # blocks that are to be planned anew, and handed to `improved`
    character: str | None = None  # who performs here; None: whoever is asked
    ahead: float = 0.0  # [s] the motion is handed over so early: changes begin no sooner
    left: tuple[Occupancy, ...] = ()  # what stays of blocks that are over

    @classmethod
    def of(cls, setup: Setup, now: float = 0.0, *, character: str | None = None, ahead: float = 0.0) -> "Scene":
        """At rest, with nothing asked.

        Args:
            setup: of planning.
            now: [s] global time.
            character: who performs here: blocks for others are refused. None: every block is performed.
            ahead: [s] by which the motion is handed over before it is performed.
        """
        return cls(setup, stay(setup.robot.skeleton.rest, start=now), character=character, ahead=ahead)

    @cached_property
    def _by_id(self) -> dict[str, RunningBlock]:
        return {each.id: each for each in self.blocks}

    def find(self, id: str) -> RunningBlock | None:
        """A block that is not over."""
        return self._by_id.get(id)

    @property
    def states(self) -> dict[str, BlockState]:
        """Of blocks that are not over, in the order in which they came."""
        return {each.id: each.state for each in self.blocks}

    @property
    def playing(self) -> tuple[RunningBlock, ...]:
        """Blocks that have begun and are not over."""
        return tuple(each for each in self.blocks if each.state.is_playing)

    @property
    def busy(self) -> tuple[Occupancy, ...]:
        """What all blocks that play need, by the names of blocks and behaviours."""
        return self.busy_but(None)

    def busy_but(self, block: str | None) -> tuple[Occupancy, ...]:
        """What all blocks need but one."""
        playing = (
            replace(busy, behaviour=f"{each.id}:{busy.behaviour}")
            for each in self.blocks
            if each.id != block
            for busy in each.busy
        )
        return (*self.left, *playing)

    @property
    def speeches(self) -> tuple[PlayingSpeech, ...]:
        """What is said and will be, by blocks that play."""
        return tuple(spoken for each in self.playing for spoken in each.speeches)

    def around(self, now: float) -> SceneContext:
        """What a block that is asked now has to know of the others."""
        times: dict[Point, float] = {}
        for over in self.past:
            times |= over.points
        for each in self.blocks:
            times |= each.points
        return SceneContext(
            now,
            self.states,
            {each.id: each.relax for each in self.blocks},
            {each.id: each.end for each in self.blocks},
            times,
        )

    def turn(self, staged: RunningBlock) -> float:
        """When the last block that another one waits for lets it begin [s] global; those that are over always do."""
        latest = -np.inf
        for id, until in staged.waits.items():
            other = self.find(id)
            if other is not None:
                latest = max(latest, other.relax if until == "relax" else other.end)
        return latest

    def _look(self, staged: RunningBlock) -> float:
        """When to see whether a block that waits has its turn [s] global; never, as long as one it waits for waits."""
        if staged.state is not BlockState.LURKING:
            return np.inf
        for id in reversed(staged.waits):  # the last that came has its turn last
            other = self.find(id)
            if other is not None and not other.state.is_playing:
                return np.inf
        return self.turn(staged) - self.ahead - SOON

    def has_turn(self, staged: RunningBlock, now: float) -> bool:
        """Whether a block that waits may begin now [s]."""
        return self._look(staged) <= now

    @property
    def next_time(self) -> float:
        """When `passed` will have something to do [s] global; infinite when nothing is awaited."""
        told = self.agenda[0].time if self.agenda else np.inf
        return min([told, *map(self._look, self.blocks)])

    def first_change(self, now: float) -> float:
        """Global time [s] from which the motion may change."""
        return max(self.motion.start, now + self.ahead)

    def say(self, *messages: ScheduledFeedback) -> "Scene":
        """Adds feedback that is to be sent now."""
        return replace(self, said=(*self.said, *messages))

    def put(self, staged: RunningBlock) -> "Scene":
        """With a block in the place of its earlier version, or as the last one."""
        if self.find(staged.id) is None:
            return replace(self, blocks=(*self.blocks, staged))
        return replace(self, blocks=tuple(staged if each.id == staged.id else each for each in self.blocks))

    def gone(self, staged: RunningBlock, state: BlockState) -> "Scene":
        """Without a block that is over."""
        past = EndedBlocks(staged.id, state, staged.points)
        return replace(
            self,
            left=settle_occupancy((*self.left, *staged.busy)) if state is BlockState.DONE else self.left,
            blocks=tuple(each for each in self.blocks if each.id != staged.id),
            wishes=tuple(wish for wish in self.wishes if wish.block.id != staged.id),
            past=(*(each for each in self.past if each.id != past.id), past)[-REMEMBERED:],
        )

    def hinges(self, busy: Iterable[Occupancy]) -> Flags:
        """(n,) that some behaviours move."""
        found = np.zeros(len(self.setup.limits.lower), dtype=np.bool_)
        for each in busy:
            found |= each.hinges
        return found


def forgotten(scene: Scene, now: float) -> Scene:
    """The scene with the past of its motion cut away, once there is enough of it."""
    if now - scene.motion.start < LONGEST_PAST:
        return scene
    blocks = tuple(each.since(now - KEPT) for each in scene.blocks)
    return replace(scene, motion=scene.motion.since(now - KEPT), blocks=blocks)
