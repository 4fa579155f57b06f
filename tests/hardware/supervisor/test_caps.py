"""Caps of velocity and power, written to virtual servos of every family."""

from collections.abc import Callable, Mapping
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import VELOCITY_UNIT, Register
from kinesic.hardware.supervisor.caps import CAP_WRITES, CapWriter, ServoCaps
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.faults import PlannedFault

from .conftest import MODEL, Desk, manifest_of

Make = Callable  # of a desk, see conftest
PWM, PROFILE = Register.GOAL_PWM, Register.PROFILE_VELOCITY
FULL = 885  # value of GOAL_PWM at full power


def caps(count: int, velocity: float = 2.0, duty: float = 0.4, holding: float = 0.2) -> ServoCaps:
    return ServoCaps(*(np.full(count, value) for value in (velocity, duty, holding)))


class Rig:
    """Cap writer of two servos, with their writes in each cycle."""

    def __init__(self) -> None:
        manifest = manifest_of(2, 1_000_000)
        self.writer = CapWriter(manifest, [{Register.PWM_LIMIT: FULL}, {Register.PWM_LIMIT: 700}])
        self.monitor = SimpleNamespace(
            energised=np.array([True, True]), holding_joints=frozenset[int](), limit_power=lambda duties: None
        )
        self.steering = SimpleNamespace(set_profile_velocities=lambda velocities: None)
        self.puts: list[tuple[Register, Mapping[int, int]]] = []

    def take(self, new: ServoCaps) -> None:
        self.writer.take(new, self.monitor, self.steering)

    def write(self, *, braking: bool = False, seconds: float = 0.01) -> dict[Register, Mapping[int, int]]:
        axes = SimpleNamespace(put=lambda register, values: self.puts.append((register, values)))
        self.puts.clear()
        self.writer.write(axes, self.monitor, seconds=seconds, braking=braking)
        return {register: values for register, values in self.puts if values}


def test_no_register_is_written_without_caps():
    rig = Rig()
    assert rig.write(braking=True) == {}
    assert rig.writer.power.tolist() == [FULL, 700]


def test_caps_are_written_in_two_cycles_and_again_only_when_they_change():
    rig = Rig()
    rig.take(caps(2))
    expected = {PROFILE: dict.fromkeys((0, 1), 84), PWM: dict.fromkeys((0, 1), 354)}
    assert [rig.write() for _ in range(CAP_WRITES + 1)] == [expected] * CAP_WRITES + [{}]
    rig.take(caps(2))
    assert rig.write() == {}
    rig.take(caps(2, duty=0.9))
    assert rig.write()[PWM] == {0: 797, 1: 700}


def test_servos_without_torque_get_their_caps_when_torque_is_on():
    rig = Rig()
    rig.monitor.energised = np.array([True, False])
    rig.take(caps(2))
    assert [set(values) for values in rig.write().values()] == [{0}, {0}]
    rig.write()
    rig.monitor.energised = np.array([True, True])
    assert [set(values) for values in rig.write().values()] == [{1}, {1}]
    rig.writer.forget()
    assert rig.write()[PWM] == {0: 354, 1: 354}


def test_servos_have_full_power_during_a_quick_stop_and_a_moment_after_it():
    rig = Rig()
    rig.take(caps(2))
    rig.write()
    assert rig.write(braking=True)[PWM] == {0: FULL, 1: 700}
    assert rig.write(seconds=0.2)[PWM] == {0: FULL, 1: 700}
    assert rig.write(seconds=0.2)[PWM] == {0: 354, 1: 354}


def test_chain_that_holds_after_a_failure_gets_only_the_power_that_holds_it():
    rig = Rig()
    rig.take(caps(2))
    rig.write()
    rig.monitor.holding_joints = frozenset({1})
    assert rig.write(braking=True)[PWM] == {0: FULL, 1: 177}


@pytest.mark.parametrize("servos", ["kinesic"])  # the independent servos are of the X series
@pytest.mark.parametrize("model", [MODEL, "sts3215", "scs0009", "ax12", "mx28"])
def test_servos_of_each_family_are_capped_while_they_perform(crowd: Make, model: str):
    made: Desk = crowd(2, model=model)
    made.channel.write_caps(caps(2))
    made.active(1.0)
    sheet = SERVO_MODELS[model]
    velocity = made.true(PROFILE) * VELOCITY_UNIT
    assert velocity == pytest.approx(2.0, rel=0.06)
    assert made.true(PWM).tolist() == ([sheet.quantise(PWM, 354)] * 2 if sheet.has(PWM) else made.true(PWM).tolist())


def test_rebooted_servo_is_capped_again_and_the_performance_goes_on(crowd: Make):
    made: Desk = crowd(2)
    made.channel.write_caps(caps(2))
    made.active(2.0)
    made.expose(PlannedFault("reboot", (2,)))
    made.run(0.3)
    assert made.true(PWM)[1] != 354
    made.until(Stage.ACTIVE, within=3.0)
    made.run(0.05)
    assert made.true(PWM).tolist() == [354, 354]
    assert made.true(PROFILE).tolist() == [84, 84]


def test_blocked_servo_counts_as_stuck_at_the_error_of_its_capped_power(crowd: Make):
    made: Desk = crowd(1)
    made.channel.write_caps(caps(1, duty=0.3, holding=0.1))
    made.open()
    made.perform(2.0, amplitude=0.15)
    made.until(Stage.ACTIVE)
    made.plant.physics.jammed[0] = True
    made.run(1.5)
    assert made.stage is not Stage.ACTIVE
    assert any("failed" in line for line in made.kinds())
    assert made.true(PWM).tolist() == [89]
    assert np.abs(made.true(Register.GOAL_POSITION) - made.present_position).max() <= 1
