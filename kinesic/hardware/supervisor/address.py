"""Lets another process of the same user find supervisors, and the one that holds a port, which is locked for others.

A small file under the port's name says which process it is and where its channel is; the channel itself has no name,
and tells by its clock whether anybody still writes it. The file is in a folder that no other user may write. Its place
does not depend on the environment, so that an emergency stop from any shell finds it; where the file is lost, the
processes of the user are searched. This needs Linux' /proc; elsewhere nobody is found.
"""

import os
import pwd
import sys
from collections.abc import Iterable, Iterator
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from time import monotonic
from typing import NamedTuple

from kinesic.files.private_folder import hold_private_folder
from kinesic.hardware.bus.host import stable_name
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.channel import MEMORY_NAME, Channel, map_memory, memory_size

RUNTIME_ROOT = Path("/run/user")
SHARED_MEMORY = Path("/dev/shm")
PROCESS_FOLDER = Path("/proc")
STATE_FOLDER = Path(".local") / "state"  # of a user, in the home folder
ALIVE = 1.0  # [s] since its last cycle


def publish(ports: Iterable[str | Path], memory: int, joints: int) -> tuple[Path, ...]:
    """Makes this process known as the supervisor of ports, and returns the files to be removed at its end.

    Args:
        ports: paths of the devices.
        memory: descriptor of the channel's memory.
        joints: of the robot.

    Raises:
        BusError: no folder can be used, so that an emergency stop might not find this process.
    """
    names, text = [_name(port) for port in ports], f"{os.getpid()} {memory} {joints}"
    faults: list[str] = []
    for folder in address_folders():
        try:
            folder.parent.mkdir(parents=True, exist_ok=True)
            with hold_private_folder(folder, make=True) as held:
                for name in names:
                    _write(held, name, text)
            return tuple(folder / name for name in names)
        except OSError as error:
            faults.append(f"{folder}: {error.strerror}")
    if sys.platform != "linux":
        return ()
    raise BusError(
        f"`kinesic servos stop` could not find this robot ({'; '.join(faults) or 'there is no folder for it'}); "
        "remove what is there, or give this user a home folder"
    )


def address_folders() -> Iterator[Path]:
    """Yield the folders for addresses of this user, preferred first."""
    user = os.geteuid()
    if (RUNTIME_ROOT / str(user)).is_dir():
        yield RUNTIME_ROOT / str(user) / "kinesic"
    if SHARED_MEMORY.is_dir():
        yield SHARED_MEMORY / f"kinesic-{user}"
    if (home := _home(user)).is_dir():
        yield home / STATE_FOLDER / "kinesic"


def find_faults() -> tuple[str, ...]:
    """Return reasons why existing address folders are unusable, one per folder."""
    faults: list[str] = []
    for folder in address_folders():
        try:
            with hold_private_folder(folder):
                pass
        except FileNotFoundError:
            pass
        except OSError as error:
            faults.append(f"{folder}: {error.strerror}")
    return tuple(faults)


def find_supervisor(port: str | Path, joints: int) -> Channel | None:
    """Returns the channel of the supervisor that holds a port; None if there is none that lives.

    Args:
        port: path of the device.
        joints: of the robot.
    """
    name = _name(port)
    found = (address for folder in address_folders() for address in _read_all(folder, (name,)))
    channels = (_connect(address) for address in found if address.joints == joints)
    return next((channel for channel in channels if channel is not None), None)


def find_supervisors() -> Iterator[Channel]:
    """Yield the channels of all running supervisors of this user."""
    seen: set[_Address] = set()  # published addresses come first, for a stop must not wait for the search
    for address in _all_addresses():
        if address not in seen:
            seen.add(address)
            if (channel := _connect(address)) is not None:
                yield channel


class _Address(NamedTuple):
    """Where a supervisor's channel is."""

    process: int
    memory: int  # descriptor in that process
    joints: int


def _all_addresses() -> Iterator["_Address"]:
    for folder in address_folders():
        yield from _read_all(folder)
    yield from search_processes()


def search_processes() -> Iterator["_Address"]:
    """Yield the addresses of processes that hold a channel open."""
    least, user = memory_size(1), os.geteuid()
    step = memory_size(2) - least  # bytes a joint
    with suppress(OSError):
        for process in filter(str.isdecimal, os.listdir(PROCESS_FOLDER)):
            with suppress(OSError):
                descriptors = PROCESS_FOLDER / process / "fd"
                if descriptors.stat().st_uid != user:
                    continue
                for memory in os.listdir(descriptors):
                    if _is_channel(descriptors / memory):
                        joints = 1 + ((descriptors / memory).stat().st_size - least) // step
                        yield _Address(int(process), int(memory), joints)


def _read_all(folder: Path, names: Iterable[str] | None = None) -> Iterator["_Address"]:
    """Yield the addresses in a folder, if it is this user's."""
    with suppress(OSError), hold_private_folder(folder) as held:
        for name in sorted(os.listdir(held)) if names is None else names:
            if "." not in name and (address := _read(held, name)) is not None:  # no drafts
                yield address


def _read(folder: int, name: str) -> _Address | None:
    """The address in a file of this user's; None if there is none."""
    with suppress(OSError, ValueError):
        descriptor = os.open(name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=folder)
        with os.fdopen(descriptor) as file:
            process, memory, joints = map(int, file.read(64).split())
            if os.fstat(descriptor).st_uid == os.geteuid() and joints > 0:
                return _Address(process, memory, joints)
    return None


def _write(folder: int, name: str, text: str) -> None:
    """Put a file into an open folder, as a whole."""
    draft = f"{name}.{os.getpid()}"
    with suppress(FileNotFoundError):
        os.unlink(draft, dir_fd=folder)
    descriptor = os.open(draft, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600, dir_fd=folder)
    with os.fdopen(descriptor, "w") as file:
        file.write(text)
    os.replace(draft, name, src_dir_fd=folder, dst_dir_fd=folder)


def _connect(address: _Address) -> Channel | None:
    """The channel at an address, if a supervisor still writes it."""
    memory = PROCESS_FOLDER / str(address.process) / "fd" / str(address.memory)
    with suppress(OSError, ValueError):
        octets = memory_size(address.joints)
        if not _is_channel(memory) or memory.stat().st_size != octets:
            return None
        descriptor = os.open(memory, os.O_RDWR)
        try:
            channel = Channel(map_memory(descriptor, octets), address.joints)
        finally:
            os.close(descriptor)
        if monotonic() - channel.status().clock < ALIVE:
            return channel
    return None


def _home(user: int) -> Path:
    """Return the home folder of a user, independent of $HOME."""
    try:
        return Path(pwd.getpwuid(user).pw_dir)
    except KeyError:
        return Path(os.devnull)


def _is_channel(memory: Path) -> bool:
    return os.readlink(memory).startswith(f"/memfd:{MEMORY_NAME}")


def _name(port: str | Path) -> str:
    """Return the file name for a port, unique to this boot."""
    boot = b""
    with suppress(OSError):
        boot = (PROCESS_FOLDER / "sys" / "kernel" / "random" / "boot_id").read_bytes()
    name = stable_name(Path(os.path.abspath(port)))  # a link of the user's own outlives unplugging
    return sha256(boot + str(name).encode()).hexdigest()[:16]
