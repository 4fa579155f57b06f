"""Servo that repeats nonsense with a valid CRC during a performance."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.state_machine import Stage

from ..conftest import Desk

Make = Callable  # of a desk, see conftest
WRONG_SERVO = 2  # index of the servo with a false value
FAULT_DURATION = 0.6  # [s] duration of the false value


@contextmanager
def lying(made: Desk, register: Register, lie: int) -> Iterator[None]:
    """Make one servo report a false value."""
    servo, (start, end) = made.plant.servos[WRONG_SERVO], (register.field.address, register.field.end)
    if made.servos == "manual":
        tampers = servo.device.firmware.tampers
        tampers.append(lambda memory: memory.bytes.__setitem__(slice(start, end), register.field.pack(lie)))
        yield
        tampers.clear()
        return

    def read(address: int, size: int) -> bytes:
        servo.electronics.show()
        servo.memory.put(start, register.field.pack(lie))
        return servo.memory.read(address, size)

    servo.read = read
    yield
    del servo.read


@pytest.mark.parametrize(
    ("register", "lie"),
    [
        (Register.PRESENT_POSITION, 1_000_000),
        pytest.param(Register.PRESENT_POSITION, -(2**31), marks=pytest.mark.soak),
        (Register.PRESENT_POSITION, 3300),
        (Register.PRESENT_VELOCITY, 30_000),
        pytest.param(Register.PRESENT_TEMPERATURE, 255, marks=pytest.mark.soak),
        (Register.PRESENT_INPUT_VOLTAGE, 65_535),
        (Register.PRESENT_CURRENT, -32_768),
    ],
)
def test_impossible_register_values_stop_the_performance_without_a_jump_and_are_reported_once(
    desk: Make, register: Register, lie: int
):
    made = desk().active(6.0)
    before, pace = made.true(Register.GOAL_POSITION), made.manifest.velocities * made.settings.period
    with lying(made, register, lie):
        for _ in range(round(FAULT_DURATION / made.settings.period)):
            made.cycle()
            goals = made.true(Register.GOAL_POSITION)
            assert (np.abs(goals - before) <= 1.6 * pace + 2).all()
            before = goals
        assert np.abs(goals - made.present_position).max() <= 10
        assert made.status.scale == 0.0
        assert made.true(Register.TORQUE_ENABLE).all()
        assert sum(line.startswith("impossible") for line in made.kinds()) == 1
    made.until(Stage.ACTIVE, within=5.0)
