"""Serial port on a pseudo-terminal with simulated `select`, clock and errors."""

import errno
import os
import termios
import tty
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
import serial

from kinesic.hardware.bus import serial_wire
from kinesic.hardware.bus.serial_wire import STALL_TIMEOUT, SerialWire, TerminalIdentity, _lock_terminal, _refusal
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, BusError

BAUD_RATE = 57_600  # [bit/s] baud rate of the serial port


class Port:
    """Both ends of a pseudo-terminal, with a simulated clock."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.file, self.other = os.openpty()
        tty.setraw(self.other)
        self.path = Path(os.ttyname(self.other))
        self.clock = 50.0
        self.waits: list[tuple[bool, float]] = []  # calls of `select`: whether for reading, and timeout [s]
        self.ready = True
        clock = SimpleNamespace(monotonic=lambda: self.clock, sleep=self._sleep)
        monkeypatch.setattr(serial_wire, "time", clock)
        monkeypatch.setattr(serial_wire, "select", SimpleNamespace(select=self._select))

    def _sleep(self, seconds: float) -> None:
        self.clock += seconds

    def _select(self, readers, writers, _, seconds: float) -> tuple[list, list, list]:
        self.waits.append((bool(readers), seconds))
        if not self.ready:
            self.clock += seconds
        return (list(readers), list(writers), []) if self.ready else ([], [], [])


@pytest.fixture
def port(monkeypatch: pytest.MonkeyPatch) -> Iterator[Port]:
    ends = Port(monkeypatch)
    yield ends
    for end in (ends.file, ends.other):
        os.close(end)


@pytest.fixture
def wire(port: Port) -> Iterator[SerialWire]:
    opened = SerialWire(str(port.path), BAUD_RATE)
    yield opened
    opened.close()


def test_port_is_opened_exclusively_without_a_timeout_and_without_old_bytes(port: Port) -> None:
    os.write(port.file, b"old")
    wire = SerialWire(port.path, BAUD_RATE)
    assert (wire.name, wire.baud, wire.now()) == (str(port.path), BAUD_RATE, 50.0)
    assert (wire._port.timeout, wire._port.exclusive, wire._port.baudrate) == (0, True, BAUD_RATE)
    assert os.read(wire._file, 10) == b""
    with pytest.raises(BusError, match="another program uses this port; `fuser"):
        SerialWire(port.path, BAUD_RATE)
    wire.close()
    wire.close()


def test_bytes_written_to_a_serial_port_are_sent_unchanged(port: Port, wire: SerialWire) -> None:
    wire.write(b"\x00\xff\r\n")
    assert os.read(port.file, 10) == b"\x00\xff\r\n"
    assert port.waits == []


def test_read_returns_all_bytes_that_have_arrived(port: Port, wire: SerialWire) -> None:
    os.write(port.file, b"\xff\xfd\x00")
    assert wire.read(50.5) == b"\xff\xfd\x00"
    assert port.waits == [(True, 0.5)]


def test_read_waits_until_its_deadline_or_returns_at_once_if_it_has_passed(port: Port, wire: SerialWire) -> None:
    port.ready = False
    assert wire.read(50.25) == b""
    assert wire.read(40.0) == b""
    assert port.waits == [(True, 0.25), (True, 0.0)]


def test_serial_port_that_is_readable_without_bytes_is_reported_as_gone(
    port: Port, wire: SerialWire, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serial_wire.os, "read", lambda file, size: b"")
    with pytest.raises(BusError, match=rf"{port.path}: the port is gone .*Input/output error"):
        wire.read(51.0)


def test_sleep_waits_until_a_time_or_returns_at_once_if_it_has_passed(port: Port, wire: SerialWire) -> None:
    wire.sleep(50.5)
    assert wire.now() == 50.5
    wire.sleep(50.0)
    assert wire.now() == 50.5


@pytest.fixture
def full(port: Port, wire: SerialWire, monkeypatch: pytest.MonkeyPatch) -> tuple[Port, SerialWire, list]:
    """Port whose output buffer holds only three bytes."""
    written: list[bytes] = []
    room = SimpleNamespace(bytes=3)

    def write(file: int, data: memoryview) -> int:
        if not room.bytes:
            raise BlockingIOError
        part = bytes(data[: room.bytes])
        written.append(part)
        room.bytes = 0 if port.ready is False else 3
        return len(part)

    flushed: list[int] = []
    monkeypatch.setattr(serial_wire.os, "write", write)
    monkeypatch.setattr(serial_wire.termios, "tcflush", lambda file, queue: flushed.append(queue))
    return port, wire, [written, flushed]


def test_long_output_to_a_serial_port_is_written_in_pieces(full) -> None:
    _, wire, (written, flushed) = full
    wire.write(bytearray(b"abcdefgh"))
    assert written == [b"abc", b"def", b"gh"]
    assert flushed == []


def test_stalled_output_of_a_serial_port_is_discarded_after_its_transmission_time_and_a_timeout(full) -> None:
    port, wire, (written, flushed) = full
    port.ready = False
    with pytest.raises(BusError, match=r"the port is gone \(it did not accept 5 of 8 bytes in time\)"):
        wire.write(b"abcdefgh")
    assert written == [b"abc"]
    assert flushed == [termios.TCOFLUSH]
    ((is_read, seconds),) = port.waits
    assert not is_read
    assert seconds == pytest.approx(8 * BITS_PER_BYTE / BAUD_RATE + STALL_TIMEOUT)


def test_write_to_a_port_that_takes_no_bytes_although_ready_times_out(full, monkeypatch: pytest.MonkeyPatch) -> None:
    port, wire, (_, flushed) = full

    def refuse(file: int, data: memoryview) -> int:
        port.clock += 0.01
        raise BlockingIOError

    monkeypatch.setattr(serial_wire.os, "write", refuse)
    with pytest.raises(BusError, match="not accept 8 of 8 bytes"):
        wire.write(b"abcdefgh")
    assert len(port.waits) == pytest.approx(STALL_TIMEOUT / 0.01, abs=1)
    assert flushed == [termios.TCOFLUSH]


def test_closed_serial_port_is_reported_as_gone_until_it_is_reopened(port: Port, wire: SerialWire) -> None:
    wire.close()
    for action in (lambda: wire.read(60.0), lambda: wire.write(b"a")):
        with pytest.raises(BusError, match="the port is gone"):
            action()
    assert wire.reopen()
    wire.write(b"b")
    assert os.read(port.file, 10) == b"b"


def test_serial_port_stays_closed_while_its_path_is_in_use_or_renamed(
    port: Port, wire: SerialWire, monkeypatch: pytest.MonkeyPatch
) -> None:
    wire.close()
    other = SerialWire(port.path, BAUD_RATE)
    assert not wire.reopen()
    other.close()
    monkeypatch.setattr(serial_wire, "find_stable_name", lambda path: Path("/dev/other"))
    assert not wire.reopen()


def test_terminal_counts_as_reused_if_its_link_is_unchanged_but_its_device_is_not() -> None:
    first = TerminalIdentity((5, 100), (7, 200))
    for later, reused in (
        (first, False),
        (TerminalIdentity((5, 101), (7, 200)), True),
        (TerminalIdentity((6, 100), (7, 200)), True),
        (TerminalIdentity((6, 100), (8, 300)), False),
        (TerminalIdentity(None, (7, 200)), False),
    ):
        assert first.is_reused_by(later) is reused


def test_identity_of_a_pseudo_terminal_has_device_and_inode_numbers(port: Port, tmp_path: Path) -> None:
    plain, link = tmp_path / "plain", tmp_path / "link"
    plain.write_text("")
    link.symlink_to(port.path)
    assert TerminalIdentity.of(plain) == TerminalIdentity(None, None)
    status = port.path.stat()
    assert TerminalIdentity.of(port.path) == TerminalIdentity((status.st_rdev, status.st_ctime_ns), None)
    entry = link.lstat()
    assert TerminalIdentity.of(link).link == (entry.st_ino, entry.st_ctime_ns)
    assert TerminalIdentity.of(link).device == (status.st_rdev, status.st_ctime_ns)


def test_serial_device_is_locked_exclusively_but_a_pseudo_terminal_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    locked: list[tuple[int, int]] = []
    monkeypatch.setattr(serial_wire, "ioctl", lambda file, request: locked.append((file, request)))
    for name in ("/dev/pts/3", "/dev/ttyUSB0"):
        monkeypatch.setattr(serial_wire.os, "ttyname", lambda file, name=name: name)
        _lock_terminal(9)
    assert locked == [(9, termios.TIOCEXCL)]


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (OSError(errno.EACCES, ""), "no permission; `sudo usermod -aG dialout"),
        (OSError(errno.EPERM, ""), "no permission"),
        (OSError(errno.EBUSY, ""), "another program uses this port; `fuser"),
        (serial.SerialException(errno.EAGAIN, ""), "another program"),
        (ValueError("odd"), "does not support 57600 baud"),
        (OSError(errno.EIO, "broken"), "cannot be opened"),
    ],
)
def test_error_for_a_refused_serial_port_names_the_reason(tmp_path: Path, error: Exception, message: str) -> None:
    path = tmp_path / "port"
    path.write_text("")
    text = str(_refusal(path, BAUD_RATE, error))
    assert text.startswith(f"{path}: {message}")


def test_error_for_a_missing_serial_port_names_the_connected_adapters(tmp_path: Path) -> None:
    folder = tmp_path / "by-id"
    folder.mkdir()
    assert str(_refusal(folder / "x", BAUD_RATE, OSError())).endswith(
        "no such port; is the adapter plugged in? see `ls /dev/serial/by-id`"
    )
    for name in ("b", "a"):
        (folder / name).write_text("")
    (tmp_path / "c").write_text("")
    assert str(_refusal(folder / "x", BAUD_RATE, OSError())).endswith(f"no such port; there are {folder}/a, {folder}/b")
    assert "is the adapter plugged in" in str(_refusal(tmp_path / "x", BAUD_RATE, OSError()))
