"""Writes the status of the supervisor into the channel, and events into the channel and a log file."""

import json
from contextlib import suppress
from math import inf, nan
from pathlib import Path
from time import time as wall_time

import numpy as np

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.channel import Channel, Note, Status
from kinesic.hardware.supervisor.goals import GoalSteering
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.monitor import CommunicationMonitor
from kinesic.hardware.supervisor.state_machine import SupervisorState

SLOWLY = 0.1  # [s] between two looks at temperatures and voltages
VOLT = Register.PRESENT_INPUT_VOLTAGE.field.scale


class EventLog:
    """A file of events; none if there is no path."""

    def __init__(self, path: Path | None) -> None:
        """Opens the file, to add to it.

        Raises:
            OSError: it cannot be written.
        """
        self._file = path.open("ab", buffering=0) if path is not None else None

    def write(self, note: Note) -> None:
        """One line; lost where the disk is full, which stops no robot."""
        if self._file is not None:
            line = {"time": round(note.clock, 6), "wall": round(wall_time(), 3), "kind": note.kind}
            servo = {"servo": note.servo} if note.servo >= 0 else {}
            with suppress(OSError):
                self._file.write(json.dumps({**line, **servo, "text": note.text}).encode() + b"\n")

    def close(self) -> None:
        """Ends the file."""
        if self._file is not None:
            self._file.close()


class StatusWriter:
    """The way to the planner, and to the file."""

    def __init__(self, manifest: Manifest, channel: Channel, journal: EventLog) -> None:
        """Of a supervisor of this manifest."""
        self._manifest, self._channel, self._journal = manifest, channel, journal
        self._measured, self._hottest, self._volts = -inf, nan, nan  # [s] when the other two were looked at

    def note(self, clock: float, kind: str, text: str, servo: int = -1) -> None:
        """Tells of an event at a time [s]."""
        note = Note(clock, servo, kind, text)
        self._channel.note(note)
        self._journal.write(note)

    def tell(
        self, clock: float, state: SupervisorState, watch: CommunicationMonitor, steering: GoalSteering, late: int
    ) -> None:
        """Tells how it was in the cycle that began at a time [s]; `late` cycles so far began too late."""
        player = steering.player
        if abs(clock - self._measured) >= SLOWLY and watch.records is not None:
            self._measured = clock
            self._hottest = float(watch.records["temperature"].max())
            self._volts = float(watch.records["volts"].min()) * VOLT
        self._channel.tell(
            Status(
                stage=state.stage,
                clock=clock,
                time=player.tempo.time if player.begun else nan,
                scale=player.tempo.scale,
                energised=int(np.count_nonzero(watch.energised)),
                hottest=self._hottest,
                volts=self._volts,
                silent=len(watch.heard) - int(np.count_nonzero(watch.heard)),
                late=late,
                faulty=state.faulty,
                angles=self._manifest.angles(watch.present, whole=watch.everybody),
                goals=steering.angles,
                taken=self._manifest.means(watch.taken, whole=watch.everybody),
            )
        )
