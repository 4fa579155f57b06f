"""Opens the servos of a table, once more where this machine did not let them answer in time."""

import os
from pathlib import Path

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.settings import SupervisorSettings

BUSES = ("left", "right")
LATE = ("no answer at", "no servo of ids", "no status packet", "answers too rarely")  # what servos are said to be then
TRIES = 4


def open_servos(robot: Robot, folder: Path, *, settings: SupervisorSettings, log: Path) -> Servos:
    """Returns servos whose ports are in a folder; the log tells of the opening that succeeded alone.

    Raises:
        BusError: they do not open for another reason, or were late each time.
    """
    ports = {name: folder / name for name in BUSES}
    for tries in range(1, TRIES + 1):
        told = log.stat().st_size if log.exists() else 0
        try:
            return Servos(robot, ports, settings=settings, log=log)
        except BusError as error:
            if tries == TRIES or not any(text in str(error) for text in LATE):
                raise
            os.truncate(log, told)
    raise AssertionError
