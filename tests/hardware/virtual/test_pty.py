"""Virtual wires in real time, with lower bounds of durations only."""

import os
import select
import termios
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Event, Thread

import pytest

from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.packet import Reader
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault
from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

pytestmark = pytest.mark.realtime

PATIENCE = 5.0  # [s] longest wait for a reply on a loaded machine

Opens = Callable[[Cable], Path]


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[Opens]:
    """Serve a wire in its own thread."""
    done, threads = Event(), []

    def open_one(cable: Cable) -> Path:
        _, buses = build_bus([cable])
        port = PtyPort(buses[cable.name], tmp_path / cable.name)
        port.exchange(0.0)
        thread = Thread(target=serve_wires, args=([port], lambda: not done.is_set()))
        thread.start()
        threads.append(thread)
        return port.link

    yield open_one
    done.set()
    for thread in threads:
        thread.join(PATIENCE)
        assert not thread.is_alive()


class Host:
    """Program at the other end of the pseudo-terminal."""

    def __init__(self, path: Path) -> None:
        self.end = os.open(path, os.O_RDWR | os.O_NOCTTY)

    def ask(self, data: bytes, count: int) -> bytes:
        """Send bytes, and wait for a number of reply bytes."""
        os.write(self.end, data)
        got, limit = b"", time.monotonic() + PATIENCE
        while len(got) < count and time.monotonic() < limit:
            if select.select([self.end], [], [], 0.1)[0]:
                came = os.read(self.end, 4096)
                if not came:
                    raise OSError("hung up")
                got += came
        return got

    def speak(self, baud: int) -> None:
        settings = termios.tcgetattr(self.end)
        settings[4] = settings[5] = getattr(termios, f"B{baud}")
        termios.tcsetattr(self.end, termios.TCSANOW, settings)


def wire(*faults: PlannedFault, count: int = 3, baud: int = 1_000_000) -> Cable:
    fittings = tuple(ServoFitting(servo) for servo in range(1, count + 1))
    return Cable("body", fittings, baud=baud, faults=FaultPlan(faults))


def test_servos_answer_a_broadcast_ping_through_a_pseudo_terminal(opened: Opens):
    host = Host(opened(wire()))
    got = host.ask(packet.ping(packet.BROADCAST_ID), 42)
    assert [status.id for status in Reader().feed(got)] == [1, 2, 3]


def test_bytes_on_a_pseudo_terminal_take_their_transmission_time(opened: Opens):
    """20 reads of 100 bytes are 134 bytes each: at least 0.4 s at 57600 baud."""
    host = Host(opened(wire(count=1, baud=57_600)))
    began = time.monotonic()
    for _ in range(20):
        assert len(host.ask(packet.read_packet(1, 0, 100), 111)) == 111
    assert time.monotonic() - began > 20 * (111 + 14) * 10 / 57_600


def test_servos_ignore_bytes_at_another_baud_rate(opened: Opens):
    host = Host(opened(wire(count=1)))
    host.speak(57_600)
    os.write(host.end, packet.ping(1))
    assert not select.select([host.end], [], [], 0.05)[0]
    host.speak(1_000_000)
    assert len(host.ask(packet.ping(1), 14)) == 14


def test_replugged_pseudo_terminal_of_virtual_servos_has_its_previous_path(opened: Opens):
    path = opened(wire(PlannedFault("unplug", start=0.2, seconds=0.1), count=1))
    first = Host(path)
    assert len(first.ask(packet.ping(1), 14)) == 14
    limit = time.monotonic() + PATIENCE
    pulled = False
    while not pulled and time.monotonic() < limit:
        try:
            first.ask(packet.ping(1), 14)
        except OSError:
            pulled = True
    assert pulled
    back = None
    while back is None and time.monotonic() < limit:
        try:
            back = Host(path)
        except FileNotFoundError:
            time.sleep(0.01)
    assert back is not None
    assert len(back.ask(packet.ping(1), 14)) == 14


def test_closed_virtual_port_leaves_no_link_or_descriptor(tmp_path: Path):
    _, buses = build_bus([wire()])
    port = PtyPort(buses["body"], tmp_path / "body")
    rounds = iter([True, True, False])
    serve_wires([port], lambda: next(rounds))
    assert not port.link.is_symlink()
    assert port.descriptor is None
