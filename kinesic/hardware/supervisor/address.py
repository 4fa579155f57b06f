"""Discovery of running supervisors by other processes of the same user.

A small file under the port's name holds the process id and the location of the channel; the channel itself has no
name, and its clock shows whether it is still written. The file is in a folder that no other user may write. Its
location does not depend on the environment, so that an emergency stop from any shell finds it; if the file is lost, the
processes of the user are searched. Other systems find no supervisor: only Linux opens memory without a name, through
/proc.
"""

import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from time import monotonic
from typing import NamedTuple

from kinesic.files.held_folder import HeldFolder
from kinesic.files.private_folder import hold_private_folder
from kinesic.hardware.bus.host import find_stable_name
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.channel import MEMORY_NAME, Channel, map_memory, memory_size
from kinesic.host import NO_LINK_FLAG, NO_WAIT_FLAG, account_home, user_id

RUNTIME_ROOT = Path("/run/user")  # Parent of the users' runtime folders
SHARED_MEMORY = Path("/dev/shm")  # folder of shared memory, second choice for address files
PROCESS_FOLDER = Path("/proc")  # folder in which the kernel lists processes
STATE_FOLDER = Path(".local") / "state"  # Folder of user state in the home folder
ALIVE_TIMEOUT = 1.0  # [s] age of the last cycle at which a supervisor counts as dead


def publish(ports: Iterable[str | Path], memory: int, joints: int) -> tuple[Path, ...]:
    """Publish this process as the supervisor of some serial ports.

    Args:
        ports: paths of the devices.
        memory: descriptor of the channel's memory.
        joints: number of joints of the robot.

    Returns:
        Files to remove at the end.

    Raises:
        BusError: no folder is usable, so that an emergency stop might not find this process.
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
        f"`kinesic servos stop` could not find this robot ({'; '.join(faults) or 'no folder is available'}); "
        "make these folders writable for this user only, or give this user a home folder"
    )


def address_folders() -> Iterator[Path]:
    """Yield this user's folders for supervisor address files, preferred first."""
    user = user_id()
    if (RUNTIME_ROOT / str(user)).is_dir():
        yield RUNTIME_ROOT / str(user) / "kinesic"
    if SHARED_MEMORY.is_dir():
        yield SHARED_MEMORY / f"kinesic-{user}"
    if (home := account_home(user)) is not None and home.is_dir():
        yield home / STATE_FOLDER / "kinesic"


def find_faults() -> tuple[str, ...]:
    """Describe each unusable folder for supervisor address files."""
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
    """Return the channel of the supervisor that holds a port, or None.

    Args:
        port: path of the device.
        joints: number of joints of the robot.
    """
    name = _name(port)
    addresses = (address for folder in address_folders() for address in _read_all(folder, (name,)))
    channels = (_connect(address) for address in addresses if address.joints == joints)
    return next((channel for channel in channels if channel is not None), None)


def find_supervisors() -> Iterator[Channel]:
    """Yield the channels of all running supervisors of this user, each once.

    Several processes hold the memory of one channel: the supervisor, its parent and the planner.
    """
    seen: set[tuple[int, int]] = set()  # published addresses come first, because a stop must not wait for the search
    for address in _all_addresses():
        memory = _memory_identity(address)
        if memory not in seen and (channel := _connect(address)) is not None:
            seen.add(memory)
            yield channel


class _Address(NamedTuple):
    """Location of a supervisor's channel."""

    process: int  # process id
    memory: int  # file descriptor in that process
    joints: int  # number of joints of the robot


def _all_addresses() -> Iterator["_Address"]:
    for folder in address_folders():
        yield from _read_all(folder)
    yield from search_processes()


def search_processes() -> Iterator["_Address"]:
    """Yield the addresses of processes that hold a supervisor channel open."""
    smallest, user = memory_size(1), user_id()
    step = memory_size(2) - smallest  # [bytes] per joint
    with suppress(OSError):
        for process in filter(str.isdecimal, os.listdir(PROCESS_FOLDER)):
            with suppress(OSError):
                descriptors = PROCESS_FOLDER / process / "fd"
                if descriptors.stat().st_uid != user:
                    continue
                for memory in os.listdir(descriptors):
                    if _is_channel(descriptors / memory):
                        joints = 1 + ((descriptors / memory).stat().st_size - smallest) // step
                        yield _Address(int(process), int(memory), joints)


def _read_all(folder: Path, names: Iterable[str] | None = None) -> Iterator["_Address"]:
    """Yield the supervisor addresses stored in a folder of this user."""
    with suppress(OSError), hold_private_folder(folder) as held:
        for name in sorted(held.names()) if names is None else names:
            if "." not in name and (address := _read(held, name)) is not None:  # excludes drafts
                yield address


def _read(folder: HeldFolder, name: str) -> _Address | None:
    """Read a supervisor address from a file of this user.

    None without a valid one.
    """
    with suppress(OSError, ValueError):
        descriptor = folder.open_entry(name, os.O_RDONLY | NO_LINK_FLAG | NO_WAIT_FLAG)
        with os.fdopen(descriptor) as file:
            process, memory, joints = map(int, file.read(64).split())
            if os.fstat(descriptor).st_uid == user_id() and joints > 0:
                return _Address(process, memory, joints)
    return None


def _write(folder: HeldFolder, name: str, text: str) -> None:
    """Write a file in an open folder atomically."""
    draft = f"{name}.{os.getpid()}"
    with suppress(FileNotFoundError):
        folder.remove_entry(draft)
    descriptor = folder.open_entry(draft, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600)
    with os.fdopen(descriptor, "w") as file:
        file.write(text)
    os.replace(
        folder.entry_path(draft), folder.entry_path(name), src_dir_fd=folder.descriptor, dst_dir_fd=folder.descriptor
    )


def _memory_identity(address: _Address) -> tuple[int, int]:
    """Return a channel memory's device and inode, (0, 0) if gone."""
    with suppress(OSError):
        status = (PROCESS_FOLDER / str(address.process) / "fd" / str(address.memory)).stat()
        return status.st_dev, status.st_ino
    return 0, 0


def _connect(address: _Address) -> Channel | None:
    """Open the channel of a running supervisor, or return None."""
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
        if monotonic() - channel.status().clock < ALIVE_TIMEOUT:
            return channel
    return None


def _is_channel(memory: Path) -> bool:
    return os.readlink(memory).startswith(f"/memfd:{MEMORY_NAME}")


def _name(port: str | Path) -> str:
    """Return the name of a port's address file, unique to this boot."""
    boot = b""
    with suppress(OSError):
        boot = (PROCESS_FOLDER / "sys" / "kernel" / "random" / "boot_id").read_bytes()
    name = find_stable_name(Path(os.path.abspath(port)))  # a user's own link survives unplugging
    return sha256(boot + str(name).encode()).hexdigest()[:16]
