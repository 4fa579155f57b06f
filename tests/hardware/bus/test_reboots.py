"""Detection of rebooted servos, and restoration of their indirect addresses."""

from collections.abc import Callable

import pytest

from kinesic.hardware.bus.cycle import CELL_CONTENTS
from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.models import SERVO_MODELS

from ..conftest import Rig

Make = Callable[..., Rig]
CELLS_ADDRESS = SERVO_MODELS["xm430_w350"].cells[0].addresses  # first indirect address of the servo model
REBOOT_TEXT = "RAM is as at power-on: torque off, no profile, no watchdog"


def look(servo: int) -> bytes:
    """Read the indirect addresses of a servo."""
    return packet.read_packet(servo, CELLS_ADDRESS, len(CELL_CONTENTS))


def setting(servo: int) -> bytes:
    """Return the packet that restores a servo's indirect addresses."""
    return packet.write_packet(servo, CELLS_ADDRESS, CELL_CONTENTS)


@pytest.fixture
def made(rig: Make) -> Rig:
    bus = rig(3)
    bus.energise()
    return bus


def overhear(made: Rig) -> list[bytes]:
    """Collect all bytes that are written to the wire from now on."""
    written: list[bytes] = []
    write = made.wire.write
    made.wire.write = lambda data: (written.append(bytes(data)), write(data))
    return written


def test_indirect_cells_of_a_rebooted_servo_are_checked_and_set_once(made: Rig):
    written = overhear(made)
    made.plant.servos[1].reboot(seconds=0.03)
    events = [(event.kind, event.servo, event.text) for cycle in made.run(20) for event in cycle.events]
    assert ("rebooted", 2, REBOOT_TEXT) in events
    assert [kind for kind, _, _ in events].count("rebooted") == 1
    assert (written.count(look(2)), written.count(setting(2))) == (1, 1)
    assert not made.bus._accepted.unmapped


def test_servo_with_intact_indirect_cells_is_not_reported_as_rebooted(made: Rig):
    """A record with zero voltage can be a transmission error that the CRC missed."""
    made.bus._accepted.unmapped.add(1)
    made.plant.servos[0].mute = True
    written = overhear(made)
    (cycle,) = made.run(1)
    assert (written.count(look(2)), written.count(setting(2))) == (1, 0)
    assert not cycle.events
    assert not made.bus._accepted.unmapped


def test_indirect_cells_of_a_silent_servo_are_read_in_every_cycle(made: Rig):
    made.bus._accepted.unmapped.add(1)
    made.plant.servos[1].mute = True
    written = overhear(made)
    made.run(2)
    assert written.count(look(2)) == 2
    assert made.bus._accepted.unmapped == {1}


def test_indirect_cells_whose_write_failed_are_set_in_the_next_cycle(made: Rig):
    """The write that sets the cells is lost on the wire."""
    written, lost = overhear(made), [setting(2)]
    write = made.wire.write
    made.wire.write = lambda data: lost.remove(data) if data in lost else write(data)
    made.plant.servos[1].reboot(seconds=0.03)
    kinds = [event.kind for cycle in made.run(20) for event in cycle.events]
    assert not lost
    assert (written.count(look(2)), written.count(setting(2))) == (2, 1)
    assert kinds.count("rebooted") == 1
    assert made.bus.cycle().fresh.all()


def test_reboot_is_reported_although_the_write_of_indirect_addresses_is_unacknowledged(made: Rig):
    """The servo's acknowledgement is lost on the wire."""
    left, deaf = [setting(2)], [False]
    write, read = made.wire.write, made.wire.read

    def lose_answer(data: bytes) -> None:
        deaf[0] = data in left
        if deaf[0]:
            left.remove(data)
        write(data)

    made.wire.write = lose_answer

    def hear(deadline: float) -> bytes:
        said = read(deadline)
        return b"" if deaf[0] else said

    made.wire.read = hear
    made.plant.servos[1].reboot(seconds=0.03)
    kinds = [event.kind for cycle in made.run(20) for event in cycle.events]
    assert not left
    assert kinds.count("rebooted") == 1
    assert made.bus.cycle().fresh.all()


def test_reboot_of_one_servo_triggers_no_check_of_other_servos(made: Rig):
    written = overhear(made)
    made.plant.servos[1].reboot(seconds=0.03)
    made.run(20)
    assert not any(written.count(packet) for servo in (1, 3) for packet in (look(servo), setting(servo)))
