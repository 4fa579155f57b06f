"""Faults while the arms are raised: no limb with torque falls."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.controller.virtual_robot import TwinPhysics
from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.faults import PlannedFault
from kinesic.hardware.virtual.wiring import build_bus, describe_cables

from ....reduced_robots import write_robot
from ..conftest import PERIOD, Desk

RAISED_ANGLES = {"shoulder_flexion": 70.0, "elbow_flexion": 60.0}  # [deg] hinge angles of raised arms
RAISE_DURATION = 1.2  # [s] duration of the motion that raises the arms
MAX_DROOP = 8.0  # [deg] largest distance of a held limb from its goal
QUICK_SETTINGS = SupervisorSettings(patience=0.5, pace=1.5, slow=0.2)  # fast moves and short waits
OVERLOAD, ENCODER, VOLTAGE = (
    error.value for error in (HardwareError.OVERLOAD, HardwareError.ENCODER, HardwareError.VOLTAGE)
)


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """Return the default robot with arms only, so that the tests take less time."""
    return Robot.load(write_robot(tmp_path_factory.mktemp("robot"), "neck", "torso", "clavicles"))


def raised(robot: Robot, log: Path) -> Desk:
    """Raise both arms in the middle of a performance."""
    names, rest = robot.skeleton.names, robot.skeleton.rest
    there = rest.copy()
    for hinge, angle in RAISED_ANGLES.items():
        for side in "lr":
            there[names.index(f"{side}_{hinge}")] = np.radians(angle)

    def assemble(wires):
        return build_bus(wires, TwinPhysics(robot, wires))

    desk = Desk(Manifest.of(robot), describe_cables(robot), log, settings=QUICK_SETTINGS, assemble=assemble)
    desk.open()
    for k in range(1800):
        share = min(1.0, k * PERIOD / RAISE_DURATION)
        assert desk.channel.write(k * PERIOD, rest + share**3 * (10 - 15 * share + 6 * share**2) * (there - rest))
    desk.until(Stage.ACTIVE)
    desk.run(RAISE_DURATION + 0.3)
    return desk


@pytest.fixture
def arms(robot: Robot, tmp_path: Path) -> Iterator[Desk]:
    desk = raised(robot, tmp_path / "events.jsonl")
    yield desk
    desk.end()
    assert not desk.dropped


def behind(desk: Desk) -> float:
    """Return the largest goal error [deg] of servos with torque."""
    turns = np.abs([member.turns for member in desk.manifest.members])
    away = np.degrees(
        np.abs(desk.present_position - desk.true(Register.GOAL_POSITION)) / turns * Register.GOAL_POSITION.field.scale
    )
    return float(np.max(away[desk.true(Register.TORQUE_ENABLE) != 0], initial=0.0))


def follow(desk: Desk, *stages: Stage, within: float = 30.0) -> None:
    """Run until a stage, and check that no limb with torque falls."""
    began = desk.plant.time
    while desk.stage not in stages and not desk.supervisor.done:
        desk.cycle()
        assert behind(desk) < MAX_DROOP
        assert desk.plant.time - began < within, desk.kinds()[-12:]


def hinges_up(desk: Desk) -> set[str]:
    torque = desk.true(Register.TORQUE_ENABLE) != 0
    return {desk.manifest.members[k].hinge for k in np.flatnonzero(desk.raised & torque)}


def estop_then_nobody(desk: Desk) -> None:
    desk.channel.set("estop", 1)
    desk.run(0.1)
    desk.alive = False


def nobody(desk: Desk) -> None:
    desk.alive = False


def alert(bits: int, *hinges: str) -> Callable[[Desk], None]:
    def strike(desk: Desk) -> None:
        struck = tuple(member.id for member in desk.manifest.members if member.hinge in hinges)
        desk.expose(PlannedFault("alert", struck, value=bits))

    return strike


FAULTS_UNTIL_REST = {  # name -> fault after which the arms move to rest and lose torque
    "an emergency stop, then no planner": estop_then_nobody,
    "an elbow overloaded": alert(OVERLOAD, "l_elbow_flexion"),
    "no planner": nobody,
    "a shoulder overloaded": alert(OVERLOAD, "l_shoulder_flexion"),
    "both elbows overloaded": alert(OVERLOAD, "l_elbow_flexion", "r_elbow_flexion"),
    "a low supply": alert(VOLTAGE),
}
SAMPLED_COUNT = 1  # number of faults tested in every run; `make soak` tests all


@pytest.mark.parametrize(
    "strike",
    [
        pytest.param(strike, id=name, marks=[pytest.mark.soak] * (k >= SAMPLED_COUNT))
        for k, (name, strike) in enumerate(FAULTS_UNTIL_REST.items())
    ],
)
def test_torque_of_raised_arms_is_switched_off_only_after_the_arms_have_been_lowered(
    arms: Desk, strike: Callable[[Desk], None]
):
    assert {"l_shoulder_flexion", "r_shoulder_flexion"} <= hinges_up(arms)
    strike(arms)
    follow(arms, Stage.RELEASE)
    assert not hinges_up(arms)
    follow(arms, Stage.CLOSED)
    assert not arms.true(Register.TORQUE_ENABLE).any()


def test_immovable_raised_arm_is_held_until_a_person_confirms(arms: Desk):
    alert(ENCODER, "l_elbow_flexion")(arms)
    arms.run(0.5)
    arms.alive = False
    follow(arms, Stage.WAITING)
    assert hinges_up(arms) == {"l_shoulder_flexion", "l_elbow_flexion"}
    arms.run(2 * arms.settings.patience)
    assert arms.stage is Stage.WAITING
    assert behind(arms) < MAX_DROOP
    arms.channel.set("confirm", 1)
    follow(arms, Stage.CLOSED)
    assert not arms.true(Register.TORQUE_ENABLE).any()


OUTAGE_CASES = [  # kind of outage, duration [s]
    ("silent", 0.1),
    ("silent", 2.0),
    ("silent", 10.0),
    ("lost", 0.5),
    ("lost", 3.0),
    ("lost", 10.0),
    ("unplug", 0.3),
    ("unplug", 5.0),
]


@pytest.mark.soak
@pytest.mark.parametrize(("kind", "seconds"), OUTAGE_CASES)
def test_raised_arms_continue_without_a_resume_request_only_after_a_short_outage(arms: Desk, kind: str, seconds: float):
    arms.expose(PlannedFault(kind, seconds=seconds))
    for _ in range(round((seconds + 4.0) / PERIOD)):
        arms.cycle()
        assert behind(arms) < MAX_DROOP
    assert not arms.status.faulty
    assert (arms.status.waits == "consent") == (seconds > 1.0)
    assert arms.stage.runs == (seconds < 1.0)
