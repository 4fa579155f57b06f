"""Supervisor on virtual servos in virtual time."""

from collections.abc import Callable

import numpy as np
import pytest

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.context import SupervisorContext
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.supervisor.supervisor import Supervisor

Make = Callable  # of a desk, see conftest
PERIOD = 0.01
TORQUE, GOAL, WATCHDOG = Register.TORQUE_ENABLE, Register.GOAL_POSITION, Register.BUS_WATCHDOG


def test_opening_configures_the_servos_and_leaves_their_torque_off(desk: Make):
    made = desk()
    made.open()
    made.run(0.3)
    assert made.stage is Stage.LIMP
    assert not made.true(TORQUE).any()
    assert not made.jumps
    assert made.true(Register.OPERATING_MODE).tolist() == [3] * 5
    lower, upper = made.manifest.spans
    assert made.true(Register.MIN_POSITION_LIMIT).tolist() == lower.tolist()
    assert made.true(Register.MAX_POSITION_LIMIT).tolist() == upper.tolist()
    assert sum(line.startswith("configured") for line in made.kinds()) == 10


def test_robot_that_the_stop_command_cannot_find_is_refused_before_configuration(desk: Make):
    made = desk()

    def fail() -> None:
        raise BusError("no stop would find this robot")

    around = SupervisorContext(made.wires.__getitem__, made.channel, lambda: True, made.journal_file, announce=fail)
    made.supervisor = Supervisor(made.manifest, around, made.settings, watchdog=made.settings.watchdog)
    made.open()
    assert made.supervisor.done
    assert made.stage is Stage.CLOSED
    assert not made.true(TORQUE).any()
    assert not any(line.startswith("configured") for line in made.kinds())
    assert [note.text for note in made.channel.notes() if note.kind == "refused"] == ["no stop would find this robot"]


def test_correct_servo_registers_are_not_written_again(desk: Make):
    made = desk()
    made.open()
    made.channel.set("ended", 1)
    made.until(Stage.CLOSED)
    before = len(made.kinds())
    made.start()
    made.open()
    assert not any(line.startswith("configured") for line in made.kinds()[before:])


def test_all_commands_sent_in_one_cycle_are_performed(desk: Make, monkeypatch: pytest.MonkeyPatch):
    made = desk()
    made.open()
    commands = made.channel.commands

    def then_all_is_said(most: int) -> object:
        sent_commands = commands(most)
        made.perform(1.0)
        made.channel.set("ended", 1)
        monkeypatch.undo()
        return sent_commands

    monkeypatch.setattr(made.channel, "commands", then_all_is_said)
    made.until(Stage.ACTIVE)
    made.until(Stage.CLOSED)
    assert made.status.time == pytest.approx(1.0, abs=PERIOD)


def test_servo_goals_follow_the_performance_which_ends_at_rest_without_torque(desk: Make):
    made = desk()
    made.open()
    made.perform(2.0)
    made.channel.set("ended", 1)
    made.until(Stage.ACTIVE)
    worst = 0.0
    while made.stage is Stage.ACTIVE:
        made.cycle()
        wished = made.manifest.scale.ticks(made.goals(made.status.time, 2.0)[made.manifest.joints])
        worst = max(worst, float(np.abs(made.true(GOAL) - wished).max()))
    assert worst <= 3
    made.until(Stage.CLOSED)
    assert not made.true(TORQUE).any()
    assert made.status.energised == 0
    assert made.jumps
    assert max(made.jumps) <= 2
    rest = made.manifest.scale.ticks(made.manifest.rest[made.manifest.joints])
    assert np.abs(made.present_position - rest).max() <= 3


def test_clearance_watch_slows_the_performance_and_restores_its_rate(desk: Make):
    made = desk().active(6.0)
    made.channel.slow_to(0.1)
    made.run(0.2)
    assert made.status.scale == pytest.approx(0.1)
    began = made.status.time
    made.run(0.5)
    assert made.status.time - began == pytest.approx(0.05, abs=0.002)
    assert made.stage is Stage.ACTIVE
    made.channel.slow_to(1.0)
    made.run(0.5)
    assert made.status.scale == 1.0


def test_feedforward_is_reduced_in_proportion_to_a_slowed_performance(desk: Make):
    """At a tenth of full speed, a tenth of the feed-forward remains."""
    made = desk()
    made.open()
    for k in range(300):
        time, rate = k * PERIOD, min(1.0, k / 30)
        way = 0.5 * (time - 0.15 if k > 30 else time * rate / 2)
        led = 0.1 * rate
        assert made.channel.write(time, made.manifest.rest + way + led, np.full(len(made.manifest.rest), led))
    made.until(Stage.ACTIVE)
    made.run(0.8)
    ahead = made.status.setpoints - made.manifest.rest - 0.5 * (made.status.time - 0.15)
    assert ahead == pytest.approx(0.1, abs=0.005)
    made.channel.slow_to(0.1)
    made.run(0.4)
    ahead = made.status.setpoints - made.manifest.rest - 0.5 * (made.status.time - 0.15)
    assert ahead == pytest.approx(0.01, abs=0.005)


def test_time_in_the_supervisor_status_is_performance_time(desk: Make):
    made = desk()
    made.open()
    made.perform(2.0, begin=7.0)
    made.until(Stage.ACTIVE)
    assert made.status.time == pytest.approx(7.0, abs=2 * PERIOD)
    made.run(1.0)
    assert made.status.time == pytest.approx(8.0, abs=3 * PERIOD)
    assert made.status.scale == 1.0


def test_status_angles_are_in_radians_and_joint_order(desk: Make):
    made = desk().active()
    turned = made.manifest.angles(made.present_position.astype(float))
    assert made.status.angles == pytest.approx(turned, abs=0.05)
    assert made.status.energised == 5


def test_motor_power_is_ramped_up_after_torque_on(desk: Make):
    made = desk()
    made.open()
    made.perform(2.0)
    made.until(Stage.ARM)
    powers = []
    while made.stage is Stage.ARM:
        made.cycle()
        if made.true(TORQUE).all():
            powers.append(int(made.true(Register.GOAL_PWM)[0]))
    assert powers[0] <= 0.15 * 885
    assert powers[-1] == 885
    assert powers == sorted(powers)
    assert len(powers) >= 25


def test_servos_away_from_their_goals_do_not_jump_at_torque_on(desk: Make):
    made = desk()
    for k, servo in enumerate(made.plant.servos):
        made.plant.physics.turn(k, made.plant.physics.shafts()[k].angle + 0.3)
        servo.memory[GOAL] = 500
    made.plant.advance(0.01)
    before = made.present_position
    made.open()
    made.perform(2.0)
    made.until(Stage.HOLD, Stage.APPROACH)
    assert len(made.jumps) == 5
    assert max(made.jumps) <= 2
    assert np.abs(made.present_position - before).max() <= 2


def test_random_commands_give_goals_in_range_without_jumps(desk: Make):
    made = desk()
    made.open()
    rng = np.random.default_rng(1)
    for k in range(100):
        assert made.channel.write(k * PERIOD, rng.uniform(-4, 4, 4))
    made.channel.set("ended", 1)
    made.until(Stage.ACTIVE)
    before = made.true(GOAL)
    lower, upper = made.manifest.spans
    while made.stage is not Stage.CLOSED:
        made.cycle()
        goals = made.true(GOAL)
        assert (goals >= lower).all()
        assert (goals <= upper).all()
        if made.true(TORQUE).all():
            step = made.manifest.velocities * PERIOD  # and half as much for the servos' own profiles
            assert (np.abs(goals - before) <= 1.6 * step + 2).all()
        before = goals
    assert any("limited" in line for line in made.kinds())
    assert not made.true(TORQUE).any()


def test_robot_without_commands_holds_then_moves_to_rest_and_restarts_with_new_commands(desk: Make):
    made = desk()
    made.open()
    for k in range(120):
        made.channel.write(k * PERIOD, made.goals(k * PERIOD, 3.0))
    made.until(Stage.ACTIVE)
    made.until(Stage.HOLD)
    assert made.status.time == pytest.approx(1.19, abs=1e-6)
    made.until(Stage.FOLD)
    made.until(Stage.HOLD)
    made.run(2 * made.settings.patience)
    assert made.stage is Stage.HOLD
    assert made.true(TORQUE).all()
    made.perform(2.0, begin=60.0)
    made.until(Stage.ACTIVE)
    made.run(0.5)
    assert made.status.time > 60.0


def test_commands_of_a_slow_planner_cause_no_goal_jumps(desk: Make):
    """Performance time slows down before the last received setpoint."""
    made = desk()
    made.open()
    for k in range(60):
        made.channel.write(k * PERIOD, made.goals(k * PERIOD, 4.0))
    made.until(Stage.ACTIVE)
    before, fastest = made.true(GOAL), 0
    for k in range(60, 200):
        made.cycle()
        made.cycle()
        made.channel.write(k * PERIOD, made.goals(k * PERIOD, 4.0))
        fastest = max(fastest, int(np.abs(made.true(GOAL) - before).max()))
        before = made.true(GOAL)
    assert fastest <= 20
    assert made.status.time <= 4.0


@pytest.mark.parametrize("ended", [False, True])
def test_dead_planner_stops_even_a_fully_buffered_performance(desk: Make, ended: bool):
    made = desk().active(20.0)
    made.channel.set("ended", int(ended))
    made.run(0.5)
    assert made.stage is Stage.ACTIVE
    made.alive = False
    made.until(Stage.HOLD, within=0.1)
    made.until(Stage.FOLD, within=0.1)
    made.until(Stage.CLOSED)
    assert made.status.time < 1.5
    assert not made.raised.any()
    assert not made.true(TORQUE).any()


def test_release_request_moves_the_robot_to_rest_and_switches_torque_off(desk: Make):
    made = desk().active()
    made.channel.set("release", 1)
    made.until(Stage.CLOSED)
    assert not made.true(TORQUE).any()
    assert any("fold" in line for line in made.kinds())


def test_event_log_of_a_supervisor_has_a_timestamp_in_each_line(desk: Make):
    made = desk().active()
    made.channel.set("release", 1)
    made.until(Stage.CLOSED)
    lines = made.journal()
    assert all({"time", "wall", "kind", "text"} <= set(line) for line in lines)
    times = [float(str(line["time"])) for line in lines[3:-1]]
    assert times == sorted(times)


def test_non_finite_command_is_dropped_and_reported(desk: Make):
    made = desk().active()
    made.channel.write(9.0, np.full(4, np.nan))
    made.run(1.0)
    assert any(line.startswith("dropped") for line in made.kinds())


def test_supervisor_writes_a_status_in_every_cycle(desk: Make):
    made = desk().active()
    history = made.channel.history()
    assert [item.stage for item in history[-20:]] == [Stage.ACTIVE] * 20
    clocks = [item.clock for item in history]
    assert clocks == sorted(clocks)
    made.cycle()
    assert len(made.channel.history()) == 1


def test_unwritable_event_log_is_reported_once_and_does_not_interrupt_the_performance(desk: Make):
    made = desk()
    made.log = made.log.with_name("missing") / "events.jsonl"
    made.start()
    made.active()
    reported = [note.text for note in made.notes() if note.kind == "journal"]
    assert reported == [f"{made.log}: No such file or directory; events are lost"]
