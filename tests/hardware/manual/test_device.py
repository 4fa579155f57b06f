"""Independent servo against the manual: registers, torque, watchdog, profiles, reboot, falling arms."""

from collections.abc import Callable
from math import pi

import pytest

from ...manual_servo import packet as p
from ...manual_servo.device import BOOT_TIME
from ...manual_servo.physics import Arm, Link
from .conftest import words

Make = Callable  # of a bench, see conftest


def test_ping_but_not_read_is_answered_at_status_return_level_zero(bench: Make):
    made = bench()
    made.write("status_return", 0)
    (said,) = made.ask(1, p.PING)
    assert said.parameters == bytes([0, 0x06, 0x04, 52])
    assert made.raw(p.instruct(1, p.READ, words(132, 4))) == b""


def test_broadcast_ping_is_answered_by_all_servos_in_order_of_id(bench: Make):
    assert [said.servo for said in bench(7, 2, 5).ask(p.BROADCAST_ID, p.PING)] == [2, 5, 7]


@pytest.mark.parametrize(
    ("name", "value", "error"),
    [
        ("led", 2, p.RANGE_ERROR),
        ("goal_pwm", 886, p.LIMIT_ERROR),
        ("goal_velocity", 331, p.LIMIT_ERROR),
        ("goal_position", 4096, p.LIMIT_ERROR),
        ("present_position", 0, p.ACCESS_ERROR),
        ("operating_mode", 2, p.RANGE_ERROR),
        ("watchdog", 127, 0),
        ("profile_velocity", 32_767, 0),
    ],
)
def test_reference_servo_accepts_only_valid_register_values(bench: Make, name: str, value: int, error: int):
    made = bench()
    before = made.read(name)
    assert made.write(name, value) == error
    assert (made.read(name) == before) is (error != 0)


def test_malformed_instructions_are_answered_with_their_error_code(bench: Make):
    made = bench()
    assert made.ask(1, p.WRITE, words(116) + b"\0\0")[0].parameters == bytes([p.LENGTH_ERROR])
    assert made.ask(1, p.WRITE, words(5000) + b"\0")[0].parameters == bytes([p.ACCESS_ERROR])
    assert made.ask(1, p.READ, words(660, 40))[0].parameters == bytes([p.ACCESS_ERROR])
    assert made.ask(1, 0x77)[0].parameters == bytes([p.INSTRUCTION_ERROR])
    assert made.ask(1, p.ACTION)[0].parameters == bytes([p.INSTRUCTION_ERROR])
    broken = p.instruct(1, p.PING)[:-1] + b"\0"
    assert p.Decoder().feed(made.raw(broken))[0].parameters == bytes([p.CRC_ERROR])


def test_eeprom_is_locked_while_torque_is_on(bench: Make):
    made = bench()
    assert made.write("return_delay", 3) == 0
    made.write("torque", 1)
    assert made.write("return_delay", 0) == p.ACCESS_ERROR
    assert made.read("return_delay") == (0, 3)


def test_reg_write_instruction_takes_effect_at_the_action_instruction(bench: Make):
    made = bench()
    made.ask(1, p.REG_WRITE, words(65) + b"\1")
    assert made.read("registered") == (0, 1)
    assert made.read("led") == (0, 0)
    made.ask(p.BROADCAST_ID, p.ACTION)
    assert made.read("led") == (0, 1)
    assert made.read("registered") == (0, 0)


def test_indirect_data_mirrors_the_register_at_its_indirect_address(bench: Make):
    made = bench()
    made.ask(1, p.WRITE, words(168, 65))
    made.ask(1, p.WRITE, words(224) + b"\1")
    assert made.read("led") == (0, 1)
    assert made.ask(1, p.WRITE, words(168, 7))[0].parameters == bytes([p.RANGE_ERROR])


def test_secondary_id_accepts_ram_writes_without_reply(bench: Make):
    made = bench(1, 2)
    made.devices[1].memory["secondary_id"] = 1
    assert len(made.ask(1, p.WRITE, words(65) + b"\1")) == 1
    assert [device.memory["led"] for device in made.devices] == [1, 1]
    made.write("return_delay", 9)
    assert [device.memory["return_delay"] for device in made.devices] == [9, 0]


def test_sync_and_bulk_instructions_address_several_servos(bench: Make):
    made = bench(1, 2, 3)
    assert made.ask(p.BROADCAST_ID, p.SYNC_WRITE, words(116, 4) + b"\1" + words(2000, 0) + b"\3" + words(2100, 0)) == []
    bulk = b"\2" + words(65, 1) + b"\1" + b"\3" + words(102, 2) + words(7)
    made.ask(p.BROADCAST_ID, p.BULK_WRITE, bulk)
    assert [device.memory["goal_position"] for device in made.devices] == [2000, 2048, 2100]
    assert made.devices[1].memory["led"] == 1
    assert made.devices[2].memory["goal_current"] == 7
    answer = made.ask(p.BROADCAST_ID, p.SYNC_READ, words(116, 4) + b"\3\1")
    assert [(said.servo, said.parameters[1:3]) for said in answer] == [(3, words(2100)), (1, words(2000))]
    answer = made.ask(p.BROADCAST_ID, p.BULK_READ, b"\2" + words(65, 1) + b"\1" + words(116, 2))
    assert [said.parameters for said in answer] == [b"\0\1", b"\0" + words(2000)]


def test_reference_servos_listed_after_a_silent_servo_do_not_reply_to_a_sync_read(bench: Make):
    made = bench(1, 2, 3)
    made.devices[1].mute = True
    assert [said.servo for said in made.ask(p.BROADCAST_ID, p.SYNC_READ, words(116, 4) + b"\1\2\3")] == [1]


def test_bus_watchdog_stops_the_servo_and_locks_its_goals(bench: Make):
    made = bench()
    for name, value in (("profile_velocity", 40), ("torque", 1), ("watchdog", 5), ("goal_position", 3000)):
        assert made.write(name, value) == 0
    made.rest(0.3)
    stood = made.device.shaft.ticks
    assert made.read("watchdog") == (0, -1)
    assert made.read("profile_velocity") == (0, 0)
    assert made.write("goal_position", 2500) == p.RANGE_ERROR
    made.rest(0.3)
    assert abs(made.device.shaft.ticks - stood) < 30
    assert made.write("watchdog", 0) == 0
    assert made.write("goal_position", 2500) == 0
    assert made.read("torque") == (0, 1)


def test_velocity_based_profile_of_a_servo_is_a_trapezoid(bench: Make):
    made = bench()
    made.write("profile_velocity", 64)  # 1000 ticks/s
    made.write("profile_acceleration", 20)  # 4883 ticks/s^2: 0.2 s to full speed
    made.write("torque", 1)
    made.write("goal_position", 3048)
    speeds = []
    for _ in range(130):
        made.rest(0.01)
        speeds.append(made.device.firmware.profile.speed)
    assert max(speeds) == pytest.approx(1000, rel=0.01)
    assert speeds[9] == pytest.approx(0.12 * 4883, rel=0.1)  # the write itself takes a moment
    assert speeds[-1] == 0
    assert made.device.shaft.ticks == pytest.approx(3048, abs=5)


def test_time_based_profile_of_a_servo_takes_its_duration(bench: Make):
    made = bench()
    for name, value in (("drive_mode", 4), ("profile_velocity", 1000), ("profile_acceleration", 200), ("torque", 1)):
        assert made.write(name, value) == 0
    made.write("goal_position", 3000)
    made.rest(0.9)
    assert made.device.firmware.profile.speed > 0
    made.rest(0.15)
    assert made.device.firmware.profile.place == pytest.approx(3000, abs=2)


def test_reverse_drive_mode_of_the_reference_servo_inverts_rotation(bench: Make):
    made = bench()
    before = made.device.shaft.angle
    made.write("drive_mode", 1)
    made.write("torque", 1)
    made.write("goal_position", 2248)
    made.rest(0.5)
    assert made.device.shaft.angle - before == pytest.approx(-200 * 2 * pi / 4096, abs=0.02)
    assert made.read("present_position")[1] == pytest.approx(2248, abs=5)


def test_torque_on_reduces_the_position_of_the_reference_servo_to_one_turn(bench: Make):
    made = bench()
    made.device.shaft.angle += 2 * pi
    assert made.read("present_position") == (0, 2048 + 4096)
    made.write("torque", 1)
    assert made.read("present_position")[1] == pytest.approx(2048, abs=2)


def test_operating_mode_change_of_the_reference_servo_resets_gains_and_profiles(bench: Make):
    made = bench()
    made.write("position_p", 5)
    made.write("profile_velocity", 9)
    made.write("operating_mode", 4)
    assert made.read("position_p") == (0, 800)
    assert made.read("profile_velocity") == (0, 0)


def test_reference_servo_replies_carry_an_alert_and_the_shutdown_mask_decides_whether_torque_goes_off(bench: Make):
    made = bench()
    made.write("torque", 1)
    made.device.firmware.alert(1)
    assert made.read("torque") == (p.ALERT_BIT, 1)
    made.device.firmware.alert(32)
    assert made.read("torque") == (p.ALERT_BIT, 0)
    assert made.write("torque", 1) == p.ALERT_BIT | p.RESULT_FAIL
    assert made.read("torque") == (p.ALERT_BIT, 0)
    made.ask(1, p.REBOOT)
    assert made.ask(1, p.PING) == []
    made.rest(BOOT_TIME)
    assert made.write("torque", 1) == 0


def test_reference_servo_reboot_resets_ram_and_keeps_eeprom(bench: Make):
    made = bench()
    made.write("moving_threshold", 3)
    made.write("profile_velocity", 9)
    made.ask(1, p.REBOOT)
    made.rest(BOOT_TIME)
    assert made.read("moving_threshold") == (0, 3)
    assert made.read("profile_velocity") == (0, 0)
    assert made.read("goal_position")[1] == made.read("present_position")[1]


def test_reference_servo_restores_registers_from_backup_and_by_factory_reset(bench: Make):
    made = bench(4)
    made.write("moving_threshold", 3, servo=4)
    assert made.ask(4, p.BACKUP, b"\1CTRL")[0].parameters == b"\0"
    made.write("moving_threshold", 8, servo=4)
    assert made.ask(4, p.BACKUP, b"\2CTRL")[0].parameters == b"\0"
    made.rest(BOOT_TIME)
    assert made.read("moving_threshold", servo=4) == (0, 3)
    assert made.ask(p.BROADCAST_ID, p.FACTORY_RESET, b"\xff") == []
    assert made.device.memory["moving_threshold"] == 3
    made.ask(4, p.FACTORY_RESET, b"\2")
    made.rest(BOOT_TIME)
    assert made.read("moving_threshold", servo=4) == (0, 10)
    made.ask(4, p.FACTORY_RESET, b"\1")
    made.rest(BOOT_TIME)
    assert made.device.id == 4
    assert made.device.baud == 57_600


def test_clear_instruction_resets_the_turn_count_of_a_reference_servo_only_at_standstill(bench: Make):
    made = bench()
    made.write("operating_mode", 4)
    made.device.shaft.angle += 4 * pi
    assert made.read("present_position") == (0, 2048 + 8192)
    assert made.ask(1, p.CLEAR, bytes.fromhex("0144584C22"))[0].parameters == b"\0"
    assert made.read("present_position") == (0, 2048)
    made.device.shaft.speed = 1.0
    assert made.ask(1, p.CLEAR, bytes.fromhex("0144584C22"))[0].parameters == bytes([p.RESULT_FAIL])


def test_reference_servo_reply_arrives_after_return_delay_transmission_time_and_latency(bench: Make):
    made = bench()
    made.device.memory["return_delay"] = 254
    asked = p.instruct(1, p.PING)
    made.line.send(asked, 0.0)
    took = (len(asked) + 14) * 10 / 1_000_000 + 508e-6 + made.line.latency
    assert made.line.arrives() == pytest.approx(took)


def test_reference_servo_tick_register_counts_milliseconds(bench: Make):
    made = bench()
    before = made.read("tick")[1]
    made.rest(0.5 - 0.02)
    assert made.read("tick")[1] - before == pytest.approx(500, abs=2)


def test_arm_of_a_reference_servo_is_held_with_torque_and_falls_without_torque(bench: Make):
    made = bench(1, 2)
    shoulder, elbow = (device.shaft for device in made.devices)
    made.line.world.arms = (Arm((Link(shoulder, 0.0, 1.0, 0.6), Link(elbow, 0.0, 1.0, 0.2))),)
    shoulder.angle = 1.2
    made.device.firmware.boot(0.0)
    made.write("torque", 1)
    made.rest(1.0)
    assert shoulder.angle == pytest.approx(1.2, abs=0.06)
    made.write("torque", 0)
    made.rest(0.5)
    assert shoulder.angle < 0.9


def test_stalled_shaft_causes_an_overload_shutdown(bench: Make):
    made = bench()
    made.write("torque", 1)
    made.device.shaft.jammed = True
    made.write("goal_position", 3000)
    made.rest(2.5)
    assert made.read("error") == (p.ALERT_BIT, 32)
    assert made.read("torque") == (p.ALERT_BIT, 0)
