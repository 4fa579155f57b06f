"""A live server that writes down every goal with its moment, so that whoever stops it sees when the goals are still.

Started as a program, `python -m kinesic.bench.bml.witnessed_server FILE`; it serves the twin, as `kinesic serve` does.
"""

import asyncio
import sys
from pathlib import Path
from time import monotonic

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.controller.perform import set_up
from kinesic.serve.server import Address, open_serving, until_done
from kinesic.serve.sinks.real_time import RealTimeSink, RealTwin


class GoalRecorder:
    """A sink that writes the machine's monotonic time [s] and the goals [rad] of each command to a file."""

    def __init__(self, path: Path) -> None:
        """Begins an empty file."""
        self._file = path.open("wb", buffering=0)

    def write(self, command: Command, /) -> None:
        """Adds one command."""
        self._file.write(np.array([monotonic(), *command.goals]).tobytes())

    def close(self) -> None:
        """Closes the file."""
        self._file.close()


def read_goals(path: Path, joints: int, last: int) -> Floats:
    """Reads the last commands so far: (last, 1 + joints), the time [s] first."""
    size = 8 * (1 + joints)
    with path.open("rb") as file:
        whole = file.seek(0, 2) // size
        file.seek(max(0, whole - last) * size)
        return np.frombuffer(file.read(min(last, whole) * size)).reshape(-1, 1 + joints)


async def _serve(path: Path) -> None:
    sinks = [RealTimeSink(GoalRecorder(path)), RealTimeSink(RealTwin(set_up().robot))]
    address, folder = Address("127.0.0.1", 0), path.parent  # where clients may keep documents, too
    async with open_serving(set_up, sinks, address=address, folder=folder) as serving:
        print(f"listening at {serving.address}", file=sys.stderr, flush=True)  # noqa: T201 - a program of its own
        await until_done(serving, asyncio.Event(), console=True)


if __name__ == "__main__":
    asyncio.run(_serve(Path(sys.argv[1])))
