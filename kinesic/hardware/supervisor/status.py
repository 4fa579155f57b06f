"""Writing of status and events to the channel and a log file."""

import errno
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf, nan
from pathlib import Path
from time import time as wall_time

import numpy as np

from kinesic.files.output_file import open_to_add
from kinesic.hardware.bus.telemetry import VOLTS_PER_COUNT
from kinesic.hardware.supervisor.channel import Channel, Status
from kinesic.hardware.supervisor.goals import GoalSteering
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.monitor import CommunicationMonitor
from kinesic.hardware.supervisor.notes import Note
from kinesic.hardware.supervisor.state_machine import Awaited, Stage, SupervisorState

TELEMETRY_INTERVAL = 0.05  # [s] between updates of temperatures, loads, voltages and errors


class EventLog:
    """Event log of the supervisor as JSON lines, disabled without a path.

    A write error does not stop the robot.
    """

    def __init__(self, path: Path | None) -> None:
        """Open the log file for appending, if a path is given."""
        self._path, self._file = path, None
        self.failure = ""  # reason of lost events; empty: none lost
        if path is not None:
            with self._record_failure():
                self._file = open_to_add(path)

    def write(self, note: Note) -> None:
        """Append an event as one JSON line.

        The line is dropped if the disk is full.
        """
        if self._file is None:
            return
        line = {"time": round(note.clock, 6), "wall": round(wall_time(), 3), "kind": note.kind}
        servo = {"servo": note.servo} if note.servo >= 0 else {}
        octets = json.dumps({**line, **servo, "text": note.text}).encode() + b"\n"
        with self._record_failure():
            written = self._file.write(octets)
            if written < len(octets):
                self._file.truncate(self._file.tell() - written)
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def close(self) -> None:
        """Close the log file."""
        if self._file is not None:
            self._file.close()

    @contextmanager
    def _record_failure(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self.failure = self.failure or f"{self._path}: {error.strerror}; events are lost"


class StatusWriter:
    """Writer of status and events for planner and log."""

    def __init__(self, manifest: Manifest, channel: Channel, journal: EventLog) -> None:
        self._manifest, self._channel, self._journal = manifest, channel, journal
        self._failure = ""  # failure of the log that was reported to the planner
        self._measured, self._hottest, self._volts = -inf, nan, nan  # [s] time of the other two values

    def note(self, clock: float, kind: str, text: str, servo: int = -1) -> None:
        """Report an event to planner and log, with its time [s]."""
        note = Note(clock, servo, kind, text)
        self._channel.note(note)
        self._journal.write(note)
        if self._failure != self._journal.failure:
            self._failure = self._journal.failure
            self._channel.note(Note(clock, -1, "journal", self._failure))

    def write(
        self, clock: float, state: SupervisorState, monitor: CommunicationMonitor, steering: GoalSteering, late: int
    ) -> None:
        """Write the status of the cycle that began at a time [s].

        Args:
            clock: [s].
            state: state of the supervisor.
            monitor: health of the servos.
            steering: goals of the servos.
            late: number of cycles that began late.
        """
        player = steering.player
        if abs(clock - self._measured) >= TELEMETRY_INTERVAL and monitor.records is not None:
            self._measured = clock
            self._hottest = float(monitor.records["temperature"].max())
            self._volts = float(monitor.records["volts"].min()) * VOLTS_PER_COUNT
            self._channel.write_telemetry(monitor.telemetry(clock))
        self._channel.write_status(
            Status(
                stage=state.stage,
                waits=awaited_input(state, well=monitor.well),
                clock=clock,
                time=player.time_scale.time if player.begun else nan,
                scale=player.time_scale.scale,
                energised=int(np.count_nonzero(monitor.energised)),
                hottest=self._hottest,
                volts=self._volts,
                silent=len(monitor.answered) - int(np.count_nonzero(monitor.answered)),
                late=late,
                faulty=state.faulty,
                angles=self._manifest.angles(monitor.present, whole=monitor.all_answered),
                setpoints=steering.angles,
                taken=self._manifest.means(monitor.taken, whole=monitor.all_answered),
            )
        )


def awaited_input(state: SupervisorState, *, well: bool) -> Awaited:
    """Return the input that the supervisor waits for, or "nothing".

    Args:
        state: current state.
        well: whether every servo answers, has torque, and neither a fault nor overload stops it.
    """
    if state.stage is Stage.WAITING:
        return "confirmation"
    if state.stage is Stage.STOPPED or (state.stage is Stage.HOLD and state.paused):
        return "consent"
    if state.stage is Stage.LOST:
        return "port"
    if state.stage is Stage.LIMP:
        return "commands"
    if state.stage is Stage.HOLD:
        return "commands" if well else "servos"
    return "nothing"
