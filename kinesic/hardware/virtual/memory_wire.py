"""Virtual wire in memory, whose clock jumps to the next event.

Tests with it take no time.
"""

from math import inf

from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.virtual.bus import VirtualBus


class MemoryWire:
    """Wire in virtual time that never waits."""

    def __init__(self, bus: VirtualBus, *, name: str = "memory", time: float = 0.0) -> None:
        """Open a port of the virtual wire.

        Args:
            bus: bus on the wire.
            name: name for messages.
            time: [s] initial time.

        Raises:
            BusError: the adapter is not plugged in.
        """
        self._bus, self._name, self._time = bus, name, time
        self._opened = time if bus.plugged(time) else -inf
        self._check()

    @property
    def name(self) -> str:
        """Name of the wire for messages."""
        return self._name

    @property
    def baud(self) -> int:
        """Baud rate [bit/s]."""
        return self._bus.baud

    @baud.setter
    def baud(self, value: int) -> None:
        self._bus.baud = value

    def now(self) -> float:
        """Return the virtual time [s]."""
        return self._time

    def write(self, data: bytes | bytearray, /) -> None:
        """Transmit bytes to the virtual servos.

        Raises:
            BusError: the adapter was unplugged.
        """
        self._check()
        self._bus.send(data, self._time)

    def read(self, deadline: float, /) -> bytes:
        """Jump to the next arrival or deadline [s], and return received bytes.

        Raises:
            BusError: the adapter was unplugged.
        """
        self._check()
        arrival = self._bus.arrives()
        pulled = self._bus.next_outage(self._time)
        if pulled <= min(arrival, deadline):
            self._time = pulled
        elif arrival <= deadline:
            self._time = max(self._time, arrival)
            return self._bus.receive(self._time)
        else:
            self._time = max(self._time, deadline)
        self._check()
        return b""

    def sleep(self, until: float, /) -> None:
        """Advance the virtual time to `until` [s] at once."""
        self._time = max(self._time, until)

    def reopen(self) -> bool:
        """Reopen the port if the adapter is plugged in, and return success."""
        is_plugged = self._bus.plugged(self._time)
        if is_plugged:
            self._opened = self._time
        return is_plugged

    def close(self) -> None:
        """Do nothing, because memory needs no release."""

    def _check(self) -> None:
        """Fail if the adapter was unplugged since the port was opened."""
        if self._bus.next_outage(self._opened) <= self._time:
            self._bus.unplug()
            raise BusError(f"{self._name}: the port is gone")
