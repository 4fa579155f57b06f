"""Live server that records every goal with its timestamp.

A benchmark of the emergency stop reads from the record when the goals are still.

Run as a program, `python -m kinesic.bench.bml.witnessed_server FILE` serves the twin as `kinesic serve` does.
"""

import asyncio
import sys
from pathlib import Path
from time import monotonic

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.serve.address import Address
from kinesic.serve.server import open_serving, serve_until_done
from kinesic.serve.sinks.real_time import RealTimeSink, RealTwin
from kinesic.session.setup import set_up


class GoalRecorder:
    """Command output that writes timestamped servo goals to a file.

    A row holds the machine's monotonic time [s] and the goals [rad].
    """

    def __init__(self, path: Path) -> None:
        """Create the empty file for the servo goals."""
        self._file = path.open("wb", buffering=0)

    def write(self, command: Command, /) -> None:
        """Append the timestamp and servo goals of one command."""
        self._file.write(np.array([monotonic(), *command.setpoints]).tobytes())

    def close(self) -> None:
        """Close the file of servo goals."""
        self._file.close()


def read_goals(path: Path, joints: int, last: int) -> Floats:
    """Read the last recorded goals as rows (last, 1 + joints).

    Each row begins with its time [s].
    """
    size = 8 * (1 + joints)
    with path.open("rb") as file:
        whole = file.seek(0, 2) // size
        file.seek(max(0, whole - last) * size)
        return np.frombuffer(file.read(min(last, whole) * size)).reshape(-1, 1 + joints)


async def _serve(path: Path) -> None:
    sinks = [RealTimeSink(GoalRecorder(path)), RealTimeSink(RealTwin(set_up().robot))]
    address, folder = Address("127.0.0.1", 0), path.parent  # clients may save documents there
    async with open_serving(set_up, sinks, address=address, folder=folder) as serving:
        print(f"listening at {serving.address}", file=sys.stderr, flush=True)  # noqa: T201 - program output
        await serve_until_done(serving, asyncio.Event(), console=True)


if __name__ == "__main__":
    asyncio.run(_serve(Path(sys.argv[1])))
