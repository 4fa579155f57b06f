"""Serial port as a wire, for exclusive use and without busy waiting.

It is identified by a name that survives unplugging.
"""

import errno
import os
import select
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import serial

from kinesic.hardware.bus.host import find_stable_name
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, BusError

if sys.platform != "win32":
    import termios
    from fcntl import ioctl

    PORT_ERRORS = (OSError, ValueError, termios.error)  # exceptions that an open port may raise
else:
    PORT_ERRORS = (OSError, ValueError)

READ_SIZE = 4096  # [bytes] largest number read from the port per system call
TERMINAL_FOLDER = "/dev/pts/"  # folder of pseudo-terminals
STALL_TIMEOUT = 0.05  # [s] longest stall beyond the transmission time before the port counts as lost


@dataclass(frozen=True)
class TerminalIdentity:
    """Identity of a pseudo-terminal, whose number may be reused.

    The number may later belong to another robot or to a shell.
    """

    device: tuple[int, int] | None  # number and creation time [ns]; None for other ports
    link: tuple[int, int] | None  # file number and creation time [ns] of a link to it

    @classmethod
    def of(cls, path: Path) -> Self:
        """Read the identity of a port.

        Raises:
            OSError: the port is missing.
        """
        device = link = None
        if sys.platform != "win32":
            properties, entry = path.stat(), path.lstat()
            if os.path.realpath(path).startswith(TERMINAL_FOLDER):
                device = properties.st_rdev, properties.st_ctime_ns
            if path.is_symlink():
                link = entry.st_ino, entry.st_ctime_ns
        return cls(device, link)

    def is_reused_by(self, later: "TerminalIdentity") -> bool:
        """Return whether an unchanged link now points to another terminal."""
        return later.device not in (None, self.device) and later.link == self.link


class SerialWire:
    """Serial port of this machine as a `Wire`."""

    def __init__(self, path: str | Path, baud: int) -> None:
        """Open the port for exclusive use.

        Args:
            path: path of the device, e.g. /dev/serial/by-id/... or /dev/ttyUSB0.
            baud: [bit/s].

        Raises:
            BusError: the port is missing, not permitted, or in use by another program.
        """
        self._path, self._baud = find_stable_name(Path(path)), baud
        self._port, self._identity = self._opened()
        self._file = self._port.fileno()

    @property
    def name(self) -> str:
        """Path of the port."""
        return str(self._path)

    @property
    def baud(self) -> int:
        """Baud rate [bit/s]."""
        return self._baud

    def now(self) -> float:
        """Return the machine's monotonic clock [s]."""
        return time.monotonic()

    def write(self, data: bytes | bytearray, /) -> None:
        """Send bytes, waiting a limited time while the output buffer is full.

        Raises:
            BusError: the port is gone, or does not take the bytes in time.
        """
        rest, limit = memoryview(data), time.monotonic() + len(data) * BITS_PER_BYTE / self._baud + STALL_TIMEOUT
        try:
            while rest:
                try:
                    rest = rest[os.write(self._file, rest) :]
                except BlockingIOError:  # the output buffer is full
                    wait = limit - time.monotonic()
                    if wait <= 0.0 or not select.select((), (self._file,), (), wait)[1]:
                        _discard_output(self._file)  # otherwise old goals would be sent once it recovers
                        raise TimeoutError(f"it did not accept {len(rest)} of {len(data)} bytes in time") from None
        except PORT_ERRORS as error:
            raise self._gone(error) from None

    def read(self, deadline: float, /) -> bytes:
        """Wait for bytes until a deadline [s], and return all received ones."""
        wait = deadline - time.monotonic()
        try:
            ready = bool(select.select((self._file,), (), (), max(0.0, wait))[0])
            data = os.read(self._file, READ_SIZE) if ready else b""
        except (OSError, ValueError) as error:
            raise self._gone(error) from None
        if ready and not data:
            raise self._gone(OSError(errno.EIO, os.strerror(errno.EIO)))
        return data

    def sleep(self, until: float, /) -> None:
        """Sleep until a time [s] of the monotonic clock."""
        wait = until - time.monotonic()
        if wait > 0.0:
            time.sleep(wait)

    def reopen(self) -> bool:
        """Try once to reopen the port and return success.

        A terminal that has taken over the number of a vanished one is not opened.
        """
        self.close()
        if (
            find_stable_name(self._path) != self._path
        ):  # the name now belongs to another adapter with its own by-id name
            return False
        try:
            if self._identity.is_reused_by(TerminalIdentity.of(self._path)):
                return False
            self._port, self._identity = self._opened()
            self._file = self._port.fileno()
        except (BusError, OSError):
            return False
        return True

    def close(self) -> None:
        """Close the port."""
        self._file = -1
        try:
            self._port.close()
        except PORT_ERRORS:
            return  # the device is gone, and the descriptor with it

    def _opened(self) -> tuple[serial.Serial, TerminalIdentity]:
        try:
            identity = TerminalIdentity.of(self._path)
            port = serial.Serial(str(self._path), self._baud, timeout=0, exclusive=True)
            _lock_terminal(port.fileno())
            port.reset_input_buffer()
        except PORT_ERRORS as error:
            raise _refusal(self._path, self._baud, error) from None
        return port, identity

    def _gone(self, error: Exception) -> BusError:
        return BusError(f"{self._path}: the port is gone ({error})")


def _discard_output(file: int) -> None:
    """Discard the bytes that a port has not sent yet."""
    if sys.platform != "win32":
        termios.tcflush(file, termios.TCOFLUSH)


def _lock_terminal(file: int) -> None:
    """Lock a port exclusively, unless it is a pseudo-terminal."""
    if sys.platform != "win32" and not os.ttyname(file).startswith("/dev/pts/"):
        ioctl(file, termios.TIOCEXCL)


def _refusal(path: Path, baud: int, error: Exception) -> BusError:
    if not path.exists():
        near = sorted(str(other) for other in path.parent.glob("*")) if path.parent.name == "by-id" else []
        hint = f"; there are {', '.join(near)}" if near else "; is the adapter plugged in? see `ls /dev/serial/by-id`"
        return BusError(f"{path}: no such port{hint}")
    number = getattr(error, "errno", None)
    if number in (errno.EACCES, errno.EPERM):
        return BusError(f"{path}: no permission; `sudo usermod -aG dialout $USER`, then log in again")
    if number in (errno.EBUSY, errno.EAGAIN):
        return BusError(f"{path}: another program uses this port; `fuser {path}` shows which")
    if isinstance(error, ValueError):
        return BusError(f"{path}: does not support {baud} baud ({error})")
    return BusError(f"{path}: cannot be opened ({error})")
