"""Simulated person who turns hinges, observed through the servos' electronics."""

import numpy as np

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.virtual.hand_turning import KEY_TIMES, HandTurnedPhysics
from kinesic.hardware.virtual.wiring import build_bus, describe_cables, independent_motors

ROBOT = Robot.load()
SCALE = ServoMap.of(ROBOT).scale
HINGE_OF_SERVO = [k for k, servos in enumerate(ServoMap.of(ROBOT).servos) for _ in servos.ids]
HELD_SERVO = 11  # index of the servo with torque


def turned(held: int | None = None) -> np.ndarray:
    """Turn all hinges by hand, and return angles [deg] at 20 Hz."""
    wires = describe_cables(ROBOT, np.zeros(len(ROBOT.skeleton.hinges)))
    physics = HandTurnedPhysics(independent_motors(wires), ROBOT, wires)
    plant, _ = build_bus(wires, physics)
    if held is not None:
        plant.servos[held].write(Register.TORQUE_ENABLE.field.address, b"\1")
    plant.advance(1.0)
    physics.turn()
    rows = []
    while not rows or physics.is_turning:
        plant.advance(plant.time + 0.05)
        rows.append([servo.electronics.present_position() for servo in plant.servos])
    ticks = np.array(rows)
    return np.degrees((ticks - SCALE.zeros[HINGE_OF_SERVO]) * (2 * np.pi / 4096) / SCALE.turns[HINGE_OF_SERVO])


def test_simulated_person_turns_each_hinge_to_its_upper_limit_before_its_lower_limit():
    angles = turned()
    upper, lower = np.degrees(ROBOT.skeleton.upper[HINGE_OF_SERVO]), np.degrees(ROBOT.skeleton.lower[HINGE_OF_SERVO])
    assert len(angles) * 0.05 - KEY_TIMES[-1] < 0.1
    assert np.all(angles[9] > 5.0)
    assert np.all(np.abs(angles.max(0) - upper) < 1.0)
    assert np.all(np.abs(angles.min(0) - lower) < 1.0)
    assert np.all(angles.argmax(0) < np.where(lower < -1.0, angles.argmin(0), len(angles)))
    assert np.all(np.abs(angles[-1]) < 1.5)


def test_simulated_person_does_not_turn_a_servo_with_torque():
    angles = turned(HELD_SERVO)
    assert np.ptp(angles[:, HELD_SERVO]) < 0.2
    assert np.all(np.ptp(np.delete(angles, HELD_SERVO, axis=1), axis=0) > 10.0)
