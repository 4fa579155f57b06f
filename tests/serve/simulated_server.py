"""The real loop and planner in one thread, on a simulated clock with chosen delays."""

from collections.abc import Callable, Iterator
from heapq import heappop, heappush
from itertools import count
from multiprocessing import Pipe
from multiprocessing.connection import Connection

from kinesic.planning.setup import Setup
from kinesic.serve.loop import PERIOD, Loop
from kinesic.serve.messages import ClientRequest, LoopProperties, PlannerReady, RequestDone
from kinesic.serve.planner import PlannerState
from kinesic.serve.refiner import RefinementJob, _refine, pack, unpack
from kinesic.serve.tracks import SILENT, Effects
from kinesic.serve.wire.quotas import USUAL


class SimulatedClock:
    """A clock that goes on only when it is told to."""

    def __init__(self) -> None:
        self.machine = 0.0  # [s] which never goes back
        self._offset = 0.0

    def now(self) -> float:
        """Time [s]."""
        return self.machine - self._offset

    def set(self, time: float) -> None:
        """Set the present time [s], as the loop does."""
        self._offset = self.machine - time


class SimulatedServer:
    """A server without sockets, threads and processes."""

    def __init__(self, setup: Setup, delays: Iterator[float]) -> None:
        """Begin at time 0, at rest.

        Args:
            setup: robot and all else that planning needs.
            delays: [s] of proposals on their way to the loop, and of plans in the refiner.
        """
        self.clock, self.told = SimulatedClock(), list[tuple[float, int, str]]()  # [s], client, message
        self._setup, self._delays, self._numbers = setup, delays, count()
        self._events: list[tuple[float, int, Callable[[], None]]] = []  # of any thread
        self._requests: list[tuple[float, int, Callable[[], ClientRequest]]] = []
        self._refined: list[tuple[float, int, bytes]] = []
        self._next_tick = self._looked = 0.0
        self.loop = Loop(setup, [], self.clock, effects=Effects(), tell=self.tell, news=_ignore)
        self.start_planner()

    def tell(self, message: str, client: int) -> None:
        """Note what a client is told, and when."""
        self.told.append((self.clock.now(), client, message))

    def start_planner(self) -> None:
        """Have another planner take over, as after the death of one."""
        beginning = self.loop.beginning()
        self.pass_time(next(self._delays))
        self.pipe, self._planner_pipe = Pipe()
        self.loop.link(self.pipe, beginning)
        self._refined.clear()
        wire, properties = _LoopWire(self), LoopProperties(self.clock, SILENT)
        self.planner = PlannerState(
            self._setup, lambda known: known, wire, _RefinerWire(self), properties, beginning=beginning, rules=USUAL
        )

    def at(self, time: float, event: Callable[[], None]) -> None:
        """Have something happen at a time [s], whatever the planner does then."""
        heappush(self._events, (time, next(self._numbers), event))

    def request(self, time: float, make: Callable[[], ClientRequest]) -> None:
        """Request something of the planner at a time [s], or later if it is busy."""
        heappush(self._requests, (time, next(self._numbers), make))

    def run(self, until: float) -> None:
        """Let loop and planner work until a time [s]."""
        while (now := self.clock.machine) < until:
            if self._planner_pipe.poll():
                self.planner.take_halt(self._planner_pipe.recv())
            elif self._requests and self._requests[0][0] <= now:
                self.planner.fulfil(heappop(self._requests)[2]())
            elif self._refined and self._refined[0][0] <= now:
                self.planner.improve(heappop(self._refined)[2])
            elif (pause := self.planner.pause) is not None and self._looked + pause <= now:
                self.planner.go_on()
            else:
                self.pass_time(PERIOD / 4)
                continue
            self.planner.request_refinement()
            self._looked = self.clock.machine

    def stall_loop(self, seconds: float) -> None:
        """Have the loop miss ticks, as on a machine that stands still for its thread alone."""
        self._next_tick += seconds

    def pass_time(self, seconds: float) -> None:
        """Let time pass, in which the loop ticks and events happen."""
        end = self.clock.machine + seconds
        while (coming := min(self._next_tick, self._events[0][0] if self._events else end)) < end:
            self.clock.machine = max(self.clock.machine, coming)
            if coming == self._next_tick:
                self.loop._tick()
                self._next_tick += PERIOD
            else:
                heappop(self._events)[2]()
        self.clock.machine = max(self.clock.machine, end)

    def is_busy(self) -> bool:
        """Whether a block waits, plays, or has feedback to be sent."""
        scene = self.planner._shared.scene
        return bool(scene.blocks or scene.agenda or self._requests or any(map(self.loop.owes, range(9))))

    def receive(self) -> object:
        """Wait for what the loop sends to the planner."""
        while not self._planner_pipe.poll():
            self.pass_time(PERIOD / 4)
        return self._planner_pipe.recv()

    def deliver(self, message: object) -> None:
        """Hand a message of the planner to the loop, some time later."""
        self.pass_time(next(self._delays))
        while self.loop._planner is not self.pipe:  # it listens to a planner from its next tick on
            self.pass_time(PERIOD / 4)
        self.loop._receive(message, self.pipe)

    def refine(self, job: bytes) -> None:
        """Plan a block anew, for some time later."""
        found = unpack(job, self._setup)
        assert isinstance(found, RefinementJob)
        result = pack(_refine(found.request, self._setup))
        heappush(self._refined, (self.clock.machine + next(self._delays), next(self._numbers), result))


class _LoopWire(Connection):
    """The planner's end of its pipe to the loop."""

    def __init__(self, server: SimulatedServer) -> None:
        self._server, self._handle = server, None

    def send(self, message: object) -> None:
        self._server.deliver(message)

    def recv(self) -> object:
        return self._server.receive()


class _RefinerWire(Connection):
    """The planner's end of its pipe to the refiner."""

    def __init__(self, server: SimulatedServer) -> None:
        self._server, self._handle = server, None

    def send_bytes(self, job: bytes) -> None:
        self._server.refine(job)


def _ignore(news: PlannerReady | RequestDone | None) -> None:
    pass
