import numpy as np

from kinesic import Performer
from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.body.dynamics import Load
from kinesic.body.robot import Robot
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.learned_gains import LearnedGains
from kinesic.motion.trajectory import stay
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'
ROBOT = Robot.load()
HINGE_COUNT = len(ROBOT.skeleton.hinges)


class Told:
    """Sink that stores its commands."""

    def __init__(self) -> None:
        self.commands: list[Command] = []

    def write(self, command: Command, /) -> None:
        self.commands.append(command)

    def close(self) -> None:
        """Do nothing, because the commands stay in memory."""


class Weightless:
    """Dynamics without gravity, inertia and friction."""

    def torques(self, angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        return np.zeros_like(angles)

    @property
    def load(self) -> Load:
        return Load(np.zeros(HINGE_COUNT), np.ones(HINGE_COUNT))


class Loaded(Weightless):
    """Dynamics with a constant torque."""

    def torques(self, angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        return np.full_like(angles, 0.5)


class Turning:
    """Motion of all hinges through a posture at constant velocity."""

    def __init__(self, posture: Floats) -> None:
        self.posture = posture

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        rows = np.tile(self.posture, (len(times), 1))
        return rows, np.full_like(rows, 0.1), np.zeros_like(rows)


def test_weightless_robot_at_rest_has_its_posture_as_setpoints():
    posture = ROBOT.skeleton.rest
    sent = (
        FeedForward(ROBOT, Weightless(), period=0.01).compute_setpoints(stay(posture), np.array([0.0, 0.05])).setpoints
    )
    np.testing.assert_allclose(sent, [posture, posture], atol=1e-12)


def test_feed_forward_offset_makes_the_servo_produce_the_load_torque():
    posture = ROBOT.skeleton.clamp(np.full(HINGE_COUNT, 0.1))
    sent = FeedForward(ROBOT, Loaded(), period=0.01).compute_setpoints(stay(posture), np.array([0.05])).setpoints
    for k, drive in enumerate(ROBOT.drives):
        assert np.isclose((sent[0, k] - posture[k]) * drive.gain * drive.stall, 0.5)


def test_learned_feed_forward_gains_scale_setpoint_offsets():
    posture = ROBOT.skeleton.clamp(np.full(HINGE_COUNT, 0.1))
    known = LearnedGains(np.full(HINGE_COUNT, 0.5), np.full(HINGE_COUNT, -0.25))
    plain, taught = (
        FeedForward(ROBOT, Loaded(), period=0.01, learned=learned).compute_setpoints(Turning(posture), np.array([0.05]))
        for learned in (None, known)
    )
    np.testing.assert_allclose(taught.loads, 1.5 * plain.loads)
    np.testing.assert_allclose(taught.leads, 0.75 * plain.leads)
    np.testing.assert_allclose(taught.setpoints - plain.setpoints, 0.5 * plain.loads - 0.25 * plain.leads, atol=1e-12)
    np.testing.assert_allclose(taught.duties, plain.duties)


def test_setpoint_of_a_moving_hinge_compensates_the_servo_lag(through):
    angles = np.stack([ROBOT.skeleton.rest, ROBOT.skeleton.rest])
    hinge = ROBOT.skeleton.joint("l_shoulder_flexion")
    angles[1, hinge] += 0.5
    move = through(np.array([0.0, 1.0]), angles)
    sent = FeedForward(ROBOT, Weightless(), period=0.01).compute_setpoints(move, np.array([0.495])).setpoints
    drive = ROBOT.drives[hinge]
    lag = 1 / (drive.gain * drive.no_load)
    middle = move.at(0.5)
    assert np.isclose(sent[0, hinge], middle.angles[hinge] + lag * middle.velocities[hinge])


def test_setpoints_under_load_do_not_exceed_the_upper_joint_limits():
    posture = ROBOT.skeleton.upper
    sent = FeedForward(ROBOT, Loaded(), period=0.01).compute_setpoints(stay(posture), np.array([0.0])).setpoints
    assert np.all(sent <= ROBOT.skeleton.upper)


def test_feed_forward_loads_are_the_setpoint_offsets_due_to_torque():
    posture = ROBOT.skeleton.clamp(np.full(HINGE_COUNT, 0.1))
    times = np.array([0.05])
    full = FeedForward(ROBOT, Loaded(), period=0.01).compute_setpoints(stay(posture), times)
    np.testing.assert_allclose(full.setpoints, posture + full.loads, atol=1e-12)
    lag = FeedForward(ROBOT, Loaded(), period=0.01, terms="lag").compute_setpoints(stay(posture), times)
    np.testing.assert_allclose(lag.setpoints[0], posture, atol=1e-12)
    assert not lag.loads.any()


def test_setpoints_equal_the_reference_without_feed_forward():
    posture = ROBOT.skeleton.clamp(np.full(HINGE_COUNT, 0.1))
    none = FeedForward(ROBOT, Loaded(), period=0.01, terms="none").compute_setpoints(stay(posture), np.array([0.05]))
    np.testing.assert_array_equal(none.setpoints[0], stay(posture).at(0.05).angles)
    assert not none.loads.any()
    assert none.duties.any()


def test_estimated_servo_gain_changes_feed_forward_setpoints():
    performer = Performer()
    plan = performer.plan(NOD)

    def goals(believed: Factors) -> Floats:
        result = Told()
        performer.perform(plan, sinks=[result], believed=believed)
        return np.array([command.setpoints for command in result.commands])

    assert np.abs(goals(NOMINAL_FACTORS) - goals(Factors(gain=0.8))).max() > 1e-3
