"""Twin on a simulated wire, driven by kinesic and the Dynamixel SDK."""

from collections.abc import Callable

import numpy as np
import pytest

from kinesic.bench.bus.drivers import Driver, KinesicDriver, SdkDriver
from kinesic.body.command import COMMAND_RATE
from kinesic.body.config import CONFIGS
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.play import commands
from kinesic.controller.virtual_robot import TwinPhysics
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.wiring import build_bus, describe_cables
from kinesic.planning.plan import Plan
from kinesic.session.plan import plan

COMMAND_PERIOD = 1 / COMMAND_RATE
CYCLE_COUNT = 240  # number of bus cycles, which contain most of the first wave


@pytest.fixture(scope="module")
def planned() -> Plan:
    return plan((CONFIGS / "bml" / "welcome.bml").read_bytes())


@pytest.mark.parametrize(("opens", "rmse"), [(KinesicDriver, 0.2), (SdkDriver, 1.0)])
def test_simulated_robot_follows_a_plan_sent_over_a_servo_bus(planned: Plan, opens: Callable[..., Driver], rmse: float):
    robot = planned.setup.robot
    wiring = ServoMap.of(robot)
    wires = describe_cables(robot)
    physics = TwinPhysics(robot, wires)
    plant, buses = build_bus(wires, physics)
    wire = MemoryWire(buses["body"])
    servos = [Servo(fitting.servo, SERVO_MODELS[fitting.model]) for fitting in wires[0].fittings]
    hinges = [next(k for k, s in enumerate(wiring.servos) if servo.id in s.ids) for servo in servos]
    for servo, fitting in zip(plant.servos, wires[0].fittings, strict=True):
        servo.write(Register.GOAL_POSITION.field.address, fitting.ticks.to_bytes(4, "little"))
        servo.write(Register.TORQUE_ENABLE.field.address, b"\1")
    driver = opens(wire, servos, COMMAND_PERIOD)
    times = planned.command_times[:CYCLE_COUNT]
    setpoints = FeedForward(robot, planned.setup.dynamics, COMMAND_PERIOD, delay=0.002).compute_setpoints(
        planned.trajectory, times
    )
    began = wire.now() + 1.0
    errors, moving = [], []
    for command in commands(planned.trajectory, times, setpoints):
        wire.sleep(began + command.time)
        buses["body"].advance(wire.now())
        errors.append(physics.body.angles - command.angles)
        moving.append(np.abs(command.velocities) > 0.05 * robot.velocity_limits)
        driver.cycle(wiring.scale.ticks(command.setpoints)[hinges])
    off = np.abs(np.degrees(np.array(errors)))[np.array(moving)]
    assert np.sqrt(np.mean(off**2)) <= rmse
    assert np.percentile(off, 95) <= 2.5
    assert off.max() <= 5.0
