"""Tells when servos fail, complain of their supply, or are well again, and how long a motion was interrupted."""

from collections.abc import Callable

import numpy as np

from kinesic.body.arrays import Flags
from kinesic.hardware.bus.telemetry import VOLT
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.monitor import CommunicationMonitor
from kinesic.hardware.supervisor.state_machine import Event, Stage


class FailureWatch:
    """Remembers who had failed or was silent, so that only news are told."""

    def __init__(self, manifest: Manifest, note: Callable[[str, str], None]) -> None:
        """Nobody has failed yet; `note` is given the kind and the text of what is worth a line in the log."""
        nobody: Flags = np.zeros(len(manifest.members), dtype=np.bool_)
        self._manifest, self._tell = manifest, note
        self._failed = self._hindered = nobody
        self._weak = False

    def look(self, monitor: CommunicationMonitor) -> tuple[Event, ...]:
        """Returns what has happened since the last look."""
        events = list[Event]()
        news, hindered = monitor.failed & ~self._failed, monitor.failed | ~monitor.answered
        if news.any():
            names = ", ".join(dict.fromkeys(self._manifest.members[k].hinge for k in np.flatnonzero(news)))
            self._tell("failed", f"{names}: shut down, or cannot move")
            events.append("failed")
        if monitor.weak and not self._weak and monitor.records is not None:
            self._tell("supply", f"{monitor.records['volts'].min() * VOLT:.1f} V are not enough: the robot folds")
        if (self._hindered & ~hindered).any():
            events.append("mended")
        self._failed, self._hindered, self._weak = monitor.failed, hindered, monitor.weak
        return tuple(events)


class InterruptionWatch:
    """Remembers when all was well last, and since when the motion has stood still for want of commands."""

    def __init__(self, startle: float) -> None:
        """Begins undisturbed; `startle` [s] is what goes on by itself at most."""
        self._startle = startle
        self._clock = self._well_at = self._dry_since = 0.0  # [s] now; all was well last; too little to perform
        self._under_way = False  # whether the present performance has moved since it began, or since a consent
        self._starved = False  # whether there are commands to go on with, after a long time without enough of them

    def note_servos(self, *, well: bool) -> None:
        """Notes whether all is well with the servos in this cycle."""
        if well:
            self._well_at = self._clock

    def note_commands(self, clock: float, *, stage: Stage, before: bool, left: bool, fresh: bool) -> None:
        """Notes the commands of a new cycle.

        Args:
            clock: now [s].
            stage: in which time stands still, or runs.
            before: whether there was still something to perform when the cycle began.
            left: whether there is something now.
            fresh: whether it is another performance.
        """
        self._clock = clock
        self._under_way = not fresh and (self._under_way or (before and stage is Stage.ACTIVE))
        if not self._under_way or (before and stage is not Stage.HOLD):  # there it waits until there is enough
            self._dry_since = clock
        self._starved = left and clock - self._dry_since > self._startle

    def note_consent(self) -> None:
        """Notes that somebody consents to go on, however long the motion has stood still."""
        self._under_way = self._starved = False

    @property
    def unwell(self) -> float:
        """[s] since all was well."""
        return self._clock - self._well_at

    @property
    def interrupted(self) -> bool:
        """Whether somebody must consent before the motion goes on."""
        return self._starved or self.unwell > self._startle

    def describe(self, trouble: str) -> str:
        """Says what was missing, and for how long.

        Args:
            trouble: of the servos; empty if they have none.
        """
        why = "commands came too late" if self._starved else trouble or "this process stood still"
        return f"{why} ({self._clock - self._dry_since if self._starved else self.unwell:.1f} s and more)"
