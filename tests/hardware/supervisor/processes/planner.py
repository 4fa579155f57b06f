"""Planner program that writes a motion continuously or all at once.

A continuous motion is written 0.7 s ahead.
"""

import sys
import time
from pathlib import Path

import numpy as np

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.hardware.supervisor.settings import SupervisorSettings

from .opening import open_servos

QUICK_SETTINGS = SupervisorSettings(pace=3.0, patience=1.0)  # fast moves and a short wait for commands


def main(robot: Robot, folder: Path, log: Path, seconds: float | None) -> None:
    servos = open_servos(robot, folder, settings=QUICK_SETTINGS, log=log)
    rest, tick, still = robot.skeleton.rest, 0, np.zeros(len(robot.skeleton.rest))
    while seconds is None or tick * 0.01 < seconds:
        time.sleep(0.02)
        now = servos.state().time
        while tick * 0.01 < (seconds or (0.0 if np.isnan(now) else now) + 0.7):
            goals = rest + 0.3 * (1 - np.cos(2 * tick * 0.01))
            servos.write(Command(tick * 0.01, goals, still, still, goals))
            tick += 1
    servos.close()


if __name__ == "__main__":
    main(
        Robot.load(Path(sys.argv[1])),
        Path(sys.argv[2]),
        Path(sys.argv[3]),
        float(sys.argv[4]) if sys.argv[4:] else None,
    )
