"""Safety observer: each rule is reported when the test breaks it."""

from collections.abc import Iterator

import numpy as np
import pytest

from kinesic.hardware.protocol.registers import Register

from ...manual_servo import packet as p
from ..conftest import BUILDERS
from .drill import Drill, drill

SHOULDER, ELBOW = 2, 3  # ids on both wires


@pytest.fixture(scope="module", params=list(BUILDERS))
def standing(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Drill]:
    """Robot with raised arms for all tests of this file."""
    made = drill(request.param, tmp_path_factory.mktemp("drill"))
    made.raise_arms()
    assert made.observer.broken == []
    yield made
    made.end()


@pytest.fixture
def raised(standing: Drill) -> Drill:
    """Robot with raised arms, without violations recorded in earlier tests."""
    standing.run(0.2)
    standing.observer.watching = False
    standing.observer.broken.clear()
    return standing


def say(made: Drill, register: Register, value: int, *, bus: str = "left", servo: int = SHOULDER) -> None:
    """Write to a servo without the supervisor's knowledge."""
    field = register.field
    parameters = field.address.to_bytes(2, "little") + field.pack(value)
    made.wires[bus].write(p.instruct(servo, p.WRITE, parameters))


def test_safety_observer_reports_nothing_for_raised_arms_without_faults(raised: Drill):
    raised.run(1.0)
    assert raised.observer.broken == []
    assert (np.abs(raised.observer.angles(raised.present_position.astype(float)))[[1, 2, 4, 5]] > np.radians(50)).all()


def test_safety_observer_accepts_a_goal_moved_to_the_servo_position(raised: Drill):
    say(raised, Register.GOAL_POSITION, 2048)
    count = len(raised.observer.broken)
    here = int(raised.present_position[1])
    say(raised, Register.GOAL_POSITION, here)
    assert len(raised.observer.broken) == count == 1
    say(raised, Register.GOAL_POSITION, here + 100)
    assert len(raised.observer.broken) == 2


def test_safety_observer_reports_a_wrongly_estimated_joint_angle(raised: Drill):
    believed = raised.status.angles.copy()
    believed[1] += 0.2
    raised.observer.look(raised.plant.time, believed, np.full(len(believed), raised.plant.time))
    assert any("is believed at" in line for line in raised.observer.broken)


def test_safety_observer_reports_unconfirmed_motion_after_a_long_standstill(raised: Drill):
    observer = raised.observer
    observer.watching = True
    for _ in range(150):  # looks without a cycle: nothing moves
        raised.pass_time(0.01)
        observer.look(raised.plant.time, raised.status.angles, raised.status.taken)
    assert observer.broken == []
    up = raised.status.setpoints[1] + 0.1
    say(raised, Register.GOAL_POSITION, round(2048 + up * 2048 / np.pi))
    observer.look(raised.plant.time, raised.status.angles, raised.status.taken)
    assert any("nobody has agreed" in line for line in observer.broken)


def test_safety_observer_reports_torque_loss_and_zero_power_and_goal_jumps_and_reboots(raised: Drill):
    say(raised, Register.TORQUE_ENABLE, 0)
    say(raised, Register.GOAL_PWM, 0, servo=ELBOW)
    say(raised, Register.GOAL_POSITION, 2048, bus="right")
    raised.wires["right"].write(p.instruct(ELBOW, p.REBOOT))
    texts = ("l_flexion: torque off at", "l_bend: power 0 at", "r_flexion: goal jumps", "r_bend: reboot at")
    for line, text in zip(raised.observer.broken, texts, strict=True):
        assert text in line
