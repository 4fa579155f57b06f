"""Lets another process of the same user find supervisors, and the one that holds a port, which is locked for others.

A small file under the port's name says which process it is and where its channel is; the channel itself has no name,
and tells by its clock whether anybody still writes it. This needs Linux' /proc; elsewhere nobody is found.
"""

import os
from collections.abc import Iterable
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from time import monotonic
from typing import NamedTuple

from kinesic.hardware.bus.host import stable_name
from kinesic.hardware.supervisor.channel import MEMORY_NAME, Channel, map_memory, memory_size

FOLDER, PROCESSES = Path("/dev/shm"), Path("/proc")  # others can write there: the owner is checked
ALIVE = 1.0  # [s] since its last cycle


def publish(ports: Iterable[str | Path], memory: int, joints: int) -> tuple[Path, ...]:
    """Makes this process known as the supervisor of ports, and returns the files to be removed at its end.

    Args:
        ports: paths of the devices.
        memory: descriptor of the channel's memory.
        joints: of the robot.
    """
    found: list[Path] = []
    for port in ports:
        path, text = _file(port), f"{os.getpid()} {memory} {joints}"
        news = path.with_name(f"{path.name}.{os.getpid()}")
        with suppress(OSError):  # without it, the supervisor still does its work
            news.unlink(missing_ok=True)
            descriptor = os.open(news, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600)
            with os.fdopen(descriptor, "w") as file:
                file.write(text)
            news.replace(path)
            found.append(path)
    return tuple(found)


def find_supervisor(port: str | Path, joints: int) -> Channel | None:
    """Returns the channel of the supervisor that holds a port; None if there is none that lives.

    Args:
        port: path of the device.
        joints: of the robot.
    """
    address = _read(_file(port))
    return _connect(address) if address is not None and address.joints == joints else None


def find_supervisors() -> tuple[Channel, ...]:
    """Returns the channels of all supervisors of this user that live, whatever they hold."""
    files = sorted(path for path in FOLDER.glob(f"{_prefix()}*") if not path.suffix)  # no drafts
    addresses = dict.fromkeys(address for path in files if (address := _read(path)) is not None)
    return tuple(channel for address in addresses if (channel := _connect(address)) is not None)


class _Address(NamedTuple):
    """Where a supervisor's channel is."""

    process: int
    memory: int  # descriptor in that process
    joints: int


def _read(path: Path) -> _Address | None:
    """The address in a file of this user's; None if there is none."""
    with suppress(OSError, ValueError):
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
        with os.fdopen(descriptor) as file:
            process, memory, joints = map(int, file.read(64).split())
            if os.fstat(descriptor).st_uid == os.getuid() and joints > 0:
                return _Address(process, memory, joints)
    return None


def _connect(address: _Address) -> Channel | None:
    """The channel at an address, if a supervisor still writes it."""
    memory = PROCESSES / str(address.process) / "fd" / str(address.memory)
    with suppress(OSError, ValueError):
        octets = memory_size(address.joints)
        if not os.readlink(memory).startswith(f"/memfd:{MEMORY_NAME}") or memory.stat().st_size != octets:
            return None
        descriptor = os.open(memory, os.O_RDWR)
        try:
            channel = Channel(map_memory(descriptor, octets), address.joints)
        finally:
            os.close(descriptor)
        if monotonic() - channel.status().clock < ALIVE:
            return channel
    return None


def _prefix() -> str:
    return f"kinesic-{os.getuid()}-"


def _file(port: str | Path) -> Path:
    name = stable_name(Path(os.path.abspath(port)))  # a link of the user's own outlives unplugging
    return FOLDER / f"{_prefix()}{sha256(str(name).encode()).hexdigest()[:16]}"
