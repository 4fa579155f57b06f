import numpy as np
import pytest

from kinesic.hardware.bus.cycle import BLOCK
from kinesic.hardware.supervisor.monitor import STUCK, LoadRatings, LoadState, derate, update_load

STRENGTH = LoadRatings(
    celsius=np.array([80.0, 80.0]), current=np.array([1000.0, 1000.0]), full=np.array([140.0, 140.0])
)
STILL = np.zeros(2)


def records(*, current: int = 0, celsius: int = 30, position: int = 0, velocity: int = 0, torque: int = 1):
    blocks = np.zeros(2, dtype=BLOCK)
    blocks["temperature"] = 30
    for name, value in (("current", current), ("temperature", celsius), ("position", position), ("velocity", velocity)):
        blocks[name][1] = value
    blocks["torque"] = torque
    return blocks


def after(seconds: float, **what: int) -> LoadState:
    load = LoadState.none(2)
    for k in range(round(seconds * 100) + 1):
        load = update_load(load, records(**what), np.full(2, 0.01 * k), STILL, STRENGTH)
    return load


def test_a_servo_at_ease_slows_nothing():
    assert derate(after(60.0, current=300), records(current=300), STRENGTH).tolist() == [1.0, 1.0]


def test_full_current_for_seconds_slows_and_then_stops():
    scales = [derate(after(seconds, current=-1000), records(), STRENGTH)[1] for seconds in (1.0, 9.0, 20.0)]
    assert scales[0] == 1.0
    assert 0.0 < scales[1] < 1.0
    assert scales[2] == 0.0


def test_work_is_forgotten():
    tired = after(20.0, current=1000)
    for k in range(1000):
        tired = update_load(tired, records(), np.full(2, 21.0 + 0.01 * k), STILL, STRENGTH)
    assert derate(tired, records(), STRENGTH)[1] == 1.0


@pytest.mark.parametrize(("celsius", "scale"), [(60, 1.0), (70, 1.0), (74, 3 / 7), (77, 0.0), (79, 0.0)])
def test_heat_slows_before_the_servo_shuts_down(celsius: int, scale: float):
    assert derate(LoadState.none(2), records(celsius=celsius), STRENGTH) == pytest.approx([1.0, scale])


def test_a_servo_far_from_its_goal_that_does_not_move_is_stuck():
    assert after(STUCK + 0.02, position=200).stuck.tolist() == [False, True]
    assert not after(STUCK + 0.02, position=100).stuck.any()
    assert not after(STUCK + 0.02, position=200, velocity=20).stuck.any()
    assert not after(STUCK + 0.02, position=200, torque=0).stuck.any()
    assert not after(STUCK - 0.05, position=200).stuck.any()
