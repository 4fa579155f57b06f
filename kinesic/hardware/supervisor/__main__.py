"""Runs the supervisor as a process of its own: `python -m kinesic.hardware.supervisor`, started by `Servos`.

Its standard input is a pipe that the planner holds: the first line says what to do, its end says that the planner is
gone.
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
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import SupervisorOrder
from kinesic.hardware.supervisor.status import EventLog
from kinesic.hardware.supervisor.supervisor import Supervisor, Surroundings

PRIORITY = 20  # of SCHED_FIFO, where the host grants it
EXIT_GOOD, EXIT_REFUSED = 0, 2


def supervise(order: SupervisorOrder, planner: Callable[[], bool], ended: Callable[[], bool]) -> int:
    """Supervises until all is over, and returns the exit code.

    Args:
        order: what for.
        planner: whether it lives.
        ended: whether somebody has asked for the end since the last call.
    """
    manifest = Manifest.of(Robot.load(Path(order.robot)))
    joints = len(manifest.rest)
    channel = Channel(map_memory(order.memory, memory_size(joints)), joints)
    settings, journal = order.settings, EventLog(Path(order.log) if order.log else None)
    watchdog = settings.watchdog if request_real_time(PRIORITY) else settings.patient_watchdog

    def opens(bus: str) -> Wire:
        return SerialWire(order.ports[bus], manifest.bauds[bus])

    published: list[Path] = []

    def announce() -> None:
        published.extend(publish(order.ports.values(), order.memory, joints))

    around = Surroundings(opens, channel, planner, journal, announce)
    supervisor = Supervisor(manifest, around, settings, watchdog=watchdog)
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
    for path in published:
        path.unlink(missing_ok=True)
    journal.close()
    return EXIT_REFUSED if refused else EXIT_GOOD


def main() -> int:
    """Reads a `SupervisorOrder` from standard input, and runs the supervisor that it describes."""
    terminated: list[int] = []

    def terminate(number: int, frame: FrameType | None) -> None:
        terminated.append(number)

    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, terminate)
    line = _line(sys.stdin.fileno())
    try:
        order = msgspec.json.decode(line, type=SupervisorOrder)
        return supervise(order, Pipe(sys.stdin.fileno()), lambda: bool(terminated and terminated.pop()))
    except (msgspec.DecodeError, ConfigError) as error:
        print(f"kinesic.hardware.supervisor: {error}", file=sys.stderr)  # noqa: T201  # nobody else can tell
        return EXIT_REFUSED


class Pipe:
    """Watches whether the planner still holds its end of the pipe."""

    def __init__(self, descriptor: int) -> None:
        """Watches the reading end of a pipe; the parent is the planner."""
        self._descriptor, self._parent = descriptor, os.getppid()
        self._open, self._silent = True, False

    def __call__(self) -> bool:
        """Looks without waiting whether it does."""
        if self._open and select.select([self._descriptor], [], [], 0)[0]:
            self._open = bool(os.read(self._descriptor, 4096))
        self._open = self._open and os.getppid() == self._parent
        if not self._open and not self._silent:
            self._silent = True
            _give_output_back()
        return self._open


def _give_output_back() -> None:
    """Lets go of the planner's terminal or pipes, on whose end somebody may wait."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
        os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


def _line(descriptor: int) -> bytes:
    """Reads the first line byte by byte: what follows is not ours to take."""
    line = b""
    while not line.endswith(b"\n") and (byte := os.read(descriptor, 1)):
        line += byte
    return line


if __name__ == "__main__":
    raise SystemExit(main())
