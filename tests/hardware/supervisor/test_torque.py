"""Procedures that give and take torque, on virtual servos: cycle by cycle, as the supervisor runs them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from kinesic.hardware.protocol.packet import sync_write
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, HardwareError, Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Snapshot
from kinesic.hardware.supervisor.torque import (
    RAMP,
    TRIES,
    adopt,
    energise,
    release_torque,
    watchdog_counts,
)

from .conftest import PERIOD
from .torque_bench import COUNT, EVERYBODY, FULL, WATCHDOG, Bench, moved


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    made.axes.close()


@pytest.mark.parametrize(("seconds", "counts"), [(0.02, 1), (0.1, 5), (0.1001, 6), (0.2, 10), (0.0, 0)])
def test_a_watchdog_waits_at_least_as_long_as_is_asked(seconds: float, counts: int):
    assert watchdog_counts(seconds) == counts


def test_torque_comes_where_servos_are_with_little_power_first(bench: Bench):
    here = [servo.electronics.here() for servo in bench.plant.servos]
    bench.run(energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=3))
    powers = [seen[Register.GOAL_PWM][2] for seen in bench.seen if seen[Register.TORQUE_ENABLE][2]]
    assert list(dict.fromkeys(powers)) == [round(share * FULL) for share in (0.1, 0.4, 0.7, 1.0)]
    assert all(seen[Register.GOAL_POSITION] == here for seen in bench.seen)
    assert all(seen[Register.GOAL_PWM] != [FULL] * COUNT for seen in bench.seen[:-1])
    assert bench.true(Register.TORQUE_ENABLE) == [1] * COUNT
    assert bench.true(Register.BUS_WATCHDOG) == [WATCHDOG] * COUNT
    for k, member in enumerate(bench.axes.manifest.members):
        for register, value in member.passing.items():
            assert bench.true(register)[k] == value


def test_power_is_full_three_tenths_of_a_second_after_torque_came(bench: Bench):
    steps = round(RAMP / PERIOD)
    bench.run(energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=steps))
    rising = [seen for seen in bench.seen if seen[Register.TORQUE_ENABLE][2] and seen[Register.GOAL_PWM][2] < FULL]
    assert len(rising) * PERIOD == pytest.approx(0.3, abs=0.02)


def test_gains_and_profile_go_out_with_the_first_goals(bench: Bench):
    members = bench.axes.manifest.members
    for register in members[0].passing:
        bench.axes.put_all(register, EVERYBODY, 1)
    bench.cycle()
    begun = energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    bench.goals = np.rint(next(begun)).astype(np.int64)
    bench.cycle()
    for register in members[0].passing:
        assert bench.true(register) == [member.passing[register] for member in members]


def test_gains_and_profile_that_were_lost_are_said_again_before_torque(bench: Bench):
    members = bench.axes.manifest.members
    procedure = energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=3)

    def forget_once(snapshot: Snapshot, cycle: int) -> Snapshot:
        if cycle == 1:
            for k, servo in enumerate(bench.plant.servos):
                for register, value in members[k].passing.items():
                    servo.memory[register] = value + 1
        return snapshot

    bench.run(procedure, forget_once)
    for register in members[0].passing:
        assert bench.true(register) == [member.passing[register] for member in members]


def test_only_those_who_are_chosen_get_torque(bench: Bench):
    bench.energised(0, 2)
    assert bench.true(Register.TORQUE_ENABLE) == [1, 0, 1, 0]
    assert bench.true(Register.BUS_WATCHDOG) == [WATCHDOG, 0, WATCHDOG, 0]


def test_a_servo_that_does_not_stand_still_stays_limp_and_so_do_all(bench: Bench):
    procedure = energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    with pytest.raises(BusError, match=r"servo 2 \(hinge1\).* some of them move.* they stay limp"):
        bench.run(procedure, lambda snapshot, cycle: moved(snapshot, 2.0 * cycle))
    assert len(bench.seen) == 200  # two seconds
    assert not any(any(seen[Register.TORQUE_ENABLE]) for seen in bench.seen)


def test_torque_waits_until_servos_stand_still_and_then_comes_where_they_are(bench: Bench):
    start = bench.true(Register.PRESENT_POSITION)[1]
    procedure = energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    bench.run(procedure, lambda snapshot, cycle: moved(snapshot, 3.0 * min(cycle, 30)))
    first = next(k for k, seen in enumerate(bench.seen) if any(seen[Register.TORQUE_ENABLE]))
    assert 31 <= first <= 36
    assert bench.seen[first][Register.GOAL_POSITION][1] == start + 90


def test_a_tick_is_no_motion(bench: Bench):
    procedure = energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    assert bench.run(procedure, lambda snapshot, cycle: moved(snapshot, cycle % 2)) < 15


def test_nothing_is_judged_by_records_from_before_the_goals_went_out(bench: Bench):
    procedure = energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    old = replace(bench.last, times=bench.last.times.copy())
    old.times[3] -= 0.5

    def late(snapshot: Snapshot, cycle: int) -> Snapshot:
        return replace(snapshot, times=np.where(np.arange(COUNT) == 3, old.times, snapshot.times))

    with pytest.raises(BusError, match="they stay limp"):
        bench.run(procedure, late)
    assert bench.true(Register.TORQUE_ENABLE) == [0] * COUNT


def test_where_torque_does_not_come_nobody_keeps_it(bench: Bench):
    bench.plant.servos[2].electronics.fail(HardwareError.OVERLOAD.value)
    procedure = energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    with pytest.raises(BusError, match=r"servo 3 \(hinge2\): torque does not come on"):
        bench.run(procedure)
    lit = [seen[Register.TORQUE_ENABLE] for seen in bench.seen]
    assert lit.count([1, 1, 0, 1]) == 25  # cycles that it is waited for
    assert lit[-1] == [0] * COUNT


@pytest.fixture
def deaf_once(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> list[list[int]]:
    """The second servo does not hear the first request for torque; collects whose torque was asked for."""
    asked: list[list[int]] = []
    put_all = bench.axes.put_all

    def lossy(register: Register, places: Sequence[int], value: int) -> None:
        if register is Register.TORQUE_ENABLE and value:
            asked.append(list(places))
            places = [k for k in places if k != 1 or len(asked) > 1]
        put_all(register, places, value)

    monkeypatch.setattr(bench.axes, "put_all", lossy)
    return asked


def test_who_did_not_hear_the_request_for_torque_is_asked_again(bench: Bench, deaf_once: list[list[int]]):
    bench.energised()
    assert deaf_once == [list(EVERYBODY), [1]]
    assert bench.true(Register.TORQUE_ENABLE) == [1] * COUNT


def test_who_has_moved_since_is_not_asked_again(bench: Bench, deaf_once: list[list[int]]):
    procedure = energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=3)
    with pytest.raises(BusError, match=r"servo 2 \(hinge1\): torque does not come on"):
        bench.run(procedure, lambda snapshot, cycle: moved(snapshot, 50 if deaf_once else 0))
    assert [places for places in deaf_once if places] == [list(EVERYBODY)]
    assert bench.true(Register.TORQUE_ENABLE) == [0] * COUNT


def test_a_host_that_hears_nobody_for_a_while_waits_for_torque(bench: Bench, deaf_once: list[list[int]]):
    told: list[Snapshot] = []
    limp = bench.last

    def late(snapshot: Snapshot, cycle: int) -> Snapshot:
        if not deaf_once or len(told) > 2 * TRIES:
            return snapshot
        told.append(replace(snapshot, records=limp.records, times=limp.times))
        return told[-1]

    bench.run(energise(bench.axes, EVERYBODY, bench.last, bench.power, watchdog=WATCHDOG, steps=3), late)
    assert len(told) > 2 * TRIES
    assert bench.true(Register.TORQUE_ENABLE) == [1] * COUNT


def test_servos_with_torque_are_adopted_with_their_goals(bench: Bench):
    bench.energised()
    earlier = bench.last.positions + np.array([0.0, 282.0, -282.0, 3.0])  # at most twice the 141 ticks of full power
    for register, value in ((Register.GOAL_PWM, 300), (Register.BUS_WATCHDOG, 0)):
        bench.axes.put_all(register, EVERYBODY, value)
    bench.cycle()
    bench.run(adopt(bench.axes, bench.last, earlier, bench.power, watchdog=WATCHDOG))
    assert bench.goals.tolist() == np.rint(earlier).tolist()
    assert all(seen[Register.TORQUE_ENABLE] == [1] * COUNT for seen in bench.seen)
    assert bench.true(Register.GOAL_PWM) == [FULL] * COUNT
    assert bench.true(Register.BUS_WATCHDOG) == [WATCHDOG] * COUNT


def test_who_is_far_from_its_goal_or_was_stopped_is_adopted_where_it_is(bench: Bench):
    bench.energised()
    here = bench.last.positions.copy()
    records = bench.last.records.copy()
    records["watchdog"][0] = WATCHDOG_TRIPPED
    stopped = replace(bench.last, records=records)
    earlier = here + np.array([50.0, 283.0, -283.0, 50.0])
    bench.run(adopt(bench.axes, stopped, earlier, bench.power, watchdog=WATCHDOG))
    assert bench.goals.tolist() == [*here[:3], here[3] + 50.0]


def test_goals_of_the_adopted_lie_in_their_ranges(bench: Bench):
    bench.energised()
    lower, upper = bench.axes.manifest.spans
    outside = bench.last.records.copy()
    outside["position"] = [round(lower[0]) - 100, round(upper[1]) + 100, 2000, 2000]
    snapshot = replace(bench.last, records=outside)
    procedure = adopt(bench.axes, snapshot, snapshot.positions, bench.power, watchdog=WATCHDOG)
    assert next(procedure).tolist() == [lower[0], upper[1], 2000.0, 2000.0]


def test_who_is_limp_is_not_adopted(bench: Bench):
    bench.energised(0, 1, 3)
    bench.axes.put_all(Register.GOAL_PWM, EVERYBODY, 300)
    bench.cycle()
    bench.run(adopt(bench.axes, bench.last, bench.last.positions, bench.power, watchdog=WATCHDOG))
    assert bench.true(Register.TORQUE_ENABLE) == [1, 1, 0, 1]
    assert bench.true(Register.BUS_WATCHDOG) == [WATCHDOG, WATCHDOG, 0, WATCHDOG]
    assert bench.true(Register.GOAL_PWM) == [FULL, FULL, 300, FULL]


def test_torque_goes_of_everybody(bench: Bench):
    bench.energised()
    assert bench.run(release_torque(bench.axes, tries=10)) <= 2
    assert bench.true(Register.TORQUE_ENABLE) == [0] * COUNT
    assert bench.true(Register.BUS_WATCHDOG) == [0] * COUNT


def test_that_torque_must_go_is_said_twice_in_a_cycle(bench: Bench):
    """What is written to all is not answered, and may be lost."""
    bench.energised()
    written: list[bytes] = []
    write = bench.wire.write
    bench.wire.write = lambda data: (written.append(bytes(data)), write(data))[1]
    bench.run(release_torque(bench.axes, tries=10))
    off = sync_write(Register.TORQUE_ENABLE.field.address, 1, {k + 1: b"\0" for k in EVERYBODY})
    assert written[0].count(off) == 2


def test_who_does_not_answer_keeps_nobody_else_from_release_and_is_named(bench: Bench):
    bench.energised()
    bench.plant.servos[1].mute = True
    with pytest.raises(BusError, match=r"^memory: servo 2 \(hinge1\): may still have torque; switch the power off$"):
        bench.run(release_torque(bench.axes, tries=7))
    assert len(bench.seen) == 7
    assert bench.true(Register.TORQUE_ENABLE) == [0] * COUNT  # it heard, though nobody knows
    assert bench.seen[0][Register.TORQUE_ENABLE][0] == 0


def test_records_from_before_the_release_prove_nothing(bench: Bench):
    before = bench.last
    bench.energised()

    def old(snapshot: Snapshot, cycle: int) -> Snapshot:
        return snapshot if cycle > 3 else before

    assert bench.run(release_torque(bench.axes, tries=10), old) == 4
