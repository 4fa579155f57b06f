from collections.abc import Callable

import pytest
from dynamixel_sdk import COMM_RX_TIMEOUT, COMM_SUCCESS, GroupSyncRead, Protocol2PacketHandler

from kinesic.hardware.protocol.packet import Instruction, packet, status, stuff
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.sdk import Packets, WirePort
from kinesic.hardware.protocol.wire import BusError

Make = Callable  # of a rig, see conftest


class Script:
    """Wire that answers each write with prepared bytes."""

    name, baud = "script", 4_500_000

    def __init__(self, *answers: bytes, error: BusError | None = None) -> None:
        self._answers, self._coming, self._error = list(answers), b"", error
        self.time, self.reads, self.closed = 0.0, 0, False

    def now(self) -> float:
        return self.time

    def write(self, data: bytes | bytearray, /) -> None:
        if self._error is not None:
            raise self._error
        self._coming = self._answers.pop(0) if self._answers else b""

    def read(self, deadline: float, /) -> bytes:
        if self._error is not None:
            raise self._error
        self.reads += 1
        if not self._coming:
            self.time = max(self.time, deadline)
        data, self._coming = self._coming, b""
        return data

    def sleep(self, until: float, /) -> None:
        self.time = max(self.time, until)

    def reopen(self) -> bool:
        return True

    def close(self) -> None:
        self.closed = True


@pytest.mark.parametrize("body", [b"\xff\xff\xfd", b"\xff\xff\xfd\xfd\xff\xfd\xfd", b"\x01\x02", b""])
def test_sdk_adapter_adds_and_removes_byte_stuffing_in_place(body: bytes):
    plain = [0xFF, 0xFF, 0xFD, 0, 1, len(body) + 2, 0, *body, 0, 0]
    packets = Packets()
    made = list(plain)
    packets.addStuffing(made)
    assert bytes(made[7:-2]) == stuff(body)
    assert made[5] == len(stuff(body)) + 2
    packets.removeStuffing(made)
    assert made == plain


def test_sdk_adapter_writes_data_that_needs_byte_stuffing_unchanged_to_the_registers(rig: Make):
    made = rig(1)
    port, packets = WirePort(made.wire), Packets()
    data = [0xFF, 0xFF, 0xFD, 0xFF, 0xFF, 0xFF]  # goal current -1, goal velocity -3
    assert packets.writeTxRx(port, 1, 102, 6, data) == (COMM_SUCCESS, 0)
    assert made.true(Register.GOAL_CURRENT) == [-1]
    assert made.true(Register.GOAL_VELOCITY) == [-3]


def test_sdk_adapter_does_not_take_a_late_acknowledgement_as_a_read_reply():
    wire = Script(status(1, 0) + status(1, 0, bytes((7, 0, 0, 0))))
    assert Packets().read4ByteTxRx(WirePort(wire), 1, 132) == (7, COMM_SUCCESS, 0)


def test_sdk_adapter_does_not_take_a_late_position_reply_as_a_temperature():
    wire = Script(status(1, 0, bytes(4)) + status(1, 0, bytes((41,))))
    assert Packets().read1ByteTxRx(WirePort(wire), 1, 146) == (41, COMM_SUCCESS, 0)


def test_sdk_adapter_ignores_the_reply_of_another_servo():
    wire = Script(status(2, 0, bytes((9,))) + status(1, 0, bytes((41,))))
    assert Packets().read1ByteTxRx(WirePort(wire), 1, 146) == (41, COMM_SUCCESS, 0)


def test_sdk_reports_a_refused_instruction():
    assert Packets().readTxRx(WirePort(Script(status(1, 7))), 1, 148, 1) == ([], COMM_SUCCESS, 7)


def test_alert_bit_in_a_reply_raises_no_error_in_the_sdk_adapter():
    wire = Script(status(1, 0x80, bytes((0x20,))))
    assert Packets().read1ByteTxRx(WirePort(wire), 1, 70) == (0x20, COMM_SUCCESS, 0x80)


@pytest.mark.realtime
def test_sdk_waits_for_a_reply_without_busy_polling():
    wire = Script()
    _, result, _ = Packets().read1ByteTxRx(WirePort(wire), 1, 146)
    assert result == COMM_RX_TIMEOUT
    assert wire.reads < 10
    assert wire.time < 0.02


@pytest.mark.parametrize("way", ["read", "write"])
def test_sdk_port_is_released_after_a_failed_read_or_write(way: str):
    wire = Script(error=BusError("gone"))
    port, packets = WirePort(wire), Packets()
    with pytest.raises(BusError):
        packets.readTxRx(port, 1, 146, 1) if way == "read" else packets.write1ByteTxRx(port, 1, 64, 1)
    assert not port.is_using


def test_sdk_port_accepts_only_the_baud_rate_of_its_wire():
    port = WirePort(Script())
    assert port.getBaudRate() == 4_500_000
    assert port.setBaudRate(4_500_000)
    assert not port.setBaudRate(57_600)
    port.closePort()
    assert not port.is_open


def test_sdk_port_reports_the_number_of_unread_bytes():
    wire = Script(b"abc")
    port = WirePort(wire)
    port.writePort([1])
    assert port.getBytesAvailable() == 3
    assert port.readPort(2) == b"ab"
    port.clearPort()
    assert port.getBytesAvailable() == 0


def test_clearing_the_sdk_port_discards_bytes_that_were_not_read_yet():
    wire = Script(b"late")
    port = WirePort(wire)
    wire.write(b"")
    port.clearPort()
    assert port.getBytesAvailable() == 0


def test_sdk_port_discards_late_replies_before_a_slower_attempt():
    wire = Script(b"late")
    port = WirePort(wire)
    wire.write(b"")
    port.pass_late_answers()
    assert port.getBytesAvailable() == 0
    assert wire.now() > 0.0


def test_sdk_group_reads_return_the_positions_of_all_servos(rig: Make):
    made = rig(4)
    port = WirePort(made.wire)
    group = GroupSyncRead(port, Packets(), 132, 4)
    for servo in made.bus.ids:
        assert group.addParam(servo)
    for read in (group.txRxPacket, group.fastSyncRead):
        assert read() == COMM_SUCCESS
        assert [group.getData(servo, 132, 4) for servo in made.bus.ids] == made.true(Register.PRESENT_POSITION).tolist()


def test_sdk_adapter_finds_all_servos_by_broadcast_ping(rig: Make):
    made = rig(5)
    outcome, result = Packets().broadcastPing(WirePort(made.wire))
    assert result == COMM_SUCCESS
    assert outcome == {servo: [1020, 52] for servo in made.bus.ids}


class Ear(Script):
    """Collector of written bytes."""

    sent = b""

    def write(self, data: bytes | bytearray, /) -> None:
        self.sent = bytes(data)


def test_sdk_adapter_and_packet_encoder_stuff_bytes_equally():
    data = [0xFF, 0xFF, 0xFD, 0xFD, 1]
    right = packet(3, Instruction.WRITE, bytes((200, 0, *data)))
    wire = Ear()
    Packets().writeTxOnly(WirePort(wire), 3, 200, 5, data)
    assert wire.sent == right
    Protocol2PacketHandler().writeTxOnly(WirePort(wire), 3, 200, 5, data)
    assert wire.sent != right
