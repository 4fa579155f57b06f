"""The robot's side of a server: a loop that plays, a planner that plans, and what waits to be planned."""

from asyncio import AbstractEventLoop, Event, get_running_loop, sleep
from collections import deque
from collections.abc import Callable, Sequence

from kinesic.planning.setup import Setup
from kinesic.realizer.request import block_id
from kinesic.serve.clock import Clock
from kinesic.serve.loop import Loop
from kinesic.serve.messages import (
    DocumentRequest,
    Interruption,
    PlannerReady,
    RequestDone,
    Restyling,
    Resumption,
    Wanted,
)
from kinesic.serve.planner_process import Planner
from kinesic.serve.queues import FairQueue, QueuedDocument
from kinesic.serve.quotas import Quotas, quota_feedback
from kinesic.serve.sinks import ServoSink
from kinesic.serve.tracks import Effects
from kinesic.speech.speaker import Speaker

LOOK = 0.02  # [s] between two looks at whether it is at rest


class Session:
    """Performs what it is given, and tells senders about it."""

    def __init__(
        self,
        make_setup: Callable[[], Setup],
        followers: Sequence[ServoSink],
        rules: Quotas,
        tell: Callable[[str, int], None],
        *,
        face: bool = False,
        sound: bool = False,
    ) -> None:
        """Nothing moves yet.

        Args:
            make_setup: makes what planning needs, here and in the planner's process.
            followers: sinks.
            rules: how many blocks may wait, and how long planning may take.
            tell: is given a message and the number of its sender, in the asyncio loop.
            face: a sink shows it.
            sound: speech is heard.
        """
        self._asyncio: AbstractEventLoop = get_running_loop()
        self._tell, self._rules = tell, rules
        self._turns, self._first = FairQueue(rules.waiting), deque[Wanted]()
        self._halted = False
        self._warm = Event()
        self.clock = Clock()
        effects = Effects(Speaker(self.clock.now) if sound else None, face=face)
        self.loop = Loop(make_setup(), followers, self.clock, effects=effects, tell=self._pass_on, news=self._hear)
        self.planner = Planner(make_setup, self.loop, self.clock, rules=rules, idle=self._feed, lost=self._apologise)

    async def start(self) -> None:
        """Lets the loop run, and waits until the planner is warm.

        Raises:
            RuntimeError: it does not start.
        """
        self.planner.start()
        self.loop.start()
        await self._warm.wait()
        if self.planner.failed:
            raise RuntimeError("the planner does not start")
        self.loop.late = 0  # what the start costs does not count

    def perform(self, waiting: QueuedDocument) -> str | None:
        """Takes a document; None, or why not, as BML feedback."""
        if self._halted:
            return quota_feedback("stopped", "an emergency stop holds; resume first", name=block_id(waiting.text))
        if not self._turns.add(waiting):
            what = f"{self._rules.waiting} blocks of yours wait to be planned; send fewer at once"
            return quota_feedback("waiting", what, name=block_id(waiting.text))
        self._feed()
        return None

    def halt(self) -> None:
        """Emergency stop, at once; what waits is not performed."""
        self.loop.halt()
        self._halted = True
        for waiting in self._turns.clear():
            self._refuse(waiting, "stopped", "an emergency stop came; resume first")

    def resume(self) -> None:
        """Back to rest after a stop; documents are taken again."""
        if self._halted:
            self._halted = False
            self._want(Resumption(self.loop.stops))

    def interrupt(self, block: str | None) -> None:
        """Ends a block softly, or all of them and all that wait."""
        if block is None:
            for waiting in self._turns.clear():
                self._refuse(waiting, "interrupted", "everything was interrupted before this was planned")
        self._want(Interruption(block))

    def restyle(self, restyling: Restyling) -> None:
        """Another manner, for what plays and what comes."""
        self._want(restyling)

    def status(self) -> dict[str, object]:
        """How it goes, for people and programs."""
        state = "stopped" if self._halted else "resting" if self.loop.settled() else "playing"
        return {
            "state": state,
            "time": round(self.clock.now(), 3),
            "waiting": len(self._turns),
            "planner": "warm" if self.planner.warm else "starting",
            "late": self.loop.late,
            "deaths": self.planner.deaths,
        }

    def owes(self, sender: int) -> bool:
        """Whether something of a sender's waits, or plays."""
        return sender in self._turns or self.loop.owes(sender) or self.planner.serves(sender)

    async def fold(self) -> None:
        """Interrupts everything, and waits until the robot rests."""
        self.interrupt(None)
        while self.loop.is_alive() and (self._first or not self.planner.free or not self.loop.settled()):
            await sleep(LOOK)

    def close(self) -> None:
        """Ends loop and planner; servos fold to rest now, if they have not."""
        self.loop.leave()
        if self.loop.is_alive():
            self.loop.join()
        self.planner.close()

    def _want(self, wanted: Wanted) -> None:
        self._first.append(wanted)
        self._feed()

    def _feed(self) -> None:
        """Gives the planner what is next, when it is free: wishes before documents."""
        if self.planner.warm:
            self._warm.set()
        if not self.planner.free:
            return
        if self._first:
            self.planner.send(self._first.popleft())
        elif (waiting := self._turns.next()) is not None:
            self.planner.send(DocumentRequest(waiting.text, waiting.sender, waiting.source, self.loop.stops))

    def _apologise(self, present: Wanted | None) -> None:
        """The planner has died over something; without any planner it is over."""
        if self.planner.failed:
            self._warm.set()
            self.loop.leave()
        if isinstance(present, DocumentRequest):
            what = f"planning failed, or took longer than {self._rules.planning:g} s; send something simpler"
            self._refuse(present, "planning", what)

    def _refuse(self, document: QueuedDocument | DocumentRequest, rule: str, what: str) -> None:
        self._tell(quota_feedback(rule, what, name=block_id(document.text)), document.sender)

    def _pass_on(self, message: str, sender: int) -> None:
        self._asyncio.call_soon_threadsafe(self._tell, message, sender)

    def _hear(self, news: PlannerReady | RequestDone | None) -> None:
        self._asyncio.call_soon_threadsafe(self.planner.heard, news)
