"""Servos behind a reopened port: the same servos, or another robot's."""

from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Axes, Snapshot
from kinesic.hardware.supervisor.identity import PERSISTENT_REGISTERS, describe_difference, identify
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.preflight import RegisterTable, take_over
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.servo import VirtualServo
from kinesic.hardware.virtual.wiring import build_bus, describe_cables

PERIOD = 0.01  # [s] cycle period
OUTAGE_DURATION = 0.2  # [s] duration of the port loss
WATCHDOG_COUNT = 5  # value of BUS_WATCHDOG of servos with torque
LEFT_SERVOS = (0, 1, 2, 3)  # indices of the servos behind the first port


@dataclass
class Bench:
    """Robot whose left port was lost and is open again."""

    axes: Axes
    tables: tuple[RegisterTable, ...]
    servos: list[VirtualServo]

    def cycle(self) -> Snapshot:
        snapshot = self.axes.cycle(None)
        self.axes.sleep(snapshot.time + PERIOD)
        return snapshot

    def identify(self) -> tuple[int, str]:
        """Return the number of cycles needed, and the reason to close the port."""
        procedure, cycles = identify(self.axes, self.tables, watchdog=WATCHDOG_COUNT), 0
        try:
            for _ in procedure:
                self.cycle()
                cycles += 1
        except BusError as error:
            return cycles, str(error)
        return cycles, ""


@pytest.fixture
def bench(robot: Robot) -> Iterator[Bench]:
    plant, buses = build_bus(describe_cables(robot))
    wires = {name: MemoryWire(bus, name=name, time=plant.time) for name, bus in buses.items()}
    axes, tables = take_over(Manifest.of(robot), wires.__getitem__, period=PERIOD)
    made = Bench(axes, tables, list(plant.servos))
    made.cycle()
    buses["left"].expose(FaultPlan((PlannedFault("unplug", start=0.001, seconds=OUTAGE_DURATION),)))
    while not made.cycle().lost:
        pass
    while made.cycle().lost:
        pass
    assert axes.unidentified == LEFT_SERVOS
    yield made
    axes.close()


def test_unchanged_servos_are_identified_in_one_cycle_each(bench: Bench):
    assert bench.identify() == (4, "")
    assert bench.axes.unidentified == ()
    assert bench.identify() == (0, "")


def test_servo_that_is_silent_during_identification_is_accepted_as_booting(bench: Bench):
    bench.servos[0].mute = True
    assert bench.identify() == (3 + 4, ""), "four attempts at the silent one"
    assert bench.axes.unidentified == ()


def test_reopened_port_without_answers_is_closed(bench: Bench):
    for servo in bench.servos[:4]:
        servo.mute = True
    cycles, why = bench.identify()
    assert cycles == 4 * 4 + 1, "the last one shows that the port is lost"
    assert why == "left: servo 1 (torsion): no servo answers on the reopened port; is the power on?"
    assert bench.cycle().lost
    assert bench.axes.unidentified == LEFT_SERVOS


def test_other_robot_is_reported_by_its_first_differing_servo(bench: Bench):
    bench.servos[1].memory[Register.SHUTDOWN] = 53
    cycles, why = bench.identify()
    assert cycles == 3
    assert why.startswith("left: servo 2 (torsion): its SHUTDOWN is 53, must be 52; another robot is behind this port")
    assert bench.cycle().lost
    assert bench.axes.unidentified == LEFT_SERVOS


def test_reconnected_servo_with_torque_and_another_watchdog_is_rejected(bench: Bench):
    bench.servos[3].memory[Register.TORQUE_ENABLE] = 1
    bench.servos[3].memory[Register.BUS_WATCHDOG] = 0
    _, why = bench.identify()
    assert "it has torque and a BUS_WATCHDOG of 0, must be 5 or tripped; another robot" in why


def test_unidentified_servos_are_read_but_not_written(bench: Bench):
    goals = bench.axes.manifest.scale.ticks(bench.axes.manifest.rest[bench.axes.manifest.joints]) + 5
    before = [servo.memory[Register.GOAL_POSITION] for servo in bench.servos]
    bench.axes.put_all(Register.PROFILE_ACCELERATION, bench.axes.all_places, 7)
    snapshot = bench.axes.cycle(goals)
    assert snapshot.recent.all()
    written = [servo.memory[Register.PROFILE_ACCELERATION] == 7 for servo in bench.servos]
    assert written == [False, False, False, False, True]
    goals_now = [servo.memory[Register.GOAL_POSITION] for servo in bench.servos]
    assert goals_now == [*before[:4], goals[4]]
    bench.axes.accept_unidentified()
    bench.axes.put_all(Register.PROFILE_ACCELERATION, bench.axes.all_places, 7)
    bench.axes.cycle(goals)
    assert all(servo.memory[Register.PROFILE_ACCELERATION] == 7 for servo in bench.servos)


def changed(table: RegisterTable, **values: int) -> RegisterTable:
    data = bytearray(table.data)
    for name, value in values.items():
        field = Register[name].field
        data[field.address : field.end] = field.pack(value)
    return RegisterTable(table.member, bytes(data))


def test_servo_with_reset_ram_is_recognised_as_the_same_servo(bench: Bench):
    before = bench.tables[0]
    assert describe_difference(before, before, watchdog=WATCHDOG_COUNT) == ""
    for register in Register:
        field = register.field
        if field.address > 64 and field.end <= len(before.data) and register is not Register.BUS_WATCHDOG:
            assert describe_difference(before, changed(before, **{register.name: 1}), watchdog=WATCHDOG_COUNT) == ""


@pytest.mark.parametrize("register", [r for r in Register if r.field.address < 64], ids=lambda r: r.name)
def test_each_changed_persistent_register_is_reported_as_a_difference(bench: Bench, register: Register):
    assert register in PERSISTENT_REGISTERS
    before = bench.tables[0]
    other = before[register] ^ 1
    said = describe_difference(before, changed(before, **{register.name: other}), watchdog=WATCHDOG_COUNT)
    assert said == f"its {register.name} is {other}, must be {before[register]}"


@pytest.mark.parametrize(
    ("torque", "watchdog", "same"),
    [(0, 0, True), (0, 9, True), (1, WATCHDOG_COUNT, True), (1, WATCHDOG_TRIPPED, True), (1, 0, False), (1, 4, False)],
)
def test_servo_with_torque_and_an_unexpected_watchdog_belongs_to_another_robot(
    bench: Bench, torque: int, watchdog: int, same: bool
):
    before = bench.tables[0]
    now = changed(before, TORQUE_ENABLE=torque, BUS_WATCHDOG=watchdog)
    assert (describe_difference(before, now, watchdog=WATCHDOG_COUNT) == "") is same
