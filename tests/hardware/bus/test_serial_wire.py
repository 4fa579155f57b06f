import os
import termios
import threading
import time
import tty
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import serial

from kinesic.hardware.bus.bring_up import open_bus
from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.bus.cycle import Cycle
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault
from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

pytestmark = pytest.mark.realtime

SERVOS = [Servo(k + 1, SERVO_MODELS["xm430_w350"]) for k in range(4)]


@pytest.fixture
def ends(tmp_path: Path) -> Iterator[tuple[int, Path]]:
    """Return a pseudo-terminal's own end, and the other end's device name."""
    ours, hosts = os.openpty()
    tty.setraw(hosts)
    yield ours, Path(os.ttyname(hosts))
    for end in (ours, hosts):
        os.close(end)


def serving(folder: Path, faults: FaultPlan) -> Iterator[tuple[Path, ShaftSimulation]]:
    plant, buses = build_bus([Cable("body", tuple(ServoFitting(servo.id) for servo in SERVOS), faults=faults)])
    link, running = folder / "port", threading.Event()
    running.set()
    thread = threading.Thread(target=serve_wires, args=([PtyPort(buses["body"], link)], running.is_set))
    thread.start()
    while not link.exists():
        time.sleep(0.001)
    yield link, plant
    running.clear()
    thread.join()


@pytest.fixture
def port(tmp_path: Path) -> Iterator[tuple[Path, ShaftSimulation]]:
    """Serve virtual servos on a pseudo-terminal."""
    yield from serving(tmp_path, FaultPlan())


@pytest.fixture
def pulled(tmp_path: Path) -> Iterator[tuple[Path, ShaftSimulation]]:
    """Serve virtual servos on a port that is unplugged for a while after 1.5 s."""
    yield from serving(tmp_path, FaultPlan((PlannedFault("unplug", start=1.5, seconds=0.3),)))


def test_serial_port_sends_and_receives_bytes(ends: tuple[int, Path]):
    ours, path = ends
    wire = SerialWire(path, 1_000_000)
    wire.write(bytearray(b"\x00\xff\x11\x13\x0d\x0a"))
    assert os.read(ours, 100) == b"\x00\xff\x11\x13\x0d\x0a"
    os.write(ours, b"\xff\xfd\x00\x03\x04")
    assert wire.read(wire.now() + 1.0) == b"\xff\xfd\x00\x03\x04"
    assert wire.baud == 1_000_000
    assert wire.name == str(path)
    wire.close()
    wire.close()


def test_serial_read_and_sleep_wait_until_their_deadline(ends: tuple[int, Path]):
    wire = SerialWire(ends[1], 57_600)
    began = wire.now()
    assert wire.read(began + 0.02) == b""
    assert wire.now() - began >= 0.02
    assert wire.read(began) == b""
    wire.sleep(began + 0.04)
    assert wire.now() - began >= 0.04
    wire.close()


def test_serial_port_is_opened_exclusively(ends: tuple[int, Path]):
    wire = SerialWire(ends[1], 57_600)
    with pytest.raises(BusError, match="another program uses this port"):
        SerialWire(ends[1], 57_600)
    wire.close()
    SerialWire(ends[1], 57_600).close()


def test_opening_a_missing_serial_port_is_refused():
    with pytest.raises(BusError, match="/dev/ttyNONE: no such port; is the adapter plugged in"):
        SerialWire("/dev/ttyNONE", 57_600)


def test_port_without_permission_is_reported(ends: tuple[int, Path], monkeypatch: pytest.MonkeyPatch):
    def refuses(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(serial, "Serial", refuses)
    with pytest.raises(BusError, match=r"no permission; `sudo usermod -aG dialout \$USER`, then log in again"):
        SerialWire(ends[1], 57_600)


def test_regular_file_is_refused_as_a_serial_port(tmp_path: Path):
    file = tmp_path / "file"
    file.write_text("no port")
    with pytest.raises(BusError, match=r"cannot be opened|does not support"):
        SerialWire(file, 57_600)


def test_serial_port_lost_while_reading_is_reported(tmp_path: Path):
    ours, hosts = os.openpty()
    tty.setraw(hosts)
    wire = SerialWire(os.ttyname(hosts), 57_600)
    os.close(hosts)
    os.close(ours)
    with pytest.raises(BusError, match="the port is gone"):
        wire.read(wire.now() + 0.5)
    assert not wire.reopen()
    with pytest.raises(BusError, match="the port is gone"):
        wire.write(b"a")


def fill(wire: SerialWire) -> None:
    """Write more bytes than an unread terminal buffers."""
    for _ in range(1000):
        wire.write(b"old" * 100)


def test_serial_port_counts_as_lost_if_bytes_written_to_it_are_never_read(
    ends: tuple[int, Path], monkeypatch: pytest.MonkeyPatch
):
    flushed: list[int] = []
    monkeypatch.setattr(termios, "tcflush", lambda _, queue: flushed.append(queue))
    ours, path = ends
    wire = SerialWire(path, 57_600)
    flushed.clear()
    with pytest.raises(BusError, match=r"the port is gone.*it did not accept"):
        fill(wire)
    assert flushed == [termios.TCOFLUSH], "or old goals would come when it goes on"
    while b"new" not in os.read(ours, 10_000):
        wire.write(b"new")
    wire.close()


def test_bus_counts_as_lost_if_bytes_written_to_its_port_are_never_read(ends: tuple[int, Path]):
    wire = SerialWire(ends[1], 1_000_000)
    bus = Bus(wire, SERVOS, period=0.002)
    cycles: list[Cycle] = []
    while len(cycles) < 2000 and not (cycles and cycles[-1].lost):
        cycles.append(bus.cycle(np.full(len(SERVOS), 2048)))
    assert cycles[-1].lost
    assert [event.kind for event in cycles[-1].events if event.servo is None] == ["port lost"]
    wire.close()


def test_servos_answer_through_a_pseudo_terminal(port: tuple[Path, ShaftSimulation]):
    link, plant = port
    wire = SerialWire(link, 1_000_000)
    bus = open_bus(wire, SERVOS, period=0.02)
    assert bus.fast
    cycles: list[Cycle] = [bus.cycle() for _ in range(20)]
    assert max(cycle.fresh.sum() for cycle in cycles) == len(SERVOS)
    assert cycles[-1].positions.tolist() == [servo.memory[Register.PRESENT_POSITION] for servo in plant.servos]
    wire.close()


def test_serial_port_is_reopened_after_its_return(pulled: tuple[Path, ShaftSimulation]):
    wire = SerialWire(pulled[0], 1_000_000)
    bus = open_bus(wire, SERVOS, period=0.02)
    results: list[str] = []
    limit = time.monotonic() + 10.0
    while "port back" not in results and time.monotonic() < limit:
        cycle = bus.cycle()
        results += [event.kind for event in cycle.events if event.servo is None]
        wire.sleep(cycle.time + bus.period)
    assert results == ["port lost", "port back"]
    assert any(bus.cycle().fresh.any() for _ in range(20))
    wire.close()


def test_port_name_that_now_belongs_to_another_adapter_is_not_reopened(
    ends: tuple[int, Path], monkeypatch: pytest.MonkeyPatch
):
    wire = SerialWire(ends[1], 57_600)
    monkeypatch.setattr("kinesic.hardware.bus.serial_wire.find_stable_name", lambda path: Path("/dev/other"))
    assert not wire.reopen()


def test_link_that_leads_to_another_terminal_after_a_loss_is_not_reopened(tmp_path: Path):
    """Another simulation or a shell may get the terminal's number."""
    first, second = os.openpty(), os.openpty()
    number, link = tmp_path / "number", tmp_path / "port"  # a number, and the link of a killed simulation to it
    number.symlink_to(os.ttyname(first[1]))
    link.symlink_to(number)
    wire = SerialWire(link, 57_600)
    for end in first:
        os.close(end)
    number.unlink()
    number.symlink_to(os.ttyname(second[1]))
    assert not wire.reopen()
    link.unlink()  # a restarted simulation of this robot makes its own link
    link.symlink_to(os.ttyname(second[1]))
    assert wire.reopen()
    assert wire.reopen(), "the same terminal, after a stall"
    wire.close()
    for end in second:
        os.close(end)


def test_terminal_path_reused_by_another_terminal_is_not_reopened():
    first = os.openpty()
    path = os.ttyname(first[1])
    wire = SerialWire(path, 57_600)
    time.sleep(0.02)  # longer than the resolution of creation times
    for end in first:
        os.close(end)
    second = os.openpty()
    if os.ttyname(second[1]) == path:  # otherwise another program has taken the number
        assert not wire.reopen()
    for end in second:
        os.close(end)
