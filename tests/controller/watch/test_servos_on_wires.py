"""Clearance watch of servos with a wrong P gain and close hands."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.servo import tracking_lags
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.play import commands
from kinesic.controller.servo_performance import make_clearance_watch
from kinesic.controller.virtual_robot import TwinPhysics
from kinesic.controller.watch.clearance import RESERVE_FRACTION
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.faults import PlannedFault
from kinesic.hardware.virtual.wiring import build_bus, describe_cables
from kinesic.planning.plan import Plan
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.servo_factors import Factors

from ...hardware.manual.adapter import build_manual
from ...hardware.supervisor.conftest import Desk
from ...manual_servo.motion import Pid
from ...performances import BLOCK_BML
from ...reduced_robots import write_robot

FOLDING_TIME = 0.9  # [s] performance time at which the hands meet
MIN_REMAINING_FRACTION = RESERVE_FRACTION - 0.05  # smallest clearance during the run / required clearance
SHORT_PATIENCE = SupervisorSettings(patience=1.0, pace=1.5)
# Gesture whose palms move up and down, closer to one another than the clearance of servos with soft position control.
JOINED_PALMS = 'palm = "in", pointing = "forward up", shape = "flat", openness = 0.2, touch = "hand", tip = "palm"'
JOINED_PATH = '{ kind = "wave", amplitude = [0, 0.05, 0.05], frequency = [1, 3, 3] }'
JOINED_HANDS = f"""category = "emotion"

[[gesture]]
id = "joined"
says = "The joined hands shake."
keys = [
  {{ both = {{ at = [0.065, 0.30, 0.50], {JOINED_PALMS} }} }},
  {{ both = {{ at = [0.065, 0.32, 0.54], {JOINED_PALMS} }}, path = {JOINED_PATH} }},
]
"""
# Gesture whose fists circle around one another: a lag makes the circles smaller, until the fists touch.
FIST = 'palm = "back", pointing = "in", shape = "fist", openness = 0'
FRONT_FIST, BACK_FIST = (f"at = [0.05, 0.3, {forward}], {FIST}" for forward in (0.62, 0.38))
ROLLING = 'kind = "circle", amplitude = [0, 0.12, 0.12], frequency = [2, 2, 2]'
FRONT_PATH, BACK_PATH = (
    f"path = {{ {ROLLING}, shift = [0, {up}, {forward}] }}" for up, forward in ((0, 0.25), (0.5, 0.75))
)
ROLLING_FISTS = f"""category = "metaphoric"

[[gesture]]
id = "rolling"
says = "The fists roll around one another."
keys = [
  {{ right = {{ {FRONT_FIST} }}, left = {{ {BACK_FIST} }} }},
  {{ right = {{ {FRONT_FIST}, {FRONT_PATH} }}, left = {{ {BACK_FIST}, {BACK_PATH} }} }},
]
"""
ROLLING_TIME = 1.1  # [s] performance time at which the fists have rolled around one another
READING_FAULTS = (PlannedFault("drop", rate=0.02), PlannedFault("late", rate=0.02), PlannedFault("lost", rate=0.02))


@dataclass
class SoftPid(Pid):
    """Position controller whose P gain differs from its register."""

    share: float = 1.0

    def step(self, error: float, gains: tuple[int, int, int], limit: float) -> float:
        """Return the PWM for an error."""
        return super().step(self.share * error, gains, limit)


@dataclass(frozen=True)
class Watched:
    """Result of a watched performance."""

    distances: Floats  # [m] clearance in each cycle in which performance time ran
    min_pace: float
    performed: float  # fraction of the plan that was performed
    stage: Stage


def plan_arms(folder: Path, lexeme: str, gestures: str) -> Plan:
    """Plan a gesture for the arms alone, which saves time."""
    lexicon = folder / "gestures.toml"
    lexicon.write_text(gestures)
    setup = set_up(write_robot(folder, "neck", "torso"), lexicon=lexicon)
    return plan(BLOCK_BML.format(f'<gesture id="g" lexeme="{lexeme}" start="0.1" stroke="0.7" end="1.5"/>'), setup)


@pytest.fixture(scope="module")
def pleading(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    return plan_arms(tmp_path_factory.mktemp("robot"), "joined", JOINED_HANDS)


@pytest.fixture(scope="module")
def rolling(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    return plan_arms(tmp_path_factory.mktemp("robot"), "rolling", ROLLING_FISTS)


def soft_desk(planned: Plan, log: Path, gain: float, servos: str) -> Desk:
    robot = planned.setup.robot

    def assemble(wires):
        if servos == "kinesic":
            return build_bus(wires, TwinPhysics(robot, wires, factors=Factors(gain=gain)))
        plant, buses = build_manual(wires)
        for servo in plant.servos:
            servo.device.firmware.pid = SoftPid(share=gain)
        return plant, buses

    return Desk(
        Manifest.of(robot), describe_cables(robot), log, settings=SHORT_PATIENCE, servos=servos, assemble=assemble
    )


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
    """Perform the plan, or its first seconds."""
    known, robot = planned.setup, planned.setup.robot
    desk = soft_desk(planned, log, gain, servos)
    desk.open()
    times, lags = planned.command_times, tracking_lags(robot.drives)
    # nothing weighs on the manual's servos: load that is led would lift them
    leading = FeedForward(robot, known.dynamics, delay=0.002, terms="full" if servos == "kinesic" else "lag")
    for command in commands(planned.trajectory, times, leading.compute_setpoints(planned.trajectory, times)):
        assert desk.channel.write(command.time, command.setpoints, lags * command.velocities)
    desk.channel.set("ended", 1)
    watch, angles, pace = make_clearance_watch(planned), [], 1.0
    desk.until(Stage.ACTIVE)
    desk.expose(*faults)
    for _ in range(1500):
        desk.cycle()
        if watched and watch.ingest(desk.channel.history()):
            desk.channel.slow_to(watch.pace)
            pace = min(pace, watch.pace)
            if watch.over:
                desk.channel.stop("hold")
        angles.append(desk.manifest.angles(desk.present_position.astype(float)))
        if desk.stage not in (Stage.ACTIVE, Stage.DEGRADED) or desk.status.time > seconds:
            break
    desk.end()
    share = desk.status.time / times[-1]
    return Watched(known.distances.clearance(np.array(angles)).distances, pace, share, desk.stage)


def test_clearance_watch_slows_servos_and_keeps_hands_from_touching(pleading, tmp_path):
    free, seen = (
        performed(pleading, tmp_path / "log", gain=0.3, watched=watched, servos="kinesic", seconds=seconds)
        for watched, seconds in ((False, FOLDING_TIME), (True, np.inf))
    )
    assert free.distances.min() < 0.6 * pleading.setup.robot.min_clearance
    assert seen.distances.min() > 0.7 * pleading.setup.robot.min_clearance
    assert seen.min_pace < 0.5
    assert seen.performed == pytest.approx(1.0)


@pytest.mark.soak
def test_clearance_watch_keeps_hands_apart_on_lagging_servos(rolling, tmp_path):
    """These servos carry no load, so that they only lag."""
    free, seen = (
        performed(rolling, tmp_path / "log", gain=0.3, watched=watched, servos="manual", seconds=ROLLING_TIME)
        for watched in (False, True)
    )
    least = rolling.setup.robot.min_clearance
    assert free.distances.min() < 0.0
    assert seen.distances.min() > least
    assert seen.min_pace < 0.5
    assert seen.performed * rolling.duration > ROLLING_TIME - 0.2


@pytest.mark.soak
@pytest.mark.parametrize("servos", ["kinesic", "manual"])
def test_clearance_watch_keeps_hands_apart_despite_late_and_missing_readings(pleading, tmp_path, servos):
    log = tmp_path / "log"
    seen = performed(pleading, log, gain=0.45, watched=True, servos=servos, faults=READING_FAULTS, seconds=FOLDING_TIME)
    assert seen.distances.min() > MIN_REMAINING_FRACTION * pleading.setup.robot.min_clearance
    assert seen.min_pace < 0.5


@pytest.mark.soak
def test_clearance_watch_does_not_slow_servos_with_nominal_gain(pleading, tmp_path):
    seen = performed(pleading, tmp_path / "log", gain=1.0, watched=True, servos="kinesic", seconds=FOLDING_TIME)
    assert seen.min_pace == 1.0
    assert seen.performed * pleading.duration > FOLDING_TIME - 0.2


@pytest.mark.soak
def test_clearance_watch_stops_servos_before_contact_if_slowing_fails(pleading, tmp_path):
    seen = performed(pleading, tmp_path / "log", gain=0.2, watched=True, servos="kinesic")
    assert seen.stage is Stage.STOPPED
    assert seen.performed < 0.9
    assert seen.distances.min() > MIN_REMAINING_FRACTION * pleading.setup.robot.min_clearance
