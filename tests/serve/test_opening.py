"""Opening and ending of a server whose parts only record their calls."""

import asyncio
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

from kinesic.serve import server
from kinesic.serve.address import Address
from kinesic.serve.desk.export import NO_WRITERS
from kinesic.serve.server import CLOSE_GOING_AWAY, THREAD_SWITCH_INTERVAL, open_serving, serve_until_done
from kinesic.serve.tracks import SoundAndFace
from kinesic.serve.wire.origin import Access
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS

ADDRESS = Address("127.0.0.1", 0)
PATIENCE = 8.0  # [s] longest wait for a condition that a test expects
CLOSING_CALLS = ["reception ends", "clients close", "reception ended", "stop lines close", "session closes"]


class House:
    """Parts of a server in the order of their calls."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.calls: list[str] = []
        self.fault: Exception | None = None  # of the start
        self.folding = 0.0  # [s]
        self.alive = True
        self.session = SimpleNamespace(
            start=self._start,
            fold=self._fold,
            close=lambda: self.calls.append("session closes"),
            emergency_stop=lambda: self.calls.append("stop"),
            loop=SimpleNamespace(is_alive=lambda: self.alive),
        )
        for name, replacement in (
            ("bound_heap", lambda: self.calls.append("heap bound")),
            ("ClientRegistry", self._make_registry),
            ("Session", self._make_session),
            ("StopLines", self._make_stop_lines),
            ("Reception", self._make_reception),
            ("raise_priority", self._raise_priority),
        ):
            monkeypatch.setattr(server, name, replacement)
        self.interval = sys.getswitchinterval()

    async def _start(self) -> None:
        self.calls.append("session starts")
        if self.fault is not None:
            raise self.fault

    async def _fold(self) -> None:
        self.calls.append("folds")
        await asyncio.sleep(self.folding)

    def _make_registry(self, rules, access, make_session) -> SimpleNamespace:
        self.rules, self.access = rules, access
        registry = SimpleNamespace(tell="tell", close=self._close_clients)
        registry.session = make_session(registry)
        return registry

    def _close_clients(self, code: int, why: str) -> None:
        assert code == CLOSE_GOING_AWAY == 1001
        self.calls.append("clients close")

    def _make_session(self, *arguments: object, **options: object) -> SimpleNamespace:
        self.session_arguments = arguments, options
        return self.session

    def _make_stop_lines(self, stop, rules) -> SimpleNamespace:
        stop()
        assert rules is self.rules
        return SimpleNamespace(
            open=lambda: self.calls.append("stop lines open"), close=lambda: self.calls.append("stop lines close")
        )

    def _make_reception(self, clients, stop_lines, files) -> SimpleNamespace:
        self.files = files

        async def end() -> None:
            self.calls.append("reception ended")

        def listen(host: str, port: int) -> int:
            self.calls.append(f"listens {host} {port}")
            return 4711

        return SimpleNamespace(
            listen=listen,
            open=lambda: self.calls.append("reception opens"),
            close=lambda: self.calls.append("reception ends"),
            end=end,
        )

    @contextmanager
    def _raise_priority(self) -> Iterator[None]:
        self.calls.append("priority raised")
        yield
        self.calls.append("priority lowered")

    def run(self, *, address: Address | None = ADDRESS, **options: object) -> Address | None:
        async def whole() -> Address | None:
            async with open_serving(make_setup, ["sink"], address=address, **options) as serving:
                self.calls.append("served")
                assert serving.clients.session is self.session
                assert sys.getswitchinterval() == pytest.approx(THREAD_SWITCH_INTERVAL)
                return serving.address

        return asyncio.run(whole())


def make_setup() -> None: ...


@pytest.fixture
def house(monkeypatch: pytest.MonkeyPatch) -> Iterator[House]:
    made = House(monkeypatch)
    yield made
    sys.setswitchinterval(made.interval)


def test_server_binds_its_address_before_the_session_starts_and_admits_clients_after(house: House) -> None:
    assert house.run() == Address("127.0.0.1", 4711)
    assert house.calls == [
        "heap bound",
        "stop",
        "listens 127.0.0.1 0",
        "session starts",
        "stop lines open",
        "reception opens",
        "priority raised",
        "served",
        "priority lowered",
        "reception ends",
        "folds",
        *CLOSING_CALLS,
    ]


def test_server_without_an_address_does_not_listen(house: House) -> None:
    assert house.run(address=None) is None
    assert not any(call.startswith("listens") for call in house.calls)
    assert house.calls[-5:] == CLOSING_CALLS


def test_server_passes_its_options_to_its_parts(house: House) -> None:
    options = {"accompaniment": SoundAndFace(face=True), "folder": Path("kept")}
    access, files = Access("open sesame"), {"/": "file"}
    house.run(access=access, files=files, **options)
    assert (house.rules, house.access, house.files) == (DEFAULT_QUOTAS, access, files)
    assert house.session_arguments == (
        (make_setup, ["sink"], DEFAULT_QUOTAS, "tell"),
        options | {"writers": NO_WRITERS},
    )


def test_server_that_cannot_start_closes_its_parts_without_folding_the_arms(house: House) -> None:
    house.fault = RuntimeError("no planner")
    with pytest.raises(RuntimeError, match="no planner"):
        house.run()
    assert house.calls[3:] == ["session starts", *CLOSING_CALLS]


def test_server_ends_after_the_folding_timeout(house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "FOLDING_TIMEOUT", 0.01)
    house.folding = PATIENCE
    house.run()
    assert house.calls[-6:] == ["folds", *CLOSING_CALLS]


class Served:
    """Server with a console that ends, a loop that may fail, and a shutdown."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *, address: Address | None) -> None:
        monkeypatch.setattr(server, "LOOP_POLL_PERIOD", 0.001)
        monkeypatch.setattr(server, "serve_console", self._read)
        self.alive, self.input_ended = True, False
        self.consoles: list[object] = []
        self.cancelled = False
        session = SimpleNamespace(loop=SimpleNamespace(is_alive=lambda: self.alive))
        self.open = SimpleNamespace(clients=SimpleNamespace(session=session), address=address)

    async def _read(self, clients: object, make_console: object) -> None:
        assert clients is self.open.clients
        self.consoles.append(make_console)
        try:
            while not self.input_ended:
                await asyncio.sleep(0.001)
        except asyncio.CancelledError:
            self.cancelled = True
            raise

    async def lasts(self, shutdown: asyncio.Event, **options: object) -> asyncio.Task[None]:
        """Return the task of the server after some turns of the loop."""
        task = asyncio.create_task(serve_until_done(self.open, shutdown, **options))
        for _ in range(20):
            await asyncio.sleep(0.001)
        assert not task.done()
        return task


async def ends(task: asyncio.Task[None]) -> None:
    async with asyncio.timeout(PATIENCE):
        await task
    assert len(asyncio.all_tasks()) == 1  # no reader is left behind


def test_shutdown_ends_the_server_and_cancels_reading_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    async def run() -> None:
        served, shutdown = Served(monkeypatch, address=None), asyncio.Event()
        task = await served.lasts(shutdown, console=True, make_console="console")
        shutdown.set()
        await ends(task)
        assert served.consoles == ["console"]
        assert served.cancelled

    asyncio.run(run())


def test_failed_control_loop_ends_the_server(monkeypatch: pytest.MonkeyPatch) -> None:
    async def run() -> None:
        served = Served(monkeypatch, address=ADDRESS)
        task = await served.lasts(asyncio.Event(), console=False)
        assert served.consoles == []
        served.alive = False
        await ends(task)

    asyncio.run(run())


@pytest.mark.parametrize(
    ("address", "ends_with_input", "ending"), [(None, False, True), (ADDRESS, True, True), (ADDRESS, False, False)]
)
def test_end_of_standard_input_ends_a_server_without_an_address_or_if_requested(
    monkeypatch: pytest.MonkeyPatch, address: Address | None, ends_with_input: bool, ending: bool
) -> None:
    async def run() -> None:
        served, shutdown = Served(monkeypatch, address=address), asyncio.Event()
        task = await served.lasts(shutdown, console=True, ends_with_input=ends_with_input)
        served.input_ended = True
        if not ending:
            for _ in range(20):
                await asyncio.sleep(0.001)
            assert not task.done()
            shutdown.set()
        await ends(task)

    asyncio.run(run())
