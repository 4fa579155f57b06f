"""Events of failing and recovering servos, and duration of interruptions."""

from collections.abc import Callable

import numpy as np

from kinesic.body.arrays import Flags
from kinesic.hardware.bus.telemetry import VOLTS_PER_COUNT
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.monitor import CommunicationMonitor
from kinesic.hardware.supervisor.state_machine import Event, Stage


class FailureWatch:
    """Detector of changes in the set of failed and silent servos."""

    def __init__(self, manifest: Manifest, note: Callable[[str, str], None]) -> None:
        """Start the watch with no servo marked as failed or silent.

        Args:
            manifest: the servos.
            note: writes an event with a kind and a text to the log.
        """
        no_member: Flags = np.zeros(len(manifest.members), dtype=np.bool_)
        self._manifest, self._log = manifest, note
        self._failed = self._hindered = no_member
        self._weak = False

    def look(self, monitor: CommunicationMonitor) -> tuple[Event, ...]:
        """Return the servo failures and recoveries since the last call."""
        events = list[Event]()
        newly_failed, hindered = monitor.failed & ~self._failed, monitor.failed | ~monitor.answered
        if newly_failed.any():
            names = ", ".join(dict.fromkeys(self._manifest.members[k].hinge for k in np.flatnonzero(newly_failed)))
            self._log("failed", f"{names}: shut down or blocked")
            events.append("failed")
        if monitor.weak and not self._weak and monitor.records is not None:
            self._log(
                "supply", f"{monitor.records['volts'].min() * VOLTS_PER_COUNT:.1f} V are too low: the robot folds"
            )
        if (self._hindered & ~hindered).any():
            events.append("mended")
        self._failed, self._hindered, self._weak = monitor.failed, hindered, monitor.weak
        return tuple(events)


class InterruptionWatch:
    """Timer of how long servo faults and missing commands last.

    It decides whether a motion may continue without a person's resume request.
    """

    def __init__(self, startle: float) -> None:
        """Start the timer without an interruption.

        Args:
            startle: [s] longest interruption after which the motion continues by itself.
        """
        self._startle = startle
        self._clock = self._well_at = self._dry_since = (
            0.0  # [s] now; last time without fault; start of missing commands
        )
        self._under_way = False  # whether the performance has moved since it began or was resumed
        self._starved = False  # whether commands are back after a long gap

    def note_servos(self, *, well: bool) -> None:
        """Record whether all servos are healthy in this cycle."""
        if well:
            self._well_at = self._clock

    def note_commands(self, clock: float, *, stage: Stage, before: bool, left: bool, fresh: bool) -> None:
        """Update the detection of missing planner commands in a new cycle.

        Args:
            clock: [s] current time.
            stage: stage of the supervisor.
            before: whether commands were left when the cycle began.
            left: whether commands are left now.
            fresh: whether a new performance has begun.
        """
        self._clock = clock
        self._under_way = not fresh and (self._under_way or (before and stage is Stage.ACTIVE))
        if not self._under_way or (before and stage is not Stage.HOLD):  # while it holds, it waits for enough commands
            self._dry_since = clock
        self._starved = left and clock - self._dry_since > self._startle

    def note_resume(self) -> None:
        """Record a person's confirmation to continue after an interruption."""
        self._under_way = self._starved = False

    @property
    def fault_duration(self) -> float:
        """Time [s] since all servos were last healthy."""
        return self._clock - self._well_at

    @property
    def interrupted(self) -> bool:
        """Whether a person must confirm before the motion continues."""
        return self._starved or self.fault_duration > self._startle

    def describe(self, trouble: str) -> str:
        """Describe the cause and the duration of the interruption.

        Args:
            trouble: fault of the servos; empty without one.
        """
        cause = "commands came too late" if self._starved else trouble or "this process was suspended"
        return f"{cause} ({self._clock - self._dry_since if self._starved else self.fault_duration:.1f} s or more)"
