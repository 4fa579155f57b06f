"""Bus of independently written servos of each family, under each fault.

The servos share no code with kinesic.
"""

from random import Random

import numpy as np
import pytest

from kinesic.hardware.bus.bring_up import open_bus
from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.bus.cycle import Cycle
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.protocol.frame_access import FrameAccess
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError

from ...manual_servo.frame_device import AX, MX, SCS, STS, FrameDevice, FrameLine

FAMILIES = {
    "sts3215": (STS, 74),
    "scs0009": (SCS, 60),
    "ax12": (AX, 120),
    "mx28": (MX, 120),
}  # register layout, voltage [0.1 V]
SERVO_COUNT = 4  # servos on the wire
PERIOD = 0.01  # [s] cycle period
TOLERANCE = 60  # [ticks] motion of a servo within two cycles, with rounding


def line_of(name: str) -> FrameLine:
    layout, volts = FAMILIES[name]
    devices = [FrameDevice(layout, SERVO_MODELS[name].number, k + 1, volts=volts) for k in range(SERVO_COUNT)]
    line = FrameLine(devices)
    line.lost = BusError
    return line


def bus_on(line: FrameLine, name: str) -> Bus:
    return open_bus(line, [Servo(k + 1, SERVO_MODELS[name]) for k in range(SERVO_COUNT)], period=PERIOD)


def true_ticks(line: FrameLine, name: str) -> np.ndarray:
    field = SERVO_MODELS[name].native_table.fields[Register.PRESENT_POSITION]
    return np.array([field.from_native(round(device.place)) for device in line.devices])


def run(bus: Bus, line: FrameLine, name: str, cycles: int, *, shift: int = 300) -> list[Cycle]:
    """Run slow goals and compare accepted positions with the true ones."""
    done = []
    start = true_ticks(line, name)
    for k in range(cycles):
        due = line.now() + PERIOD
        done.append(bus.cycle(start + round(shift * np.sin(k / 15))))
        known = (done[-1].ages < 2 * PERIOD) & np.isfinite(done[-1].times)
        wrong = np.abs(done[-1].positions - true_ticks(line, name))[known]
        assert (wrong <= TOLERANCE).all(), (name, k, wrong)
        line.sleep(due)
    return done


SAMPLED_FAMILIES = {"sts3215", "ax12"}  # families with and without a sync read, tested in every run


@pytest.fixture(
    params=[pytest.param(name, marks=[pytest.mark.soak] * (name not in SAMPLED_FAMILIES)) for name in FAMILIES]
)
def name(request: pytest.FixtureRequest) -> str:
    """Return the name of a servo model of each family."""
    return str(request.param)


@pytest.fixture
def moving(name: str) -> tuple[Bus, FrameLine]:
    """Return a bus whose servos have torque and move."""
    line = line_of(name)
    bus = bus_on(line, name)
    bus.put(Register.TORQUE_ENABLE, dict.fromkeys(bus.ids, 1))
    cycles = run(bus, line, name, 20)
    assert cycles[-1].raw_values("torque").tolist() == [1] * SERVO_COUNT
    return bus, line


def test_independently_written_servos_follow_the_goals_sent_by_the_kinesic_bus(name: str, moving):
    bus, line = moving
    cycles = run(bus, line, name, 40)
    assert all(cycle.fresh.all() for cycle in cycles)
    reached = [cycle.positions[0] for cycle in cycles]
    assert max(reached) - min(reached) > 200
    assert not any(cycle.events for cycle in cycles)


def test_damaged_replies_of_independently_written_servos_give_no_wrong_position(name: str, moving):
    bus, line = moving
    random = Random(7)

    def damage(data: bytes) -> bytes:
        kind, place = random.random(), random.randrange(len(data))
        if kind < 0.05:
            return data[:place] + bytes((data[place] ^ random.randint(1, 255),)) + data[place + 1 :]
        if kind < 0.10:
            return data[:place]
        return random.randbytes(3) + data if kind < 0.13 else b"" if kind < 0.18 else data

    line.damage = damage
    cycles = run(bus, line, name, 150)
    assert np.mean([cycle.fresh.mean() for cycle in cycles]) > 0.75  # 18 % of all replies are damaged


def test_silent_and_failed_independently_written_servos_are_reported_without_effect_on_others(name: str, moving):
    bus, line = moving
    device = line.devices[1]
    device.silent = True
    cycles = run(bus, line, name, 12)
    assert ("silent", 2) in [(event.kind, event.servo) for cycle in cycles for event in cycle.events]
    assert cycles[-1].fresh.tolist() == [True, False, True, True]
    device.silent = False
    cycles = run(bus, line, name, 30)
    assert ("heard", 2) in [(event.kind, event.servo) for cycle in cycles for event in cycle.events]
    device.answers_as = 9
    run(bus, line, name, 6)
    device.answers_as = None
    run(bus, line, name, 30)
    device.table[device.layout.celsius] = 34
    assert run(bus, line, name, 5)[-1].raw_values("temperature")[1] == 34
    device.fail(0x20)
    cycles = run(bus, line, name, 12)
    assert cycles[-1].raw_values("hardware_error")[1] == 0x20
    assert [event.servo for cycle in cycles for event in cycle.events if event.kind == "error"] == [2]


def test_unplugged_port_of_independently_written_servos_is_reported_lost_and_reopened(name: str, moving):
    bus, line = moving
    line.plugged = False
    cycles = run(bus, line, name, 10)
    assert cycles[-1].lost
    line.plugged = True
    cycles = run(bus, line, name, 20)
    assert not cycles[-1].lost
    assert cycles[-1].fresh.all()


def test_error_for_unsuitable_independently_written_servos_names_each_id_and_fault(name: str):
    line = line_of(name)
    line.devices[0].silent = True
    line.devices[1].table[line.devices[1].layout.volts] = 20
    line.devices[1].volts = 20
    line.devices[2].put(line.devices[2].layout.model, 2825 if name != "sts3215" else 12)
    with pytest.raises(BusError) as caught:
        bus_on(line, name)
    lines = str(caught.value).splitlines()
    assert "servo 1: no answer" in lines[0]
    assert "servo 2: supply is 2.0 V" in lines[1]
    assert "servo 3: is a" in lines[2]


def test_registers_of_independently_written_servos_are_read_and_written(name: str):
    line = line_of(name)
    access = FrameAccess(line, SERVO_MODELS[name].native_table)
    assert access.read(1, Register.MODEL_NUMBER) == SERVO_MODELS[name].number
    access.write(1, Register.ID, 7)
    assert line.devices[0].id == 7
    reply = access.ping(7)
    assert reply is not None
    assert reply.name == name
    with pytest.raises(BusError, match="has no register BUS_WATCHDOG"):
        access.write(7, Register.BUS_WATCHDOG, 5)
