"""Entry point of the supervisor process, started by `Servos`.

`python -m kinesic.hardware.supervisor` reads from standard input, a pipe that the planner holds: the first line is the
order, and end of file means that the planner is gone.
"""

import gc
import os
import select
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import msgspec

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.hardware.bus.host import request_real_time
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.wire import Wire
from kinesic.hardware.supervisor.address import publish
from kinesic.hardware.supervisor.channel import Channel, map_memory, memory_size
from kinesic.hardware.supervisor.context import SupervisorContext
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import SupervisorOrder
from kinesic.hardware.supervisor.status import EventLog
from kinesic.hardware.supervisor.supervisor import Supervisor
from kinesic.host import ENDING_SIGNALS

REAL_TIME_PRIORITY = 20  # SCHED_FIFO priority of the supervisor, if the host grants it
EXIT_SUCCESS = 0  # Exit code after a normal end
EXIT_REFUSED = 2  # Exit code if the servos were refused


def supervise(order: SupervisorOrder, planner: Callable[[], bool], ended: Callable[[], bool]) -> int:
    """Run the supervisor until it has ended, and return the exit code.

    Args:
        order: robot, ports and settings.
        planner: returns whether the planner is alive.
        ended: returns whether a signal has requested the end since the last call.
    """
    manifest = Manifest.of(Robot.load(Path(order.robot)))
    joints = len(manifest.rest)
    channel = Channel(map_memory(order.memory, memory_size(joints)), joints)
    settings, journal = order.settings, EventLog(Path(order.log) if order.log else None)
    watchdog = settings.watchdog if request_real_time(REAL_TIME_PRIORITY) else settings.patient_watchdog

    def opens(bus: str) -> Wire:
        return SerialWire(order.ports[bus], manifest.bauds[bus])

    published_files: list[Path] = []

    def announce() -> None:
        published_files.extend(publish(order.ports.values(), order.memory, joints))

    context = SupervisorContext(opens, channel, planner, journal, announce)
    supervisor = Supervisor(manifest, context, settings, watchdog=watchdog)
    supervisor.open()
    refused = supervisor.done
    gc.collect()
    gc.freeze()
    due = supervisor.now()
    while not supervisor.done:
        if ended():
            channel.set("release", channel.word("release") + 1)
        supervisor.step()
        due += settings.period
        behind = supervisor.now() - due
        if behind > settings.period:
            supervisor.late += 1
            due += behind
        supervisor.sleep(due)
    for path in published_files:
        path.unlink(missing_ok=True)
    journal.close()
    return EXIT_REFUSED if refused else EXIT_SUCCESS


def main() -> int:
    """Read a `SupervisorOrder` from standard input, and run the supervisor."""
    terminated: list[int] = []

    def terminate(number: int, frame: FrameType | None) -> None:
        terminated.append(number)

    for number in ENDING_SIGNALS:
        signal.signal(number, terminate)
    line = _read_line(sys.stdin.fileno())
    try:
        order = msgspec.json.decode(line, type=SupervisorOrder)
        return supervise(order, PlannerPipe(sys.stdin.fileno()), lambda: bool(terminated and terminated.pop()))
    except (msgspec.DecodeError, ConfigError) as error:
        print(f"kinesic.hardware.supervisor: {error}", file=sys.stderr)  # noqa: T201  # the channel is not open yet
        return EXIT_REFUSED


class PlannerPipe:
    """Liveness check of the planner through its end of a pipe."""

    def __init__(self, descriptor: int) -> None:
        """Watch the reading end of a pipe.

        The parent process is the planner.
        """
        self._descriptor, self._parent = descriptor, os.getppid()
        self._open, self._silent = True, False

    def __call__(self) -> bool:
        """Check without waiting whether the planner is alive."""
        if self._open and select.select([self._descriptor], [], [], 0)[0]:
            self._open = bool(os.read(self._descriptor, 4096))
        self._open = self._open and os.getppid() == self._parent
        if not self._open and not self._silent:
            self._silent = True
            _close_output()
        return self._open


def _close_output() -> None:
    """Redirect standard output and error to /dev/null, closing their pipes."""
    null_device = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
        os.dup2(null_device, stream.fileno())
    os.close(null_device)


def _read_line(descriptor: int) -> bytes:
    """Read the first line without consuming later bytes."""
    line = b""
    while not line.endswith(b"\n") and (byte := os.read(descriptor, 1)):
        line += byte
    return line


if __name__ == "__main__":
    raise SystemExit(main())
