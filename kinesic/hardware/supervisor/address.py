"""Lets another process of the same user find the supervisor that holds a port, which is locked for all others.

A small file under the port's name says which process it is and where its channel is; the channel itself has no name,
and tells by its clock whether anybody still writes it. This needs Linux' /proc; elsewhere nobody is found.
"""

import os
from collections.abc import Iterable
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from time import monotonic

from kinesic.hardware.bus.host import stable_name
from kinesic.hardware.supervisor.channel import MEMORY_NAME, Channel, map_memory, memory_size

FOLDER, PROCESSES = Path("/dev/shm"), Path("/proc")  # others can write there: the owner is checked
ALIVE = 1.0  # [s] since its last cycle


def publish(ports: Iterable[str | Path], memory: int) -> tuple[Path, ...]:
    """Makes this process known as the supervisor of ports, and returns the files to be removed at its end.

    Args:
        ports: paths of the devices.
        memory: descriptor of the channel's memory.
    """
    found: list[Path] = []
    for port in ports:
        path, text = _file(port), f"{os.getpid()} {memory}"
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
    octets = memory_size(joints)
    with suppress(OSError, ValueError):
        descriptor = os.open(_file(port), os.O_RDONLY | os.O_NOFOLLOW)
        with os.fdopen(descriptor) as file:
            if os.fstat(descriptor).st_uid != os.getuid():
                return None
            process, number = map(int, file.read(64).split())
        memory = PROCESSES / str(process) / "fd" / str(number)
        if not os.readlink(memory).startswith(f"/memfd:{MEMORY_NAME}") or memory.stat().st_size != octets:
            return None
        descriptor = os.open(memory, os.O_RDWR)
        try:
            channel = Channel(map_memory(descriptor, octets), joints)
        finally:
            os.close(descriptor)
        if monotonic() - channel.status().clock < ALIVE:
            return channel
    return None


def _file(port: str | Path) -> Path:
    name = stable_name(Path(os.path.abspath(port)))  # a link of the user's own outlives unplugging
    return FOLDER / f"kinesic-{os.getuid()}-{sha256(str(name).encode()).hexdigest()[:16]}"
