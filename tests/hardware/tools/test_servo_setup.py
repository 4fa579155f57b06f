"""Setup and restart of single servos of each family.

The setup changes id and baud rate.
"""

from collections.abc import Callable

import pytest

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.tools.servo_setup import identify_servo, reboot, set_baud, set_id
from kinesic.hardware.tools.survey import FEETECH_PROTOCOL, FRAME_PROTOCOL, PACKET_PROTOCOL, scan_bus
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

NEW_RATES = {
    "xl330_m288": 2_000_000,
    "sts3215": 500_000,
    "scs0009": 250_000,
    "ax12": 115_200,
    "mx28": 57_600,
}  # [bit/s]


@pytest.fixture(params=list(NEW_RATES))
def model(request: pytest.FixtureRequest) -> str:
    """Return the name of a servo model of each family."""
    return str(request.param)


def port(model: str, *ids: int) -> tuple[Callable[[int], Wire], ShaftSimulation]:
    """Return a function that opens the servos' port, and their simulation."""
    plant, buses = build_bus([Cable("body", tuple(ServoFitting(k, model=model) for k in ids))])

    wires = [MemoryWire(buses["body"])]

    def opened(rate: int) -> Wire:
        wires.append(MemoryWire(buses["body"], time=wires[-1].now()))
        wires[-1].baud = rate
        return wires[-1]

    return opened, plant


def test_servo_id_is_changed_and_verified(model: str):
    opened, plant = port(model, 1, 9)
    assert set_id(opened(1_000_000), 1, 5).id == 5
    assert [servo.id for servo in plant.servos] == [5, 9]
    with pytest.raises(BusError, match="id 9 is taken"):
        set_id(opened(1_000_000), 5, 9)
    with pytest.raises(BusError, match="no known servo answers as id 1 at 1000000 baud"):
        set_id(opened(1_000_000), 1, 2)


def test_servo_baud_rate_is_changed_and_verified(model: str):
    opened, plant = port(model, 3)
    assert set_baud(opened, 3, baud=1_000_000, new=NEW_RATES[model]).name == model
    assert plant.servos[0].baud == NEW_RATES[model]
    with pytest.raises(BusError, match="has no baud rate 123; there are"):
        set_baud(opened, 3, baud=NEW_RATES[model], new=123)


def test_id_and_baud_rate_of_a_servo_with_torque_are_not_changed(model: str):
    opened, plant = port(model, 3)
    found = identify_servo(opened(1_000_000), 3)
    found.access.write(3, Register.TORQUE_ENABLE, 1)
    for change in (
        lambda: set_id(opened(1_000_000), 3, 4),
        lambda: set_baud(opened, 3, baud=1_000_000, new=NEW_RATES[model]),
        lambda: reboot(opened(1_000_000), 3),
    ):
        with pytest.raises(BusError, match="servo 3 has torque"):
            change()
    assert (plant.servos[0].id, plant.servos[0].baud) == (3, 1_000_000)


@pytest.mark.parametrize("name", ["xl330_m288", "sts3215"])
def test_servo_restart_clears_a_hardware_error(name: str):
    opened, plant = port(name, 3)
    plant.servos[0].electronics.fail(32)
    assert reboot(opened(1_000_000), 3).id == 3
    assert plant.servos[0].memory[Register.HARDWARE_ERROR_STATUS] == 0


def test_bus_scan_names_the_protocol_of_each_servo_family(model: str):
    opened, _ = port(model, 3, 7)
    protocols = {"xl330_m288": PACKET_PROTOCOL, "ax12": FRAME_PROTOCOL, "mx28": FRAME_PROTOCOL}
    (one, two) = scan_bus(opened, bauds=(57_600, 1_000_000))
    assert (one.servo.id, two.servo.id, one.baud) == (3, 7, 1_000_000)
    assert one.servo.name == model
    assert one.protocol == protocols.get(model, FEETECH_PROTOCOL)


def test_bus_scan_counts_the_received_bytes():
    opened, _ = port("sts3215", 3)
    heard: dict[int, int] = {}
    scan_bus(opened, bauds=(1_000_000, 500_000), heard=heard)
    assert heard[1_000_000] > 0
    assert heard[500_000] == 0
