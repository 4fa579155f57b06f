"""Tells when servos fail, complain of their supply, or are well again."""

from collections.abc import Callable

import numpy as np

from kinesic.body.arrays import Flags
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.monitor import VOLT, CommunicationMonitor
from kinesic.hardware.supervisor.state_machine import Event


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
            names = ", ".join(self._manifest.members[k].hinge for k in np.flatnonzero(news))
            self._tell("failed", f"{names}: shut down, or cannot move")
            events.append("failed")
        if monitor.weak and not self._weak and monitor.records is not None:
            self._tell("supply", f"{monitor.records['volts'].min() * VOLT:.1f} V are not enough: the robot folds")
        if (self._hindered & ~hindered).any():
            events.append("mended")
        self._failed, self._hindered, self._weak = monitor.failed, hindered, monitor.weak
        return tuple(events)
