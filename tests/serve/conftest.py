"""A server of the tests' own, with real sockets, in a thread."""

import asyncio
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from time import monotonic, sleep

import pytest

from kinesic.body.command import Command, Sink
from kinesic.client import Client
from kinesic.controller.perform import set_up
from kinesic.motion.trajectory import stay
from kinesic.planning.setup import Setup
from kinesic.serve import loop as loop_module
from kinesic.serve import messages
from kinesic.serve.messages import Clock, LoopProperties, LoopStart
from kinesic.serve.planner import PlannerState
from kinesic.serve.server import Address, Serving, open_serving, until_done
from kinesic.serve.sinks.real_time import RealTimeSink, RealTwin
from kinesic.serve.tracks import SILENT, SoundAndFace
from kinesic.serve.wire.origin import ANYBODY_HERE, Access
from kinesic.serve.wire.pages import NO_FILES, WebFile
from kinesic.serve.wire.quotas import USUAL, Quotas

from .planning_bench import Planning
from .simulated import Simulation
from .staged_session import Act, Stage


class Witness:
    """A sink that keeps all commands, with the time at which they came."""

    def __init__(self) -> None:
        self.commands: list[tuple[float, Command]] = []
        self.closed = self.held = False

    def waits(self) -> bool:
        """Whether it was out of hand, and wants consent."""
        return self.held

    def resume(self) -> None:
        self.held = False

    def write(self, command: Command, /) -> None:
        self.commands.append((monotonic(), command))

    def close(self) -> None:
        self.closed = True


PATIENCE = 30.0  # [s]


@dataclass
class Running:
    """A server that runs, and what its sinks saw."""

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
    access: Access = ANYBODY_HERE,
    *,
    files: Mapping[str, WebFile] = NO_FILES,
    folder: Path | None = None,
    make_setup: Callable[[], Setup] = set_up,
    more: Sequence[Sink] = (),
) -> Iterator[Running]:
    """A server on a free port, with files for browsers, a folder of documents and more sinks if any are given."""
    witness, ready, found = Witness(), threading.Event(), []

    async def serve() -> None:
        enough = asyncio.Event()
        sinks = [RealTimeSink(sink) for sink in (witness, RealTwin(set_up().robot), *more)]
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
            found.extend((Running(open_, witness, asyncio.get_running_loop()), enough))
            ready.set()
            await until_done(open_, enough, console=False)

    thread = threading.Thread(target=lambda: asyncio.run(serve()))
    thread.start()
    assert ready.wait(60), "the server did not open"
    server, enough = found
    try:
        yield server
    finally:
        server.tasks.call_soon_threadsafe(enough.set)
        thread.join(60)
        assert not thread.is_alive()


@pytest.fixture(scope="package")
def server() -> Iterator[Running]:
    """With the usual rules, but for the rate; it works as long as it is open, so not beside other tests."""
    with running(Quotas(rate=1000.0, burst=1000)) as found:
        yield found


@pytest.fixture(scope="module")
def abused() -> Iterator[Running]:
    """For documents that make no sense, which may leave the robot in another stance."""
    with running(Quotas(rate=1000.0, burst=1000)) as found:
        yield found


@pytest.fixture(scope="module")
def guarded() -> Iterator[Running]:
    """With a token and tight rules."""
    rules = Quotas(
        message=2000, depth=8, rate=20.0, burst=10, waiting=2, clients=4, unread=64, patience=1.0, duration=20.0
    )
    with running(rules, Access("open sesame")) as found:
        yield found


@pytest.fixture
def wired() -> tuple[PlannerState, Connection]:
    """A planner that has taken over, and the loop's end of its pipe."""
    setup, clock = set_up(), Clock()
    to_planner, to_loop = Pipe()
    beginning = LoopStart(stay(setup.robot.skeleton.rest, start=clock.now()), 0, ())
    properties = LoopProperties(clock, SILENT)
    return PlannerState(
        setup, lambda known: known, to_loop, Pipe()[0], properties, beginning=beginning, rules=USUAL
    ), to_planner


@pytest.fixture(scope="session")
def becomes() -> Callable[[Callable[[], bool]], bool]:
    """Waits until something is so; whether it became so in time."""

    def waited(condition: Callable[[], bool]) -> bool:
        end = monotonic() + PATIENCE
        while not condition():
            if monotonic() > end:
                return False
            sleep(0.01)
        return True

    return waited


@pytest.fixture
def simulation(known: Setup, monkeypatch: pytest.MonkeyPatch) -> Simulation:
    made = Simulation(known)
    for module in (loop_module, messages):
        monkeypatch.setattr(module, "monotonic", made.read)
    monkeypatch.setattr(loop_module, "sleep", made.sleep)
    monkeypatch.setattr(loop_module, "wait", made.wait)
    return made


@pytest.fixture
def make_planning(known: Setup, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Planning]:
    """Makes planners whose time goes on only when they are told to."""
    made: list[Planning] = []
    monkeypatch.setattr(messages, "monotonic", lambda: made[-1].time if made else 0.0)

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
