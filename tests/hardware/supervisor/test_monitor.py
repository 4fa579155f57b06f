from math import degrees, radians

import numpy as np
import pytest

from kinesic.hardware.bus.cycle import BLOCK_DTYPE
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, HardwareError, Register
from kinesic.hardware.supervisor.monitor import (
    LOAD_TUNING,
    LoadRatings,
    LoadState,
    derate,
    update_load,
)

from .judged import Given, tables_of

LOAD_RATINGS = LoadRatings(
    celsius=np.array([80.0, 80.0]), current=np.array([1000.0, 1000.0]), full=np.array([140.0, 140.0])
)
ZERO_GOALS = np.zeros(2)


def records(*, current: int = 0, celsius: int = 30, position: int = 0, velocity: int = 0, torque: int = 1):
    blocks = np.zeros(2, dtype=BLOCK_DTYPE)
    blocks["temperature"] = 30
    for name, value in (("current", current), ("temperature", celsius), ("position", position), ("velocity", velocity)):
        blocks[name][1] = value
    blocks["torque"] = torque
    return blocks


def after(seconds: float, **what: int) -> LoadState:
    load = LoadState.none(2)
    for k in range(round(seconds * 100) + 1):
        load = update_load(load, records(**what), np.full(2, 0.01 * k), ZERO_GOALS, LOAD_RATINGS)
    return load


def test_lightly_loaded_servo_does_not_slow_the_performance():
    assert derate(after(60.0, current=300), records(current=300), LOAD_RATINGS).tolist() == [1.0, 1.0]


def test_sustained_full_current_slows_and_then_stops_the_performance():
    scales = [derate(after(seconds, current=-1000), records(), LOAD_RATINGS)[1] for seconds in (1.0, 9.0, 20.0)]
    assert scales[0] == 1.0
    assert 0.0 < scales[1] < 1.0
    assert scales[2] == 0.0


def test_servo_load_decays_without_current():
    tired = after(20.0, current=1000)
    for k in range(1000):
        tired = update_load(tired, records(), np.full(2, 21.0 + 0.01 * k), ZERO_GOALS, LOAD_RATINGS)
    assert derate(tired, records(), LOAD_RATINGS)[1] == 1.0


@pytest.mark.parametrize(("celsius", "scale"), [(60, 1.0), (70, 1.0), (74, 3 / 7), (77, 0.0), (79, 0.0)])
def test_hot_servo_slows_the_time_scale_before_it_shuts_down(celsius: int, scale: float):
    assert derate(LoadState.none(2), records(celsius=celsius), LOAD_RATINGS) == pytest.approx([1.0, scale])


@pytest.mark.parametrize(("velocity", "stuck"), [(2, True), (-2, True), (3, False), (-3, False)])
def test_servo_that_creeps_at_three_counts_of_velocity_is_not_stuck(velocity: int, stuck: bool):
    """Three counts are 4 degrees a second."""
    assert after(LOAD_TUNING.stuck_time + 0.02, position=200, velocity=velocity).stuck.tolist() == [False, stuck]


def test_servo_far_from_its_goal_that_does_not_move_is_stuck():
    assert after(LOAD_TUNING.stuck_time + 0.02, position=200).stuck.tolist() == [False, True]
    assert not after(LOAD_TUNING.stuck_time + 0.02, position=100).stuck.any()
    assert not after(LOAD_TUNING.stuck_time + 0.02, position=200, velocity=20).stuck.any()
    assert not after(LOAD_TUNING.stuck_time + 0.02, position=200, torque=0).stuck.any()
    assert not after(LOAD_TUNING.stuck_time - 0.05, position=200).stuck.any()


@pytest.mark.parametrize(("gap", "halted"), [(0.15, True), (0.16, False)])
def test_stall_time_restarts_after_a_gap_in_servo_records(gap: float, halted: bool):
    load = update_load(LoadState.none(2), records(position=200), np.zeros(2), ZERO_GOALS, LOAD_RATINGS)
    load = update_load(load, records(position=200), np.full(2, gap), ZERO_GOALS, LOAD_RATINGS)
    assert load.stalled[1] == (gap if halted else 0.0)


def test_old_servo_record_does_not_change_the_estimated_load():
    load = after(0.2, position=200, current=1000)
    again = update_load(load, records(position=200), load.taken, np.array([0.0, 200.0]), LOAD_RATINGS)
    assert again.stalled.tolist() == load.stalled.tolist()
    assert again.work.tolist() == load.work.tolist()
    assert load.stalled[1] == pytest.approx(0.2)


def test_servo_load_is_the_squared_current_low_pass_filtered_over_ten_seconds():
    load = update_load(LoadState.none(2), records(), np.zeros(2), ZERO_GOALS, LOAD_RATINGS)
    load = update_load(load, records(current=-500), np.full(2, 0.1), ZERO_GOALS, LOAD_RATINGS)
    assert load.work == pytest.approx([0.0, 0.25 * 0.1 / 10.0])
    load = update_load(
        load, records(current=2000), np.full(2, 0.2), ZERO_GOALS, LOAD_RATINGS
    )  # never more than its limit
    assert load.work == pytest.approx([0.0, 0.0025 + (1.0 - 0.0025) * 0.01])


@pytest.mark.parametrize(("work", "scale"), [(0.0, 1.0), (0.5, 1.0), (0.65, 0.5), (0.74, 0.2), (0.8, 0.0), (1.0, 0.0)])
def test_performance_slows_between_half_and_four_fifths_of_the_load_limit(work: float, scale: float):
    load = LoadState(np.array([0.0, work]), np.zeros(2), np.zeros(2))
    assert derate(load, records(), LOAD_RATINGS) == pytest.approx([1.0, scale])


def test_load_ratings_come_from_the_servo_registers(manifest):
    """Without current sensor the load is in thousandths; a limit of 0 leaves a minimal rating."""
    tables = tables_of(manifest)
    tables[3] = Given(manifest.members[3], {Register.TEMPERATURE_LIMIT: 70, Register.CURRENT_LIMIT: 0})
    ratings = LoadRatings.of(tables)
    assert ratings.current.tolist() == [700.0, 700.0, 1000.0, 1.0, 1000.0]
    assert ratings.celsius.tolist() == [80.0, 80.0, 80.0, 70.0, 80.0]
    assert ratings.full.tolist() == manifest.full.tolist()


def test_monitor_has_nan_positions_until_the_first_bus_cycle(room):
    monitor = room.monitor
    assert np.isnan(monitor.present).all()
    assert not monitor.raised.any()
    known = (monitor.answering, monitor.all_answered, monitor.well, monitor.any_energised, monitor.all_energised)
    assert known == (False,) * 5
    assert (monitor.lost, monitor.tripped, monitor.any_limp, monitor.weak, monitor.scale) == (False,) * 4 + (0.0,)


def test_healthy_servos_give_no_reason_to_stop_the_performance(room):
    monitor = room.look()
    assert (monitor.answering, monitor.all_answered, monitor.well, monitor.any_energised, monitor.all_energised) == (
        True,
    ) * 5
    assert (monitor.lost, monitor.tripped, monitor.any_limp, monitor.weak) == (False,) * 4
    assert monitor.present.tolist() == room.records["position"].tolist()
    assert monitor.taken.tolist() == [0.01] * 5
    assert (monitor.scale, monitor.trouble(), monitor.holding_joints) == (1.0, "", frozenset())
    assert not monitor.raised.any()


def test_silent_servo_is_named_as_reason_of_the_stop_and_has_a_nan_position(room):
    room.look(3)
    room.recent[3] = False
    monitor = room.look()
    assert np.isnan(monitor.present).tolist() == np.isnan(monitor.taken).tolist() == [False, False, False, True, False]
    assert (monitor.answering, monitor.all_answered, monitor.well) == (False,) * 3
    assert monitor.trouble() == "l_twist: silent"
    room.recent[3] = True
    assert room.look().well


def test_lost_port_does_not_count_as_silent_servos(room):
    room.look()
    room.lost = True
    monitor = room.look()
    assert (monitor.lost, monitor.all_answered, monitor.answering, monitor.well) == (True, True, False, False)
    assert monitor.trouble() == "a port is gone"


def test_servo_after_shutdown_is_reported_as_failed_and_not_as_torque_off(room):
    room.records["hardware_error"][2], room.records["torque"][2] = HardwareError.OVERLOAD.value, 0
    monitor = room.look()
    assert monitor.failed.tolist() == [False, False, True, False, False]
    assert not monitor.limp.any()
    assert (monitor.well, monitor.weak, monitor.any_limp) == (False, False, False)
    assert (monitor.any_energised, monitor.all_energised) == (True, False)
    assert monitor.trouble() == "l_flexion: shut down or blocked"
    assert monitor.holding_joints == frozenset()  # the others of its chain may bring it to rest


def test_chain_holds_when_one_of_its_servos_fails_with_torque_still_on(room):
    room.records["hardware_error"][3] = HardwareError.ENCODER.value | HardwareError.VOLTAGE.value
    monitor = room.look()
    assert monitor.failed.tolist() == [False, False, False, True, False]
    assert not monitor.weak
    assert monitor.holding_joints == frozenset({1, 2})  # of the left arm


def test_low_voltage_alone_does_not_count_as_failure(room):
    room.records["hardware_error"][[0, 4]] = HardwareError.VOLTAGE.value
    monitor = room.look()
    assert (monitor.weak, monitor.well, monitor.failed.any()) == (True, True, False)


def test_servo_without_torque_is_reported_as_torque_off(room):
    room.records["torque"][1] = 0
    monitor = room.look()
    assert monitor.limp.tolist() == [False, True, False, False, False]
    assert (monitor.any_limp, monitor.any_energised, monitor.all_energised, monitor.well) == (True, True, False, False)
    assert monitor.trouble() == "torsion: without torque"
    room.records["torque"][:] = 0
    assert not room.look().any_energised


def test_tripped_watchdog_of_a_servo_without_torque_does_not_count_as_a_fault(room):
    room.records["watchdog"][2], room.records["torque"][2] = WATCHDOG_TRIPPED, 0
    assert not room.look().tripped
    room.records["torque"][2] = 1
    monitor = room.look()
    assert (monitor.tripped, monitor.well) == (True, False)
    assert monitor.trouble() == "servos were stopped by their bus watchdog"


def test_servo_temperature_slows_the_performance_at_updates_every_twentieth_of_a_second(room):
    room.look()
    room.records["temperature"][4] = 75
    scales = [room.look().scale for _ in range(7)]
    assert scales == pytest.approx([1.0] * 4 + [2 / 7] * 3)
    room.records["temperature"][4] = 77
    monitor = room.look(6)
    assert (monitor.scale, monitor.well) == (0.0, False)
    assert monitor.trouble() == "a servo is too hot or overloaded"


def test_blocked_servo_is_stuck_until_its_torque_is_off(room):
    room.look()
    room.goals = room.goals + np.array([0.0, 0.0, 200.0, 0.0, 0.0])
    assert not room.look(25).stuck.any()
    monitor = room.look(15)
    assert monitor.stuck.tolist() == monitor.failed.tolist() == [False, False, True, False, False]
    room.goals = np.array(room.records["position"], dtype=float)
    assert room.look(20).stuck[2]  # that it is asked for nothing more does not mend it
    room.records["torque"][2] = 0
    assert not room.look(10).failed.any()


def test_servo_without_a_goal_does_not_count_as_stuck(room):
    room.records["position"][2] += 500
    assert not room.look(60, goals=False).stuck.any()


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_servo_with_torque_counts_as_raised_beyond_five_degrees_from_rest(room, manifest, way):
    """The last servo turns 1.2 times as far as its hinge."""
    rest = manifest.rest.take(manifest.joints)
    for angle, raised in ((4.8, False), (5.2, True)):
        room.records["position"] = np.rint(manifest.scale.ticks((rest + way * radians(angle))[None])[0])
        assert degrees(np.abs(manifest.scale.angles(room.records["position"].astype(float)) - rest).min()) > angle - 0.1
        assert room.look().raised.tolist() == [raised] * 5
    room.records["torque"] = [1, 0, 1, 1, 1]
    assert room.look().raised.tolist() == [True, False, True, True, True]


def test_silent_servo_counts_as_raised_if_its_goal_is_raised(room):
    room.look()
    room.goals = room.goals + 300.0
    assert not room.look().raised.any()
    room.recent[4] = False
    assert room.look().raised.tolist() == [False, False, False, False, True]
    assert not room.look(goals=False).raised.any()
