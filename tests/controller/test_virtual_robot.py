import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.controller.virtual_robot import TwinPhysics
from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.registers import Mode, Register
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.physics import NO_TORQUE, Demand
from kinesic.hardware.virtual.wiring import build_bus, describe_cables
from kinesic.sim.servo_shafts import Shafts


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load()


def test_simulated_servo_shafts_start_in_the_rest_posture(robot: Robot):
    wires = describe_cables(robot)
    physics = TwinPhysics(robot, wires)
    fittings = [fitting for wire in wires for fitting in wire.fittings]
    for shaft, fitting in zip(physics.shafts(), fittings, strict=True):
        assert shaft.angle / Register.PRESENT_POSITION.field.scale == pytest.approx(fitting.ticks, abs=0.5)


def test_twin_moves_equally_for_setpoints_in_ticks_and_radians(robot: Robot):
    wires = describe_cables(robot)
    physics, plain = TwinPhysics(robot, wires), Shafts(robot)
    wiring = ServoMap.of(robot)
    goals = np.array(robot.skeleton.rest)
    goals[list(robot.joints("r_arm"))] += 0.3
    ticks = wiring.scale.ticks(goals)
    of = {servo: int(tick) for servos, tick in zip(wiring.servos, ticks, strict=True) for servo in servos.ids}
    scale = Register.GOAL_POSITION.field.scale
    demands = [Demand("angle", of[fitting.servo] * scale) for wire in wires for fitting in wire.fittings]
    for _ in range(100):
        physics.advance(0.01, demands)
        plain.advance(0.01, wiring.scale.angles(ticks), np.ones(len(goals)))
    np.testing.assert_allclose(physics.body.angles, plain.angles, atol=1e-9)


def test_one_powered_servo_of_two_on_a_joint_yields_at_most_half_the_torque(robot: Robot):
    wires = describe_cables(robot)
    physics = TwinPhysics(robot, wires)
    ids = [fitting.servo for fitting in wires[0].fittings]
    demands = [Demand("angle", shaft.angle) for shaft in physics.shafts()]
    demands[ids.index(2)] = NO_TORQUE
    demands[ids.index(3)] = demands[ids.index(3)]._replace(value=demands[ids.index(3)].value + 1.0)
    physics.advance(0.02, demands)
    tilt = robot.skeleton.joint("vl5_tilt")
    assert 0.4 < abs(physics.body.loads[tilt]) <= 0.5 + 1e-9


@pytest.mark.parametrize(
    ("mode", "goal", "value"), [(Mode.VELOCITY, Register.GOAL_VELOCITY, 40), (Mode.PWM, Register.GOAL_PWM, 200)]
)
def test_velocity_and_pwm_modes_of_virtual_servos_move_the_twin(robot: Robot, mode: Mode, goal: Register, value: int):
    wires = describe_cables(robot)
    plant, buses = build_bus(wires, TwinPhysics(robot, wires))
    wire = MemoryWire(buses["body"])
    neck = next(servos.ids[0] for servos in ServoMap.of(robot).servos if servos.hinge == "skullbase_torsion")
    for register, data in ((Register.OPERATING_MODE, mode.value), (Register.TORQUE_ENABLE, 1), (goal, value)):
        wire.write(packet.write_packet(neck, register.field.address, register.field.pack(data)))
        wire.read(wire.now() + 0.01)
    buses["body"].advance(wire.now() + 0.3)
    servo = next(servo for servo in plant.servos if servo.id == neck)
    servo.electronics.show()
    speed = servo.memory[Register.PRESENT_VELOCITY]
    if mode is Mode.VELOCITY:
        assert speed == pytest.approx(value, rel=0.2)
    else:
        assert 0 < speed < 350
    assert servo.memory[Register.PRESENT_POSITION] > 2060
