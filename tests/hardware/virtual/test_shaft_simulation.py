import pytest

from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.packet import ALERT_BIT
from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault
from kinesic.hardware.virtual.firmware import ROOM_TEMPERATURE
from kinesic.hardware.virtual.wiring import Cable, ServoFitting

from .conftest import Line


def struck(*faults: PlannedFault) -> Line:
    return Line(Cable("body", (ServoFitting(1), ServoFitting(2)), faults=FaultPlan(faults)))


def test_planned_alert_switches_torque_off_at_its_time():
    line = struck(PlannedFault("alert", servos=(2,), start=1.0))
    line.set(Register.TORQUE_ENABLE, 1, servo=2)
    line.pass_time(0.9)
    assert line.error(packet.ping(2)) == 0
    line.pass_time(0.2)
    assert line.error(packet.ping(2)) == ALERT_BIT
    assert line.get(Register.HARDWARE_ERROR_STATUS, servo=2) == HardwareError.OVERLOAD.value
    assert line.get(Register.TORQUE_ENABLE, servo=2) == 0
    assert line.error(packet.ping(1)) == 0


def test_planned_overheating_raises_the_temperature_until_the_servo_shuts_down():
    line = struck(PlannedFault("overheat", servos=(1,), start=1.0, seconds=20.0, value=5.0))
    line.set(Register.TORQUE_ENABLE, 1)
    line.pass_time(11.0)
    assert line.get(Register.PRESENT_TEMPERATURE) == pytest.approx(ROOM_TEMPERATURE + 50, abs=1)
    assert line.get(Register.TORQUE_ENABLE) == 1
    line.pass_time(1.1)
    assert line.get(Register.HARDWARE_ERROR_STATUS) == HardwareError.OVERHEATING.value
    assert line.get(Register.TORQUE_ENABLE) == 0
    line.pass_time(20.0)
    assert line.get(Register.PRESENT_TEMPERATURE) == pytest.approx(ROOM_TEMPERATURE + 100, abs=1), "it ends"


def test_planned_undervoltage_recovers_but_its_hardware_error_stays():
    line = struck(PlannedFault("undervoltage", start=0.5, seconds=0.5, value=8.0))
    line.pass_time(0.7)
    assert line.get(Register.PRESENT_INPUT_VOLTAGE) == 80
    line.pass_time(0.5)
    assert line.get(Register.PRESENT_INPUT_VOLTAGE) == 120
    assert line.get(Register.HARDWARE_ERROR_STATUS) == HardwareError.VOLTAGE.value


def test_planned_reboot_watchdog_trip_and_silence_of_virtual_servos_occur_at_their_times():
    line = struck(
        PlannedFault("reboot", servos=(1,), start=1.0, value=0.5),
        PlannedFault("watchdog", servos=(2,), start=1.0),
        PlannedFault("silent", servos=(2,), start=2.0, seconds=0.5),
    )
    line.pass_time(1.3)
    assert line.ask(packet.ping(1)) == []
    assert line.get(Register.BUS_WATCHDOG, servo=2) == -1
    line.pass_time(0.3)
    assert len(line.ask(packet.ping(1))) == 1
    line.pass_time(0.6)
    assert line.ask(packet.ping(2)) == []
    line.pass_time(0.4)
    assert len(line.ask(packet.ping(2))) == 1


def test_goal_position_after_a_reboot_is_the_present_position():
    line = struck(PlannedFault("reboot", servos=(1,), start=0.5))
    line.set(Register.TORQUE_ENABLE, 1)
    line.set(Register.GOAL_POSITION, 2500)
    line.pass_time(0.55)
    line.plant.physics.turn(0, 1000 * Register.PRESENT_POSITION.field.scale)
    line.pass_time(0.5)
    assert line.get(Register.GOAL_POSITION) == 1000


def test_watchdog_trips_on_time_within_a_long_simulation_step():
    line = struck()
    line.set(Register.TORQUE_ENABLE, 1)
    line.set(Register.BUS_WATCHDOG, 3)
    heard = line.servo.electronics._instructed
    trips = []
    plain = line.servo.electronics.trip
    line.servo.electronics.trip = lambda: (trips.append(line.servo.electronics.time), plain())
    line.pass_time(1.0)
    assert trips == [pytest.approx(heard + 0.06)]


def test_advancing_the_simulation_to_an_earlier_time_changes_nothing():
    line = struck()
    line.plant.advance(2.0)
    line.plant.advance(1.0)
    assert line.plant.time == 2.0
