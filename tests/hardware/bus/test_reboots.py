"""A servo that has rebooted shows its registers no longer: how a bus makes sure, and sets its cells anew."""

from collections.abc import Callable

import pytest

from kinesic.hardware.bus.cycle import CELLS
from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.models import MODELS

from ..conftest import Rig

Make = Callable[..., Rig]
CELLS_AT = MODELS["xm430_w350"].cells[0].addresses
TOLD = "its RAM is as at power-on: torque off, no profile, no watchdog"


def look(servo: int) -> bytes:
    """Asks a servo what its cells show."""
    return packet.read_packet(servo, CELLS_AT, len(CELLS))


def setting(servo: int) -> bytes:
    """Sets its cells."""
    return packet.write_packet(servo, CELLS_AT, CELLS)


@pytest.fixture
def made(rig: Make) -> Rig:
    bus = rig(3)
    bus.energise()
    return bus


def overhear(made: Rig) -> list[bytes]:
    """What is written on the wire from now on."""
    written: list[bytes] = []
    write = made.wire.write
    made.wire.write = lambda data: (written.append(bytes(data)), write(data))
    return written


def test_its_cells_are_looked_at_and_set_once(made: Rig):
    written = overhear(made)
    made.plant.servos[1].reboot(seconds=0.03)
    told = [(event.kind, event.servo, event.text) for cycle in made.run(20) for event in cycle.events]
    assert ("rebooted", 2, TOLD) in told
    assert [kind for kind, _, _ in told].count("rebooted") == 1
    assert (written.count(look(2)), written.count(setting(2))) == (1, 1)
    assert not made.bus._believed.forgetful


def test_who_still_shows_its_registers_has_not_rebooted(made: Rig):
    """A record without voltage may be an error that the CRC let pass."""
    made.bus._believed.forgetful.add(1)
    made.plant.servos[0].mute = True
    written = overhear(made)
    (cycle,) = made.run(1)
    assert (written.count(look(2)), written.count(setting(2))) == (1, 0)
    assert not cycle.events
    assert not made.bus._believed.forgetful


def test_who_does_not_answer_is_looked_at_again(made: Rig):
    made.bus._believed.forgetful.add(1)
    made.plant.servos[1].mute = True
    written = overhear(made)
    made.run(2)
    assert written.count(look(2)) == 2
    assert made.bus._believed.forgetful == {1}


def test_cells_that_were_not_set_are_set_in_the_next_cycle(made: Rig):
    """What should set them is lost on the wire."""
    written, lost = overhear(made), [setting(2)]
    write = made.wire.write
    made.wire.write = lambda data: lost.remove(data) if data in lost else write(data)
    made.plant.servos[1].reboot(seconds=0.03)
    told = [event.kind for cycle in made.run(20) for event in cycle.events]
    assert not lost
    assert (written.count(look(2)), written.count(setting(2))) == (2, 1)
    assert told.count("rebooted") == 1
    assert made.bus.cycle().fresh.all()


def test_who_set_its_cells_and_was_not_heard_has_rebooted_all_the_same(made: Rig):
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
    told = [event.kind for cycle in made.run(20) for event in cycle.events]
    assert not left
    assert told.count("rebooted") == 1
    assert made.bus.cycle().fresh.all()


def test_no_other_is_asked_whether_it_has_rebooted(made: Rig):
    written = overhear(made)
    made.plant.servos[1].reboot(seconds=0.03)
    made.run(20)
    assert not any(written.count(packet) for servo in (1, 3) for packet in (look(servo), setting(servo)))
