"""Faults of servos with Protocol 1.0 frames during a performance.

There is no exception, no jump, and no torque after the release.
"""

from collections.abc import Callable

import pytest

from kinesic.bench.bus.matrix import FAULT_START, FaultCase, list_cases
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.faults import BUILD_KINDS, FaultPlan

Make = Callable  # of a desk, see conftest
SETTINGS = SupervisorSettings(patience=0.5, slow=0.2, pace=3.0, hopeless=2.0)
UNKNOWN_FAULTS = {"watchdog", "old firmware"}  # faults of a bus watchdog, which these families lack
REFUSED_FAULTS = {"duplicate id", "wrong model"}  # faults for which the supervisor refuses the servos
HELD_FAULTS = {"alert encoder"}  # faults after which the servo is not moved, as its position is unknown
QUICK_CASES = {"sts3215": {"mixed 6 x 2%", "reboot", "unplug", "duplicate id"}}
QUICK_CASES |= {"mx28": {"alert overload"}, "ax12": {"mixed 6 x 2%"}, "scs0009": {"corrupt 5%"}}


@pytest.fixture
def servos() -> str:
    """Return kinesic's virtual servos, because the independent ones are of the X series."""
    return "kinesic"


def struck(make: Make, case: FaultCase, model: str) -> None:
    """Run a whole performance of three servos under a fault."""
    built = FaultPlan(tuple(m for m in case.faults if m.kind in BUILD_KINDS), 1)
    later = tuple(m for m in case.faults if m.kind not in BUILD_KINDS)
    desk = make(3, faults=built, settings=SETTINGS, model=model)
    desk.open()
    if case.name in REFUSED_FAULTS:
        assert desk.stage is Stage.CLOSED
        assert not desk.true(Register.TORQUE_ENABLE).any()
        return
    assert desk.stage is Stage.LIMP, desk.kinds()
    desk.perform(4.0)
    desk.channel.set("ended", 1)
    desk.until(Stage.ACTIVE)
    desk.buses["body"].expose(FaultPlan(later, 1))
    desk.run(FAULT_START + 0.8)
    desk.channel.set("release", 1)
    desk.until(Stage.CLOSED, Stage.WAITING, within=60.0)
    desk.channel.set("confirm", 1)
    desk.until(Stage.CLOSED, within=60.0)
    assert not desk.true(Register.TORQUE_ENABLE).any()
    assert desk.jumps
    assert max(desk.jumps) <= 4


@pytest.mark.parametrize(
    ("model", "case"),
    [
        pytest.param(model, case, id=f"{model} {case.name}", marks=[] if case.name in quick else [pytest.mark.soak])
        for model, quick in QUICK_CASES.items()
        for case in list_cases()
        if case.name not in UNKNOWN_FAULTS
    ],
)
def test_performance_on_each_servo_family_survives_each_bus_fault(crowd: Make, model: str, case: FaultCase):
    struck(crowd, case, model)


@pytest.mark.parametrize("model", ["sts3215", "ax12"])
def test_servos_without_a_watchdog_are_adopted_after_a_killed_supervisor(crowd: Make, model: str):
    desk = crowd(3, settings=SETTINGS, model=model)
    desk.open()
    desk.perform(3.0)
    desk.until(Stage.ACTIVE)
    desk.run(0.3)
    last_goals = desk.true(Register.GOAL_POSITION)
    desk.pass_time(1.0)
    assert desk.true(Register.TORQUE_ENABLE).all()
    assert abs(desk.present_position - last_goals).max() <= 3  # they hold the last goal after the supervisor's end
    desk.start()
    desk.open()
    desk.run(0.5)
    assert desk.true(Register.TORQUE_ENABLE).all()
    desk.channel.set("ended", 1)
    desk.until(Stage.CLOSED)
    assert not desk.true(Register.TORQUE_ENABLE).any()
    assert max(desk.jumps) <= 4
