"""Effects of each fault of the independent servos, only while active."""

from collections.abc import Callable
from dataclasses import dataclass

import pytest

from ...manual_servo import faults, lies, servo_faults, strangers
from ...manual_servo import packet as p
from ...manual_servo.device import Device
from ...manual_servo.faults import Fault
from .conftest import Bench, words

Make = Callable  # of a bench, see conftest
VOLTAGE, OVERHEAT, ENCODER, SHOCK, OVERLOAD = 1, 4, 8, 16, 32  # bits of the hardware error status
POSITION_QUERY = p.instruct(p.BROADCAST_ID, p.SYNC_READ, words(132, 4) + b"\1\2")  # sync read of both servos' positions


def record(made: Bench) -> bytes:
    """Return the reported positions of both servos as raw bytes."""
    return made.raw(POSITION_QUERY)


def answers(made: Bench) -> list[int]:
    """Return the ids of servos that answer a sync read intact."""
    return [said.servo for said in p.Decoder().feed(record(made), made.line.world.time) if said.intact]


def position(made: Bench, servo: int = 1) -> int:
    """Return the position that a servo reports."""
    return made.read("present_position", servo)[1]


def torque(made: Bench) -> int:
    """Return the actual and the reported torque state of servo 1."""
    return made.device.memory["torque"]


def moves(made: Bench) -> bool:
    """Return whether servo 1 follows a goal."""
    before = made.device.shaft.ticks
    made.write("goal_position", round(before) + 50)
    made.rest(0.5)
    return abs(made.device.shaft.ticks - before) > 35


def climbs(made: Bench) -> int:
    """Return the clock advance [ms] of servo 1 during 0.2 s."""
    before = made.read("tick")[1]
    made.rest(0.2)
    return made.read("tick")[1] - before


@dataclass(frozen=True)
class Case:
    """Fault with its visible effect."""

    fault: Callable[[], Fault]
    seen: Callable[[Bench], bool]


REPLY_SIZE = 2 * 15  # [bytes] size of the replies of both servos
CASES = {
    "garble": Case(faults.Garble, lambda made: len(record(made)) == REPLY_SIZE and answers(made) != [1, 2]),
    "truncate": Case(faults.Truncate, lambda made: len(record(made)) < REPLY_SIZE),
    "a byte dropped": Case(faults.DropByte, lambda made: len(record(made)) == REPLY_SIZE - 2),
    "insert": Case(faults.Insert, lambda made: len(record(made)) > REPLY_SIZE),
    "duplicate": Case(faults.Duplicate, lambda made: answers(made) == [1, 1, 2, 2]),
    "lose": Case(faults.Lose, lambda made: record(made) == b""),
    "late": Case(faults.Late, lambda made: made.raw(POSITION_QUERY, 0.01) == b"" and bool(made.raw(b"", 0.02))),
    "mirror": Case(faults.Mirror, lambda made: record(made).startswith(b"\xff\xff\xbf\x00")),
    "lost requests": Case(faults.LostRequest, lambda made: answers(made) == []),
    "echo": Case(faults.Echo, lambda made: record(made).startswith(POSITION_QUERY)),
    "flood": Case(faults.Flood, lambda made: len(record(made)) == 200 + REPLY_SIZE),
    "frozen link": Case(faults.FrozenLink, lambda made: record(made) == b""),
    "silent all": Case(faults.SilentAll, lambda made: record(made) == b"" and not made.device.mute),
    "unplugged": Case(faults.Unplugged, lambda made: not made.line.plugged and record(made) == b""),
    "wrong id": Case(lambda: faults.WrongId(2, 9), lambda made: answers(made) == [1, 9]),
    "bad crc": Case(lambda: faults.BadCrc(2), lambda made: len(record(made)) == REPLY_SIZE and answers(made) == [1]),
    "wrong length": Case(lambda: faults.WrongLength(2), lambda made: len(record(made)) == REPLY_SIZE - 1),
    "misquoted": Case(
        lambda: faults.Misquoted(2), lambda made: len(record(made)) == REPLY_SIZE and answers(made) == [1]
    ),
    "silent": Case(lambda: servo_faults.Silent(2), lambda made: answers(made) == [1]),
    "unhearing": Case(
        lambda: servo_faults.Unhearing(2),
        lambda made: made.write("led", 1 - made.devices[1].memory["led"], 2) == -1,
    ),
    "boasting": Case(lambda: servo_faults.Boasting(1), lambda made: made.read("error") == (p.ALERT_BIT, 0)),
    "goal ignored": Case(lambda: servo_faults.GoalIgnored(1), lambda made: not moves(made)),
    "stalled": Case(lambda: servo_faults.Stalled(1), lambda made: not moves(made)),
    "undervoltage": Case(lambda: servo_faults.Undervoltage(1), lambda made: made.read("volts")[1] == 90),
    "frozen servo": Case(lambda: lies.FrozenServo(1), lambda made: climbs(made) == 0),
    "stuck tick": Case(lambda: lies.StuckTick(1), lambda made: climbs(made) == 0),
    "drifting clock": Case(lambda: lies.DriftingClock(1, 1.5), lambda made: climbs(made) > 300),
    "nonsense": Case(lambda: lies.Nonsense(1), lambda made: [position(made), position(made)] == [1_000_000] * 2),
    "scattered": Case(lambda: lies.Scattered(1), lambda made: abs(position(made) - position(made)) > 10_000),
    "turn offset": Case(lambda: lies.TurnOffset(1), lambda made: abs(position(made) - 2048 - 4096) < 9),
    "foreign firmware": Case(lambda: strangers.foreign_firmware(1), lambda made: made.read("firmware")[1] == 35),
    "foreign model": Case(lambda: strangers.foreign_model(1), lambda made: made.read("model")[1] == 1060),
    "alias id": Case(
        lambda: strangers.alias_id(1, 2),
        lambda made: (made.write("led", 0), made.write("led", 1, 2), made.device.memory["led"])[-1] == 1,
    ),
    "duplicate id": Case(lambda: strangers.duplicate_id(1, 2), lambda made: made.ask(1, p.PING) == []),
    "return level": Case(lambda: strangers.return_level(2), lambda made: answers(made) == [1]),
    "baud changed": Case(lambda: strangers.baud_changed(2), lambda made: made.ask(2, p.PING) == []),
}


@pytest.mark.parametrize("name", CASES)
def test_each_injected_servo_fault_acts_only_during_its_duration(bench: Make, name: str):
    made, case = bench(1, 2), CASES[name]
    made.write("torque", 1)
    assert not case.seen(made)
    made.line.expose(case.fault(), seconds=3.0)
    assert case.seen(made)
    made.rest(4.0)
    if name not in ("unplugged", "frozen link"):  # what was kept back comes
        assert not case.seen(made)


@pytest.mark.parametrize("bit", [VOLTAGE, OVERHEAT, ENCODER, SHOCK, OVERLOAD])
def test_servo_error_sets_the_alert_bit_and_obeys_the_shutdown_mask(bench: Make, bit: int):
    made = bench(1, 2)
    made.write("torque", 1)
    made.line.expose(servo_faults.Alert(1, bit))
    assert made.read("error") == (p.ALERT_BIT, bit)
    assert torque(made) == (not bit & made.device.memory["shutdown"])


@pytest.mark.parametrize("fault", [servo_faults.Reboot(1), servo_faults.BrownOut()])
def test_rebooting_servo_is_silent_and_then_answers_without_torque(bench: Make, fault: Fault):
    made = bench(1, 2)
    made.write("torque", 1)
    made.line.expose(fault)
    assert made.ask(1, p.PING) == []
    made.rest(0.3)
    assert len(made.ask(1, p.PING)) == 1
    assert torque(made) == 0


def test_planned_torque_off_and_watchdog_trip_show_in_registers(bench: Make):
    made = bench(1, 2)
    for servo in (1, 2):
        made.write("torque", 1, servo)
    made.line.expose(servo_faults.TorqueOff(1))
    made.line.expose(servo_faults.Tripped(2))
    assert made.read("torque") == (0, 0)
    assert made.read("watchdog", 2) == (0, -1)


def test_simulated_temperature_ramp_and_voltage_sag_reach_the_registers(bench: Make):
    made = bench(1, 2)
    made.line.expose(servo_faults.TemperatureRamp(1, rate=10.0))
    made.line.expose(servo_faults.VoltageSag(2, rate=-1.0))
    made.rest(2.0)
    assert made.read("celsius")[1] == pytest.approx(45, abs=2)
    assert made.read("volts", 2)[1] == pytest.approx(100, abs=2)
    made.rest(1.0)
    assert made.read("error", 2) == (p.ALERT_BIT, VOLTAGE)


def test_replay_fault_repeats_once_the_reply_sent_three_exchanges_earlier(bench: Make):
    made = bench(1, 2)
    made.line.expose(faults.Replay(age=3, servos=(1,)))
    made.device.firmware.tampers.append(lambda memory: memory.__setitem__("present_position", memory["tick"]))
    positions = [position(made) for _ in range(5)]
    assert positions[2:] == [*positions[:1], positions[0] + 20, positions[0] + 40]


def test_longer_return_delay_time_delays_the_servo_reply(bench: Make):
    made = bench(1, 2)
    made.line.send(POSITION_QUERY, made.line.world.time)
    soon = made.line.arrives() - made.line.world.time
    made.rest(0.1)
    made.line.receive(made.line.world.time)
    made.line.expose(strangers.return_delay(1))
    made.line.send(POSITION_QUERY, made.line.world.time)
    assert made.line.arrives() - made.line.world.time == pytest.approx(soon + 508e-6, abs=1e-4)


def test_replugged_cable_can_connect_the_servos_of_another_robot(bench: Make):
    made = bench(1, 2)
    others = [Device(1, "xm540_w270")]
    made.line.expose(faults.Replugged(others), seconds=0.5)
    assert not made.line.plugged
    made.rest(0.6)
    assert made.line.plugged
    assert made.read("model") == (0, 1120)
    assert made.ask(2, p.PING) == []
