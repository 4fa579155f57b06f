"""Says what the bus needs of a wire: bytes out, bytes in, and a clock; real and virtual ports have it."""

from typing import Protocol

BITS_PER_BYTE = 10  # start, eight bits, stop


class BusError(OSError):
    """A port or a servo is missing or wrong: names which, what was found and what would have worked."""


class Wire(Protocol):
    """A half-duplex wire to servos. Its clock is the only one the bus knows, so time may be virtual."""

    @property
    def name(self) -> str:
        """For messages: the port's path."""

    @property
    def baud(self) -> int:
        """[bit/s]."""

    def now(self) -> float:
        """Returns the time [s], which never goes back."""

    def write(self, data: bytes | bytearray, /) -> None:
        """Hands bytes to the wire without waiting until they are out.

        Raises:
            BusError: the port is gone.
        """

    def read(self, deadline: float, /) -> bytes:
        """Waits until at least one byte is there or the deadline has passed, then returns all there is, b"" if none.

        Args:
            deadline: [s] on the wire's clock; one in the past only looks.

        Raises:
            BusError: the port is gone.
        """

    def sleep(self, until: float, /) -> None:
        """Waits until the wire's clock says `until` [s]."""

    def reopen(self) -> bool:
        """Tries once to get a lost port back, and returns whether it is there; never raises."""

    def close(self) -> None:
        """Gives the port back; may be called twice."""
