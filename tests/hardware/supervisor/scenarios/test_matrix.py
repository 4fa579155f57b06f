"""Every fault of the matrix during a performance.

There is no exception, no jump, and no torque after the release.
"""

from collections.abc import Callable

import pytest

from kinesic.bench.bus.matrix import FAULT_START, FaultCase, list_cases
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.faults import BUILD_KINDS, FaultPlan, PlannedFault

Make = Callable  # of a desk, see conftest
REFUSED_FAULTS = {"duplicate id", "wrong model"}  # faults for which the supervisor refuses the servos
HELD_FAULTS = {"alert encoder"}  # faults after which the servo is not moved, as its position is unknown
SOAK_FAULTS = {  # faults similar to others that are tested in every run, tested only by `make soak`
    "calm",
    "corrupt 5%",
    "late 5%",
    "truncate 5%",
    "duplicate 5%",
    "noise 5%",
    "alert voltage",
    "alert overheating",
    "alert electrical_shock",
}
FEW_SERVOS = 3  # number of servos in tests of one fault: the faulty servo and two others
SERVO_COUNTS = (7, 14, 26)  # numbers of servos
BAUD_RATES = (57_600, 1_000_000, 4_000_000)  # [bit/s] baud rates
FAULT_SEEDS = (1, 2, 3)  # seeds of the random faults


def settings(count: int, baud: int) -> SupervisorSettings:
    """Return a period within the wire's limits and a sufficient watchdog."""
    period = max(0.01, 1.6 * ((36 + 28 * count) * 10 / baud + 0.001))
    watchdog = max(0.1, 10 * period)
    return SupervisorSettings(
        period=period,
        watchdog=watchdog,
        patient_watchdog=watchdog,
        lead=10 * period,
        patience=0.5,
        pace=3.0,
        hopeless=2.0,
    )


def struck(make: Make, case: FaultCase, count: int, baud: int, seed: int) -> None:
    """Run a whole performance under a fault."""
    built = FaultPlan(tuple(m for m in case.faults if m.kind in BUILD_KINDS), seed)
    later = tuple(m for m in case.faults if m.kind not in BUILD_KINDS)
    desk = make(count, baud=baud, faults=built, settings=settings(count, baud))
    desk.open()
    if case.name in REFUSED_FAULTS:
        assert desk.stage is Stage.CLOSED
        assert not desk.true(Register.TORQUE_ENABLE).any()
        return
    desk.perform(4.0)
    desk.channel.set("ended", 1)
    desk.until(Stage.ACTIVE)
    desk.buses["body"].expose(FaultPlan(later, seed))
    desk.run(FAULT_START + 0.8)
    desk.channel.set("release", 1)
    desk.until(Stage.CLOSED, Stage.WAITING, within=60.0)
    assert (desk.stage is Stage.WAITING) == (case.name in HELD_FAULTS)
    desk.channel.set("confirm", 1)
    desk.until(Stage.CLOSED, within=60.0)
    assert not desk.true(Register.TORQUE_ENABLE).any()
    assert desk.jumps
    assert max(desk.jumps) <= 2


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, id=case.name, marks=[pytest.mark.soak] * (case.name in SOAK_FAULTS))
        for case in list_cases()
        if "1%" not in case.name
    ],
)
def test_performance_of_few_servos_survives_each_bus_fault(crowd: Make, case: FaultCase):
    struck(crowd, case, FEW_SERVOS, 1_000_000, 1)


COMBINATIONS = [(count, baud, seed) for count in SERVO_COUNTS for baud in BAUD_RATES for seed in FAULT_SEEDS]


@pytest.mark.soak
@pytest.mark.parametrize(("count", "baud", "seed"), COMBINATIONS)
@pytest.mark.parametrize("case", list_cases(), ids=lambda case: case.name)
def test_performance_survives_each_bus_fault_with_several_servo_counts_and_baud_rates(
    crowd: Make, case: FaultCase, count: int, baud: int, seed: int
):
    struck(crowd, case, count, baud, seed)


@pytest.mark.parametrize("count", [5, pytest.param(20, marks=pytest.mark.soak)])
def test_servos_are_adopted_after_every_port_outage(crowd: Make, count: int):
    desk = crowd(FEW_SERVOS)
    desk.open()
    desk.perform(100.0)
    desk.until(Stage.ACTIVE)
    for k in range(count):
        desk.expose(PlannedFault("unplug", seconds=0.02 * (k + 1)))
        desk.until(Stage.LOST)
        desk.until(Stage.ACTIVE)
        assert desk.true(Register.TORQUE_ENABLE).all()
    desk.channel.set("release", 1)
    desk.until(Stage.CLOSED)
    assert not desk.true(Register.TORQUE_ENABLE).any()


@pytest.mark.parametrize("count", [3, pytest.param(20, marks=pytest.mark.soak)])
def test_supervisor_started_after_a_killed_supervisor_continues_with_torque_and_ends_normally(crowd: Make, count: int):
    desk = crowd(FEW_SERVOS)
    for _ in range(count):
        desk.open()
        desk.perform(3.0)
        desk.until(Stage.ACTIVE)
        desk.run(0.2)
        desk.pass_time(0.4)
        assert desk.true(Register.TORQUE_ENABLE).all()
        desk.start()
    desk.open()
    desk.channel.set("ended", 1)
    desk.until(Stage.CLOSED)
    assert not desk.true(Register.TORQUE_ENABLE).any()
    assert max(desk.jumps) <= 2
