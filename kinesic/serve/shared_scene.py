"""The scene as the loop follows it: a change that comes too late is made again, for a later time."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from enum import Enum, auto
from math import inf
from multiprocessing.connection import Connection

from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import Scene, halt
from kinesic.realizer.request import TimedRequest
from kinesic.serve.messages import (
    FeedbackNotice,
    Halted,
    LoopProperties,
    LoopStart,
    Proposal,
    ProposalVerdict,
)
from kinesic.serve.tracks import Track, Version, changed_tracks

MARGIN = (
    0.015  # [s] from a proposal to its cut, beside what it takes to make it; twice as much after each that was late
)
LONGEST = 1.0  # [s] that making a proposal is expected to take at most, whatever the last one took
SLOWER = 0.7  # share of the expected time that is kept when a proposal takes less
ATTEMPTS = 9  # at being accepted: the last one has nearly four seconds beside the expected time
Change = Callable[[Scene, float], Scene]


class Verdict(Enum):
    """What became of a change that was proposed."""

    ACCEPTED = auto()  # an emergency stop may have interrupted it since
    STOPPED = auto()  # an emergency stop came before
    LATE = auto()  # commands beyond the time from which it changes the motion were out, at the last attempt
    UNSTEADY = auto()  # it would have been a step from the motion that plays by now, at the last attempt


class SharedScene:
    """The planner's scene; the loop plays its motion."""

    def __init__(
        self,
        setup: Setup,
        loop: Connection,
        properties: LoopProperties,
        *,
        beginning: LoopStart,
        owed: Callable[[], frozenset[int]],
        halted: Callable[[], None],
    ) -> None:
        """Begins with nothing but the motion that the loop plays, and what it still has to say.

        Args:
            setup: what planning needs.
            loop: proposals go there, verdicts and stops come back.
            properties: of the loop.
            beginning: its state.
            owed: clients who are owed something beside their blocks.
            halted: is called at each emergency stop.
        """
        self._loop, self._clock, self._accompaniment = loop, properties.clock, properties.accompaniment
        self._owed, self._halted = owed, halted
        self._latest = -inf  # [s] of the clock in a proposal that was accepted: the loop may set the clock back
        self._took = 0.0  # [s] to make the last proposal, or more
        self._versions = dict[str, Version]()  # of the tracks that the loop has
        self.stops = beginning.stops
        self._stopped_at = inf  # [s] of the first emergency stop whose interruptions the loop has not accepted yet
        self.scene = replace(Scene.of(setup), motion=beginning.motion, agenda=beginning.agenda, runs=beginning.runs)

    def tell(self, message: str, client: int) -> None:
        """Tells a client something at once."""
        self._loop.send(FeedbackNotice(message, client))

    def renew(self, setup: Setup) -> None:
        """Plans by another setup from now on; what plays stays as it is."""
        self.scene = replace(self.scene, setup=setup)

    def take_replan(self) -> TimedRequest | None:
        """Takes out the first block that could be planned better; None where there is none."""
        if not self.scene.replans:
            return None
        first, *others = self.scene.replans
        self.scene = replace(self.scene, replans=tuple(others))
        return first

    def propose(self, change: Change, *, moves: bool = True) -> Verdict:
        """Changes the scene as soon as the loop can follow; what is refused is made again for a later time.

        Args:
            change: makes the next scene of the present one and a time [s].
            moves: whether the loop is to play the motion; else it plays it already.
        """
        verdict = Verdict.LATE
        for attempt in range(ATTEMPTS):
            began = self._clock.now()
            now = max(began, self._latest)
            ahead = self._took + MARGIN * 2**attempt
            scene = change(replace(self.scene, ahead=ahead, said=()), now)
            self._took = min(LONGEST, max(self._clock.now() - began, SLOWER * self._took))
            versions, tracks = changed_tracks(scene, self._versions, self._accompaniment)
            moved = moves and scene.motion is not self.scene.motion
            self._loop.send(self._proposal(scene, now, tracks, moved=moved))
            halted, answer = self._answer()
            if answer.accepted:
                self.scene, self._versions, self._latest = scene, versions, now
            if halted is not None:
                self.take_halt(halted)
            if answer.accepted or halted is not None:
                return Verdict.ACCEPTED if answer.accepted else Verdict.STOPPED
            if answer.stops > self.stops:
                self.catch_up(answer.stops)
                return Verdict.STOPPED
            verdict = Verdict.LATE if now + ahead < answer.time else Verdict.UNSTEADY
        return verdict

    def take_halt(self, halted: Halted) -> None:
        """Takes over the motion of an emergency stop, which interrupts every block."""
        self.stops = halted.stops
        self._halted()
        stopped = self._stopped_at = min(self._stopped_at, halted.time)
        if self.propose(lambda scene, _now: halt(scene, stopped, halted.motion), moves=False) is Verdict.ACCEPTED:
            self._stopped_at = inf

    def catch_up(self, stops: int) -> None:
        """Waits until the loop, in its next tick, has sent the motion of so many emergency stops."""
        while self.stops < stops:
            self.take_halt(self._loop.recv())

    def _proposal(self, scene: Scene, now: float, tracks: Mapping[str, Track | None], *, moved: bool) -> Proposal:
        return Proposal(
            self.stops,
            now,
            now + scene.ahead,
            scene.motion if moved else None,
            scene.said,
            scene.agenda,
            owed=frozenset(block.sender for block in scene.blocks) | self._owed(),
            moving={(block.id, need.behaviour): need.hinges for block in scene.blocks for need in block.occupancy},
            tracks=tracks,
            idles=scene.idle is not None and not scene.blocks,
        )

    def _answer(self) -> tuple[Halted | None, ProposalVerdict]:
        """The last emergency stop before the loop's verdict, and the verdict."""
        halted = None
        while not isinstance(message := self._loop.recv(), ProposalVerdict):
            halted = message
        return halted, message
