"""Puts virtual wires behind pseudo-terminals, in real time: any Dynamixel program can open one.

The kernel never paces a pseudo-terminal: bytes are read when they come, count from then on, and go back when the
virtual wire says. The host's baud rate is that of the terminal's settings, and servos of another rate do not hear it.
"""

import os
import select
import struct
import termios
import time
import tty
from collections.abc import Callable, Sequence
from contextlib import suppress
from fcntl import ioctl
from math import inf
from pathlib import Path

from kinesic.hardware.virtual.bus import VirtualBus

IDLE = 0.02  # [s] longest wait: the plant moves on at least so often
TERMINALS = "/dev/pts/"
CHUNK = 65_536  # [bytes] read at once
_TCGETS2 = 0x802C542A
_SETTINGS = struct.Struct("=4I20B2I")  # flags, line discipline and control characters, speeds in and out


class PtyPort:
    """The host's end of one virtual wire: a link to a pseudo-terminal, which comes and goes with the adapter."""

    def __init__(self, bus: VirtualBus, link: Path) -> None:
        """Is not there before `exchange` plugs it in.

        Args:
            bus: what is on the wire.
            link: where the port is to be found; what a by-id name is to a real one.
        """
        self._bus, self.link = bus, link
        self._ends: tuple[int, int] | None = None  # file descriptors of our end and of the host's

    @property
    def descriptor(self) -> int | None:
        """What to wait for; None while it is unplugged."""
        return None if self._ends is None else self._ends[0]

    def exchange(self, now: float) -> float:
        """Gives the host what has arrived.

        Args:
            now: [s] on the plant's clock.

        Returns:
            [s] when there is more to do.
        """
        self._bus.advance(now)
        if self._bus.plugged(now):
            self._plug()
        else:
            self.close()
        due = self._bus.receive(now)
        if due and self._ends is not None:
            with suppress(BlockingIOError):  # nobody reads, and the terminal is full: the bytes are lost
                os.write(self._ends[0], due)
        return min(self._bus.arrives(), self._bus.next_outage(now))

    def listen(self, now: float) -> None:
        """Takes what the host has written."""
        if self._ends is None:
            return
        ours, hosts = self._ends
        self._bus.baud = _speed(hosts)
        self._bus.send(os.read(ours, CHUNK), now)

    def close(self) -> None:
        """Pulls the adapter out; may be called twice."""
        if self._ends is None:
            return
        ours, hosts = self._ends
        if _leads(self.link) == os.ttyname(hosts):
            self.link.unlink()
        for end in (ours, hosts):
            os.close(end)
        self._ends = None
        self._bus.unplug()

    def _plug(self) -> None:
        if self._ends is not None:
            return
        ours, hosts = os.openpty()
        tty.setraw(hosts)
        _set_speed(hosts, self._bus.baud)
        os.set_blocking(ours, False)
        self._ends = ours, hosts
        if _leads(self.link).startswith(TERMINALS):  # left by a simulation that was killed
            self.link.unlink()
        self.link.symlink_to(os.ttyname(hosts))


def serve_wires(ports: Sequence[PtyPort], running: Callable[[], bool], *, start: float = 0.0) -> None:
    """Plays virtual wires in real time until told to stop.

    Args:
        ports: of one plant.
        running: asked at least every `IDLE` seconds.
        start: [s] on the plant's clock.
    """
    began = time.monotonic() - start
    try:
        while running():
            now = time.monotonic() - began
            next_due = min((port.exchange(now) for port in ports), default=inf)
            waited = {port.descriptor: port for port in ports if port.descriptor is not None}
            pause = max(0.0, min(next_due - (time.monotonic() - began), IDLE))
            ready, _, _ = select.select(list(waited), [], [], pause)
            for descriptor in ready:
                waited[descriptor].listen(time.monotonic() - began)
    finally:
        for port in ports:
            port.close()


def _leads(link: Path) -> str:
    """Where a link leads; empty for anything else."""
    try:
        return os.readlink(link)
    except OSError:
        return ""


def _speed(descriptor: int) -> int:
    """[bit/s] that the terminal's settings say, custom ones too."""
    settings = ioctl(descriptor, _TCGETS2, bytes(_SETTINGS.size))
    return int(_SETTINGS.unpack(settings)[-1])


def _set_speed(descriptor: int, baud: int) -> None:
    """Sets a usual baud rate; the host sets its own when it opens the port."""
    code = getattr(termios, f"B{baud}", None)
    if code is not None:
        settings = termios.tcgetattr(descriptor)
        settings[4] = settings[5] = code
        termios.tcsetattr(descriptor, termios.TCSANOW, settings)
