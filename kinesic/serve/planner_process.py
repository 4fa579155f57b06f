"""Child processes of the server for planning and refinement.

The planner handles one request at a time. It is killed if it exceeds its time limit and replaced by a spare planner
that is warmed up already. Both share imported modules; a spare planner costs 55 MB of additional memory. Its warm-up
waits for a quiet time, because it would delay the first motion of a new server.
"""

import sys
from asyncio import TimerHandle, get_running_loop
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

from kinesic.child import Child, PipeEnd, ProcessContext
from kinesic.planning.setup import Setup
from kinesic.serve import planner, refiner
from kinesic.serve.forking import planning_context
from kinesic.serve.loop import Loop
from kinesic.serve.messages import ClientRequest, DocumentRequest, LoopStart, PlannerReady, Renewal, RequestDone
from kinesic.serve.wire.quotas import Quotas

PIPE_CAPACITY = 1 << 20  # [bytes] largest pipe buffer that Linux grants unprivileged processes
SPARE_DELAY = 2.0  # [s] time without a request after which a spare planner starts to warm up
MAX_SPARE_DELAY = 20.0  # [s] longest time from a warm planner to the start of its spare
MAX_COLD_DEATHS = 2  # consecutive planner deaths before warm-up after which the server gives up


@dataclass(frozen=True, eq=False)
class PlannerProcess:
    """Planner process and the server's ends of its pipes."""

    child: Child
    requests: PipeEnd
    loop: PipeEnd  # pipe end used by the loop
    refiner: PipeEnd  # pipe end used by the refiner
    renewals: int  # count of lexicon reloads requested before the process was started

    def end(self) -> None:
        """Kill the process without waiting."""
        self.requests.close()
        self.child.kill(wait=False)


class Planner:
    """Manager of the planner processes: the working one and its spare.

    Used only in the server's asyncio loop.
    """

    def __init__(
        self,
        make_setup: Callable[[], Setup],
        loop: Loop,
        *,
        rules: Quotas,
        idle: Callable[[], None],
        lost: Callable[[ClientRequest | None], None],
        spare_delay: float = SPARE_DELAY,
        tables: Sequence[str] = (),
    ) -> None:
        """Create a planner that is not started yet.

        Args:
            make_setup: creates the setup for planning, in the planner process.
            loop: receives the proposals.
            rules: limits for document size and planning time.
            idle: called whenever the planner can accept a request.
            lost: called with the current request after the planner has died; the planner is then restarted unless it
                failed.
            spare_delay: time without a request before a spare planner is started; 0: at once [s].
            tables: modules that are imported once for all processes.
        """
        self._make_setup, self._loop, self._rules, self._tables = make_setup, loop, rules, tables
        self._idle, self._lost = idle, lost
        self._working: PlannerProcess | None = None
        self._spare: PlannerProcess | None = None  # warming up, or waiting for activation
        self._spare_delay, self._spare_deadline = spare_delay, 0.0  # [s], and in the time of the asyncio loop [s]
        self._spare_start: TimerHandle | None = None  # start of a spare planner
        self._refiner: Child | None = None
        self._watch: TimerHandle | None = None
        self._current_request: ClientRequest | None = None  # request in progress
        self._cold_deaths = 0  # since the last warm planner
        self.is_warm = False
        self.deaths = 0  # planner processes that died
        self.has_failed = False  # whether no planner can be started
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="planner")
        self._renewals = 0  # requested lexicon reloads

    @property
    def is_free(self) -> bool:
        """Whether the planner is warm and has no request."""
        return self.is_warm and self._current_request is None

    @property
    def is_planning(self) -> bool:
        """Whether the planner is planning a document."""
        return isinstance(self._current_request, DocumentRequest)

    def serves(self, sender: int) -> bool:
        """Return whether the planner is planning a document of this client."""
        return isinstance(self._current_request, DocumentRequest) and self._current_request.message.sender == sender

    def start(self) -> None:
        """Activate the spare planner, or a new one if there is none."""
        if self._spare is None or not self._spare.child.is_alive:
            self._spare = self._begin()
        self._working, self._spare = self._spare, None
        beginning = self._loop.snapshot()
        self._thread.submit(
            _send, self._working.requests, beginning
        )  # in a thread, because long motions exceed the pipe buffer
        self._refiner = Child(
            self._context(), refiner.run_refiner, self._make_setup, self._working.refiner, name="refiner"
        )
        self._loop.connect_planner(self._working.loop, beginning)

    def _begin(self) -> PlannerProcess:
        """Start a planner process that warms up and waits for activation."""
        context = self._context()
        requests, to_requests = context.Pipe(duplex=False)
        _widen(to_requests)
        to_planner, to_loop = context.Pipe()
        from_planner, to_refiner = context.Pipe()
        arguments = (self._make_setup, requests, to_loop, to_refiner, self._loop.properties, self._rules)
        child = Child(context, planner.run_planner, *arguments, name="planner")
        return PlannerProcess(child, to_requests, to_planner, from_planner, self._renewals)

    def _begin_spare(self) -> None:
        if self._spare is None:
            self._spare = self._begin()

    def _schedule_spare(self) -> None:
        """Schedule a spare planner after a time without requests, before a deadline."""
        if self._spare_start is not None:
            self._spare_start.cancel()
        clock = get_running_loop()
        start = min(clock.time() + self._spare_delay, self._spare_deadline)
        self._spare_start = clock.call_at(start, self._begin_spare)

    def _context(self) -> ProcessContext:
        return planning_context(self._make_setup, self._tables)

    def send(self, request: ClientRequest) -> None:
        """Send a request to the planner, which must be free.

        Raises:
            RuntimeError: the planner is not warm or has a request.
        """
        if self._working is None or not self.is_free:
            raise RuntimeError("the planner is busy; send only when it is free")
        self._renewals += isinstance(request, Renewal)
        self._give(self._working, request)

    def _give(self, working: PlannerProcess, request: ClientRequest) -> None:
        self._current_request = request
        end = partial(working.child.kill, wait=False)
        self._watch = get_running_loop().call_later(self._rules.planning, end)
        if self._spare is None:
            self._schedule_spare()
        _send(working.requests, request)

    def receive(self, news: PlannerReady | RequestDone | None) -> None:
        """Handle a planner message, or the planner's death (message None)."""
        if self._watch is not None:
            self._watch.cancel()
        request, self._current_request = self._current_request, None
        match news:
            case PlannerReady():
                self.is_warm, self._cold_deaths = True, 0
                if not self._spare_delay:
                    self._begin_spare()
                self._spare_deadline = get_running_loop().time() + MAX_SPARE_DELAY
                if self._spare is None:
                    self._schedule_spare()
                if self._working is not None and self._working.renewals < self._renewals:
                    self._give(self._working, Renewal())
                self._idle()
            case RequestDone():
                self._idle()
            case None:
                self._cold_deaths += not self.is_warm
                self.deaths += 1
                self.is_warm = False
                self._end_working()
                self.has_failed = self._cold_deaths >= MAX_COLD_DEATHS
                self._lost(request)
                if not self.has_failed:
                    self.start()

    def close(self) -> None:
        """Kill all planner processes and wait for their end."""
        if self._spare_start is not None:
            self._spare_start.cancel()
        self._end_working()
        if self._spare is not None:
            self._spare.end()
        for process in (self._working, self._spare):
            if process is not None:
                process.child.wait()
        self._thread.shutdown(wait=False)

    def _end_working(self) -> None:
        if self._working is not None:
            self._working.end()
        if self._refiner is not None:
            self._refiner.kill(wait=False)


def _send(pipe: PipeEnd, message: LoopStart | ClientRequest) -> None:
    """Send a message to a planner process, if it is alive."""
    with suppress(OSError):  # the planner has died; the loop reports it
        pipe.send(message)


def _widen(pipe: PipeEnd) -> None:
    """Enlarge the pipe buffer to the size of a document (Linux only)."""
    if sys.platform == "linux":
        import fcntl  # noqa: PLC0415 - Windows has none

        with suppress(OSError):
            fcntl.fcntl(pipe.fileno(), fcntl.F_SETPIPE_SZ, PIPE_CAPACITY)
