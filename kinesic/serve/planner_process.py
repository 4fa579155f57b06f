"""Keeps planner and refiner as child processes: one request at a time, killed when they hang, and replaced at once.

A spare planner is warm beside the one that works. Both share what they have imported; it costs 55 MB of its own.
"""

import fcntl
import sys
from asyncio import TimerHandle, get_running_loop
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, SpawnContext

from kinesic.child import Child, child_context
from kinesic.controller import perform
from kinesic.planning.setup import Setup
from kinesic.serve import planner, refiner
from kinesic.serve.loop import Loop
from kinesic.serve.messages import ClientRequest, DocumentRequest, LoopStart, PlannerReady, Renewal, RequestDone
from kinesic.serve.wire.quotas import Quotas

PIPE = 1 << 20  # [bytes] that anybody may have a pipe keep
COLD_DEATHS = 2  # of planners one after the other before they are warm: there is no hope for a third


@dataclass(frozen=True, eq=False)
class PlannerProcess:
    """A planner and the server's ends of its pipes."""

    child: Child
    requests: Connection
    loop: Connection  # for the loop
    refiner: Connection  # for a refiner
    renewals: int  # how often gestures had been read anew when it began

    def end(self) -> None:
        """Ends it at once, in whatever state it is."""
        self.requests.close()
        self.child.kill(wait=False)


class Planner:
    """The planner as the server sees it; everything here happens in the asyncio loop of the server."""

    def __init__(
        self,
        make_setup: Callable[[], Setup],
        loop: Loop,
        *,
        rules: Quotas,
        idle: Callable[[], None],
        lost: Callable[[ClientRequest | None], None],
    ) -> None:
        """Not started yet.

        Args:
            make_setup: makes what planning needs, in the other process.
            loop: gets what is planned.
            rules: how large a document may be, and how long one request may take.
            idle: called whenever it can take a request.
            lost: called with what it was doing, when it has died; it is then started again, unless it failed.
        """
        self._make_setup, self._loop, self._rules = make_setup, loop, rules
        self._idle, self._lost = idle, lost
        self._working: PlannerProcess | None = None
        self._spare: PlannerProcess | None = None  # warms up, or waits for its turn
        self._refiner: Child | None = None
        self._watch: TimerHandle | None = None
        self._present: ClientRequest | None = None  # what it is doing
        self._cold_deaths = 0  # since one was warm
        self.warm = False
        self.deaths = 0  # so far
        self.failed = False  # it cannot even be started
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="planner")
        self._renewals = 0  # how often gestures were to be read anew

    @property
    def free(self) -> bool:
        """Whether it waits for something to do."""
        return self.warm and self._present is None

    def serves(self, sender: int) -> bool:
        """Whether it plans a document of this sender."""
        return isinstance(self._present, DocumentRequest) and self._present.message.sender == sender

    def start(self) -> None:
        """Has the spare planner take over, or a new one where there is none; it says when it is warm."""
        if self._spare is None or not self._spare.child.is_alive:
            self._spare = self._begin()
        self._working, self._spare = self._spare, None
        beginning = self._loop.beginning()
        self._thread.submit(_send, self._working.requests, beginning)  # long motions do not go into a pipe at once
        self._refiner = Child(
            self._context(), refiner.run_refiner, self._make_setup, self._working.refiner, name="refiner"
        )
        self._loop.link(self._working.loop, beginning)

    def _begin(self) -> PlannerProcess:
        """Begins a planner, which warms up and then waits for the state of the loop."""
        context = self._context()
        requests, to_requests = context.Pipe(duplex=False)
        _widen(to_requests)
        to_planner, to_loop = context.Pipe()
        from_planner, to_refiner = context.Pipe()
        given = (self._make_setup, requests, to_loop, to_refiner, self._loop.properties, self._rules)
        child = Child(context, planner.run_planner, *given, name="planner")
        return PlannerProcess(child, to_requests, to_planner, from_planner, self._renewals)

    def _context(self) -> ForkServerContext | SpawnContext:
        """How processes begin: with nothing of the server's threads."""
        return child_context(planner.__name__, perform.__name__, self._make_setup.__module__)

    def send(self, request: ClientRequest) -> None:
        """Has it fulfil a request; only while it is free."""
        if self._working is None or not self.free:
            raise RuntimeError("the planner is at work: send when it is free")
        self._renewals += isinstance(request, Renewal)
        self._give(self._working, request)

    def _give(self, working: PlannerProcess, request: ClientRequest) -> None:
        self._present = request
        end = partial(working.child.kill, wait=False)
        self._watch = get_running_loop().call_later(self._rules.planning, end)
        _send(working.requests, request)

    def receive(self, news: PlannerReady | RequestDone | None) -> None:
        """Takes what it says to the server; None: it has died."""
        if self._watch is not None:
            self._watch.cancel()
        present, self._present = self._present, None
        match news:
            case PlannerReady():
                self.warm, self._cold_deaths = True, 0
                if self._spare is None:
                    self._spare = self._begin()
                if self._working is not None and self._working.renewals < self._renewals:
                    self._give(self._working, Renewal())
                self._idle()
            case RequestDone():
                self._idle()
            case None:
                self._cold_deaths += not self.warm
                self.deaths += 1
                self.warm = False
                self._end_working()
                self.failed = self._cold_deaths >= COLD_DEATHS
                self._lost(present)
                if not self.failed:
                    self.start()

    def close(self) -> None:
        """Ends the processes, and waits until they have."""
        self._end_working()
        if self._spare is not None:
            self._spare.end()
        for each in (self._working, self._spare):
            if each is not None:
                each.child.wait()
        self._thread.shutdown(wait=False)

    def _end_working(self) -> None:
        if self._working is not None:
            self._working.end()
        if self._refiner is not None:
            self._refiner.kill(wait=False)


def _send(pipe: Connection, message: LoopStart | ClientRequest) -> None:
    """Sends a planner what it waits for."""
    with suppress(OSError):  # it has died, as the loop will find out
        pipe.send(message)


def _widen(pipe: Connection) -> None:
    """Lets a pipe take a whole document at once, where the system can: nobody waits until it is read."""
    if sys.platform == "linux":
        with suppress(OSError):
            fcntl.fcntl(pipe.fileno(), fcntl.F_SETPIPE_SZ, PIPE)
