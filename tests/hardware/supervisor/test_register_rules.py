"""Treatment of unsuitable register values, and the motion after it."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import get_args

import numpy as np
import pytest

from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.packet import Instruction
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.supervisor.register_rules import REGISTER_RULES, Treatment
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.wiring import Cable, ServoFitting

from .conftest import Desk, manifest_of

DOCS = Path(__file__).parents[3] / "docs" / "reference" / "servos.md"
TABLE_HEAD = ("| register | treatment | reason |", "|---|---|---|")
RULE_OF_REGISTER = {register: rule for rule in REGISTER_RULES for register in rule.registers}
MOTION_DURATION = 0.6  # [s] duration of the compared motion
MOTION_AMPLITUDE = 0.25  # [rad] amplitude of the compared motion
USUAL_MODEL = "xm430_w350"
SET_VALUES = {  # (register, wrong value) -> value that the supervisor sets
    (Register.RETURN_DELAY_TIME, 254): 0,
    **{(Register.DRIVE_MODE, bits): 0 for bits in (1, 4, 8, 13)},
    **{(Register.OPERATING_MODE, mode): 3 for mode in (0, 1, 4, 5, 16)},
    (Register.SECONDARY_ID, 2): 255,
    **{(Register.HOMING_OFFSET, ticks): 0 for ticks in (1000, -1000, 4096)},
    (Register.MOVING_THRESHOLD, 1023): 10,
    (Register.PWM_SLOPE, 1): 255,
    (Register.STARTUP_CONFIGURATION, 3): 0,
    **{(Register.SHUTDOWN, mask): 52 for mask in (0, 53)},
    **{(Register.STATUS_RETURN_LEVEL, level): 2 for level in (0, 1)},
    **{(Register.POSITION_P_GAIN, gain): 800 for gain in (0, 16383)},
    **{(r, 16383): 0 for r in (Register.POSITION_D_GAIN, Register.POSITION_I_GAIN)},
    **{(r, 16383): 0 for r in (Register.FEEDFORWARD_1ST_GAIN, Register.FEEDFORWARD_2ND_GAIN)},
    (Register.PROFILE_ACCELERATION, 1): 0,
    **{(Register.PROFILE_VELOCITY, velocity): 201 for velocity in (1, 0)},
}
NARROWED_LIMITS = {  # (limit register, wide value) -> narrower value that the supervisor sets
    (Register.TEMPERATURE_LIMIT, 100): 80,
    (Register.MAX_VOLTAGE_LIMIT, 240): 160,
    (Register.MIN_VOLTAGE_LIMIT, 0): 95,
    (Register.MAX_POSITION_LIMIT, 4095): 3040,
    (Register.MIN_POSITION_LIMIT, 0): 960,
}
TOO_NARROW_LIMITS = {  # (limit register, too narrow value) -> text of the refusal
    (Register.TEMPERATURE_LIMIT, 49): "temperature limit is 49 C",
    (Register.MAX_VOLTAGE_LIMIT, 110): "has shut down (voltage)",
    (Register.MIN_VOLTAGE_LIMIT, 130): "supply is 12.0 V",
    (Register.MAX_POSITION_LIMIT, 2900): "its hinge needs 1000..3000",
    (Register.MIN_POSITION_LIMIT, 1100): "its hinge needs 1000..3000",
}
REFUSED_VALUES = {  # (register, value) -> text of the refusal
    (Register.MODEL_NUMBER, 1060): "is a xl430_w250, must be a xm430_w350",
    (Register.FIRMWARE_VERSION, 37): "firmware 37 has no bus watchdog",
    (Register.ID, 9): "no answer",
    (Register.ID, 2): "",
    (Register.PWM_LIMIT, 0): "PWM limit is 0, but plans use 647",
    (Register.PWM_LIMIT, 646): "PWM limit is 646",
    (Register.CURRENT_LIMIT, 0): "current limit is 0, must be 597 at least",
    (Register.VELOCITY_LIMIT, 10): "velocity limit",
    (Register.HARDWARE_ERROR_STATUS, 32): "has shut down (overload)",
}
MOVED_VALUES = {  # wrong values whose motion with torque is tested in every run; `make soak` tests all
    (Register.DRIVE_MODE, 13),
    (Register.OPERATING_MODE, 4),
    (Register.HOMING_OFFSET, 1000),
    (Register.POSITION_P_GAIN, 0),
    (Register.POSITION_I_GAIN, 16383),
    (Register.PROFILE_VELOCITY, 1),
    (Register.MAX_POSITION_LIMIT, 4095),
}
WRONG_VALUES = (SET_VALUES | NARROWED_LIMITS).items()
SET_CASES = [
    pytest.param(*row, id=str(row[0]), marks=[pytest.mark.soak] * (row[0] not in MOVED_VALUES)) for row in WRONG_VALUES
]
DRIVEN_VALUES = {  # (register, value) that the supervisor overwrites in operation
    *((Register.BUS_WATCHDOG, count) for count in (-1, 1)),
    (Register.GOAL_PWM, 0),
    (Register.GOAL_PWM, -885),
    (Register.GOAL_POSITION, 500),
}
LEFT_VALUES = {  # register -> value that the supervisor keeps, because it has no effect on motion
    **dict.fromkeys((r for r in Register if r.name.startswith("EXTERNAL_PORT_MODE")), 1),
    **dict.fromkeys((r for r in Register if r.name.startswith("EXTERNAL_PORT_DATA")), 4095),
    Register.LED: 1,
    Register.REGISTERED_INSTRUCTION: 1,
    Register.VELOCITY_I_GAIN: 16383,
    Register.VELOCITY_P_GAIN: 0,
    Register.GOAL_CURRENT: 0,
    Register.GOAL_VELOCITY: 1023,
    Register.BACKUP_READY: 1,
}


def model_with(register: Register) -> str:
    names = (USUAL_MODEL, "xc330_t288", "xm540_w270")
    return next(name for name in names if SERVO_MODELS[name].has(register))


def two_servos(folder: Path, model: str) -> Desk:
    """Make two hinges with one factory-fresh servo each."""
    whole = manifest_of(2, 1_000_000)
    members = tuple(replace(m, servo=Servo(m.id, SERVO_MODELS[model]), speed=min(m.speed, 3.0)) for m in whole.members)
    members = whole.members if model == USUAL_MODEL else members
    cable = Cable("body", tuple(ServoFitting(member.id, model=model) for member in members))
    return Desk(replace(whole, members=members), (cable,), folder / "events.jsonl")


@pytest.fixture
def pair(tmp_path: Path) -> Iterator[Desk]:
    made = two_servos(tmp_path, USUAL_MODEL)
    yield made
    made.end()


def leave(desk: Desk, register: Register, value: int) -> None:
    """Set a register of the first servo as a previous user might have left it."""
    servo = desk.plant.servos[0]
    servo.memory[register] = value
    servo.electronics.changed()
    if register in (Register.HOMING_OFFSET, Register.OPERATING_MODE, Register.DRIVE_MODE):
        servo.electronics.fold()
    if register is Register.REGISTERED_INSTRUCTION:
        servo.execute(Instruction.REG_WRITE, Register.GOAL_POSITION.field.address.to_bytes(2, "little") + b"\0\1\0\0")


def moved(desk: Desk) -> Ticks:
    """Return positions (k, m) during a motion that is stopped in its middle."""
    desk.open()
    assert desk.stage is Stage.LIMP, desk.kinds()
    desk.perform(MOTION_DURATION, amplitude=MOTION_AMPLITUDE)
    desk.until(Stage.ACTIVE)
    places = []
    while desk.stage is Stage.ACTIVE and desk.status.time < MOTION_DURATION - 0.02:
        desk.cycle()
        places.append([round(servo.electronics.shaft.angle / 2 / np.pi * 4096) for servo in desk.plant.servos])
    return np.array(places)


@cache
def untouched(model: str) -> Ticks:
    """Return positions (k, m) of the same motion with factory-fresh servos."""
    with TemporaryDirectory() as folder:
        made = two_servos(Path(folder), model)
        places = moved(made)
        made.end()
    assert np.ptp(places, axis=0).min() > 100, "it is not a motion"
    return places


def held_with_torque(desk: Desk, *registers: Register) -> tuple[int, ...]:
    """Return register values of the first servo while it has torque."""
    held = set()
    cycle = desk.cycle

    def looking() -> None:
        cycle()
        if desk.true(Register.TORQUE_ENABLE)[0]:
            held.add(tuple(int(desk.true(register)[0]) for register in registers))

    desk.cycle = looking  # type: ignore[method-assign]  # only to look on
    assert np.abs(moved(desk) - untouched(desk.manifest.members[0].model.name)).max() <= 3
    assert len(held) == 1
    return held.pop()


def test_each_servo_register_is_covered_by_exactly_one_register_rule():
    assert sorted(register.name for rule in REGISTER_RULES for register in rule.registers) == sorted(
        Register.__members__
    )
    assert {rule.treatment for rule in REGISTER_RULES} == set(get_args(Treatment))


def test_servo_guide_lists_all_register_rules():
    rows = [
        f"| {', '.join(register.name for register in rule.registers)} "
        f"| {rule.treatment}{': ' if rule.detail else ''}{rule.detail} | {rule.why} |"
        for rule in REGISTER_RULES
    ]
    table = "\n".join((*TABLE_HEAD, *rows))
    assert table in DOCS.read_text(), f"docs/reference/servos.md must hold\n{table}"


def test_register_tests_cover_every_register_that_can_be_wrong():
    cannot = {Register.MODEL_INFORMATION, Register.BAUD_RATE, Register.PROTOCOL_TYPE, Register.TORQUE_ENABLE}
    versions = {Register.MODEL_NUMBER, Register.FIRMWARE_VERSION}
    sensors = {r for r in Register if not r.field.writable} - {*versions, *LEFT_VALUES}
    tried = {r for r, _ in (*SET_VALUES, *NARROWED_LIMITS, *REFUSED_VALUES, *DRIVEN_VALUES)} | set(LEFT_VALUES)
    assert tried | cannot | (sensors - {Register.HARDWARE_ERROR_STATUS}) == set(Register)
    for treatment, result in (
        ("set", {r for r, _ in SET_VALUES}),
        ("narrowed", {r for r, _ in NARROWED_LIMITS} & {r for r, _ in TOO_NARROW_LIMITS}),
        ("refused", {r for r, _ in REFUSED_VALUES}),
        ("driven", {r for r, _ in DRIVEN_VALUES} | {Register.TORQUE_ENABLE}),
    ):
        assert {r for r in result if RULE_OF_REGISTER[r].treatment != treatment} == set()
        assert {r for r in Register if RULE_OF_REGISTER[r].treatment == treatment} - sensors <= result


@pytest.mark.parametrize(("hostile", "value"), WRONG_VALUES, ids=str)
def test_wrong_register_value_is_corrected_before_torque_on(tmp_path: Path, hostile: tuple[Register, int], value: int):
    made = two_servos(tmp_path, model_with(hostile[0]))
    leave(made, *hostile)
    made.open()
    made.perform(MOTION_DURATION, amplitude=MOTION_AMPLITUDE)
    while not made.true(Register.TORQUE_ENABLE)[0]:
        made.cycle()
    assert made.true(hostile[0])[0] == value
    made.end()


@pytest.mark.parametrize(("hostile", "value"), SET_CASES)
def test_wrong_register_of_a_servo_with_torque_keeps_its_value_and_motion_is_correct(
    tmp_path: Path, hostile: tuple[Register, int], value: int
):
    made = two_servos(tmp_path, model_with(hostile[0]))
    leave(made, *hostile)
    assert held_with_torque(made, hostile[0]) == (value,)
    made.end()


@pytest.mark.parametrize(("hostile", "message"), (REFUSED_VALUES | TOO_NARROW_LIMITS).items(), ids=str)
def test_servo_with_unsuitable_register_values_is_refused_and_gets_no_torque(
    pair: Desk, hostile: tuple[Register, int], message: str
):
    leave(pair, *hostile)
    pair.plant.advance(0.01)
    pair.open()
    assert pair.stage is Stage.CLOSED
    refused = [note.text for note in pair.notes() if note.kind == "refused"]
    assert refused
    assert any(message in line for line in refused), refused
    assert not pair.true(Register.TORQUE_ENABLE).any()


@pytest.mark.parametrize("model", sorted({model_with(register) for register in LEFT_VALUES}))
def test_registers_that_kinesic_leaves_unchanged_do_not_affect_motion(tmp_path: Path, model: str):
    values = {register: value for register, value in LEFT_VALUES.items() if model_with(register) == model}
    assert {RULE_OF_REGISTER[register].treatment for register in values} == {"left"}
    made = two_servos(tmp_path, model)
    for register, value in values.items():
        leave(made, register, value)
    assert held_with_torque(made, *values) == tuple(values.values())
    made.end()


@pytest.mark.parametrize(("register", "value"), sorted(DRIVEN_VALUES, key=str), ids=str)
def test_initial_values_of_registers_that_kinesic_writes_do_not_affect_motion(
    pair: Desk, register: Register, value: int
):
    leave(pair, register, value)
    assert np.abs(moved(pair) - untouched(USUAL_MODEL)).max() <= 3
    assert max(pair.jumps) <= 2


@pytest.mark.parametrize(
    "register", [Register.OPERATING_MODE, Register.DRIVE_MODE, Register.HOMING_OFFSET, Register.SECONDARY_ID]
)
def test_servo_with_torque_and_a_deviating_safety_register_is_refused(pair: Desk, register: Register):
    leave(pair, register, 1)
    leave(pair, Register.TORQUE_ENABLE, 1)
    pair.open()
    (refused,) = [note.text for note in pair.notes() if note.kind == "refused"]
    assert f"has torque, but other values of {register.name}" in refused


def test_integral_and_feedforward_gains_of_adopted_servos_are_reset_to_zero(pair: Desk):
    gains = (Register.POSITION_I_GAIN, Register.FEEDFORWARD_1ST_GAIN, Register.FEEDFORWARD_2ND_GAIN)
    pair.active()
    pair.start()
    for gain in gains:
        leave(pair, gain, 16383)
    pair.open()
    pair.until(Stage.HOLD)
    assert all((pair.true(gain) == 0).all() for gain in gains)
    assert pair.true(Register.TORQUE_ENABLE).all()


def test_lost_register_writes_are_repeated_before_torque_is_enabled(pair: Desk, monkeypatch: pytest.MonkeyPatch):
    """Gains are written by broadcast, which no servo acknowledges."""
    servo, place, lost = pair.plant.servos[0], Register.POSITION_I_GAIN.field.address, [1, 2]
    heard = servo.write
    monkeypatch.setattr(servo, "write", lambda at, data: lost.pop() if at == place and lost else heard(at, data))
    leave(pair, Register.POSITION_I_GAIN, 16383)
    moved(pair)
    assert not lost
    assert (pair.true(Register.POSITION_I_GAIN) == 0).all()


def test_servo_whose_secondary_id_equals_another_id_does_not_get_its_position_limits(desk: Callable[..., Desk]):
    made = desk()
    made.open()
    lower, upper = made.manifest.spans
    assert lower[2] != lower[3]
    made.start()
    made.plant.servos[3].memory[Register.SECONDARY_ID] = made.manifest.members[2].id
    made.plant.servos[2].memory[Register.MIN_POSITION_LIMIT] = 0
    made.open()
    assert made.stage is Stage.LIMP
    assert made.true(Register.MIN_POSITION_LIMIT).tolist() == lower.tolist()
    assert made.true(Register.MAX_POSITION_LIMIT).tolist() == upper.tolist()


def test_servo_outside_its_goal_range_after_the_reset_of_its_homing_offset_is_refused(pair: Desk):
    pair.plant.physics.turn(0, 3500 / 4096 * 2 * np.pi)
    leave(pair, Register.HOMING_OFFSET, -1000)
    pair.plant.advance(0.01)
    pair.open()
    (refused,) = [note.text for note in pair.notes() if note.kind == "refused"]
    assert "is at 3500 ticks, outside 960..3040" in refused
    assert not pair.true(Register.TORQUE_ENABLE).any()
