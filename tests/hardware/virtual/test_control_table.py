"""Indirect addresses and data cells of the control table."""

from collections.abc import Callable

from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.packet import Fault
from kinesic.hardware.protocol.registers import Register

from .conftest import Line

Lines = Callable[..., Line]


def test_indirect_cells_read_and_write_their_targets(line: Lines):
    one = line()
    pointers = b"".join(a.to_bytes(2, "little") for a in (65, 132, 133, 134, 135))
    assert one.error(packet.write_packet(1, 168, pointers)) == Fault.NONE
    assert one.error(packet.write_packet(1, 224, b"\1")) == Fault.NONE
    assert one.get(Register.LED) == 1
    (status,) = one.ask(packet.read_packet(1, 224, 5))
    assert status.data == b"\1" + (2048).to_bytes(4, "little")
    assert one.error(packet.write_packet(1, 225, bytes(4))) == Fault.ACCESS, "what is shown stays read-only"


def test_changed_indirect_address_applies_to_the_next_read_and_write(line: Lines):
    one, targets = line(), {Register.LED: 1, Register.BUS_WATCHDOG: 5}
    for register, value in targets.items():
        one.bytes(packet.write_packet(1, 168, register.field.address.to_bytes(2, "little")))
        assert one.ask(packet.read_packet(1, 224, 1))[0].data == b"\0"
        assert one.error(packet.write_packet(1, 224, bytes((value,)))) == Fault.NONE
    assert {register: one.get(register) for register in targets} == targets


def test_indirect_data_cannot_write_part_of_a_register(line: Lines):
    one = line()
    one.bytes(packet.write_packet(1, 168, (116).to_bytes(2, "little")))
    assert one.error(packet.write_packet(1, 224, b"\1")) == Fault.LENGTH


def test_unmapped_indirect_cells_store_their_own_bytes(line: Lines):
    one = line()
    one.bytes(packet.write_packet(1, 224, b"abc"))
    assert one.ask(packet.read_packet(1, 224, 4))[0].data == b"abc\0"


def test_xl330_servos_have_indirect_data_at_address_208(line: Lines):
    one = line(model="xl330_m288")
    one.bytes(packet.write_packet(1, 168, (65).to_bytes(2, "little")))
    one.bytes(packet.write_packet(1, 208, b"\1"))
    assert one.get(Register.LED) == 1
    assert one.error(packet.read_packet(1, 578, 2)) == Fault.ACCESS
