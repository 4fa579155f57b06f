"""Differences between operating systems, and the features that some of them lack."""

import os
import signal
import sys
from contextlib import suppress
from dataclasses import dataclass
from math import nan
from pathlib import Path

NO_LINK_FLAG: int = getattr(os, "O_NOFOLLOW", 0)  # open flag: refuse a link as last part of a path; 0 on Windows
NO_WAIT_FLAG: int = getattr(os, "O_NONBLOCK", 0)  # open flag: do not wait for a pipe's other end; 0 on Windows
FOLDER_FLAG: int = getattr(os, "O_DIRECTORY", 0)  # open flag: refuse all but folders; 0 on Windows
HAS_FOLDER_DESCRIPTORS = os.open in os.supports_dir_fd  # whether paths can be relative to an open folder
WINDOWS_OPEN_FILES = 8192  # largest count of open files in the C library of Windows
ENDING_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)  # signals that ask a program to end in an orderly way


@dataclass(frozen=True)
class HostFeature:
    """Feature of kinesic that some operating systems cannot run."""

    name: str
    systems: str  # operating systems that have this feature
    is_available: bool
    remedy: str

    def require(self) -> None:
        """Raise an error if this system lacks the feature.

        Raises:
            ConfigError: this system lacks it; the message has the remedy.
        """
        if not self.is_available:
            from kinesic.body.config import ConfigError  # noqa: PLC0415 - the command line imports this module first

            raise ConfigError(f"{self.name} needs {self.systems}, and this is {platform_name()}; {self.remedy}")


LIVE_SERVER = HostFeature(
    "the live server (serve, studio, mcp, say -)",
    "Linux or macOS",
    sys.platform != "win32",
    "run it in WSL 2, or on a robot's machine with Linux, and connect to it with kinesic.Client; "
    "`kinesic perform`, `plan` and `say TEXT` work here without it",
)
SERVO_DRIVER = HostFeature(
    "the servo driver",
    "Linux or macOS",
    sys.platform != "win32",
    "run it in WSL 2 with the adapter attached by usbipd; the twin works here",
)
STOP_FROM_OUTSIDE = HostFeature(
    "a stop of the servos from another program",
    "Linux",
    sys.platform == "linux",
    "press space in `perform`, or send stop to `serve`; if the robot still moves, switch the power off",
)
VIRTUAL_PORTS = HostFeature(
    "the simulation of servo ports",
    "Linux",
    sys.platform == "linux",
    "run it in WSL 2 or in a virtual machine with Linux; `kinesic perform` without `--on servos` works here",
)


def platform_name() -> str:
    """Return the usual name of this operating system."""
    return {"win32": "Windows", "darwin": "macOS", "linux": "Linux"}.get(sys.platform, sys.platform)


def user_id() -> int:
    """Return the effective user id of this process, 0 on Windows.

    The owner of every file has the id 0 on Windows, so comparisons of owners always pass there.
    """
    user = 0
    if sys.platform != "win32":
        user = os.geteuid()
    return user


def account_home(user: int) -> Path | None:
    """Return the home folder of an account, independent of $HOME.

    None where the system has no such account or no account file.
    """
    if sys.platform != "win32":
        import pwd  # noqa: PLC0415 - Windows has none

        with suppress(KeyError):
            return Path(pwd.getpwuid(user).pw_dir)
    return None


def max_open_files() -> int:
    """Return the soft limit on open descriptors of this process, sockets included.

    On Windows it is `WINDOWS_OPEN_FILES`.
    """
    limit = WINDOWS_OPEN_FILES
    if sys.platform != "win32":
        import resource  # noqa: PLC0415 - Windows has none

        limit = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return limit


def processor_load() -> float:
    """Return the load average of the last minute, NaN on Windows."""
    load = nan
    if sys.platform != "win32":
        load = os.getloadavg()[0]
    return load


def lower_priority(increment: int) -> None:
    """Add an increment to the niceness of this process, except on Windows."""
    if sys.platform != "win32":
        os.nice(increment)
