"""Bus of virtual servos with Protocol 1.0 frames in virtual time."""

from dataclasses import replace

import pytest

from kinesic.bench.bus.drivers import KinesicDriver
from kinesic.bench.bus.matrix import FaultCase, list_cases, run_trial
from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.bus.dialect import AUDIT_CYCLES, Servo, cycle_size
from kinesic.hardware.protocol.frame_access import FrameAccess
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.tables import STS_TABLE
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault

from ..conftest import rig_of

MIN_RATE = 180.0  # [Hz] lowest accepted rate of 14 STS servos at 1 Mbaud
CASES = {case.name: case for case in list_cases()}
UNKNOWN_CASES = {"watchdog", "old firmware"}  # faults of bus watchdogs, which these servo families lack
QUICK_CASES = (("sts3215", "mixed 6 x 2%"), ("mx28", "corrupt 5%"), ("ax12", "truncate 5%"), ("scs0009", "reboot"))


def test_fourteen_sts_servos_are_driven_at_180_hz_with_one_megabaud():
    period = 1 / MIN_RATE
    rig = rig_of(14, model="sts3215", period=period)
    rig.energise()
    goals = rig.true(Register.PRESENT_POSITION)
    rig.run(AUDIT_CYCLES, goals)
    begun, cycles = rig.wire.now(), 60
    done = [rig.bus.cycle(goals) for _ in range(cycles)]
    assert cycles / (rig.wire.now() - begun) >= MIN_RATE
    assert all(cycle.fresh.all() for cycle in done)
    assert {tuple(cycle.raw_values("torque").tolist()) for cycle in done} == {(1,) * 14}


def test_torque_loss_of_an_sts_servo_is_reported_although_fast_cycles_read_only_sensors():
    rig = rig_of(14, model="sts3215", period=1 / MIN_RATE)
    rig.energise()
    rig.run(AUDIT_CYCLES, rig.true(Register.PRESENT_POSITION))
    rig.plant.servos[3].write_native(40, b"\0")
    cycles = rig.run(AUDIT_CYCLES + 1, rig.true(Register.PRESENT_POSITION))
    assert [event.servo for cycle in cycles for event in cycle.events if event.kind == "torque"] == [4]


def test_sts_bus_at_100_hz_reads_the_torque_switch_in_every_cycle():
    rig = rig_of(14, model="sts3215", period=0.01)
    rig.energise()
    rig.plant.servos[3].write_native(40, b"\0")
    (cycle,) = rig.run(1, rig.true(Register.PRESENT_POSITION))
    assert cycle.raw_values("torque")[3] == 0


@pytest.mark.parametrize("model", ["ax12", "scs0009"])
def test_servos_without_a_sync_read_instruction_are_read_in_turns(model: str):
    rig = rig_of(12, model=model)
    rig.energise()
    cycles = rig.run(30, rig.true(Register.PRESENT_POSITION))
    assert not any(cycle.events for cycle in cycles)
    assert max(cycle.duration for cycle in cycles) <= 0.0105
    assert all((cycle.ages < 0.035).all() for cycle in cycles[3:])


def test_silent_servo_without_a_sync_read_instruction_does_not_prevent_reads_of_other_servos():
    rig = rig_of(9, model="ax12", faults=FaultPlan((PlannedFault("silent", (2,), start=0.2),)))
    rig.energise()
    cycles = rig.run(80, rig.true(Register.PRESENT_POSITION))
    assert [event.servo for cycle in cycles for event in cycle.events if event.kind == "silent"] == [2]
    others = [0, *range(2, 9)]
    assert all((cycle.ages[others] < 0.045).all() for cycle in cycles[5:])


def test_reboot_of_a_servo_without_a_watchdog_is_reported_as_lost_torque():
    rig = rig_of(3, model="sts3215", faults=FaultPlan((PlannedFault("reboot", (2,), start=0.3),)))
    rig.energise()
    cycles = rig.run(60, rig.true(Register.PRESENT_POSITION))
    kinds = [(event.kind, event.servo) for cycle in cycles for event in cycle.events]
    assert ("torque", 2) in kinds
    assert cycles[-1].raw_values("torque").tolist() == [1, 0, 1]


def test_computed_size_of_a_bus_cycle_equals_its_transmitted_bytes():
    rig = rig_of(5, model="sts3215")
    sizes: list[int] = []
    write, read = rig.wire.write, rig.wire.read
    rig.wire.write = lambda data: (sizes.append(len(data)), write(data))[1]

    def counted(deadline: float) -> bytes:
        data = read(deadline)
        sizes.append(len(data))
        return data

    rig.wire.read = counted
    rig.bus.cycle(rig.true(Register.PRESENT_POSITION))
    assert sum(sizes) == cycle_size(STS_TABLE, 5, full=True)


def test_servos_of_different_protocol_families_on_one_wire_are_refused():
    servos = [Servo(1, SERVO_MODELS["sts3215"]), Servo(2, SERVO_MODELS["xl330_m288"])]
    with pytest.raises(BusError, match="different protocols share a bus: sts3215, xl330_m288"):
        Bus(rig_of(2).wire, servos)


def test_eeprom_values_written_while_locked_are_lost_by_a_servo_reboot():
    rig = rig_of(1, model="sts3215")
    access = FrameAccess(rig.wire)
    access.write_span(1, 13, b"\x41")  # temperature limit, with the EEPROM locked
    access.write(1, Register.MAX_POSITION_LIMIT, 3000)  # unlocks it
    assert access.read(1, Register.TEMPERATURE_LIMIT) == 65
    access.reboot(1)
    rig.wire.sleep(rig.wire.now() + 0.5)
    assert access.read(1, Register.TEMPERATURE_LIMIT) == 70
    assert access.read(1, Register.MAX_POSITION_LIMIT) == 3000


def test_value_128_in_the_torque_register_makes_the_present_position_the_middle_position():
    rig = rig_of(1, model="sts3215")
    rig.plant.physics.turn(0, 0.5)
    access = FrameAccess(rig.wire)
    before = access.read(1, Register.PRESENT_POSITION)
    access.write_span(1, 40, b"\x80")
    assert before != 2048
    assert access.read(1, Register.PRESENT_POSITION) == 2048
    assert access.read(1, Register.HOMING_OFFSET) == 2048 - before


def _judge(model: str, case: FaultCase, seed: int) -> None:
    """Run a trial and check that no wrong position was accepted."""
    count = 14 if model == "sts3215" else 7
    case = replace(case, model=model)
    result = run_trial(case, KinesicDriver, servos=count, baud=1_000_000, seed=seed, cycles=100)
    assert (result.exceptions, result.wrong) == (0, 0)
    assert bool(result.refused) == (case.name in ("duplicate id", "wrong model"))


@pytest.mark.parametrize(("model", "case"), QUICK_CASES)
def test_bus_accepts_no_wrong_position_under_typical_faults(model: str, case: str):
    _judge(model, CASES[case], 1)


@pytest.mark.soak
@pytest.mark.parametrize("model", ["sts3215", "mx28", "ax12", "scs0009"])
@pytest.mark.parametrize("case", [name for name in CASES if name not in UNKNOWN_CASES])
def test_bus_accepts_no_wrong_position_under_each_fault_of_the_matrix(model: str, case: str):
    for seed in (1, 2, 3):
        _judge(model, CASES[case], seed)
