"""Broadcast instructions to servos with frames: Feetech, and Dynamixel with Protocol 1.0."""

import pytest

from kinesic.hardware.protocol.frame_access import FrameAccess
from kinesic.hardware.protocol.tables import FAMILY_TABLES

# Frames as in the manuals: FF FF, id 254 of all servos, length, write instruction, address, value, checksum
TORQUE_OFF_AT_24 = bytes([0xFF, 0xFF, 0xFE, 4, 3, 24, 0, 0xE2])
TORQUE_OFF_AT_40 = bytes([0xFF, 0xFF, 0xFE, 4, 3, 40, 0, 0xD2])


class SilentWire:
    """Wire without servos that keeps what is written."""

    baud, name = 1_000_000, "wire"

    def __init__(self) -> None:
        self.written: list[bytes] = []
        self.time = 0.0

    def write(self, data: bytes) -> None:
        self.written.append(data)

    def read(self, deadline: float) -> bytes:
        self.time = max(self.time, deadline)
        return b""

    def now(self) -> float:
        return self.time


def test_torque_of_servos_of_unknown_families_is_switched_off_at_the_addresses_of_all_families():
    wire = SilentWire()
    FrameAccess(wire).release_all()
    assert wire.written == [TORQUE_OFF_AT_24, TORQUE_OFF_AT_40]


@pytest.mark.parametrize(
    ("family", "frame"),
    [("sts", TORQUE_OFF_AT_40), ("scs", TORQUE_OFF_AT_40), ("ax", TORQUE_OFF_AT_24), ("mx", TORQUE_OFF_AT_24)],
)
def test_torque_of_servos_of_a_known_family_is_switched_off_at_its_address_alone(family, frame):
    wire = SilentWire()
    FrameAccess(wire, FAMILY_TABLES[family]).release_all()
    assert wire.written == [frame]
