"""What this machine gives a bus: ports by lasting names, the latency timers of their USB adapters, and real time."""

import os
import sys
from dataclasses import dataclass
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
