"""Adapter of dynamixel-sdk to a wire, with fixes for its defects.

Fixed: stuffing lost on output and wrong on input, replies accepted without a check of their length, busy waiting, a
port that stays busy after an error, wall-clock timeouts that no USB timer explains, and refused 4.5 Mbaud. Replies to
fast reads stay unstuffed, which is right. Slow operations use it.
"""

# ruff: noqa: N802  # overrides keep the names of the SDK

from collections.abc import Sequence

from dynamixel_sdk import COMM_SUCCESS, PortHandler, Protocol2PacketHandler

from kinesic.hardware.protocol.packet import ALERT_BIT, stuff, unstuff
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, Wire

LATENCY_MS = 4.0  # [ms] delay by adapter and host in each direction
SLOW_LATENCY_MS = 16.0  # [ms] delay by an adapter with the default latency timer
MAX_LATE_MS = 30.0  # [ms] longest delay of a reply to an abandoned instruction
MIN_TIMEOUT_MS = 2.0  # [ms] constant part of every timeout
BODY_OFFSET = 7  # [bytes] offset of the instruction in a packet
STATUS_EXTRA = 4  # [bytes] size of instruction, error and CRC, included in the length field of a status packet


class WirePort(PortHandler):  # type: ignore[misc]  # the SDK ships no types
    """SDK port that sends and receives over a `Wire`."""

    def __init__(self, wire: Wire) -> None:
        super().__init__(wire.name)
        self._wire, self._spare = wire, bytearray()
        self.baudrate, self.is_open = wire.baud, True
        self.latency_ms = LATENCY_MS
        self.tx_time_per_byte = 1000.0 * BITS_PER_BYTE / wire.baud

    def closePort(self) -> None:
        """Close the wire."""
        self._wire.close()
        self.is_open = False

    def clearPort(self) -> None:
        """Discard all received bytes."""
        self._spare.clear()
        self._wire.read(self._wire.now())

    def pass_late_answers(self) -> None:
        """Discard late replies to an earlier instruction.

        The next instruction gets a longer timeout.
        """
        self._wire.sleep(self._wire.now() + MAX_LATE_MS / 1000.0)
        self.clearPort()
        self.latency_ms = SLOW_LATENCY_MS

    def getBytesAvailable(self) -> int:
        """Return the number of bytes that are readable without waiting."""
        self._spare += self._wire.read(self._wire.now())
        return len(self._spare)

    def readPort(self, length: int) -> bytes:
        """Return up to `length` bytes, waiting until the packet's timeout at most."""
        if not self._spare:
            self._spare += self._wire.read((self.packet_start_time + self.packet_timeout) / 1000.0)
        data = bytes(self._spare[:length])
        del self._spare[:length]
        return data

    def writePort(self, packet: Sequence[int]) -> int:
        """Send a packet, and return its number of bytes."""
        self._wire.write(bytes(packet))
        return len(packet)

    def setPacketTimeout(self, packet_length: int) -> None:
        """Set the timeout for a reply of the given length.

        It covers the packet that was sent before.
        """
        self.setPacketTimeoutMillis(self.tx_time_per_byte * packet_length + 2 * self.latency_ms + MIN_TIMEOUT_MS)

    def getCurrentTime(self) -> float:
        """Return the wire's clock [ms]."""
        return self._wire.now() * 1000.0

    def isPacketTimeout(self) -> bool:
        """Return whether the packet's timeout has passed.

        A virtual clock stops exactly at the deadline.
        """
        return bool(self.getTimeSinceStart() >= self.packet_timeout - 1e-6)

    def getCFlagBaud(self, baudrate: int) -> int:
        """Accept every baud rate, because the wire checks it."""
        return baudrate

    def setupPort(self, cflag_baud: int) -> bool:
        """Return whether the wire is already open at this baud rate."""
        return cflag_baud == self._wire.baud


class Packets(Protocol2PacketHandler):  # type: ignore[misc]  # the SDK ships no types
    """Packet handler of the SDK, corrected to follow Protocol 2.0."""

    def addStuffing(self, packet: list[int]) -> list[int]:
        """Insert the stuffing bytes of a packet in place."""
        length = packet[5] | packet[6] << 8
        body = stuff(bytes(packet[BODY_OFFSET : BODY_OFFSET + length - 2]))
        packet[BODY_OFFSET:] = [*body, 0, 0]
        packet[5], packet[6] = (len(body) + 2) & 0xFF, (len(body) + 2) >> 8
        return packet

    def removeStuffing(self, packet: list[int]) -> list[int]:
        """Remove the stuffing bytes of a packet in place."""
        length = packet[5] | packet[6] << 8
        end = BODY_OFFSET + length - 2
        body = unstuff(bytes(packet[BODY_OFFSET:end]))
        packet[BODY_OFFSET:] = [*body, *packet[end : end + 2]]
        packet[5], packet[6] = (len(body) + 2) & 0xFF, (len(body) + 2) >> 8
        return packet

    def txPacket(self, port: WirePort, txpacket: list[int]) -> int:
        """Send a packet, and free the port on failure."""
        try:
            return int(super().txPacket(port, txpacket))
        except BaseException:
            port.is_using = False
            raise

    def rxPacket(self, port: WirePort, fast_option: bool = False) -> tuple[list[int], int]:
        """Receive a packet, and free the port on failure."""
        try:
            packet, result = super().rxPacket(port, fast_option)
        except BaseException:
            port.is_using = False
            raise
        return packet, result

    def readRx(self, port: WirePort, dxl_id: int, length: int) -> tuple[list[int], int, int]:
        """Wait for this servo's status with the requested amount of data."""
        while True:
            packet, result = self.rxPacket(port)
            if result != COMM_SUCCESS:
                return [], result, 0
            if packet[4] == dxl_id and packet[5] | packet[6] << 8 == length + STATUS_EXTRA:
                return list(packet[9 : 9 + length]), result, packet[8]
            if packet[4] == dxl_id and packet[8] & ~ALERT_BIT:
                return [], result, packet[8]

    def readTxRx(self, port: WirePort, dxl_id: int, address: int, length: int) -> tuple[list[int], int, int]:
        """Read registers with the checks of `readRx`."""
        result = self.readTx(port, dxl_id, address, length)
        return self.readRx(port, dxl_id, length) if result == COMM_SUCCESS else ([], result, 0)
