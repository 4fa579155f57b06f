"""Autonomous behaviour of a virtual servo."""

from collections.abc import Callable

from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.packet import ALERT_BIT, Fault, Instruction
from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.virtual.firmware import BOOT_TIME, OVERLOAD_TIME, ROOM_TEMPERATURE

from .conftest import Line

Lines = Callable[..., Line]


def test_reboot_of_a_virtual_servo_resets_ram_and_takes_its_boot_time(line: Lines):
    one = line()
    one.set(Register.RETURN_DELAY_TIME, 5)
    one.set(Register.PROFILE_VELOCITY, 5)
    one.set(Register.TORQUE_ENABLE, 1)
    one.bytes(packet.write_packet(1, 168, (146).to_bytes(2, "little")))
    assert len(one.bytes(packet.packet(1, Instruction.REBOOT))) == packet.STATUS_OVERHEAD
    assert one.bytes(packet.ping(1), wait=BOOT_TIME / 2) == b""
    one.pass_time(BOOT_TIME)
    assert one.get(Register.RETURN_DELAY_TIME) == 5
    assert (one.get(Register.PROFILE_VELOCITY), one.get(Register.TORQUE_ENABLE)) == (0, 0)
    assert one.ask(packet.read_packet(1, 224, 1))[0].data == b"\0", "the cells show themselves again"
    assert one.get(Register.REALTIME_TICK) < 1000 * BOOT_TIME


def test_watchdog_stops_a_servo_and_locks_its_goals(line: Lines):
    one = line()
    one.set(Register.TORQUE_ENABLE, 1)
    one.set(Register.PROFILE_VELOCITY, 20)
    one.set(Register.BUS_WATCHDOG, 5)
    one.set(Register.GOAL_POSITION, 4000)
    for _ in range(3):
        one.pass_time(0.09)
        assert one.get(Register.BUS_WATCHDOG) == 5, "every instruction feeds it"
    one.pass_time(1.0)
    place = one.servo.electronics.present_position()
    assert one.get(Register.BUS_WATCHDOG) == -1
    assert one.get(Register.TORQUE_ENABLE) == 1, "torque stays"
    assert 2048 < place < 2048 + 20 * 0.229 * 4096 / 60 * 0.5
    assert one.get(Register.PRESENT_POSITION) == place
    assert (one.get(Register.PROFILE_VELOCITY), one.get(Register.PROFILE_ACCELERATION)) == (0, 0)
    for goal in (Register.GOAL_PWM, Register.GOAL_CURRENT, Register.GOAL_VELOCITY, Register.GOAL_POSITION):
        assert one.set(goal, 10) == Fault.RANGE
    assert one.set(Register.BUS_WATCHDOG, 0) == Fault.NONE
    assert one.get(Register.PRESENT_POSITION) == place, "it stays until there is a new goal"
    assert one.set(Register.GOAL_POSITION, 2048) == Fault.NONE
    one.pass_time(1.0)
    assert one.get(Register.PRESENT_POSITION) == 2048


def test_old_firmware_has_no_watchdog(line: Lines):
    one = line(firmware=37)
    assert one.set(Register.BUS_WATCHDOG, 5) == Fault.ACCESS


def test_error_in_the_shutdown_mask_disables_torque_until_reboot(line: Lines):
    one = line()
    one.set(Register.TORQUE_ENABLE, 1)
    one.servo.electronics.fail(HardwareError.OVERLOAD.value)
    (status,) = one.ask(packet.read_packet(1, Register.TORQUE_ENABLE.field.address, 1))
    assert (status.error, status.data) == (ALERT_BIT, b"\0"), "the alert is data beside the answer"
    assert one.set(Register.TORQUE_ENABLE, 1) == ALERT_BIT | Fault.RESULT
    one.bytes(packet.packet(1, Instruction.REBOOT))
    one.pass_time(BOOT_TIME)
    assert one.get(Register.HARDWARE_ERROR_STATUS) == 0
    assert one.set(Register.TORQUE_ENABLE, 1) == Fault.NONE


def test_error_outside_the_shutdown_mask_only_sets_the_alert_bit(line: Lines):
    one = line()
    one.set(Register.TORQUE_ENABLE, 1)
    one.servo.electronics.fail(HardwareError.VOLTAGE.value)
    assert one.get(Register.TORQUE_ENABLE) == 1
    assert one.error(packet.ping(1)) == ALERT_BIT
    small = line(model="xl330_m288")
    small.set(Register.TORQUE_ENABLE, 1)
    small.servo.electronics.fail(HardwareError.VOLTAGE.value)
    assert small.get(Register.TORQUE_ENABLE) == 0, "this family shuts down for its voltage too"


def test_jammed_shaft_causes_an_overload_error_after_the_overload_time(line: Lines):
    one = line()
    one.set(Register.TORQUE_ENABLE, 1)
    one.plant.physics.jammed[0] = True
    one.set(Register.GOAL_POSITION, 4000)
    one.pass_time(OVERLOAD_TIME / 2)
    assert one.get(Register.HARDWARE_ERROR_STATUS) == 0
    one.pass_time(OVERLOAD_TIME)
    assert one.get(Register.HARDWARE_ERROR_STATUS) == HardwareError.OVERLOAD.value
    assert one.get(Register.TORQUE_ENABLE) == 0


def test_sensor_registers_show_voltage_temperature_and_time(line: Lines):
    one = line()
    assert one.get(Register.PRESENT_INPUT_VOLTAGE) == 120
    assert one.get(Register.PRESENT_TEMPERATURE) == ROOM_TEMPERATURE
    assert line(model="xl330_m288").get(Register.PRESENT_INPUT_VOLTAGE) == 50
    one.pass_time(40.0)
    assert one.get(Register.REALTIME_TICK) == int(one.servo.electronics.time * 1000) % 32768


def test_startup_configuration_of_a_servo_restores_ram_and_torque_after_a_reboot(line: Lines):
    one = line()
    one.set(Register.STARTUP_CONFIGURATION, 3)
    one.set(Register.PROFILE_VELOCITY, 33)
    store = packet.packet(1, Instruction.BACKUP, bytes.fromhex("01 43 54 52 4C"))
    assert one.error(store) == Fault.NONE
    assert one.get(Register.BACKUP_READY) == 1
    one.bytes(packet.packet(1, Instruction.REBOOT))
    one.pass_time(BOOT_TIME)
    assert one.get(Register.PROFILE_VELOCITY) == 33
    assert one.get(Register.TORQUE_ENABLE) == 1
