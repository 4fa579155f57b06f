"""Loop, planner and waiting documents of a server."""

from asyncio import AbstractEventLoop, Event, Task, create_task, get_running_loop, shield, sleep, timeout
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import Literal

from kinesic.planning.setup import Setup
from kinesic.realizer.request import Message, block_id
from kinesic.serve.conversation_requests import conversation_requests, drop_outdated, end_of_conversation
from kinesic.serve.desk.desk import Desk
from kinesic.serve.desk.export import NO_WRITERS, Writers
from kinesic.serve.kept_conversation import KeptConversation
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
from kinesic.serve.tracks import NO_ACCOMPANIMENT, SoundAndFace, TrackEffects
from kinesic.serve.wire.conversing import ConversationMessage
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.quotas import Quotas, quota_feedback
from kinesic.speech.speaker import Speaker
from kinesic.speech.voice import table_modules

START_POLL_PERIOD = 0.1  # [s] between two checks of the loop thread while the planner starts
SETTLE_POLL_PERIOD = 0.02  # [s] between two checks whether the robot is at rest
RENEWAL_PERIOD = 1.0  # [s] minimum time between two lexicon reloads


class Session:
    """Control loop, planner and queues that perform documents of clients."""

    def __init__(
        self,
        make_setup: Callable[[], Setup],
        sinks: Sequence[RealTimeSink],
        rules: Quotas,
        send_feedback: Callable[[str, int], None],
        *,
        accompaniment: SoundAndFace = NO_ACCOMPANIMENT,
        folder: Path | None = None,
        writers: Writers = NO_WRITERS,
    ) -> None:
        """Create the loop and the planner.

        Nothing moves yet.

        Args:
            make_setup: creates the setup for planning, here and in the planner process.
            sinks: sinks to drive.
            rules: limits for waiting blocks and planning time.
            send_feedback: called in the asyncio loop with a message and the number of the client that receives it.
            accompaniment: whether a sink shows the face and whether speech is audible.
            folder: folder for documents of clients; None disables saving.
            writers: additional file writers for exports; picklable.
        """
        self._asyncio: AbstractEventLoop = get_running_loop()
        self._send_feedback, self._rules, self._sinks = send_feedback, rules, sinks
        self._documents, self._requests = FairQueue(rules.waiting), deque[ClientRequest]()
        self._is_stopped, self._conversation = False, KeptConversation()  # whether an emergency stop holds
        self._warm = Event()
        self._renewal: Task[None] | None = None  # requests the next lexicon reload
        self._renewed = -RENEWAL_PERIOD  # [s] monotonic clock time of the last requested reload
        self.clock = Clock()
        self.speaker = Speaker(self.clock.now) if accompaniment.sound else None
        effects = TrackEffects(self.speaker, face=accompaniment.face)
        setup = make_setup()
        self.loop = Loop(
            setup, sinks, self.clock, effects=effects, send_feedback=self._pass_on, notify_server=self._pass_news
        )
        tables = table_modules(setup.voice)
        self.planner = Planner(
            make_setup, self.loop, rules=rules, idle=self._feed, lost=self._refuse_lost, tables=tables
        )
        self.desk = Desk(
            make_setup, self.loop, rules, folder=folder, on_gestures_saved=self._renew, writers=writers, tables=tables
        )
        self.arming = Arming(self.loop, self)

    async def start(self) -> None:
        """Start the loop and wait until the planner is warm.

        Raises:
            BusError: the servos stopped meanwhile.
            RuntimeError: the planner does not start.
        """
        self.planner.start()
        self.loop.start()
        while not self._warm.is_set() and self.loop.is_alive():
            with suppress(TimeoutError):
                async with timeout(START_POLL_PERIOD):
                    await self._warm.wait()
        if self.loop.error is not None:
            raise self.loop.error
        if self.planner.has_failed or not self._warm.is_set():
            raise RuntimeError("the planner does not start")
        self.loop.late_ticks = 0  # delays of the start do not count

    def perform(self, document: Message) -> str | None:
        """Queue a document, or return the BML feedback that refuses it.

        None if the document is accepted.
        """
        obstacle = self._find_obstacle()
        if obstacle is not None:
            return quota_feedback(*obstacle, name=block_id(document.text))
        if not self._documents.add(document):
            why = f"{self._rules.waiting} of your blocks already wait to be planned; send fewer at once"
            return quota_feedback("waiting", why, name=block_id(document.text))
        self._feed()
        return None

    def emergency_stop(self) -> None:
        """Request an emergency stop and refuse all waiting documents.

        Thread-safe and non-blocking.

        Raises:
            RuntimeError: the loop has ended, so that no stop is possible.
        """
        if not self.loop.is_alive():
            raise RuntimeError("the control loop has ended")
        self.loop.emergency_stop()
        self._is_stopped = True
        self._conversation.forget()
        self._asyncio.call_soon_threadsafe(self._refuse_all)

    def resume(self) -> None:
        """Return to rest after an emergency stop and accept documents again.

        Servos that hold are resumed.
        """
        self.loop.resume()
        if self._is_stopped:
            self._is_stopped = False
            self._request(Resumption(self.loop.stop_count))

    def interrupt(self, block: str | None, *, yields: bool = False, sender: int | None = None) -> None:
        """End one block, or all blocks if None, with a smooth return.

        Speech fades out at the next tick of the loop, before the motion is planned.

        Args:
            block: id of the block.
            yields: whether arms hold before they return, because a person speaks.
            sender: client to be told the text heard so far, if the block yields.
        """
        self.loop.change_sound(lambda effects: effects.silence(block))
        if block is None:
            for document in self._documents.clear():
                self._refuse(document, "interrupted", "everything was interrupted before this was planned")
        self._request(Interruption(block, yields, self.clock.now(), sender))

    def converse(self, message: ConversationMessage, sender: int) -> str:
        """Forward a conversation message, or return the reason against a conversation."""
        obstacle = self._find_obstacle()
        if obstacle is None:
            for request in conversation_requests(message, sender, self.loop.stop_count):
                self._conversation.keep(request, self.clock.now())
                drop_outdated(self._requests, request)
                self._request(request)
        return "" if obstacle is None else obstacle[1]

    @property
    def converses(self) -> bool:
        """Whether a conversation runs."""
        return self._conversation.owner is not None

    def _find_obstacle(self) -> tuple[str, str] | None:
        """Return rule and reason that prevent motion, or None."""
        if self._is_stopped:
            return "stopped", "an emergency stop holds; resume first"
        if self.loop.needs_resume():
            return "stopped", "the servos hold after an interruption of more than a second; resume first"
        if self.loop.servos is not None and not self.loop.servos.armed:
            return "limp", "the servos have no torque; arm them first"
        return None

    def restyle(self, restyling: Restyling) -> None:
        """Change the style of one block, or of running and future ones."""
        self._request(restyling)

    def status(self) -> dict[str, object]:
        """Return state, time, queue length and fault counters."""
        return {
            "robot": self.loop.robot,
            "state": self._state,
            "blocks": [block.status(self.clock.now()) for block in self.loop.pending_blocks()],
            "stops": self.loop.stop_count,
            "idles": self.loop.is_idling and self._state != "stopped",
            "servos": None if self.loop.servos is None else self.loop.servos.state,
            "time": round(self.clock.now(), 3),
            "waiting": len(self._documents),
            "planning": self.planner.is_planning,
            "planner": "warm" if self.planner.is_warm else "starting",
            "late": self.loop.late_ticks,
            "deaths": self.planner.deaths,
            "learned": [str(sink.lesson) for sink in self._sinks if sink.lesson is not None],
        }

    @property
    def _state(self) -> Literal["stopped", "resting", "playing"]:
        if self._is_stopped or self.loop.needs_resume():
            return "stopped"
        return "resting" if self.loop.is_settled() or self.loop.is_idling else "playing"

    @property
    def arming_obstacle(self) -> str:
        """Reason that prevents arming the servos, empty if none.

        Servos may be armed only while the motion rests.
        """
        if self._is_stopped:
            return "an emergency stop holds; resume first"
        return "" if self._state != "playing" else "the robot moves; wait until it rests, or interrupt it"

    def has_unfinished_blocks(self, sender: int) -> bool:
        """Return whether a client has waiting, planned or running blocks."""
        return sender in self._documents or self.loop.has_unfinished_blocks(sender) or self.planner.serves(sender)

    async def fold(self) -> None:
        """End blocks and conversation, and wait until the robot is at rest."""
        if self.converses:
            self._request(end_of_conversation(self.loop.stop_count))
        self.interrupt(None)
        while self.loop.is_alive() and (self._requests or not self.planner.is_free or not self.loop.is_settled()):
            await sleep(SETTLE_POLL_PERIOD)

    def close(self) -> None:
        """End the loop and the planner.

        Servos fold to rest if necessary.
        """
        self.loop.shut_down()
        if self.loop.is_alive():
            self.loop.join()
        if self._renewal is not None:
            self._renewal.cancel()
        self.planner.close()
        self.arming.close()
        self.desk.close()

    async def _renew(self) -> None:
        """Queue a lexicon reload for the planner, at most once a second."""
        if self._renewal is None or self._renewal.done():
            self._renewal = create_task(self._renew_soon())
        await shield(self._renewal)

    async def _renew_soon(self) -> None:
        await sleep(max(0.0, self._renewed + RENEWAL_PERIOD - monotonic()))
        self._renewed = monotonic()
        self._request(Renewal())

    def _request(self, request: ClientRequest) -> None:
        self._requests.append(request)
        self._feed()

    def _feed(self) -> None:
        """Send the next client request or document to an idle planner.

        Requests precede documents.
        """
        if self.planner.is_warm:
            self._warm.set()
        if not self.planner.is_free:
            return
        if self._requests:
            self.planner.send(self._requests.popleft())
        elif (document := self._documents.next()) is not None:
            self.planner.send(DocumentRequest(document, self.loop.stop_count))

    def _refuse_lost(self, request: ClientRequest | None) -> None:
        """Refuse a document whose planning ended with the planner process.

        The next planner continues a conversation. If no planner can be started, the loop ends.
        """
        owner, requests = self._conversation.owner, self._conversation.restore(request, self.clock.now())
        self._requests.extendleft(reversed(requests))
        if owner is not None and not requests:
            self._send_feedback(json_answer("conversing", state="off"), owner)
        if self.planner.has_failed:
            self._warm.set()
            self.loop.shut_down()
        if isinstance(request, DocumentRequest):
            what = f"planning failed, or took longer than {self._rules.planning:g} s; send something simpler"
            self._refuse(request.message, "planning", what)

    def _refuse_all(self) -> None:
        self._refuse_stopped(iter(self._documents.clear()))

    def _refuse_stopped(self, documents: Iterator[Message]) -> None:
        """Refuse documents one by one so that other clients get their turn."""
        document = next(documents, None)
        if document is not None:
            self._refuse(document, "stopped", "an emergency stop came; resume first")
            self._asyncio.call_soon(self._refuse_stopped, documents)

    def _refuse(self, document: Message, rule: str, what: str) -> None:
        self._send_feedback(quota_feedback(rule, what, name=block_id(document.text)), document.sender)

    def _pass_on(self, message: str, sender: int) -> None:
        self._asyncio.call_soon_threadsafe(self._send_feedback, message, sender)

    def _pass_news(self, news: PlannerReady | RequestDone | None) -> None:
        self._asyncio.call_soon_threadsafe(self.planner.receive, news)
