"""Opening of servos with one retry on a slow machine."""

import os
from pathlib import Path

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.settings import SupervisorSettings

BUS_NAMES = ("left", "right")
LATE_ERRORS = (  # parts of error messages that a slow machine can cause
    "no answer at",
    "no servo of ids",
    "no status packet",
    "answer too rarely",
)
MAX_TRIES = 4  # most attempts to open the servos


def open_servos(robot: Robot, folder: Path, *, settings: SupervisorSettings, log: Path) -> Servos:
    """Open servos with ports in a folder.

    The log contains only the successful opening.
    """
    ports = {name: folder / name for name in BUS_NAMES}
    for tries in range(1, MAX_TRIES + 1):
        st_size = log.stat().st_size if log.exists() else 0
        try:
            return Servos(robot, ports, settings=settings, log=log)
        except BusError as error:
            if tries == MAX_TRIES or not any(text in str(error) for text in LATE_ERRORS):
                raise
            os.truncate(log, st_size)
    raise AssertionError
