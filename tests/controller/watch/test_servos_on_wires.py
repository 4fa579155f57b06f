"""Folded hands on servos whose P gain is wrong: they touch, unless somebody watches: on kinesic's servos and others."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.servo import follow_lags
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.perform import plan
from kinesic.controller.play import command_times, commands
from kinesic.controller.servo_performance import watch_of
from kinesic.controller.virtual_robot import TwinPhysics
from kinesic.controller.watch.clearance import RESERVE
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.faults import PlannedFault
from kinesic.hardware.virtual.wiring import build_bus, cables
from kinesic.planning.plan import Plan
from kinesic.sim.servo_factors import Factors

from ...hardware.manual.adapter import build_manual
from ...hardware.supervisor.conftest import Desk
from ...manual_servo.motion import Pid
from ...performances import BLOCK

FOLDED = 0.9  # [s] of the performance, in which the hands come together
LEFT = RESERVE - 0.05  # of the clearance that a robot asks for: what stays after all
BRIEF = SupervisorSettings(patience=1.0, pace=1.5)
SPOILED = (PlannedFault("drop", rate=0.02), PlannedFault("late", rate=0.02), PlannedFault("lost", rate=0.02))


@dataclass
class SoftPid(Pid):
    """Position control whose P is not what its register says."""

    share: float = 1.0

    def step(self, error: float, gains: tuple[int, int, int], limit: float) -> float:
        """Returns the PWM for an error."""
        return super().step(self.share * error, gains, limit)


@dataclass(frozen=True)
class Watched:
    """What became of it."""

    distances: Floats  # [m] in each cycle in which time ran
    least_pace: float
    performed: float  # share
    stage: Stage


@pytest.fixture(scope="module")
def pleading(known) -> Plan:
    return plan(BLOCK.format('<gesture id="g" lexeme="plead" start="0.1" stroke="0.7" end="1.5"/>'), known)


def soft_desk(planned: Plan, log: Path, gain: float, servos: str) -> Desk:
    robot = planned.setup.robot

    def assemble(wires):
        if servos == "kinesic":
            return build_bus(wires, TwinPhysics(robot, wires, factors=Factors(gain=gain)))
        plant, buses = build_manual(wires)
        for each in plant.servos:
            each.device.firmware.pid = SoftPid(share=gain)
        return plant, buses

    return Desk(Manifest.of(robot), cables(robot), log, settings=BRIEF, servos=servos, assemble=assemble)


def performed(
    planned: Plan,
    log: Path,
    *,
    gain: float,
    watched: bool,
    servos: str,
    faults: Sequence[PlannedFault] = (),
    seconds: float = np.inf,
) -> Watched:
    """Performs it, or so many seconds of it."""
    known, robot = planned.setup, planned.setup.robot
    desk = soft_desk(planned, log, gain, servos)
    desk.open()
    times, lags = command_times(planned.duration), follow_lags(robot.drives)
    # nothing weighs on the manual's servos: load that is led would lift them
    leading = FeedForward(robot, known.dynamics, delay=0.002, terms="full" if servos == "kinesic" else "lag")
    for each in commands(planned.trajectory, times, leading.lead(planned.trajectory, times)):
        assert desk.channel.write(each.time, each.goals, lags * each.speeds)
    desk.channel.set("ended", 1)
    watch, angles, pace = watch_of(planned), [], 1.0
    desk.until(Stage.ACTIVE)
    desk.expose(*faults)
    for _ in range(1500):
        desk.cycle()
        if watched and watch.see(desk.channel.history()):
            desk.channel.slow_to(watch.pace)
            pace = min(pace, watch.pace)
            if watch.over:
                desk.channel.stop("hold")
        angles.append(desk.manifest.angles(desk.here.astype(float)))
        if desk.stage not in (Stage.ACTIVE, Stage.DEGRADED) or desk.status.time > seconds:
            break
    desk.end()
    share = desk.status.time / times[-1]
    return Watched(known.distances.clearance(np.array(angles)).distances, pace, share, desk.stage)


def test_hands_that_would_touch_are_slowed_down_and_keep_the_reserve(pleading, tmp_path):
    free, seen = (
        performed(pleading, tmp_path / "log", gain=0.5, watched=watched, servos="kinesic", seconds=seconds)
        for watched, seconds in ((False, FOLDED), (True, np.inf))
    )
    assert free.distances.min() < 0.0
    assert seen.distances.min() > 0.8 * pleading.setup.robot.least_clearance
    assert seen.least_pace < 0.5
    assert seen.performed == pytest.approx(1.0)


@pytest.mark.soak
def test_it_keeps_the_hands_of_other_servos_apart_too(pleading, tmp_path):
    """Nothing weighs on them, so that they only lag."""
    free, seen = (
        performed(pleading, tmp_path / "log", gain=0.3, watched=watched, servos="manual", seconds=FOLDED)
        for watched in (False, True)
    )
    least = pleading.setup.robot.least_clearance
    assert free.distances.min() < 0.6 * least
    assert seen.distances.min() > 0.8 * least
    assert seen.least_pace < 0.5
    assert seen.performed * pleading.duration > FOLDED - 0.2


@pytest.mark.parametrize("servos", [pytest.param("kinesic", marks=pytest.mark.soak), "manual"])
def test_records_that_are_late_or_missing_do_not_blind_it(pleading, tmp_path, servos):
    log = tmp_path / "log"
    seen = performed(pleading, log, gain=0.4, watched=True, servos=servos, faults=SPOILED, seconds=FOLDED)
    assert seen.distances.min() > LEFT * pleading.setup.robot.least_clearance
    assert seen.least_pace < 0.5


def test_servos_as_described_are_not_slowed(pleading, tmp_path):
    seen = performed(pleading, tmp_path / "log", gain=1.0, watched=True, servos="kinesic", seconds=FOLDED)
    assert seen.least_pace == 1.0
    assert seen.performed * pleading.duration > FOLDED - 0.2


@pytest.mark.soak
def test_where_slowing_does_not_help_they_stop_before_contact(pleading, tmp_path):
    seen = performed(pleading, tmp_path / "log", gain=0.2, watched=True, servos="kinesic")
    assert seen.stage is Stage.STOPPED
    assert seen.performed < 0.9
    assert seen.distances.min() > LEFT * pleading.setup.robot.least_clearance
