"""What this machine gives a bus: ports by lasting names, the latency timers of their USB adapters, and real time."""

import os
import sys
from dataclasses import dataclass
from math import inf
from pathlib import Path

BY_ID = Path("/dev/serial/by-id")
SYSTEM = Path("/sys")
WANTED_MS = 1
RULE_FILE = "/etc/udev/rules.d/99-kinesic-latency.rules"
RULE = 'ACTION=="add", SUBSYSTEM=="usb-serial", DRIVER=="ftdi_sio", ATTR{latency_timer}="1"'


def stable_name(path: Path, *, names: Path = BY_ID) -> Path:
    """Returns the name of a port that outlives unplugging, if it has one: ttyUSBn counts up, by-id does not."""
    if path.exists() and names.is_dir() and path.parent != names:
        for name in sorted(names.iterdir()):
            if name.resolve() == path.resolve():
                return name
    return path


def ports(*, names: Path = BY_ID) -> tuple[Path, ...]:
    """Returns all USB serial ports, by their lasting names."""
    return tuple(sorted(names.iterdir())) if names.is_dir() else ()


STRETCHES = (1, 2, 4)
NEAR = 0.25  # of a bus watchdog: the longest gap between two cycles that is far enough from it
BUSY_PACE = 0.5  # time scale on a host so late that the longest watchdog is near
CALM = 10.0  # [s] without a long gap after which it is forgotten


class Punctuality:
    """Judges how late a host lets cycles begin, and by how much bus watchdogs must be longer not to trip for that."""

    def __init__(self, watchdog: float) -> None:
        """Has seen no cycle; `watchdog` [s] is that of a punctual host."""
        self._watchdog, self._last, self._worst, self._seen = watchdog, inf, 0.0, 0.0
        self._excused = False  # whether the cycle before took its time
        self.stretch = 1  # times the watchdog of a punctual host

    def note(self, now: float, *, excused: bool) -> str:
        """Notes that a cycle begins, and returns what has changed by that, if anything has.

        Args:
            now: [s].
            excused: whether it takes its time, as when registers are read one by one.
        """
        gap = 0.0 if excused or self._excused else now - self._last
        self._last, self._excused = now, excused
        if gap >= self._worst or now - self._seen > CALM:
            self._worst, self._seen = max(gap, 0.0), now
        before = self.stretch
        self.stretch = next((k for k in STRETCHES if self._worst <= NEAR * k * self._watchdog), STRETCHES[-1])
        if self.stretch == before:
            return ""
        longer, slower = f"bus watchdogs are {self.stretch * self._watchdog:g} s", f"time runs at {100 * self.pace:g} %"
        return f"cycles begin up to {1e3 * self._worst:.0f} ms apart: {longer}, {slower}"

    @property
    def pace(self) -> float:
        """The time scale that it allows."""
        return BUSY_PACE if self.stretch == STRETCHES[-1] else 1.0


@dataclass(frozen=True)
class AdapterLatency:
    """How long an adapter may keep bytes back before it hands them to the host."""

    port: Path
    timer_ms: int
    setting: Path  # where it is set

    @property
    def good(self) -> bool:
        """Whether it lets the bus run at its rate."""
        return self.timer_ms <= WANTED_MS

    @property
    def remedy(self) -> str:
        """The lines that mend it, now and for good."""
        return (
            f"{self.port}: USB latency timer is {self.timer_ms} ms, which limits every bus to about "
            f"{1000 // max(self.timer_ms, 1)} Hz; mend it now with\n"
            f"  echo {WANTED_MS} | sudo tee {self.setting}\n"
            f"and for good with\n"
            f"  echo '{RULE}' | sudo tee {RULE_FILE} && sudo udevadm control --reload && sudo udevadm trigger"
        )


def latency(path: Path, *, system: Path = SYSTEM) -> AdapterLatency | None:
    """Returns the latency timer of a port's adapter; None where it has none, as a pseudo-terminal."""
    setting = system / "bus/usb-serial/devices" / path.resolve().name / "latency_timer"
    try:
        return AdapterLatency(path, int(setting.read_text()), setting)
    except (OSError, ValueError):
        return None


def request_real_time(priority: int) -> bool:
    """Asks the host for real time for this process, and returns whether it grants it.

    Args:
        priority: of SCHED_FIFO, 1..99.
    """
    if sys.platform != "linux":
        return False
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except OSError:
        return False
    return True
