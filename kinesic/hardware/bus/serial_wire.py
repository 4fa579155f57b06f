"""Makes a serial port a wire: one program at a time, no busy waiting, and a name that survives unplugging."""

import errno
import os
import select
import termios
import time
from fcntl import ioctl
from pathlib import Path

import serial

from kinesic.hardware.bus.host import stable_name
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, BusError

CHUNK = 4096  # [bytes]
STALLED = 0.05  # [s] beyond their time on the wire after which bytes that nobody takes mean that the port is gone


class SerialWire:
    """A serial port of this machine as a `Wire`."""

    def __init__(self, path: str | Path, baud: int) -> None:
        """Opens the port for this program alone.

        Args:
            path: of the device, e.g. /dev/serial/by-id/... or /dev/ttyUSB0.
            baud: [bit/s].

        Raises:
            BusError: there is no such port, it may not be used, or another program uses it.
        """
        self._path, self._baud = stable_name(Path(path)), baud
        self._port = self._opened()
        self._file = self._port.fileno()

    @property
    def name(self) -> str:
        """The port's path."""
        return str(self._path)

    @property
    def baud(self) -> int:
        """[bit/s]."""
        return self._baud

    def now(self) -> float:
        """[s] of the machine's monotonic clock."""
        return time.monotonic()

    def write(self, data: bytes | bytearray, /) -> None:
        """See `Wire`."""
        rest, limit = memoryview(data), time.monotonic() + len(data) * BITS_PER_BYTE / self._baud + STALLED
        try:
            while rest:
                try:
                    rest = rest[os.write(self._file, rest) :]
                except BlockingIOError:  # no room for now
                    wait = limit - time.monotonic()
                    if wait <= 0.0 or not select.select((), (self._file,), (), wait)[1]:
                        termios.tcflush(self._file, termios.TCOFLUSH)  # or old goals come when it goes on
                        raise TimeoutError(f"it has not taken {len(rest)} of {len(data)} bytes in time") from None
        except (OSError, ValueError, termios.error) as error:
            raise self._gone(error) from None

    def read(self, deadline: float, /) -> bytes:
        """See `Wire`."""
        wait = deadline - time.monotonic()
        try:
            ready = bool(select.select((self._file,), (), (), max(0.0, wait))[0])
            data = os.read(self._file, CHUNK) if ready else b""
        except (OSError, ValueError) as error:
            raise self._gone(error) from None
        if ready and not data:
            raise self._gone(OSError(errno.EIO, os.strerror(errno.EIO)))
        return data

    def sleep(self, until: float, /) -> None:
        """See `Wire`."""
        wait = until - time.monotonic()
        if wait > 0.0:
            time.sleep(wait)

    def reopen(self) -> bool:
        """See `Wire`."""
        self.close()
        if stable_name(self._path) != self._path:  # a name that is used again, for an adapter that has one of its own
            return False
        try:
            self._port = self._opened()
            self._file = self._port.fileno()
        except BusError:
            return False
        return True

    def close(self) -> None:
        """See `Wire`."""
        self._file = -1
        try:
            self._port.close()
        except (OSError, termios.error):
            return  # the device is gone, and the descriptor with it

    def _opened(self) -> serial.Serial:
        try:
            port = serial.Serial(str(self._path), self._baud, timeout=0, exclusive=True)
            if not os.ttyname(port.fileno()).startswith("/dev/pts/"):  # those would stay shut after us, to all but root
                ioctl(port.fileno(), termios.TIOCEXCL)
            port.reset_input_buffer()
        except (OSError, ValueError, termios.error) as error:
            raise _refusal(self._path, self._baud, error) from None
        return port

    def _gone(self, error: Exception) -> BusError:
        return BusError(f"{self._path}: the port is gone ({error})")


def _refusal(path: Path, baud: int, error: Exception) -> BusError:
    if not path.exists():
        near = sorted(str(other) for other in path.parent.glob("*")) if path.parent.name == "by-id" else []
        known = f"; there are {', '.join(near)}" if near else "; is the adapter plugged in? see `ls /dev/serial/by-id`"
        return BusError(f"{path}: no such port{known}")
    number = getattr(error, "errno", None)
    if number in (errno.EACCES, errno.EPERM):
        return BusError(f"{path}: no permission; `sudo usermod -aG dialout $USER`, then log in again")
    if number in (errno.EBUSY, errno.EAGAIN):
        return BusError(f"{path}: another program uses this port; `fuser {path}` tells which")
    if isinstance(error, ValueError):
        return BusError(f"{path}: does not do {baud} baud ({error})")
    return BusError(f"{path}: does not open ({error})")
