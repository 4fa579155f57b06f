"""Virtual wires behind pseudo-terminals, in real time, for any Dynamixel program.

The kernel does not pace a pseudo-terminal: bytes are read when they arrive, count from then on, and return when the
virtual wire delivers them. The host's baud rate is that of the terminal settings; servos of another rate do not receive
it.
"""

import os
import select
import struct
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from math import inf
from pathlib import Path

from kinesic.hardware.virtual.bus import VirtualBus

if sys.platform != "win32":
    import termios
    import tty
    from fcntl import ioctl

MAX_WAIT = 0.02  # [s] longest wait between two steps of the simulation
PTY_PREFIX = "/dev/pts/"  # Folder of pseudo-terminals
READ_SIZE = 65_536  # [bytes] largest number read from the terminal per system call
_GET_SETTINGS_IOCTL = 0x802C542A  # Linux ioctl TCGETS2, which reads terminal settings with any baud rate
_SETTINGS_FORMAT = struct.Struct("=4I20B2I")  # Linux termios2: flags, control characters, baud rates


class PtyPort:
    """Host's end of a virtual wire: a link to a pseudo-terminal.

    The link appears and disappears with the adapter.
    """

    def __init__(self, bus: VirtualBus, link: Path) -> None:
        """Create the port with its adapter unplugged.

        `exchange` plugs it in.

        Args:
            bus: bus on the wire.
            link: path of the port, like the by-id name of a real one.
        """
        self._bus, self.link = bus, link
        self._ends: tuple[int, int] | None = None  # file descriptors of both ends, that of the host second

    @property
    def descriptor(self) -> int | None:
        """File descriptor on which host bytes arrive, or None while unplugged."""
        return None if self._ends is None else self._ends[0]

    def exchange(self, now: float) -> float:
        """Plug or unplug the adapter, and deliver arrived bytes to the host.

        Args:
            now: [s] on the plant's clock.

        Returns:
            [s] time of the next delivery or unplugging.
        """
        self._bus.advance(now)
        if self._bus.plugged(now):
            self._plug()
        else:
            self.close()
        due = self._bus.receive(now)
        if due and self._ends is not None:
            with suppress(BlockingIOError):  # the terminal is full because no program reads it, and the bytes are lost
                os.write(self._ends[0], due)
        return min(self._bus.arrives(), self._bus.next_outage(now))

    def listen(self, now: float) -> None:
        """Transmit the host's newly written bytes to the servos."""
        if self._ends is None:
            return
        virtual_end, host_end = self._ends
        self._bus.baud = _baud_rate(host_end)
        self._bus.send(os.read(virtual_end, READ_SIZE), now)

    def close(self) -> None:
        """Unplug the adapter.

        Repeated calls have no effect.
        """
        if self._ends is None:
            return
        virtual_end, host_end = self._ends
        if _link_target(self.link) == _terminal_name(host_end):
            self.link.unlink()
        for end in (virtual_end, host_end):
            os.close(end)
        self._ends = None
        self._bus.unplug()

    def _plug(self) -> None:
        if self._ends is not None:
            return
        virtual_end, host_end = _open_terminal(self._bus.baud)
        self._ends = virtual_end, host_end
        if _link_target(self.link).startswith(PTY_PREFIX):  # left by a killed simulation
            self.link.unlink()
        self.link.symlink_to(_terminal_name(host_end))


def serve_wires(ports: Sequence[PtyPort], running: Callable[[], bool], *, start: float = 0.0) -> None:
    """Simulate virtual wires in real time until stopped.

    Args:
        ports: ports of one plant.
        running: returns whether to continue, called at least every `MAX_WAIT` seconds.
        start: [s] on the plant's clock.
    """
    began = time.monotonic() - start
    try:
        while running():
            now = time.monotonic() - began
            next_due = min((port.exchange(now) for port in ports), default=inf)
            waited = {port.descriptor: port for port in ports if port.descriptor is not None}
            pause = max(0.0, min(next_due - (time.monotonic() - began), MAX_WAIT))
            ready, _, _ = select.select(list(waited), [], [], pause)
            for descriptor in ready:
                waited[descriptor].listen(time.monotonic() - began)
    finally:
        for port in ports:
            port.close()


def _link_target(link: Path) -> str:
    """Return the target of a link, empty for other paths."""
    try:
        return os.readlink(link)
    except OSError:
        return ""


def _open_terminal(baud: int) -> tuple[int, ...]:
    """Open a pseudo-terminal and return the descriptors of device and host.

    Empty on Windows, which has none; `VIRTUAL_PORTS` refuses it before.
    """
    ends: tuple[int, ...] = ()
    if sys.platform != "win32":
        ends = os.openpty()
        tty.setraw(ends[1])
        _set_baud_rate(ends[1], baud)
        os.set_blocking(ends[0], False)
    return ends


def _terminal_name(descriptor: int) -> str:
    """Return the path of a pseudo-terminal."""
    name = ""
    if sys.platform != "win32":
        name = os.ttyname(descriptor)
    return name


def _baud_rate(descriptor: int) -> int:
    """Return the terminal's baud rate [bit/s], including custom ones."""
    rate = 0
    if sys.platform != "win32":
        settings = ioctl(descriptor, _GET_SETTINGS_IOCTL, bytes(_SETTINGS_FORMAT.size))
        rate = int(_SETTINGS_FORMAT.unpack(settings)[-1])
    return rate


def _set_baud_rate(descriptor: int, baud: int) -> None:
    """Set a standard baud rate until the host sets its own."""
    if sys.platform != "win32":
        code = getattr(termios, f"B{baud}", None)
        if code is not None:
            settings = termios.tcgetattr(descriptor)
            settings[4] = settings[5] = code
            termios.tcsetattr(descriptor, termios.TCSANOW, settings)
