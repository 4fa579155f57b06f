"""dynamixel-sdk on a wire, its defects mended by small subclasses; for everything that may take its time.

Mended: stuffing lost on the way out and wrong on the way in, replies taken without a look at their length, waiting
that burns a core, a port that stays busy for ever after an error, timeouts by wall clock that no USB timer explains,
and 4.5 Mbaud refused. Replies to fast reads stay as they come, which is right.
"""

# ruff: noqa: N802  # overrides bear the names of the SDK

from collections.abc import Sequence

from dynamixel_sdk import COMM_SUCCESS, PortHandler, Protocol2PacketHandler

from kinesic.hardware.protocol.packet import ALERT, stuff, unstuff
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, Wire

LATENCY_MS = 4.0  # [ms] that an adapter and a busy host may add, each way
SLOW_LATENCY_MS = 16.0  # [ms] the same, of an adapter whose latency timer nobody has set
LATEST_MS = 30.0  # [ms] after which the answer to a question that was given up does not come any more
LEAST_MS = 2.0  # [ms]
BODY = 7  # where the instruction stands
STATUS_EXTRA = 4  # [bytes] of the length field of a status beyond its data: instruction, error, CRC


class WirePort(PortHandler):  # type: ignore[misc]  # the SDK ships no types
    """The SDK's port on a wire: time, and waiting, are the wire's."""

    def __init__(self, wire: Wire) -> None:
        super().__init__(wire.name)
        self._wire, self._spare = wire, bytearray()
        self.baudrate, self.is_open = wire.baud, True
        self.latency_ms = LATENCY_MS
        self.tx_time_per_byte = 1000.0 * BITS_PER_BYTE / wire.baud

    def closePort(self) -> None:
        """Gives the port back."""
        self._wire.close()
        self.is_open = False

    def clearPort(self) -> None:
        """Drops what has come so far."""
        self._spare.clear()
        self._wire.read(self._wire.now())

    def pass_late_answers(self) -> None:
        """Waits for what may still come of an earlier question, drops it, and gives the next one more time."""
        self._wire.sleep(self._wire.now() + LATEST_MS / 1000.0)
        self.clearPort()
        self.latency_ms = SLOW_LATENCY_MS

    def getBytesAvailable(self) -> int:
        """How many bytes can be read without waiting."""
        self._spare += self._wire.read(self._wire.now())
        return len(self._spare)

    def readPort(self, length: int) -> bytes:
        """Waits for bytes until the packet's time is over."""
        if not self._spare:
            self._spare += self._wire.read((self.packet_start_time + self.packet_timeout) / 1000.0)
        data = bytes(self._spare[:length])
        del self._spare[:length]
        return data

    def writePort(self, packet: Sequence[int]) -> int:
        """Sends a packet."""
        self._wire.write(bytes(packet))
        return len(packet)

    def setPacketTimeout(self, packet_length: int) -> None:
        """Sets the time to wait for so many bytes, and for what was sent before them."""
        self.setPacketTimeoutMillis(self.tx_time_per_byte * packet_length + 2 * self.latency_ms + LEAST_MS)

    def getCurrentTime(self) -> float:
        """[ms] of the wire's clock."""
        return self._wire.now() * 1000.0

    def isPacketTimeout(self) -> bool:
        """Whether the packet's time is over, to a nanosecond: a virtual clock stops at the deadline."""
        return bool(self.getTimeSinceStart() >= self.packet_timeout - 1e-6)

    def getCFlagBaud(self, baudrate: int) -> int:
        """Takes every baud rate: it is the wire's business."""
        return baudrate

    def setupPort(self, cflag_baud: int) -> bool:
        """Says whether this is the rate at which the wire is open already."""
        return cflag_baud == self._wire.baud


class Packets(Protocol2PacketHandler):  # type: ignore[misc]  # the SDK ships no types
    """The SDK's Protocol 2.0, as the protocol is."""

    def addStuffing(self, packet: list[int]) -> list[int]:
        """Stuffs a packet in place."""
        length = packet[5] | packet[6] << 8
        body = stuff(bytes(packet[BODY : BODY + length - 2]))
        packet[BODY:] = [*body, 0, 0]
        packet[5], packet[6] = (len(body) + 2) & 0xFF, (len(body) + 2) >> 8
        return packet

    def removeStuffing(self, packet: list[int]) -> list[int]:
        """Undoes the stuffing of a packet in place."""
        length = packet[5] | packet[6] << 8
        end = BODY + length - 2
        body = unstuff(bytes(packet[BODY:end]))
        packet[BODY:] = [*body, *packet[end : end + 2]]
        packet[5], packet[6] = (len(body) + 2) & 0xFF, (len(body) + 2) >> 8
        return packet

    def txPacket(self, port: WirePort, txpacket: list[int]) -> int:
        """Sends a packet, and leaves the port free when that fails."""
        try:
            return int(super().txPacket(port, txpacket))
        except BaseException:
            port.is_using = False
            raise

    def rxPacket(self, port: WirePort, fast_option: bool = False) -> tuple[list[int], int]:
        """Receives a packet, and leaves the port free when that fails."""
        try:
            packet, result = super().rxPacket(port, fast_option)
        except BaseException:
            port.is_using = False
            raise
        return packet, result

    def readRx(self, port: WirePort, dxl_id: int, length: int) -> tuple[list[int], int, int]:
        """Waits for the status of this servo that has as much data as was asked for."""
        while True:
            packet, result = self.rxPacket(port)
            if result != COMM_SUCCESS:
                return [], result, 0
            if packet[4] == dxl_id and packet[5] | packet[6] << 8 == length + STATUS_EXTRA:
                return list(packet[9 : 9 + length]), result, packet[8]
            if packet[4] == dxl_id and packet[8] & ~ALERT:
                return [], result, packet[8]

    def readTxRx(self, port: WirePort, dxl_id: int, address: int, length: int) -> tuple[list[int], int, int]:
        """Reads registers with the care of `readRx`."""
        result = self.readTx(port, dxl_id, address, length)
        return self.readRx(port, dxl_id, length) if result == COMM_SUCCESS else ([], result, 0)
