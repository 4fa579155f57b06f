"""Real loop and planner in one thread, in simulated time with chosen delays."""

from collections.abc import Callable, Iterator
from heapq import heappop, heappush
from itertools import count
from multiprocessing import Pipe
from multiprocessing.connection import Connection

from kinesic.planning.setup import Setup
from kinesic.serve.loop import TICK_PERIOD, Loop
from kinesic.serve.messages import ClientRequest, LoopProperties, PlannerReady, RequestDone
from kinesic.serve.planner import PlannerState
from kinesic.serve.refiner import RefinementJob, _refine, pack, unpack
from kinesic.serve.tracks import NO_ACCOMPANIMENT, TrackEffects
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS


class SimulatedClock:
    """Clock that the test advances."""

    def __init__(self) -> None:
        self.machine = 0.0  # [s] monotonic time
        self._offset = 0.0

    def now(self) -> float:
        """Return the time [s]."""
        return self.machine - self._offset

    def set(self, time: float) -> None:
        """Set the current time [s], as the loop does."""
        self._offset = self.machine - time


class SimulatedServer:
    """Server without sockets, threads and processes."""

    def __init__(self, setup: Setup, delays: Iterator[float]) -> None:
        """Create a resting server at time 0.

        Args:
            setup: setup for planning.
            delays: delays [s] of proposals to the loop and of plans in the refiner.
        """
        self.clock, self.told = SimulatedClock(), list[tuple[float, int, str]]()  # [s], client, message
        self._setup, self._delays, self._numbers = setup, delays, count()
        self._events: list[tuple[float, int, Callable[[], None]]] = []  # from any thread
        self._requests: list[tuple[float, int, Callable[[], ClientRequest]]] = []
        self._refined: list[tuple[float, int, bytes]] = []
        self._next_tick = self._looked = 0.0
        self.loop = Loop(setup, [], self.clock, effects=TrackEffects(), send_feedback=self.tell, notify_server=_ignore)
        self.start_planner()

    def tell(self, message: str, client: int) -> None:
        """Record a message to a client with its time."""
        self.told.append((self.clock.now(), client, message))

    def start_planner(self) -> None:
        """Replace the planner, as after its death."""
        beginning = self.loop.snapshot()
        self.pass_time(next(self._delays))
        self.pipe, self._planner_pipe = Pipe()
        self.loop.connect_planner(self.pipe, beginning)
        self._refined.clear()
        wire, properties = _LoopWire(self), LoopProperties(self.clock, NO_ACCOMPANIMENT)
        self.planner = PlannerState(
            self._setup,
            lambda known: known,
            wire,
            _RefinerWire(self),
            properties,
            beginning=beginning,
            rules=DEFAULT_QUOTAS,
        )

    def at(self, time: float, event: Callable[[], None]) -> None:
        """Schedule an event at a time [s]."""
        heappush(self._events, (time, next(self._numbers), event))

    def request(self, time: float, make: Callable[[], ClientRequest]) -> None:
        """Send a request to the planner at a time [s], or later if it is busy."""
        heappush(self._requests, (time, next(self._numbers), make))

    def run(self, until: float) -> None:
        """Run loop and planner until a time [s]."""
        while (now := self.clock.machine) < until:
            if self._planner_pipe.poll():
                self.planner.handle_stop(self._planner_pipe.recv())
            elif self._requests and self._requests[0][0] <= now:
                self.planner.execute(heappop(self._requests)[2]())
            elif self._refined and self._refined[0][0] <= now:
                self.planner.apply_refinement(heappop(self._refined)[2])
            elif (pause := self.planner.pause) is not None and self._looked + pause <= now:
                self.planner.advance_scene()
            else:
                self.pass_time(TICK_PERIOD / 4)
                continue
            self.planner.request_refinement()
            self._looked = self.clock.machine

    def stall_loop(self, seconds: float) -> None:
        """Skip control cycles of the loop, as if its thread were suspended."""
        self._next_tick += seconds

    def pass_time(self, seconds: float) -> None:
        """Advance the time with control cycles of the loop and scheduled events."""
        end = self.clock.machine + seconds
        while (coming := min(self._next_tick, self._events[0][0] if self._events else end)) < end:
            self.clock.machine = max(self.clock.machine, coming)
            if coming == self._next_tick:
                self.loop._tick()
                self._next_tick += TICK_PERIOD
            else:
                heappop(self._events)[2]()
        self.clock.machine = max(self.clock.machine, end)

    def is_busy(self) -> bool:
        """Return whether blocks or feedback are pending."""
        scene = self.planner._shared.scene
        return bool(
            scene.blocks or scene.agenda or self._requests or any(map(self.loop.has_unfinished_blocks, range(9)))
        )

    def receive(self) -> object:
        """Wait for a message from the loop to the planner."""
        while not self._planner_pipe.poll():
            self.pass_time(TICK_PERIOD / 4)
        return self._planner_pipe.recv()

    def deliver(self, message: object) -> None:
        """Deliver a planner message to the loop after a delay."""
        self.pass_time(next(self._delays))
        while self.loop._planner is not self.pipe:  # The loop reads from a planner after its next tick
            self.pass_time(TICK_PERIOD / 4)
        self.loop._handle_message(message, self.pipe)

    def refine(self, job: bytes) -> None:
        """Replan a block and deliver the result later."""
        unpacked = unpack(job, self._setup)
        assert isinstance(unpacked, RefinementJob)
        result = pack(_refine(unpacked.request, self._setup))
        heappush(self._refined, (self.clock.machine + next(self._delays), next(self._numbers), result))


class _LoopWire(Connection):
    """Planner end of its pipe to the loop."""

    def __init__(self, server: SimulatedServer) -> None:
        self._server, self._handle = server, None

    def send(self, message: object) -> None:
        self._server.deliver(message)

    def recv(self) -> object:
        return self._server.receive()


class _RefinerWire(Connection):
    """Planner end of its pipe to the refiner."""

    def __init__(self, server: SimulatedServer) -> None:
        self._server, self._handle = server, None

    def send_bytes(self, job: bytes) -> None:
        self._server.refine(job)


def _ignore(news: PlannerReady | RequestDone | None) -> None:
    pass
