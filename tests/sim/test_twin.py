from dataclasses import replace

import mujoco
import numpy as np
import pytest
from msgspec import structs
from scipy.interpolate import make_interp_spline

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Skeleton
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.model import describe, find_actuator_indices, find_joint_indices
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors
from kinesic.sim.twin import MAX_PHYSICS_STEP, Twin

ROBOT = Robot.load()
SKELETON = ROBOT.skeleton
REST_POSTURE = SKELETON.rest
ZERO_VELOCITIES = np.zeros(22)
DYNAMICS = MujocoDynamics(ROBOT)
COMMAND_PERIOD = 0.01  # [s] between commands


def still(time, goals=REST_POSTURE):
    return Command(
        time=time, angles=REST_POSTURE, velocities=ZERO_VELOCITIES, accelerations=ZERO_VELOCITIES, setpoints=goals
    )


def make_commands(seed=0, *, seconds=2.0):
    """Return commands of a smooth motion through random postures with exact feed-forward."""
    random = np.random.default_rng(seed)
    low, high = np.maximum(SKELETON.lower, REST_POSTURE - 0.3), np.minimum(SKELETON.upper, REST_POSTURE + 0.6)
    rest = REST_POSTURE
    keys = random.uniform(rest + 0.4 * (low - rest), rest + 0.6 * (high - rest), (4, 22))
    for side in "lr":
        keys[:, SKELETON.joint(f"{side}_shoulder_abduct")] += 0.3
    keys[0] = keys[-1] = REST_POSTURE
    ends = [(1, ZERO_VELOCITIES), (2, ZERO_VELOCITIES)]
    path = make_interp_spline(np.linspace(0, seconds, 4), keys, k=5, bc_type=(ends, ends))
    times = COMMAND_PERIOD * np.arange(round(seconds / COMMAND_PERIOD) + 1)
    ahead = np.minimum(times + COMMAND_PERIOD / 2, seconds)  # setpoints are held for one period
    angles, speeds, accelerations = path(ahead), path(ahead, 1), path(ahead, 2)
    torques = DYNAMICS.torques(angles, speeds, accelerations)
    stall = ROBOT.drives.stall
    gain = ROBOT.drives.gain
    no_load = ROBOT.drives.no_load
    goals = np.clip(angles + (torques / stall + speeds / no_load) / gain, SKELETON.lower, SKELETON.upper)
    return [Command(t, path(t), path(t, 1), path(t, 2), goal) for t, goal in zip(times, goals, strict=True)]


def performed(commands, robot=ROBOT, **options):
    twin = Twin(robot, **options)
    for command in commands:
        twin.write(command)
    twin.close()
    return twin.measurements()


COMMANDS = make_commands()
REFERENCE = np.array([command.angles for command in COMMANDS])


def test_equal_commands_give_identical_measurements():
    one, two = performed(COMMANDS), performed(COMMANDS)
    for name in ("times", "angles", "velocities", "torques", "duties"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()
    assert one.clearance.distances.tobytes() == two.clearance.distances.tobytes()
    assert list(one.clearance.pairs) == list(two.clearance.pairs)


@pytest.mark.parametrize("factors", [NOMINAL_FACTORS, PESSIMISTIC_FACTORS])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_longest_physics_step_deviates_by_at_most_0_05_degrees_from_1_ms_steps(seed, factors):
    commands = make_commands(seed)
    long, short = (performed(commands, factors=factors, step=step) for step in (MAX_PHYSICS_STEP, 0.001))
    assert short.clearance.distances.min() > 0.0, "the motion must not touch"
    assert np.degrees(np.abs(long.angles - short.angles).max()) <= 0.05


def test_tracking_error_of_the_nominal_twin_is_below_that_of_the_pessimistic_twin():
    nominal, weak = performed(COMMANDS), performed(COMMANDS, factors=PESSIMISTIC_FACTORS)
    errors = [np.degrees(np.sqrt(np.mean((m.angles - REFERENCE) ** 2))) for m in (nominal, weak)]
    assert errors[0] < 0.1
    assert errors[0] < errors[1] < 2.0


def test_measurements_are_sampled_before_each_command_acts():
    lifted = REST_POSTURE.copy()
    lifted[SKELETON.joint("l_elbow_flexion")] += 0.4
    seen = performed([still(5.0), still(5.1, lifted), still(5.2, lifted)])
    assert list(seen.times) == [5.0, 5.1, 5.2]
    elbow = seen.angles[:, SKELETON.joint("l_elbow_flexion")]
    assert abs(elbow[1] - elbow[0]) < 0.02
    assert elbow[2] - elbow[1] > 0.2


def test_time_of_the_twin_starts_at_its_first_command():
    early, late = performed([still(0.0), still(0.05)]), performed([still(7.0), still(7.05)])
    assert early.angles == pytest.approx(late.angles, abs=1e-12)
    assert early.angles[0] == pytest.approx(REST_POSTURE)


def test_twin_starts_in_the_given_posture():
    start = REST_POSTURE + 0.1
    assert performed([still(0.0)], start=start).angles[0] == pytest.approx(start)


def test_twin_steps_exactly_to_uneven_command_times():
    times = [0.0, 0.003, 0.003, 0.0171, 0.05]
    seen = performed([still(t) for t in times])
    assert list(seen.times) == times
    assert np.array_equal(seen.angles[1], seen.angles[2])
    assert len(seen.clearance.distances) == len(seen.clearance.pairs) == 5


def test_servo_latency_delays_the_motion_of_the_twin():
    # The delayed twin sags before its first setpoints arrive.
    waiting = [structs.replace(COMMANDS[0], time=-0.5), *COMMANDS]
    prompt, late = performed(waiting), performed(waiting, factors=Factors(latency=0.02))
    assert late.angles[3:] == pytest.approx(prompt.angles[1:-2], abs=np.radians(0.2))
    assert np.abs(late.angles - prompt.angles).max() > np.radians(1.0)


def test_servo_latency_equals_the_actuator_delay_of_mujoco():
    """MuJoCo's actuator delay is an independent reference."""
    latency, step = 0.006, 0.001
    spec = describe(ROBOT)
    for actuator in spec.actuators:
        actuator.delay, actuator.nsample = latency, 12
    model = spec.compile()
    model.opt.timestep = step
    data = mujoco.MjData(model)
    order, actuators = find_joint_indices(ROBOT, model), find_actuator_indices(ROBOT, model)
    ticks = ROBOT.drives.tick
    goals = [np.rint(command.setpoints / ticks) * ticks for command in COMMANDS]
    data.qpos[order] = REST_POSTURE
    for joint, actuator in enumerate(actuators):
        before = step * np.arange(-12, 0)
        mujoco.mj_initCtrlHistory(
            model, data, actuator, before, np.full(12, np.rint(REST_POSTURE / ticks)[joint] * ticks[joint])
        )
    angles = []
    for goal in goals:
        angles.append(data.qpos[order] - step / 2 * data.qvel[order])
        data.ctrl[actuators] = goal
        mujoco.mj_step(model, data, round(COMMAND_PERIOD / step))
    late = performed(COMMANDS, factors=Factors(latency=latency), step=step)
    assert late.latency == latency
    assert np.abs(late.angles[1:] - angles[1:]).max() < np.radians(0.01)
    assert np.abs(performed(COMMANDS, step=step).angles[1:] - angles[1:]).max() > np.radians(0.3)


def test_measured_angles_of_loaded_hinges_change_by_under_0_2_degrees_with_backlash():
    """Compare loaded hinges of twins with and without backlash."""
    raised = np.array(REST_POSTURE)
    for side in "lr":
        raised[SKELETON.joint(f"{side}_elbow_flexion")] = 1.5
        raised[SKELETON.joint(f"{side}_shoulder_flexion")] = 0.8
    results = [still(COMMAND_PERIOD * k, raised) for k in range(150)]
    tight, loose = (
        performed(results, start=raised, factors=Factors(play=play)).angles[-1]
        for play in (0.0, np.radians(1.0).item())
    )
    loaded = [SKELETON.joint(f"{side}_{name}") for side in "lr" for name in ("elbow_flexion", "shoulder_flexion")]
    assert np.abs(tight - loose)[loaded].max() < np.radians(0.2)


def test_hinge_with_backlash_lags_by_4_to_30_mrad_after_the_motor_reverses():
    """After a slow reversal the hinge follows later than without backlash."""
    way = np.concatenate([np.linspace(0.0, 0.3, 100), np.linspace(0.3, 0.0, 100)])
    neck = SKELETON.joint("skullbase_torsion")
    results = [still(COMMAND_PERIOD * k, REST_POSTURE + turn * (np.arange(22) == neck)) for k, turn in enumerate(way)]
    tight, loose = (performed(results, factors=Factors(play=play)).angles[:, neck] for play in (0.0, 0.02))
    strayed = np.abs(tight - loose)
    assert 0.004 < strayed[100:130].max() < 0.03


def test_setpoints_recorded_by_the_twin_are_the_sent_ones_rounded_to_ticks():
    seen = performed(COMMANDS)
    ticks = ROBOT.drives.tick
    assert seen.setpoints.shape == seen.angles.shape
    assert np.abs(seen.setpoints - [command.setpoints for command in COMMANDS]).max() <= ticks.max() / 2 + 1e-12
    assert seen.setpoints / ticks == pytest.approx(np.rint(seen.setpoints / ticks), abs=1e-6)


def test_positions_reported_by_the_twin_are_the_current_angles_rounded_to_ticks():
    twin = Twin(ROBOT)
    ticks = ROBOT.drives.tick
    for command in COMMANDS[:100]:
        twin.write(command)
        positions = twin.positions()
        assert np.abs(positions - twin.state().angles).max() <= ticks.max() / 2 + 1e-12
        assert positions / ticks == pytest.approx(np.rint(positions / ticks), abs=1e-6)


def test_setpoint_moves_the_twin_like_the_nearest_tick():
    tick = ROBOT.drives[0].tick
    turned = REST_POSTURE.copy()
    turned[0] = 100.4 * tick
    exact = REST_POSTURE.copy()
    exact[0] = 100 * tick
    one, two = (performed([still(0.0, goals), still(0.5, goals)]) for goals in (turned, exact))
    assert np.array_equal(one.angles, two.angles)


def test_torques_and_duties_measured_by_the_twin_follow_the_servo_control_law():
    seen = performed(COMMANDS, factors=PESSIMISTIC_FACTORS)
    weak = PESSIMISTIC_FACTORS.applied(ROBOT).drives
    held = [REST_POSTURE, *[command.setpoints for command in COMMANDS[:-1]]]
    ticks = np.array([drive.tick for drive in weak])
    goals = np.round(np.array(held) / ticks) * ticks
    for j, drive in enumerate(weak):
        duty = drive.gain * (goals[:, j] - seen.angles[:, j]) - drive.rate_gain / drive.stall * seen.velocities[:, j]
        assert seen.duties[:, j] == pytest.approx(duty, abs=1e-12)
        torque = drive.stall * np.clip(duty, -1, 1) - drive.stall / drive.no_load * seen.velocities[:, j]
        assert seen.torques[:, j] == pytest.approx(torque, abs=1e-9)


def test_overloaded_servo_demands_more_than_full_duty():
    far = REST_POSTURE.copy()
    far[SKELETON.joint("l_shoulder_flexion")] = 2.0
    seen = performed([still(0.0, far), still(0.01, far)])
    j = SKELETON.joint("l_shoulder_flexion")
    assert seen.duties[1, j] > 1.0
    assert seen.torques[1, j] < ROBOT.drives[j].stall


def test_measured_hands_are_the_wrist_centres():
    seen = performed(COMMANDS)
    for k in (0, 70, 150):
        frames = SKELETON.frames(seen.angles[k])
        for side in "lr":
            wrist = frames.origins[SKELETON.segment(ROBOT.chains[f"{side}_arm"][-1])]
            assert seen.hands[side][k] == pytest.approx(wrist, abs=1e-12)


def test_clearance_measured_by_the_twin_is_the_minimum_over_all_physics_steps():
    fine = [structs.replace(COMMANDS[0], time=0.0)]
    for command in COMMANDS:  # equal setpoints, recorded at every physics step
        held = command.setpoints if command is COMMANDS[0] else fine[-1].setpoints
        third = COMMAND_PERIOD / 3
        fine += [
            structs.replace(command, time=command.time - share * third, setpoints=held)
            for share in (2, 1)
            if command.time > 0
        ]
        fine.append(command)
    seen, every = performed(COMMANDS), performed(fine[1:], step=COMMAND_PERIOD)
    assert every.angles[::3] == pytest.approx(seen.angles, abs=1e-6)
    assert seen.clearance.distances.min() == pytest.approx(every.clearance.distances.min(), abs=1e-7)
    at_samples = CapsuleDistances(ROBOT).clearance(seen.angles).distances
    assert (seen.clearance.distances <= at_samples + 1e-12).all()
    assert seen.clearance.distances.min() == pytest.approx(at_samples.min(), abs=1e-3)


def test_collision_between_two_commands_is_detected():
    flung = REST_POSTURE.copy()
    flung[SKELETON.joint("l_shoulder_twisting")] = -1.5
    flung[SKELETON.joint("l_elbow_flexion")] = 2.3
    seen = performed([still(0.0, flung), still(1.0, REST_POSTURE), still(2.5, REST_POSTURE)])
    assert seen.clearance.distances[1] < 0.0 < seen.clearance.distances[0]
    assert "l_elbow" in seen.clearance.pairs[1] or "l_wrist" in seen.clearance.pairs[1]


def test_deleting_twin_measurements_during_a_motion_keeps_the_later_ones():
    whole = performed(COMMANDS)
    twin = Twin(ROBOT)
    for k, command in enumerate(COMMANDS):
        if k == 100:
            twin.forget()
        twin.write(command)
    rest = twin.measurements()
    assert np.array_equal(rest.times, whole.times[100:])
    assert np.array_equal(rest.angles, whole.angles[100:])
    assert np.array_equal(rest.duties, whole.duties[100:])
    assert np.array_equal(twin.state().angles, whole.angles[-1])
    assert np.array_equal(twin.state().velocities, whole.velocities[-1])


def test_twin_results_do_not_depend_on_segment_order():
    """Compare two robots that list the segments in different orders."""
    level = {None: -1}
    for segment in SKELETON.segments:
        level[segment.name] = level[segment.parent] + 1
    segments = sorted(SKELETON.segments, key=lambda segment: level[segment.name])
    names = [segment.name for segment in segments]
    order = sorted(range(22), key=lambda j: names.index(SKELETON.hinges[j].segment))
    assert order != list(range(22))
    shuffled = replace(
        ROBOT,
        skeleton=Skeleton(tuple(segments), tuple(SKELETON.hinges[j] for j in order)),
        mounts=tuple(ROBOT.mounts[j] for j in order),
    )
    commands = [
        structs.replace(
            c,
            angles=c.angles[order],
            velocities=c.velocities[order],
            accelerations=c.accelerations[order],
            setpoints=c.setpoints[order],
        )
        for c in COMMANDS[:80]
    ]
    seen, expected = performed(commands, shuffled), performed(COMMANDS[:80])
    assert seen.angles == pytest.approx(expected.angles[:, order], abs=1e-9)
    assert seen.duties == pytest.approx(expected.duties[:, order], abs=1e-7)


def test_invalid_physics_steps_and_decreasing_times_are_rejected():
    with pytest.raises(ValueError, match="step is 0"):
        Twin(ROBOT, step=0.0)
    with pytest.raises(ValueError, match="no command was written"):
        Twin(ROBOT).measurements()
    twin = Twin(ROBOT)
    twin.write(still(1.0))
    with pytest.raises(ValueError, match="time must not decrease"):
        twin.write(still(0.5))
