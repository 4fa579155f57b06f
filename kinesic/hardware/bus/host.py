"""Serial ports, USB latency timers and real-time scheduling of the host."""

import os
import sys
from contextlib import suppress
from dataclasses import dataclass
from math import inf
from pathlib import Path

SERIAL_BY_ID = Path("/dev/serial/by-id")  # folder of links that name USB ports by their adapter
SYSFS_ROOT = Path("/sys")  # folder of the kernel's device settings
TARGET_LATENCY_MS = 1  # [ms] latency timer setting at which the bus reaches its full rate
UDEV_RULE_FILE = "/etc/udev/rules.d/99-kinesic-latency.rules"  # file of UDEV_RULE
# Rule that sets the latency timer of each plugged-in FTDI adapter to 1 ms
UDEV_RULE = 'ACTION=="add", SUBSYSTEM=="usb-serial", DRIVER=="ftdi_sio", ATTR{latency_timer}="1"'


def find_stable_name(path: Path, *, names: Path = SERIAL_BY_ID) -> Path:
    """Return a port's by-id path, or the given path if none exists.

    It survives unplugging, while the number of ttyUSBn changes.
    """
    if path.exists() and names.is_dir() and path.parent != names:
        for name in sorted(names.iterdir()):
            if name.resolve() == path.resolve():
                return name
    return path


def list_ports(*, names: Path = SERIAL_BY_ID) -> tuple[Path, ...]:
    """List all USB serial ports by their by-id paths."""
    return tuple(sorted(names.iterdir())) if names.is_dir() else ()


WATCHDOG_FACTORS = (1, 2, 4)  # Selectable bus watchdog times / watchdog time on a punctual host
MAX_GAP_FRACTION = 0.25  # Longest safe gap between two cycles / watchdog time
BUSY_TIME_SCALE = 0.5  # Time scale of the performance while the longest watchdog time is needed
GAP_MEMORY = 10.0  # [s] duration for which a long gap is remembered


class Punctuality:
    """Monitor of the host's cycle delays.

    It lengthens the bus watchdogs so that they do not trip on a slow host.
    """

    def __init__(self, watchdog: float) -> None:
        """Start the monitor without recorded bus cycles.

        Args:
            watchdog: [s] watchdog time on a punctual host.
        """
        self._watchdog, self._last, self._worst, self._seen = watchdog, inf, 0.0, 0.0
        self._excused = False  # whether the last cycle was allowed to be slow
        self.watchdog_factor = 1  # watchdog time / watchdog time on a punctual host

    def note(self, now: float, *, excused: bool) -> str:
        """Record a cycle's start, and return a message if watchdog times change.

        Without a change, the message is empty.

        Args:
            now: [s].
            excused: whether the cycle may be slow, as when registers are read one by one.
        """
        gap = 0.0 if excused or self._excused else now - self._last
        self._last, self._excused = now, excused
        if gap >= self._worst or now - self._seen > GAP_MEMORY:
            self._worst, self._seen = max(gap, 0.0), now
        before = self.watchdog_factor
        self.watchdog_factor = next(
            (k for k in WATCHDOG_FACTORS if self._worst <= MAX_GAP_FRACTION * k * self._watchdog), WATCHDOG_FACTORS[-1]
        )
        if self.watchdog_factor == before:
            return ""
        watchdogs, time_scale = (
            f"bus watchdogs are {self.watchdog_factor * self._watchdog:g} s",
            f"time runs at {100 * self.pace:g} %",
        )
        return f"cycles begin up to {1e3 * self._worst:.0f} ms apart: {watchdogs}, {time_scale}"

    @property
    def pace(self) -> float:
        """Time scale of the motion, below 1 at the longest watchdog time."""
        return BUSY_TIME_SCALE if self.watchdog_factor == WATCHDOG_FACTORS[-1] else 1.0


@dataclass(frozen=True)
class AdapterLatency:
    """Latency timer of a USB adapter, which delays received bytes."""

    port: Path
    timer_ms: int  # [ms] setting of the timer
    setting: Path  # system file that holds the setting

    @property
    def is_good(self) -> bool:
        """Whether the timer is short enough for the full bus rate."""
        return self.timer_ms <= TARGET_LATENCY_MS

    @property
    def remedy(self) -> str:
        """Message with the shell commands that shorten the timer."""
        return (
            f"{self.port}: USB latency timer is {self.timer_ms} ms, which limits the bus to about "
            f"{1000 // max(self.timer_ms, 1)} Hz; change it now with\n"
            f"  echo {TARGET_LATENCY_MS} | sudo tee {self.setting}\n"
            f"and permanently with\n"
            f"  echo '{UDEV_RULE}' | sudo tee {UDEV_RULE_FILE} && sudo udevadm control --reload && sudo udevadm trigger"
        )


def read_latency(path: Path, *, system: Path = SYSFS_ROOT) -> AdapterLatency | None:
    """Read the latency timer of a port's adapter.

    None if it has none, such as a pseudo-terminal.
    """
    setting = system / "bus/usb-serial/devices" / path.resolve().name / "latency_timer"
    try:
        return AdapterLatency(path, int(setting.read_text()), setting)
    except (OSError, ValueError):
        return None


def request_real_time(priority: int) -> bool:
    """Request real-time scheduling for this process and return success.

    Args:
        priority: SCHED_FIFO priority, 1..99.
    """
    if sys.platform == "linux":
        with suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
            return True
    return False
