"""Procedures that switch torque on and off, cycle by cycle."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from kinesic.hardware.protocol.packet import sync_write
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, HardwareError, Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Snapshot
from kinesic.hardware.supervisor.torque import (
    POWER_RAMP_TIME,
    STEP_CYCLES,
    adopt,
    energise,
    release_torque,
    watchdog_counts,
)

from .conftest import PERIOD
from .torque_bench import ALL_PLACES, COUNT, FULL_PWM, WATCHDOG, Bench, moved


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    made.axes.close()


@pytest.mark.parametrize(("seconds", "counts"), [(0.02, 1), (0.1, 5), (0.1001, 6), (0.14, 7), (0.2, 10), (0.0, 0)])
def test_watchdog_time_is_rounded_up_to_register_counts(seconds: float, counts: int):
    assert watchdog_counts(seconds) == counts


def test_torque_is_switched_on_at_the_present_positions_with_low_power(bench: Bench):
    here = [servo.electronics.present_position() for servo in bench.plant.servos]
    bench.run(energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3))
    powers = [seen[Register.GOAL_PWM][2] for seen in bench.seen if seen[Register.TORQUE_ENABLE][2]]
    assert list(dict.fromkeys(powers)) == [round(share * FULL_PWM) for share in (0.1, 0.4, 0.7, 1.0)]
    assert all(seen[Register.GOAL_POSITION] == here for seen in bench.seen)
    assert all(seen[Register.GOAL_PWM] != [FULL_PWM] * COUNT for seen in bench.seen[:-1])
    assert bench.true(Register.TORQUE_ENABLE) == [1] * COUNT
    assert bench.true(Register.BUS_WATCHDOG) == [WATCHDOG] * COUNT
    for k, member in enumerate(bench.axes.manifest.members):
        for register, value in member.ram_values.items():
            assert bench.true(register)[k] == value


def test_motor_power_is_full_0_3_seconds_after_torque_on(bench: Bench):
    steps = round(POWER_RAMP_TIME / PERIOD)
    bench.run(energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=steps))
    rising = [seen for seen in bench.seen if seen[Register.TORQUE_ENABLE][2] and seen[Register.GOAL_PWM][2] < FULL_PWM]
    assert len(rising) * PERIOD == pytest.approx(0.3, abs=0.02)


def test_gains_and_profile_registers_of_servos_are_written_with_the_first_goals(bench: Bench):
    members = bench.axes.manifest.members
    for register in members[0].ram_values:
        bench.axes.put_all(register, ALL_PLACES, 1)
    bench.cycle()
    begun = energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    bench.goals = np.rint(next(begun)).astype(np.int64)
    bench.cycle()
    for register in members[0].ram_values:
        assert bench.true(register) == [member.ram_values[register] for member in members]


def test_gains_and_profile_lost_on_the_bus_are_rewritten_before_torque_is_switched_on(bench: Bench):
    members = bench.axes.manifest.members
    procedure = energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3)

    def forget_once(snapshot: Snapshot, cycle: int) -> Snapshot:
        if cycle == 1:
            for k, servo in enumerate(bench.plant.servos):
                for register, value in members[k].ram_values.items():
                    servo.memory[register] = value + 1
        return snapshot

    bench.run(procedure, forget_once)
    for register in members[0].ram_values:
        assert bench.true(register) == [member.ram_values[register] for member in members]


def test_torque_is_switched_on_only_after_every_servo_has_stored_its_goal(bench: Bench):
    """A servo with a wrong goal would jump as soon as it has torque."""

    def lose_goal(snapshot: Snapshot, cycle: int) -> Snapshot:
        if cycle <= 10:
            bench.plant.servos[1].memory[Register.GOAL_POSITION] += 300
        return snapshot

    here = bench.true(Register.PRESENT_POSITION)
    procedure = energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    bench.run(procedure, lose_goal)
    first = next(k for k, seen in enumerate(bench.seen) if any(seen[Register.TORQUE_ENABLE]))
    assert first >= 10
    assert bench.seen[first][Register.GOAL_POSITION] == here


def test_torque_is_enabled_only_on_the_requested_servos(bench: Bench):
    bench.energised(0, 2)
    assert bench.true(Register.TORQUE_ENABLE) == [1, 0, 1, 0]
    assert bench.true(Register.BUS_WATCHDOG) == [WATCHDOG, 0, WATCHDOG, 0]


def test_no_servo_gets_torque_if_one_of_them_never_stops_moving(bench: Bench):
    procedure = energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    with pytest.raises(BusError, match=r"servo 2 \(hinge1\).* some of them move.* torque stays off"):
        bench.run(procedure, lambda snapshot, cycle: moved(snapshot, 2.0 * cycle))
    assert len(bench.seen) == 200  # two seconds
    assert not any(any(seen[Register.TORQUE_ENABLE]) for seen in bench.seen)


def test_torque_is_switched_on_only_at_standstill(bench: Bench):
    start = bench.true(Register.PRESENT_POSITION)[1]
    procedure = energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    bench.run(procedure, lambda snapshot, cycle: moved(snapshot, 3.0 * min(cycle, 30)))
    first = next(k for k, seen in enumerate(bench.seen) if any(seen[Register.TORQUE_ENABLE]))
    assert 31 <= first <= 36
    assert bench.seen[first][Register.GOAL_POSITION][1] == start + 90


def test_servo_motion_of_one_tick_counts_as_standstill_before_torque_on(bench: Bench):
    procedure = energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    assert bench.run(procedure, lambda snapshot, cycle: moved(snapshot, cycle % 2)) < 15


def test_servo_records_older_than_the_goals_do_not_confirm_torque(bench: Bench):
    procedure = energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    old = replace(bench.last, times=bench.last.times.copy())
    old.times[3] -= 0.5

    def late(snapshot: Snapshot, cycle: int) -> Snapshot:
        return replace(snapshot, times=np.where(np.arange(COUNT) == 3, old.times, snapshot.times))

    with pytest.raises(BusError, match="torque stays off"):
        bench.run(procedure, late)
    assert bench.true(Register.TORQUE_ENABLE) == [0] * COUNT


def test_failed_switch_on_leaves_no_servo_with_torque(bench: Bench):
    bench.plant.servos[2].electronics.fail(HardwareError.OVERLOAD.value)
    procedure = energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    with pytest.raises(BusError, match=r"servo 3 \(hinge2\): torque does not come on"):
        bench.run(procedure)
    lit = [seen[Register.TORQUE_ENABLE] for seen in bench.seen]
    assert lit.count([1, 1, 0, 1]) == 25  # cycles that it is waited for
    assert lit[-1] == [0] * COUNT


def test_servos_whose_values_cannot_be_read_get_no_torque(bench: Bench, monkeypatch: pytest.MonkeyPatch):
    def fail(place: int, registers: object) -> None:
        raise BusError("no answer")

    monkeypatch.setattr(bench.axes, "read", fail)
    with pytest.raises(BusError, match="do not take their goals; torque stays off"):
        bench.run(energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3))
    assert all(seen[Register.TORQUE_ENABLE] == [0] * COUNT for seen in bench.seen)


@pytest.fixture
def deaf_once(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> list[list[int]]:
    """Make the second servo miss the first torque command.

    Collects the servos of each torque command.
    """
    asked: list[list[int]] = []
    put_all = bench.axes.put_all

    def lossy(register: Register, places: Sequence[int], value: int) -> None:
        if register is Register.TORQUE_ENABLE and value:
            asked.append(list(places))
            places = [k for k in places if k != 1 or len(asked) > 1]
        put_all(register, places, value)

    monkeypatch.setattr(bench.axes, "put_all", lossy)
    return asked


def test_missed_torque_command_is_repeated(bench: Bench, deaf_once: list[list[int]]):
    bench.energised()
    assert deaf_once == [list(ALL_PLACES), [1]]
    assert bench.true(Register.TORQUE_ENABLE) == [1] * COUNT


def test_moved_servo_gets_no_repeated_torque_command(bench: Bench, deaf_once: list[list[int]]):
    procedure = energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    with pytest.raises(BusError, match=r"servo 2 \(hinge1\): torque does not come on"):
        bench.run(procedure, lambda snapshot, cycle: moved(snapshot, 50 if deaf_once else 0))
    assert [places for places in deaf_once if places] == [list(ALL_PLACES)]
    assert bench.true(Register.TORQUE_ENABLE) == [0] * COUNT


def test_torque_procedure_waits_until_the_host_receives_new_records(bench: Bench, deaf_once: list[list[int]]):
    results: list[Snapshot] = []
    limp = bench.last

    def late(snapshot: Snapshot, cycle: int) -> Snapshot:
        if not deaf_once or len(results) > 2 * STEP_CYCLES:
            return snapshot
        results.append(replace(snapshot, records=limp.records, times=limp.times))
        return results[-1]

    bench.run(energise(bench.axes, ALL_PLACES, bench.last, bench.power, watchdog=WATCHDOG, steps=3), late)
    assert len(results) > 2 * STEP_CYCLES
    assert bench.true(Register.TORQUE_ENABLE) == [1] * COUNT


def test_supervisor_takes_over_servos_with_torque_and_keeps_their_goals(bench: Bench):
    bench.energised()
    earlier = bench.last.positions + np.array([0.0, 282.0, -282.0, 3.0])  # at most twice the 141 ticks of full power
    for register, value in ((Register.GOAL_PWM, 300), (Register.BUS_WATCHDOG, 0)):
        bench.axes.put_all(register, ALL_PLACES, value)
    bench.cycle()
    bench.run(adopt(bench.axes, bench.last, earlier, bench.power, watchdog=WATCHDOG))
    assert bench.goals.tolist() == np.rint(earlier).tolist()
    assert all(seen[Register.TORQUE_ENABLE] == [1] * COUNT for seen in bench.seen)
    assert bench.true(Register.GOAL_PWM) == [FULL_PWM] * COUNT
    assert bench.true(Register.BUS_WATCHDOG) == [WATCHDOG] * COUNT


def test_servo_whose_watchdog_does_not_come_on_is_not_adopted(bench: Bench):
    bench.energised()

    def deny(snapshot: Snapshot, cycle: int) -> Snapshot:
        records = snapshot.records.copy()
        records["watchdog"][1] = 0
        return replace(snapshot, records=records)

    with pytest.raises(BusError, match=r"servo 2 \(hinge1\): its bus watchdog does not come on"):
        bench.run(adopt(bench.axes, bench.last, bench.last.positions, bench.power, watchdog=WATCHDOG), deny)
    assert len(bench.seen) == 1 + STEP_CYCLES


def test_servo_stopped_by_its_watchdog_is_adopted_at_its_position(bench: Bench):
    bench.energised()
    here = bench.last.positions.copy()
    records = bench.last.records.copy()
    records["watchdog"][0] = WATCHDOG_TRIPPED
    stopped = replace(bench.last, records=records)
    earlier = here + np.array([50.0, 283.0, -283.0, 50.0])
    bench.run(adopt(bench.axes, stopped, earlier, bench.power, watchdog=WATCHDOG))
    assert bench.goals.tolist() == [*here[:3], here[3] + 50.0]


def test_adoption_waits_for_recent_records_of_all_servos(bench: Bench):
    bench.energised()
    stale = replace(bench.last, recent=np.arange(COUNT) != 2)
    procedure = adopt(bench.axes, stale, bench.last.positions, bench.power, watchdog=WATCHDOG)
    assert next(procedure) is None
    assert procedure.send(stale) is None
    goals = procedure.send(bench.last)
    assert goals is not None
    assert goals.tolist() == bench.last.positions.tolist()


def test_goals_of_adopted_servos_are_within_their_ranges(bench: Bench):
    bench.energised()
    lower, upper = bench.axes.manifest.spans
    outside = bench.last.records.copy()
    outside["position"] = [round(lower[0]) - 100, round(upper[1]) + 100, 2000, 2000]
    snapshot = replace(bench.last, records=outside)
    procedure = adopt(bench.axes, snapshot, snapshot.positions, bench.power, watchdog=WATCHDOG)
    assert next(procedure).tolist() == [lower[0], upper[1], 2000.0, 2000.0]


def test_servo_without_torque_is_not_adopted(bench: Bench):
    bench.energised(0, 1, 3)
    bench.axes.put_all(Register.GOAL_PWM, ALL_PLACES, 300)
    bench.cycle()
    bench.run(adopt(bench.axes, bench.last, bench.last.positions, bench.power, watchdog=WATCHDOG))
    assert bench.true(Register.TORQUE_ENABLE) == [1, 1, 0, 1]
    assert bench.true(Register.BUS_WATCHDOG) == [WATCHDOG, WATCHDOG, 0, WATCHDOG]
    assert bench.true(Register.GOAL_PWM) == [FULL_PWM, FULL_PWM, 300, FULL_PWM]


def test_torque_is_switched_off_on_all_servos(bench: Bench):
    bench.energised()
    assert bench.run(release_torque(bench.axes, tries=10)) <= 2
    assert bench.true(Register.TORQUE_ENABLE) == [0] * COUNT
    assert bench.true(Register.BUS_WATCHDOG) == [0] * COUNT


def test_torque_off_is_sent_twice_per_cycle(bench: Bench):
    """Broadcasts are not acknowledged, so one may be lost."""
    bench.energised()
    written: list[bytes] = []
    write = bench.wire.write
    bench.wire.write = lambda data: (written.append(bytes(data)), write(data))[1]
    bench.run(release_torque(bench.axes, tries=10))
    off = sync_write(Register.TORQUE_ENABLE.field.address, 1, {k + 1: b"\0" for k in ALL_PLACES})
    assert written[0].count(off) == 2


def test_torque_release_ends_with_an_error_that_names_a_silent_servo(bench: Bench):
    bench.energised()
    bench.plant.servos[1].mute = True
    with pytest.raises(BusError, match=r"^memory: servo 2 \(hinge1\): may still have torque; switch the power off$"):
        bench.run(release_torque(bench.axes, tries=7))
    assert len(bench.seen) == 7
    assert bench.true(Register.TORQUE_ENABLE) == [0] * COUNT  # it heard, though nobody knows
    assert bench.seen[0][Register.TORQUE_ENABLE][0] == 0


def test_servo_records_older_than_the_release_do_not_confirm_torque_off(bench: Bench):
    before = bench.last
    bench.energised()

    def old(snapshot: Snapshot, cycle: int) -> Snapshot:
        return snapshot if cycle > 3 else before

    assert bench.run(release_torque(bench.axes, tries=10), old) == 4
