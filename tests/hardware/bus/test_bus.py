from collections.abc import Callable

import numpy as np
import pytest

from kinesic.hardware.bus.cycle import Cycle
from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault

MID_TICKS = 2048  # [ticks] position in the middle of a turn
SOAK_DAMAGES = (
    "corrupt",
    "lost",
    "drop",
    "duplicate",
    "noise",
)  # kinds of wire damage similar to `truncate`, tested only by `make soak`
SAMPLED_CASES = {  # kind of damage -> (servo implementation, number of servos) tested in every run
    "corrupt": {("kinesic", 7)},
    "drop": {("kinesic", 7)},
    "truncate": {("manual", 7)},
    "duplicate": {("manual", 7)},
    "noise": {("manual", 7)},
    "lost": {("kinesic", 7)},
    "late": {("kinesic", 7), ("manual", 7)},
}
Make = Callable  # type of a function that makes a rig, see conftest
on_kinesic_servos = (
    pytest.mark.parametrize(  # marks tests that run only with kinesic's servos, because independent servos take longer
        "servos", ["kinesic", pytest.param("manual", marks=pytest.mark.soak)], indirect=True
    )
)


def plan(kind: str, **changes: object) -> FaultPlan:
    return FaultPlan((PlannedFault(kind, **changes),), seed=1)


def kinds(cycles: list[Cycle]) -> list[tuple[str, int | None]]:
    return [(event.kind, event.servo) for cycle in cycles for event in cycle.events]


def fresh_share(cycles: list[Cycle]) -> float:
    return float(np.mean([cycle.fresh for cycle in cycles]))


def test_every_bus_cycle_has_a_fresh_record_of_every_servo(rig: Make):
    cycles = rig(14).run(50)
    assert fresh_share(cycles) == 1.0
    assert all(not cycle.events for cycle in cycles)


def test_servo_records_match_the_registers(rig: Make):
    made = rig(7)
    made.energise()
    (cycle,) = made.run(1, np.full(7, MID_TICKS))
    assert (cycle.positions == made.true(Register.PRESENT_POSITION)).all()
    assert (cycle.raw_values("volts") == made.true(Register.PRESENT_INPUT_VOLTAGE)).all()
    assert (cycle.raw_values("temperature") == made.true(Register.PRESENT_TEMPERATURE)).all()
    assert (cycle.raw_values("torque") == 1).all()
    assert (cycle.ages >= 0.0).all()
    assert (cycle.ages < made.bus.period).all()


def test_virtual_servos_follow_their_goals(rig: Make):
    made = rig(7)
    made.energise()
    goals = MID_TICKS + np.arange(7) * 20
    assert (np.abs(made.run(40, goals)[-1].positions - goals) <= 2).all()


def test_servo_goals_outside_of_one_turn_are_clipped(rig: Make):
    made = rig(2)
    made.run(1, np.array([-50, 9000]))
    assert made.true(Register.GOAL_POSITION).tolist() == [0, 4095]


def test_bus_cycle_without_goals_writes_no_register(rig: Make):
    made = rig(3)
    before = made.true(Register.GOAL_POSITION).tolist()
    made.run(5)
    assert made.true(Register.GOAL_POSITION).tolist() == before
    assert not made.true(Register.TORQUE_ENABLE).any()


def test_bus_cycle_lasts_as_long_as_the_transmission_of_its_bytes(rig: Make):
    made = rig(14)
    made.run(3, np.full(14, MID_TICKS))
    (cycle,) = made.run(1, np.full(14, MID_TICKS))
    octets = 14 + 5 * 14 + 14 + 14 + 8 + 22 * 14
    assert cycle.duration == pytest.approx(octets * 1e-5 + 0.001, abs=5e-5)


def test_queued_register_writes_are_sent_with_the_next_cycle(rig: Make):
    made = rig(3)
    made.bus.put(Register.PROFILE_VELOCITY, {1: 100, 3: 300})
    assert not made.true(Register.PROFILE_VELOCITY).any()
    made.run(1)
    assert made.true(Register.PROFILE_VELOCITY).tolist() == [100, 0, 300]


def test_value_too_large_for_its_register_is_refused_before_it_is_sent(rig: Make):
    with pytest.raises(ValueError, match="does not fit"):
        rig(1).bus.put(Register.TORQUE_ENABLE, {1: 256})


@pytest.mark.parametrize("model", ["xl330_m288", "xl430_w250", "xm540_w270"])
def test_xl330_and_xl430_and_xm540_servos_return_a_record_in_every_cycle(rig: Make, model: str):
    assert fresh_share(rig(4, model=model).run(5)) == 1.0


def test_servo_families_with_different_indirect_addresses_work_on_one_bus(rig: Make):
    made = rig(8, mixed=True)
    made.energise()
    cycles = made.run(20, np.full(8, MID_TICKS))
    assert fresh_share(cycles) == 1.0
    assert (cycles[-1].positions == made.true(Register.PRESENT_POSITION)).all()


@pytest.mark.parametrize("mixed", [False, True])
def test_old_firmware_is_queried_without_fast_reads(rig: Make, mixed: bool):
    made = rig(7, firmware=41, mixed=mixed)
    assert not made.bus.fast
    assert fresh_share(made.run(20, np.full(7, MID_TICKS))) == 1.0


def test_bus_with_a_single_servo_has_a_fresh_record_in_every_cycle(rig: Make):
    assert fresh_share(rig(1).run(10, np.array([MID_TICKS]))) == 1.0


@pytest.mark.parametrize(
    ("servos", "count", "kind"),
    [
        pytest.param(servos, count, kind, marks=[] if (servos, count) in sampled else [pytest.mark.soak])
        for kind, sampled in SAMPLED_CASES.items()
        for servos in ("kinesic", "manual")
        for count in (7, 26)
    ],
    indirect=["servos"],
)
def test_servo_records_stay_fresh_although_one_reply_in_a_hundred_is_damaged(rig: Make, kind: str, count: int):
    made = rig(count, baud=4_000_000, faults=plan(kind, rate=0.01, start=0.2))
    made.energise()
    cycles = made.run(200, np.full(count, MID_TICKS))
    assert fresh_share(cycles) >= (0.985 if kind == "late" else 0.999)
    assert all((np.abs(cycle.positions - MID_TICKS) <= 2).all() for cycle in cycles[10:])
    assert np.quantile([cycle.duration for cycle in cycles], 0.99) < made.bus.period
    assert max(cycle.ages.max() for cycle in cycles) < 3 * made.bus.period


@on_kinesic_servos
def test_many_bus_faults_raise_no_error_and_give_no_false_servo_record(rig: Make):
    names = ("corrupt", "drop", "truncate", "duplicate", "noise", "lost", "late")
    faults = FaultPlan(tuple(PlannedFault(name, rate=0.05, start=0.2) for name in names), seed=2)
    made = rig(14, faults=faults)
    made.energise()
    cycles = made.run(100, np.full(14, MID_TICKS))
    assert all((np.abs(cycle.positions - MID_TICKS) <= 2).all() for cycle in cycles[30:])
    assert fresh_share(cycles) > 0.1


@on_kinesic_servos
def test_silent_servo_does_not_delay_records_of_other_servos(rig: Make):
    made = rig(14)
    made.run(3)
    made.plant.servos[4].mute = True
    cycles = made.run(100)
    others = [np.delete(cycle.fresh, 4) for cycle in cycles]
    assert np.mean(others) >= 0.99
    assert kinds(cycles) == [("silent", 5)]
    assert np.quantile([cycle.duration for cycle in cycles], 0.99) < made.bus.period
    assert cycles[-1].silent.tolist() == [k == 4 for k in range(14)]
    assert cycles[-1].ages[4] > 0.9


def test_silent_servo_rejoins_common_queries_after_its_first_reply(rig: Make):
    made = rig(14)
    made.plant.servos[4].mute = True
    made.run(60)
    made.plant.servos[4].mute = False
    cycles = made.run(20)
    assert kinds(cycles[:3]) == [("heard", 5)]
    assert fresh_share(cycles[2:]) == 1.0


@on_kinesic_servos
def test_silent_servo_that_answers_again_is_detected_even_without_spare_bus_time(rig: Make):
    made = rig(14, period=0.0055)
    made.plant.servos[4].mute = True
    made.run(100)
    made.plant.servos[4].mute = False
    cycles = made.run(60)
    assert ("heard", 5) in kinds(cycles)
    assert cycles[-1].fresh.all()


def test_simultaneous_silence_of_all_servos_reports_no_silent_servo(rig: Make):
    made = rig(7)
    for servo in made.plant.servos:
        servo.mute = True
    silent = made.run(50)
    for servo in made.plant.servos:
        servo.mute = False
    assert kinds(silent) == []
    assert fresh_share(silent[1:]) == 0.0
    assert fresh_share(made.run(20)[1:]) == 1.0


@pytest.mark.parametrize("error", HardwareError)
@pytest.mark.parametrize("count", [7, pytest.param(26, marks=pytest.mark.soak)])
def test_servo_alert_is_reported_in_the_next_bus_cycle(rig: Make, count: int, error: HardwareError):
    made = rig(count)
    made.energise()
    made.plant.servos[2].electronics.fail(error.value)
    (cycle,) = made.run(1, np.full(count, MID_TICKS))
    assert ("error", 3) in kinds([cycle])
    assert cycle.raw_values("hardware_error")[2] == error.value
    assert cycle.fresh.all()


def test_reboot_of_a_servo_is_reported_and_its_records_return_within_two_cycles(rig: Make):
    made = rig(7)
    made.energise()
    made.plant.servos[2].reboot(seconds=0.13)
    cycles = made.run(60, np.full(7, MID_TICKS))
    result = kinds(cycles)
    assert ("rebooted", 3) in result
    assert ("torque", 3) in result
    assert cycles[-1].fresh.all()
    assert cycles[-1].raw_values("torque").tolist() == [1, 1, 0, 1, 1, 1, 1]
    assert all(cycle.raw_values("volts")[2] > 0 for cycle in cycles)
    answered = next(k for k, cycle in enumerate(cycles) if ("rebooted", 3) in kinds([cycle]))
    assert cycles[answered + 2].fresh.all()


def test_tripped_bus_watchdog_of_a_servo_is_reported_as_an_event(rig: Make):
    made = rig(3)
    made.energise()
    made.bus.put(Register.BUS_WATCHDOG, dict.fromkeys(made.bus.ids, 2))
    made.run(3, np.full(3, MID_TICKS))
    made.wire.sleep(made.wire.now() + 0.2)
    cycles = made.run(3, np.full(3, MID_TICKS))
    assert kinds(cycles) == [("watchdog", 1), ("watchdog", 2), ("watchdog", 3)]
    assert (cycles[-1].raw_values("watchdog") == -1).all()


def test_loss_and_return_of_a_serial_port_are_reported_as_bus_events(rig: Make):
    made = rig(7, faults=plan("unplug", start=0.5, seconds=0.4))
    made.energise()
    cycles = made.run(150, np.full(7, MID_TICKS))
    assert kinds(cycles) == [("port lost", None), ("port back", None)]
    gone = [cycle for cycle in cycles if cycle.lost]
    assert gone
    assert all(not cycle.fresh.any() for cycle in gone)
    assert cycles[-1].fresh.all()
    back = next(cycle for cycle in cycles if ("port back", None) in kinds([cycle]))
    assert back.time - 0.9 < 0.1
    assert made.true(Register.TORQUE_ENABLE).all()


def test_queued_register_writes_are_dropped_while_the_port_is_lost(rig: Make):
    made = rig(2, faults=plan("unplug", start=0.3, seconds=0.2))
    made.wire.sleep(0.35)
    assert made.run(1)[0].lost
    made.bus.put(Register.TORQUE_ENABLE, {1: 1})
    cycles = made.run(40)
    assert not cycles[-1].lost
    assert not made.true(Register.TORQUE_ENABLE).any()


def test_reply_timeout_adapts_to_a_slow_adapter(rig: Make):
    made = rig(7, latency=0.012, period=0.03)
    cycles = made.run(120, np.full(7, MID_TICKS))
    assert fresh_share(cycles[-40:]) == 1.0
    assert not cycles[-1].silent.any()


def test_adapter_slower_than_the_bus_period_delays_records_but_no_servo_counts_as_silent(rig: Make):
    made = rig(7, latency=0.016)
    cycles = made.run(100, np.full(7, MID_TICKS))
    assert not any(event.kind == "silent" for cycle in cycles for event in cycle.events)
    assert max(cycle.ages.max() for cycle in cycles[20:]) < 0.06


@pytest.mark.parametrize(
    "kind",
    ["truncate", *(pytest.param(kind, marks=pytest.mark.soak) for kind in SOAK_DAMAGES)],
)
@on_kinesic_servos
def test_repeated_queries_recover_damaged_records_on_a_bus_that_is_four_fifths_busy(rig: Make, kind: str):
    made = rig(26, period=0.0108, faults=plan(kind, rate=0.01, start=0.2))
    made.energise()
    cycles = made.run(120, np.full(26, MID_TICKS))
    assert fresh_share(cycles) >= 0.999
    assert np.quantile([cycle.duration for cycle in cycles], 0.99) < made.bus.period


@on_kinesic_servos
def test_newly_silent_servo_affects_records_of_other_servos_in_at_most_two_cycles(rig: Make):
    made = rig(26, period=0.0108)
    made.run(5)
    made.plant.servos[2].mute = True
    cycles = made.run(40)
    others = [np.delete(cycle.fresh, 2) for cycle in cycles]
    assert all(fresh.all() for fresh in others[2:])


def test_reply_that_arrives_after_its_cycle_affects_only_that_cycle(rig: Make):
    made = rig(14, faults=plan("late", start=0.5, seconds=0.008))
    made.energise()
    whole = [bool(cycle.fresh.all()) for cycle in made.run(50, np.full(14, MID_TICKS))]
    assert whole.count(False) == 1


def test_implausible_temperature_jump_is_reported_with_the_servo_id(rig: Make):
    """The reported temperature of a servo rises by 30 C within a cycle."""
    made = rig(3)
    made.run(3)
    made.plant.servos[1].electronics.celsius += 30.0
    assert kinds(made.run(2)) == [("doubted", 2)]
