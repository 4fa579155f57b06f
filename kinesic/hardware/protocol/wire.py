"""Interface of half-duplex serial lines to servos, real or virtual."""

from typing import Protocol

BITS_PER_BYTE = 10  # Transmitted bits per byte: start bit, eight data bits and stop bit


class BusError(OSError):
    """Error for a missing or unsuitable port or servo.

    The message names it, the found value and the required one.
    """


class Wire(Protocol):
    """Half-duplex wire to servos.

    Its clock is the only clock of the bus, so time may be virtual.
    """

    @property
    def name(self) -> str:
        """Path of the port, for messages."""

    @property
    def baud(self) -> int:
        """Baud rate [bit/s]."""

    def now(self) -> float:
        """Return the wire's clock [s], which never decreases."""

    def write(self, data: bytes | bytearray, /) -> None:
        """Pass bytes to the wire without waiting for their transmission.

        Raises:
            BusError: the port is gone.
        """

    def read(self, deadline: float, /) -> bytes:
        """Wait for at least one byte, and return all received bytes.

        Returns b"" if the deadline passes without a byte.

        Args:
            deadline: [s] on the wire's clock; a past deadline does not wait.

        Raises:
            BusError: the port is gone.
        """

    def sleep(self, until: float, /) -> None:
        """Wait until the wire's clock reaches `until` [s]."""

    def reopen(self) -> bool:
        """Try once to reopen a lost port, without raising."""

    def close(self) -> None:
        """Close the port.

        Repeated calls have no effect.
        """
