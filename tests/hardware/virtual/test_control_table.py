"""Indirect cells."""

from collections.abc import Callable

from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.packet import Fault
from kinesic.hardware.protocol.registers import Register

from .conftest import Line

Lines = Callable[..., Line]


def test_indirect_cells_show_and_take_what_they_point_at(line: Lines):
    one = line()
    pointers = b"".join(a.to_bytes(2, "little") for a in (65, 132, 133, 134, 135))
    assert one.error(packet.write_packet(1, 168, pointers)) == Fault.NONE
    assert one.error(packet.write_packet(1, 224, b"\1")) == Fault.NONE
    assert one.get(Register.LED) == 1
    (status,) = one.ask(packet.read_packet(1, 224, 5))
    assert status.data == b"\1" + (2048).to_bytes(4, "little")
    assert one.error(packet.write_packet(1, 225, bytes(4))) == Fault.ACCESS, "what is shown stays read-only"


def test_a_part_of_a_register_cannot_be_written_through_a_cell(line: Lines):
    one = line()
    one.bytes(packet.write_packet(1, 168, (116).to_bytes(2, "little")))
    assert one.error(packet.write_packet(1, 224, b"\1")) == Fault.LENGTH


def test_cells_hold_bytes_of_their_own_until_they_point_elsewhere(line: Lines):
    one = line()
    one.bytes(packet.write_packet(1, 224, b"abc"))
    assert one.ask(packet.read_packet(1, 224, 4))[0].data == b"abc\0"


def test_the_small_family_has_its_cells_elsewhere(line: Lines):
    one = line(model="xl330_m288")
    one.bytes(packet.write_packet(1, 168, (65).to_bytes(2, "little")))
    one.bytes(packet.write_packet(1, 208, b"\1"))
    assert one.get(Register.LED) == 1
    assert one.error(packet.read_packet(1, 578, 2)) == Fault.ACCESS
