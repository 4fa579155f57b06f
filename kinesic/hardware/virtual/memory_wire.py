"""Makes a virtual bus a wire in memory, whose clock jumps to whatever happens next: tests take no time."""

from math import inf

from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.virtual.bus import VirtualBus


class MemoryWire:
    """A wire in virtual time: nothing ever waits."""

    def __init__(self, bus: VirtualBus, *, name: str = "memory", time: float = 0.0) -> None:
        """Opens the port.

        Args:
            bus: what is on the wire.
            name: for messages.
            time: [s] that the clock begins with.

        Raises:
            BusError: the adapter is not plugged in.
        """
        self._bus, self._name, self._time = bus, name, time
        self._opened = time if bus.plugged(time) else -inf
        self._check()

    @property
    def name(self) -> str:
        """For messages."""
        return self._name

    @property
    def baud(self) -> int:
        """[bit/s]."""
        return self._bus.baud

    @baud.setter
    def baud(self, value: int) -> None:
        self._bus.baud = value

    def now(self) -> float:
        """Returns the time [s]."""
        return self._time

    def write(self, data: bytes | bytearray, /) -> None:
        """Hands bytes to the wire.

        Raises:
            BusError: the adapter is pulled.
        """
        self._check()
        self._bus.send(data, self._time)

    def read(self, deadline: float, /) -> bytes:
        """Jumps to the next arrival, or to the deadline.

        Raises:
            BusError: the adapter is pulled.
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
        """Jumps to a time [s]."""
        self._time = max(self._time, until)

    def reopen(self) -> bool:
        """Returns whether the adapter is plugged in again."""
        back = self._bus.plugged(self._time)
        if back:
            self._opened = self._time
        return back

    def close(self) -> None:
        """Nothing to give back."""

    def _check(self) -> None:
        """A port that was pulled since it was opened is gone, even if it is there again."""
        if self._bus.next_outage(self._opened) <= self._time:
            self._bus.unplug()
            raise BusError(f"{self._name}: the port is gone")
