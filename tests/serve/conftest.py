"""Fixtures: servers with real sockets in a thread, planners and simulations."""

import asyncio
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from time import monotonic, sleep
from types import ModuleType

import pytest

from kinesic.body.command import Command, Sink
from kinesic.body.robot import Robot
from kinesic.client import Client
from kinesic.motion.trajectory import stay
from kinesic.planning.setup import Setup
from kinesic.serve import loop as loop_module
from kinesic.serve import messages, planner_process
from kinesic.serve import session as session_module
from kinesic.serve.address import Address
from kinesic.serve.messages import Clock, LoopProperties, LoopStart
from kinesic.serve.planner import PlannerState
from kinesic.serve.planner_process import Planner
from kinesic.serve.server import Serving, open_serving, serve_until_done
from kinesic.serve.sinks.real_time import RealTimeSink, RealTwin
from kinesic.serve.tracks import NO_ACCOMPANIMENT, SoundAndFace
from kinesic.serve.wire.origin import OPEN_ACCESS, Access
from kinesic.serve.wire.pages import NO_FILES, WebFile
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS, Quotas
from kinesic.session.setup import set_up

from .planning_bench import Planning
from .simulated import Simulation
from .staged_session import Act, Stage


class Witness(RealTwin):
    """Simulated robot that records all commands with their arrival times."""

    def __init__(self, robot: Robot) -> None:
        super().__init__(robot)
        self.commands: list[tuple[float, Command]] = []
        self.closed = self.held = False

    def needs_resume(self) -> bool:
        """Return whether the sink holds until `resume`."""
        return self.held

    def resume(self) -> None:
        self.held = False

    def write(self, command: Command, /) -> None:
        self.commands.append((monotonic(), command))
        super().write(command)

    def close(self) -> None:
        self.closed = True
        super().close()


MAX_WAIT = 30.0  # [s] longest wait for a message or condition
OPENING_TIME = 60.0  # [s] longest wait for a server to open
NO_SPARE_DELAY = 3600.0  # [s] start of a spare planner, after the end of all tests


@dataclass
class Running:
    """Running server with the records of its sinks."""

    open: Serving
    witness: Witness
    tasks: asyncio.AbstractEventLoop

    @property
    def port(self) -> int:
        assert self.open.address is not None
        return self.open.address.port

    def client(self, **settings: object) -> Client:
        return Client(port=self.port, **settings)


@contextmanager
def running(
    rules: Quotas,
    access: Access = OPEN_ACCESS,
    *,
    files: Mapping[str, WebFile] = NO_FILES,
    folder: Path | None = None,
    make_setup: Callable[[], Setup] = set_up,
    more: Sequence[Sink] = (),
    has_spare: bool = False,
) -> Iterator[Running]:
    """Run a server on a free port, optionally with web files, a folder and sinks.

    Without a spare planner, which would warm up for nothing, a planner that dies is replaced by a new one.
    """
    witness, ready, results = Witness(set_up().robot), threading.Event(), []

    async def serve() -> None:
        enough = asyncio.Event()
        sinks = [RealTimeSink(sink) for sink in (witness, *more)]
        address = Address("127.0.0.1", 0)
        async with open_serving(
            make_setup,
            sinks,
            address=address,
            rules=rules,
            access=access,
            accompaniment=SoundAndFace(face=True),
            files=files,
            folder=folder,
        ) as open_:
            results.extend((Running(open_, witness, asyncio.get_running_loop()), enough))
            ready.set()
            await serve_until_done(open_, enough, console=False)

    thread = threading.Thread(target=lambda: asyncio.run(serve()))
    try:
        with pytest.MonkeyPatch.context() as patch:
            if not has_spare:
                patch.setattr(session_module, "Planner", partial(Planner, spare_delay=NO_SPARE_DELAY))
                patch.setattr(planner_process, "MAX_SPARE_DELAY", NO_SPARE_DELAY)
            thread.start()
            assert ready.wait(OPENING_TIME), "the server did not open"
        yield results[0]
    finally:
        if ready.wait(OPENING_TIME):  # a server that opens late would run until the end of all tests
            server, enough = results
            server.tasks.call_soon_threadsafe(enough.set)
        thread.join(60)
        assert not thread.is_alive()


@pytest.fixture(scope="package")
def server() -> Iterator[Running]:
    """Server with default limits except for the message rate.

    It shares the package scope, so it runs during all tests that follow its first use.
    """
    with running(Quotas(rate=1000.0, burst=1000), has_spare=True) as result:
        yield result


@pytest.fixture(scope="module")
def abused() -> Iterator[Running]:
    """Server for hostile documents, which may leave the robot in another posture."""
    with running(Quotas(rate=1000.0, burst=1000)) as result:
        yield result


@pytest.fixture(scope="module")
def guarded() -> Iterator[Running]:
    """Server with a token and tight limits."""
    rules = Quotas(
        message=2000, depth=8, rate=20.0, burst=10, waiting=2, clients=4, unread=64, patience=1.0, duration=20.0
    )
    with running(rules, Access("open sesame")) as result:
        yield result


@pytest.fixture
def wired() -> tuple[PlannerState, Connection]:
    """Active planner and the loop's end of its pipe."""
    setup, clock = set_up(), Clock()
    to_planner, to_loop = Pipe()
    beginning = LoopStart(stay(setup.robot.skeleton.rest, start=clock.now()), 0, ())
    properties = LoopProperties(clock, NO_ACCOMPANIMENT)
    return PlannerState(
        setup, lambda known: known, to_loop, Pipe()[0], properties, beginning=beginning, rules=DEFAULT_QUOTAS
    ), to_planner


@pytest.fixture(scope="session")
def becomes() -> Callable[[Callable[[], bool]], bool]:
    """Function that waits for a condition, with a time limit."""

    def waited(condition: Callable[[], bool]) -> bool:
        end = monotonic() + MAX_WAIT
        while not condition():
            if monotonic() > end:
                return False
            sleep(0.01)
        return True

    return waited


def patch_in_this_thread(
    monkeypatch: pytest.MonkeyPatch, module: ModuleType, name: str, simulated: Callable[..., object]
) -> None:
    """Replace a function of a module for calls of the current thread only.

    The loop of the shared server runs meanwhile and must not use simulated time.
    """
    real, owner = getattr(module, name), threading.get_ident()

    def chosen(*arguments: object) -> object:
        return simulated(*arguments) if threading.get_ident() == owner else real(*arguments)

    monkeypatch.setattr(module, name, chosen)


@pytest.fixture
def simulation(known: Setup, monkeypatch: pytest.MonkeyPatch) -> Simulation:
    made = Simulation(known)
    for module in (loop_module, messages):
        patch_in_this_thread(monkeypatch, module, "monotonic", made.read)
    patch_in_this_thread(monkeypatch, loop_module, "sleep", made.sleep)
    patch_in_this_thread(monkeypatch, loop_module, "wait", made.wait)
    return made


@pytest.fixture
def make_planning(known: Setup, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Planning]:
    """Factory of planners in simulated time."""
    made: list[Planning] = []
    patch_in_this_thread(monkeypatch, messages, "monotonic", lambda: made[-1].time if made else 0.0)

    def making(setup: Setup = known, **options: object) -> Planning:
        made.append(Planning(setup, **options))
        return made[-1]

    return making


@pytest.fixture
def planning(make_planning: Callable[..., Planning]) -> Planning:
    return make_planning()


@pytest.fixture(scope="module")
def lively() -> Setup:
    return set_up(idle=1.0)


@pytest.fixture
def on_stage(monkeypatch: pytest.MonkeyPatch) -> Callable[[Act], None]:
    def run(act: Act) -> None:
        async def whole() -> None:
            await act(Stage(monkeypatch))

        asyncio.run(whole())

    return run
