"""Performs for a server: the loop that plays, the planner, and what waits to be planned."""

from asyncio import AbstractEventLoop, Event, Task, create_task, get_running_loop, shield, sleep
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from time import monotonic
from typing import Literal

from kinesic.planning.setup import Setup
from kinesic.realizer.request import Message, block_id
from kinesic.serve.desk.desk import Desk
from kinesic.serve.desk.export import NO_WRITERS, Writers
from kinesic.serve.loop import Loop
from kinesic.serve.messages import (
    ClientRequest,
    Clock,
    DocumentRequest,
    Interruption,
    PlannerReady,
    Renewal,
    RequestDone,
    Restyling,
    Resumption,
)
from kinesic.serve.planner_process import Planner
from kinesic.serve.queues import FairQueue
from kinesic.serve.sinks.arming import Arming
from kinesic.serve.sinks.real_time import RealTimeSink
from kinesic.serve.tracks import SILENT, Effects, SoundAndFace
from kinesic.serve.wire.quotas import Quotas, quota_feedback
from kinesic.speech.speaker import Speaker

LOOK = 0.02  # [s] between two looks at whether it is at rest
RENEWAL = 1.0  # [s] between two times at which the planner reads gestures anew


class Session:
    """Performs documents and requests of clients, and sends them feedback."""

    def __init__(
        self,
        make_setup: Callable[[], Setup],
        sinks: Sequence[RealTimeSink],
        rules: Quotas,
        tell: Callable[[str, int], None],
        *,
        accompaniment: SoundAndFace = SILENT,
        folder: Path | None = None,
        writers: Writers = NO_WRITERS,
    ) -> None:
        """Makes loop and planner; nothing moves yet.

        Args:
            make_setup: makes what planning needs, here and in the planner's process.
            sinks: that perform.
            rules: how many blocks may wait, and how long planning may take.
            tell: is given a message and the number of its receiver, in the asyncio loop.
            accompaniment: whether a sink shows the face, and whether speech is heard.
            folder: where clients keep documents; None: nowhere.
            writers: of files that the desk does not know how to write; picklable.
        """
        self._asyncio: AbstractEventLoop = get_running_loop()
        self._tell, self._rules, self._sinks = tell, rules, sinks
        self._documents, self._requests = FairQueue(rules.waiting), deque[ClientRequest]()
        self._halted = False
        self._warm = Event()
        self._renewal: Task[None] | None = None  # has the planner read gestures anew
        self._renewed = -RENEWAL  # [s] of the machine's monotonic clock, when it was last told to
        self.clock = Clock()
        effects = Effects(Speaker(self.clock.now) if accompaniment.sound else None, face=accompaniment.face)
        setup = make_setup()
        self.loop = Loop(setup, sinks, self.clock, effects=effects, tell=self._pass_on, news=self._pass_news)
        self.planner = Planner(make_setup, self.loop, rules=rules, idle=self._feed, lost=self._refuse_lost)
        self.desk = Desk(make_setup, self.loop, rules, folder=folder, on_gestures_saved=self._renew, writers=writers)
        self.arming = Arming(self.loop, self)

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

    def perform(self, document: Message) -> str | None:
        """Queues a document; says why not as BML feedback, or None."""
        if self._halted:
            return quota_feedback("stopped", "an emergency stop holds; resume first", name=block_id(document.text))
        if self.loop.waits():
            what = "the servos were out of hand for more than a second, and hold; resume first"
            return quota_feedback("stopped", what, name=block_id(document.text))
        if self.loop.servos is not None and not self.loop.servos.armed:
            return quota_feedback("limp", "the servos have no torque; arm them first", name=block_id(document.text))
        if not self._documents.add(document):
            what = f"{self._rules.waiting} blocks of yours wait to be planned; send fewer at once"
            return quota_feedback("waiting", what, name=block_id(document.text))
        self._feed()
        return None

    def halt(self) -> None:
        """Makes an emergency stop at once; what waits is not performed. From any thread, and never waits.

        Raises:
            RuntimeError: the loop has ended, and nobody stops anything.
        """
        if not self.loop.is_alive():
            raise RuntimeError("the loop that moves it has ended")
        self.loop.halt()
        self._halted = True
        self._asyncio.call_soon_threadsafe(self._refuse_all)

    def resume(self) -> None:
        """Returns to rest after an emergency stop, and lets servos go on; documents are taken again."""
        self.loop.resume()
        if self._halted:
            self._halted = False
            self._request(Resumption(self.loop.stops))

    def interrupt(self, block: str | None) -> None:
        """Ends a block softly, or all of them and all that wait."""
        if block is None:
            for document in self._documents.clear():
                self._refuse(document, "interrupted", "everything was interrupted before this was planned")
        self._request(Interruption(block))

    def restyle(self, restyling: Restyling) -> None:
        """Changes the style of what plays and what comes."""
        self._request(restyling)

    def status(self) -> dict[str, object]:
        """Reports state, time, queue and faults, for people and programs."""
        return {
            "robot": self.loop.robot,
            "state": self._state,
            "stops": self.loop.stops,
            "idles": self.loop.idles and self._state != "stopped",
            "servos": None if self.loop.servos is None else self.loop.servos.state,
            "time": round(self.clock.now(), 3),
            "waiting": len(self._documents),
            "planner": "warm" if self.planner.warm else "starting",
            "late": self.loop.late,
            "deaths": self.planner.deaths,
            "learned": [str(each.lesson) for each in self._sinks if each.lesson is not None],
        }

    @property
    def _state(self) -> Literal["stopped", "resting", "playing"]:
        if self._halted or self.loop.waits():
            return "stopped"
        return "resting" if self.loop.settled() or self.loop.idles else "playing"

    @property
    def hindrance(self) -> str:
        """Why no servo may be armed now, from where it would go to where the motion is; empty if one may."""
        if self._halted:
            return "an emergency stop holds; resume first"
        return "" if self._state != "playing" else "the motion goes on; wait until it rests, or interrupt it"

    def owes(self, sender: int) -> bool:
        """Whether something of a client's waits, or plays."""
        return sender in self._documents or self.loop.owes(sender) or self.planner.serves(sender)

    async def fold(self) -> None:
        """Interrupts everything, and waits until the robot rests."""
        self.interrupt(None)
        while self.loop.is_alive() and (self._requests or not self.planner.free or not self.loop.settled()):
            await sleep(LOOK)

    def close(self) -> None:
        """Ends loop and planner; servos fold to rest now, if they have not."""
        self.loop.leave()
        if self.loop.is_alive():
            self.loop.join()
        if self._renewal is not None:
            self._renewal.cancel()
        self.planner.close()
        self.arming.close()
        self.desk.close()

    async def _renew(self) -> None:
        """Returns when the planner has been told to read gestures anew, which it is once a second at most."""
        if self._renewal is None or self._renewal.done():
            self._renewal = create_task(self._renew_soon())
        await shield(self._renewal)

    async def _renew_soon(self) -> None:
        await sleep(max(0.0, self._renewed + RENEWAL - monotonic()))
        self._renewed = monotonic()
        self._request(Renewal())

    def _request(self, request: ClientRequest) -> None:
        self._requests.append(request)
        self._feed()

    def _feed(self) -> None:
        """Gives the planner what is next, when it is free: requests before documents."""
        if self.planner.warm:
            self._warm.set()
        if not self.planner.free:
            return
        if self._requests:
            self.planner.send(self._requests.popleft())
        elif (document := self._documents.next()) is not None:
            self.planner.send(DocumentRequest(document, self.loop.stops))

    def _refuse_lost(self, present: ClientRequest | None) -> None:
        """Refuses the document over which the planner has died; without any planner the loop ends."""
        if self.planner.failed:
            self._warm.set()
            self.loop.leave()
        if isinstance(present, DocumentRequest):
            what = f"planning failed, or took longer than {self._rules.planning:g} s; send something simpler"
            self._refuse(present.message, "planning", what)

    def _refuse_all(self) -> None:
        self._refuse_stopped(iter(self._documents.clear()))

    def _refuse_stopped(self, documents: Iterator[Message]) -> None:
        """Refuses one document after the other; whoever waits for an answer has a turn in between."""
        document = next(documents, None)
        if document is not None:
            self._refuse(document, "stopped", "an emergency stop came; resume first")
            self._asyncio.call_soon(self._refuse_stopped, documents)

    def _refuse(self, document: Message, rule: str, what: str) -> None:
        self._tell(quota_feedback(rule, what, name=block_id(document.text)), document.sender)

    def _pass_on(self, message: str, sender: int) -> None:
        self._asyncio.call_soon_threadsafe(self._tell, message, sender)

    def _pass_news(self, news: PlannerReady | RequestDone | None) -> None:
        self._asyncio.call_soon_threadsafe(self.planner.receive, news)
