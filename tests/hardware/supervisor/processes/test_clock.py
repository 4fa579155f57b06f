"""Jumps of the time of day by an hour do not affect the motion."""

import json
import shutil
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.state_machine import Stage

pytestmark = [pytest.mark.realtime, pytest.mark.soak]  # every run: tests/hardware/test_clocks.py

HERE = Path(__file__).parent
CLOCK_JUMP = 3600  # [s] size of the clock jump
MOTION_DURATION = 1.8  # [s] duration of the compared motion
MAX_DELAY = 0.1  # [s] largest delay of cycles at which the supervisor does not slow the performance
MAX_VELOCITY = 0.6  # [rad/s] largest joint velocity of the planner's motion
MOTION_AMPLITUDE = 0.3  # [rad] amplitude of the planner's motion


@pytest.fixture(scope="module")
def jumping_clock(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build a preloadable library that shifts the time of day."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler: the time of day of a process cannot be moved")
    library = tmp_path_factory.mktemp("clock") / "jumping_clock.so"
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", library, HERE / "jumping_clock.c"], check=True)
    return library


def test_wall_clock_jump_changes_no_goal_and_no_end_time(rig, robot: Robot, jumping_clock: Path, tmp_path: Path):
    offset = tmp_path / "clock"
    offset.write_bytes(bytes(8))
    planner = rig.planner(str(MOTION_DURATION), LD_PRELOAD=str(jumping_clock), KINESIC_CLOCK=str(offset))
    for jump in (CLOCK_JUMP, -CLOCK_JUMP):
        time.sleep(0.4)
        with offset.open("r+b") as file:  # in place: it is mapped
            file.write(jump.to_bytes(8, "little", signed=True))
    assert planner.wait(60.0) == 0
    lines = [json.loads(line) for line in rig.log.read_text().splitlines()]
    ahead = np.array([line["wall"] - line["time"] for line in lines])
    assert np.ptp(ahead) > CLOCK_JUMP - 60.0, "the clock has not jumped"
    assert (np.diff([line["time"] for line in lines]) >= 0.0).all()
    begun, ended = rig.entered(Stage.ACTIVE), rig.entered(Stage.FOLD)
    assert ended - begun > MOTION_DURATION - MAX_DELAY
    assert rig.entered(Stage.CLOSED) is not None
    if not any(line["kind"] in ("host", "paused") for line in lines):  # else the machine stood still, and time with it
        assert ended - begun < MOTION_DURATION + 1.0
        follows_the_plan(rig, robot, begun)


def follows_the_plan(rig, robot: Robot, begun: float) -> None:
    """Compare the servos' goals with the planner's setpoints over time."""
    record, manifest = rig.record(), Manifest.of(robot)
    rows = (record.times > begun + MAX_DELAY) & (record.times < begun + MOTION_DURATION - MAX_DELAY)
    sent = manifest.scale.angles(record.goals[rows]) - manifest.rest[manifest.joints]
    planned = MOTION_AMPLITUDE * (1 - np.cos(2 * (record.times[rows] - begun)))
    assert np.abs(sent - planned[:, None]).max() < MAX_VELOCITY * MAX_DELAY
