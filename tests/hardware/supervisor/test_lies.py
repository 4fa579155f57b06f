"""A servo that says the same nonsense again and again, each record with a right CRC, in the middle of a performance."""

from collections.abc import Callable

import numpy as np
import pytest

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.state_machine import Stage

Make = Callable  # of a desk, see conftest
LIAR, SECONDS = 2, 0.6


@pytest.mark.parametrize(
    ("register", "lie"),
    [
        (Register.PRESENT_POSITION, 1_000_000),
        (Register.PRESENT_POSITION, -(2**31)),
        (Register.PRESENT_POSITION, 3300),
        (Register.PRESENT_VELOCITY, 30_000),
        (Register.PRESENT_TEMPERATURE, 255),
        (Register.PRESENT_INPUT_VOLTAGE, 65_535),
        (Register.PRESENT_CURRENT, -32_768),
    ],
)
def test_nonsense_moves_nothing_and_is_told_once(
    desk: Make, monkeypatch: pytest.MonkeyPatch, register: Register, lie: int
):
    made = desk().active(6.0)
    liar = made.plant.servos[LIAR]
    honest = liar.read

    def lying(address: int, size: int) -> bytes:
        liar.electronics.show()
        liar.memory.put(register.field.address, register.field.pack(lie))
        return liar.memory.read(address, size)

    monkeypatch.setattr(liar, "read", lying)
    before, pace = made.true(Register.GOAL_POSITION), made.manifest.speeds * made.settings.period
    for _ in range(round(SECONDS / made.settings.period)):
        made.cycle()
        goals = made.true(Register.GOAL_POSITION)
        assert (np.abs(goals - before) <= 1.6 * pace + 2).all()
        assert np.abs(goals - made.here).max() <= 60
        before = goals
    assert made.status.scale == 0.0
    assert made.true(Register.TORQUE_ENABLE).all()
    assert sum(line.startswith("impossible") for line in made.kinds()) == 1
    monkeypatch.setattr(liar, "read", honest)
    made.until(Stage.ACTIVE, within=5.0)
