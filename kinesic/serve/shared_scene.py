"""Scene of the planner, synchronised with the loop by proposals.

A change that the loop rejects as late is computed again for a later time.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from enum import Enum, auto
from math import inf

from kinesic.child import PipeEnd
from kinesic.planning.setup import Setup
from kinesic.realizer.following import find_final_posture
from kinesic.realizer.realizer import Scene, stop_all_blocks
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

PROPOSAL_MARGIN = 0.015  # [s] between a proposal and its splice time; doubled after each rejection
MAX_EXPECTED_DURATION = 1.0  # [s] upper bound of the expected time to compute a proposal
EXPECTATION_DECAY = 0.7  # smallest factor on the expected computing time after a quickly computed proposal
MAX_PROPOSAL_ATTEMPTS = (
    9  # largest number of proposals of a change; the time before it doubles with each, to nearly 4 s
)
Change = Callable[[Scene, float], Scene]


class Verdict(Enum):
    """Outcome of a proposed change."""

    ACCEPTED = auto()  # possibly interrupted by a later emergency stop
    STOPPED = auto()  # an emergency stop preceded the proposal
    LATE = auto()  # at the last attempt, later commands were sent already
    UNSTEADY = auto()  # at the last attempt, a step in the motion, or a conflict with sent feedback


class SharedScene:
    """Scene of the planner, changed only by proposals that the loop accepts."""

    def __init__(
        self,
        setup: Setup,
        loop: PipeEnd,
        properties: LoopProperties,
        *,
        beginning: LoopStart,
        other_clients: Callable[[], frozenset[int]],
        on_halt: Callable[[], None],
    ) -> None:
        """Create a scene from the current state of the loop.

        Args:
            setup: setup for planning.
            loop: proposals are sent to it; verdicts and emergency stops are received from it.
            properties: constant properties of the loop.
            beginning: current state of the loop.
            other_clients: returns clients with unfinished work that is not part of a block.
            on_halt: called at each emergency stop.
        """
        self._loop, self._clock, self._accompaniment = loop, properties.clock, properties.accompaniment
        self._other_clients, self._on_halt = other_clients, on_halt
        self._latest_time = -inf  # [s] clock time of the last accepted proposal; the loop may set the clock back
        self._expected_duration = 0.0  # [s] expected time to compute a proposal
        self._versions = dict[str, Version]()  # versions of the loop's tracks
        self.stops = beginning.stops
        self._stopped_at = inf  # [s] first emergency stop whose interruptions the loop has not accepted yet
        lasting = find_final_posture(beginning.motion, setup.robot)
        motion, agenda, runs = beginning.motion, beginning.agenda, beginning.runs
        self.scene = replace(Scene.of(setup), motion=motion, agenda=agenda, runs=runs, lasting=lasting)

    def tell(self, message: str, client: int) -> None:
        """Send feedback to a client immediately."""
        self._loop.send(FeedbackNotice(message, client))

    def renew(self, setup: Setup) -> None:
        """Use another planning setup for future plans.

        Running motion stays unchanged.
        """
        self.scene = replace(self.scene, setup=setup)

    def pop_replan(self) -> TimedRequest | None:
        """Remove and return the next block to be replanned, or None."""
        if not self.scene.replans:
            return None
        first, *others = self.scene.replans
        self.scene = replace(self.scene, replans=tuple(others))
        return first

    def propose(self, change: Change, *, moves: bool = True) -> Verdict:
        """Propose a change until the loop accepts it or attempts run out.

        The number of attempts is `MAX_PROPOSAL_ATTEMPTS`.

        Args:
            change: computes the next scene from the current one and a time [s].
            moves: whether the proposal contains the motion; False if the loop plays it already.
        """
        verdict = Verdict.LATE
        for attempt in range(MAX_PROPOSAL_ATTEMPTS):
            began = self._clock.now()
            now = max(began, self._latest_time)
            ahead = self._expected_duration + PROPOSAL_MARGIN * 2**attempt
            scene = change(replace(self.scene, ahead=ahead, outgoing_feedback=()), now)
            self._expected_duration = min(
                MAX_EXPECTED_DURATION, max(self._clock.now() - began, EXPECTATION_DECAY * self._expected_duration)
            )
            versions, tracks = changed_tracks(scene, self._versions, self._accompaniment, now)
            moved = moves and scene.motion is not self.scene.motion
            self._loop.send(self._proposal(scene, now, tracks, moved=moved))
            halted, answer = self._answer()
            if answer.accepted:
                self.scene, self._versions, self._latest_time = scene, versions, now
            if halted is not None:
                self.handle_stop(halted)
            if answer.accepted or halted is not None:
                return Verdict.ACCEPTED if answer.accepted else Verdict.STOPPED
            if answer.stops > self.stops:
                self.wait_for_stops(answer.stops)
                return Verdict.STOPPED
            verdict = Verdict.LATE if now + ahead < answer.time else Verdict.UNSTEADY
        return verdict

    def handle_stop(self, halted: Halted) -> None:
        """Adopt the motion of an emergency stop, which interrupts all blocks."""
        self.stops = halted.stops
        self._on_halt()
        stopped = self._stopped_at = min(self._stopped_at, halted.time)
        if (
            self.propose(lambda scene, _now: stop_all_blocks(scene, stopped, halted.motion), moves=False)
            is Verdict.ACCEPTED
        ):
            self._stopped_at = inf

    def wait_for_stops(self, stops: int) -> None:
        """Wait until the loop has reported the given number of emergency stops."""
        while self.stops < stops:
            self.handle_stop(self._loop.recv())

    def _proposal(self, scene: Scene, now: float, tracks: Mapping[str, Track | None], *, moved: bool) -> Proposal:
        return Proposal(
            self.stops,
            now,
            now + scene.ahead,
            scene.motion if moved else None,
            scene.outgoing_feedback,
            scene.agenda,
            owed=frozenset(block.sender for block in scene.blocks) | self._other_clients(),
            moving={(block.id, need.behaviour): need.hinges for block in scene.blocks for need in block.occupancy},
            tracks=tracks,
            idles=(scene.idle is not None or scene.follows) and not scene.blocks,
        )

    def _answer(self) -> tuple[Halted | None, ProposalVerdict]:
        """Receive the loop's verdict on a proposal and any preceding emergency stop.

        The stop gets the time of the first one, which ended the blocks.
        """
        halted: Halted | None = None
        while not isinstance(message := self._loop.recv(), ProposalVerdict):
            halted = message if halted is None else replace(message, time=halted.time)
        return halted, message
