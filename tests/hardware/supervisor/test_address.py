"""Discovery of the supervisor that holds a port, from another process."""

import mmap
import os
import pwd
import stat
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

import numpy as np
import pytest

from kinesic.cli.servos import stop
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor import address
from kinesic.hardware.supervisor.address import ALIVE_TIMEOUT, find_faults, find_supervisor, find_supervisors, publish
from kinesic.hardware.supervisor.channel import Channel, Status, map_memory, memory_file, memory_size
from kinesic.host import account_home

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="needs /proc, as kinesic says")
JOINTS = 3  # number of joints of the robot
NOW = 1000.0  # [s] time of the simulated clock
NOBODY = 65_534  # user id of another user


@dataclass
class Held:
    """Port with the channel of the supervisor that holds it."""

    port: Path
    memory: int
    channel: Channel
    folder: Path

    @property
    def file(self) -> Path:
        (only,) = self.folder.iterdir()
        return only

    def found(self) -> bool:
        return find_supervisor(self.port, JOINTS) is not None


def beat(clock: float, *, joints: int = JOINTS) -> Status:
    """Return a status with the given clock time [s]."""
    nowhere = np.zeros(joints)
    return Status(clock=clock, angles=nowhere, setpoints=nowhere, taken=nowhere)


@pytest.fixture
def held(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Held]:
    for name in ("RUNTIME_ROOT", "SHARED_MEMORY"):
        (tmp_path / name).mkdir()
        monkeypatch.setattr(address, name, tmp_path / name)
    monkeypatch.setattr(address, "account_home", lambda _user: tmp_path / "home")
    monkeypatch.setattr(address, "search_processes", lambda: ())  # of other tests
    monkeypatch.setattr(address, "monotonic", lambda: NOW)
    folder = tmp_path / "SHARED_MEMORY" / f"kinesic-{os.geteuid()}"
    octets = memory_size(JOINTS)
    memory = memory_file(octets)
    channel = Channel(map_memory(memory, octets), JOINTS)
    channel.write_status(beat(NOW))
    yield Held(tmp_path / "ttyUSB0", memory, channel, folder)
    os.close(memory)


def test_published_supervisor_is_found_and_reachable(held: Held):
    assert publish([held.port], held.memory, JOINTS) == (held.file,)
    channel = find_supervisor(held.port, JOINTS)
    assert channel is not None
    channel.set("confirm", 1)
    assert held.channel.word("confirm") == 1
    assert not list(held.folder.glob("*.*")), "no draft stays"
    assert stat.S_IMODE(held.folder.stat().st_mode) == 0o700


def test_search_without_ports_finds_each_running_supervisor_once(held: Held):
    publish([held.port, held.port.with_name("ttyUSB1")], held.memory, JOINTS)
    octets = memory_size(JOINTS + 1)
    memory = memory_file(octets)
    other = Channel(map_memory(memory, octets), JOINTS + 1)
    other.write_status(beat(NOW, joints=JOINTS + 1))
    publish([held.port.with_name("ttyACM0")], memory, JOINTS + 1)
    (held.folder / f"{held.folder.name}-of-another-program").write_text("1 2 3")
    channels = find_supervisors()
    assert sorted(len(channel.status().angles) for channel in channels) == [JOINTS, JOINTS + 1]
    held.channel.write_status(beat(NOW - ALIVE_TIMEOUT))
    assert [len(channel.status().angles) for channel in find_supervisors()] == [JOINTS + 1]
    os.close(memory)


def test_supervisor_memory_that_is_open_in_several_processes_is_found_once(held: Held, monkeypatch: pytest.MonkeyPatch):
    publish([held.port], held.memory, JOINTS)
    copy = os.dup(held.memory)
    other = memory_file(memory_size(JOINTS))
    Channel(map_memory(other, memory_size(JOINTS)), JOINTS).write_status(beat(NOW))
    holders = [address._Address(os.getpid(), memory, JOINTS) for memory in (copy, held.memory, other)]
    monkeypatch.setattr(address, "search_processes", lambda: holders)
    assert len(list(find_supervisors())) == 2
    for memory in (copy, other):
        os.close(memory)


def test_search_for_supervisors_leaves_no_file_open(held: Held):
    publish([held.port], held.memory, JOINTS)
    before = len(os.listdir("/proc/self/fd"))
    kept = [find_supervisor(held.port, JOINTS) for _ in range(3)]
    assert all(kept)
    assert find_supervisor(held.port, JOINTS + 1) is None
    del kept
    assert len(os.listdir("/proc/self/fd")) == before


def test_address_file_has_permissions_for_its_owner_only(held: Held):
    publish([held.port], held.memory, JOINTS)
    assert stat.S_IMODE(held.file.stat().st_mode) == 0o600


def test_supervisor_is_found_only_through_its_published_ports(held: Held):
    second, third = (held.port.with_name(name) for name in ("ttyUSB1", "ttyUSB2"))
    assert len(set(publish([held.port, second], held.memory, JOINTS))) == 2
    assert held.found()
    assert (find_supervisor(second, JOINTS) is not None, find_supervisor(third, JOINTS)) == (True, None)


def test_supervisor_is_found_through_a_relative_port_path(held: Held, monkeypatch: pytest.MonkeyPatch):
    publish([held.port], held.memory, JOINTS)
    monkeypatch.chdir(held.port.parent)
    assert find_supervisor("ttyUSB0", JOINTS) is not None


def test_new_supervisor_replaces_the_address_file_of_a_dead_supervisor(held: Held):
    publish([held.port], held.memory, JOINTS)
    held.file.write_text("1 1 3")
    held.file.with_name(f"{held.file.name}.{os.getpid()}").write_text("a draft that was left")
    publish([held.port], held.memory, JOINTS)
    assert held.found()


def test_supervisor_without_a_writable_address_folder_is_refused(held: Held, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(address, "SHARED_MEMORY", held.folder / "missing")
    with pytest.raises(BusError, match=r"`kinesic servos stop` could not find this robot \(no folder is available"):
        publish([held.port], held.memory, JOINTS)
    assert not held.found()


def test_no_supervisor_address_is_published_on_macos(held: Held, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(address, "SHARED_MEMORY", held.folder / "missing")
    monkeypatch.setattr(sys, "platform", "darwin")
    assert publish([held.port], held.memory, JOINTS) == ()


def squat(path: Path, kind: str) -> None:
    """Occupy the folder's name, as another user can in a shared directory."""
    match kind:
        case "file":
            path.write_text("1 2 3")
        case "link":
            (path.parent / "theirs").mkdir(exist_ok=True)
            path.symlink_to("theirs")
        case "open":
            path.mkdir()
            path.chmod(0o777)
        case _:
            path.mkdir(mode=0o755)
            os.chown(path, NOBODY, NOBODY)


OCCUPANT_KINDS = ["file", "link", "open", *(["foreign"] if os.geteuid() == 0 else [])]  # files in the folder's place


@pytest.mark.parametrize("kind", OCCUPANT_KINDS)
def test_supervisor_is_found_although_another_user_owns_the_address_folder(held: Held, kind: str):
    squat(held.folder, kind)
    home = held.port.parent / "home"
    home.mkdir()
    (file,) = publish([held.port], held.memory, JOINTS)
    assert file.is_relative_to(home)
    assert held.found()
    assert len(list(find_supervisors())) == 1


@pytest.mark.parametrize("kind", OCCUPANT_KINDS)
def test_robot_is_refused_without_usable_address_folder(held: Held, kind: str):
    squat(held.folder, kind)
    with pytest.raises(BusError, match=rf"could not find this robot \({held.folder}: "):
        publish([held.port], held.memory, JOINTS)
    assert not held.found()
    (fault,) = find_faults()
    assert fault.startswith(f"{held.folder}: ")
    if kind == "foreign":
        assert fault.endswith(f"it belongs to another user (uid {NOBODY})")
    with pytest.raises(BusError, match=rf"none of your programs drives servos from this machine; {held.folder}: "):
        stop.stop_robots()


def test_address_is_published_in_the_session_folder_and_searched_in_all_folders(
    held: Held, monkeypatch: pytest.MonkeyPatch
):
    """A search may run in another environment or login session."""
    session = held.port.parent / "RUNTIME_ROOT" / str(os.geteuid())
    session.mkdir()
    (file,) = publish([held.port], held.memory, JOINTS)
    assert file.is_relative_to(session)
    monkeypatch.setenv("XDG_RUNTIME_DIR", "/nonexistent")
    monkeypatch.delenv("HOME", raising=False)
    assert held.found()
    file.unlink()
    assert not held.found()
    (file.parent).rmdir()
    session.rmdir()
    publish([held.port], held.memory, JOINTS)
    session.mkdir()
    assert held.found(), "a session that began later hides nothing"


def test_supervisor_is_found_by_process_search_without_its_address_file(held: Held, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.undo()
    processes = set(address.search_processes())
    assert (os.getpid(), held.memory, JOINTS) in processes
    held.channel.write_status(beat(monotonic()))
    assert JOINTS in {len(channel.status().angles) for channel in find_supervisors()}


@pytest.mark.parametrize(("since", "alive"), [(-1.0, True), (0.5, True), (ALIVE_TIMEOUT, False), (5.0, False)])
def test_supervisor_whose_last_status_is_too_old_is_ignored(held: Held, since: float, alive: bool):
    publish([held.port], held.memory, JOINTS)
    held.channel.write_status(beat(NOW - since))
    assert held.found() is alive


def test_supervisor_of_robot_with_other_joints_is_ignored(held: Held):
    publish([held.port], held.memory, JOINTS)
    assert [find_supervisor(held.port, joints) for joints in (JOINTS + 1, JOINTS - 1)] == [None, None]


def test_supervisor_of_a_robot_with_one_joint_is_found(held: Held):
    memory = memory_file(memory_size(1))
    Channel(map_memory(memory, memory_size(1)), 1).write_status(beat(NOW, joints=1))
    publish([held.port], memory, 1)
    assert find_supervisor(held.port, 1) is not None
    os.close(memory)


def test_address_of_an_ended_process_is_ignored(held: Held):
    publish([held.port], held.memory, JOINTS)
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    held.file.write_text(f"{ended.pid} {held.memory} {JOINTS}")
    assert not held.found()


INVALID_ADDRESSES = ("", "nonsense", "1 3", "1 2 3 4", "-1 4 3", "../.. 4 3", "1 4 0", "1 4 -3", "1 4 999999999999")


@pytest.mark.parametrize("text", INVALID_ADDRESSES)
def test_search_with_an_invalid_address_finds_no_supervisor(held: Held, text: str):
    publish([held.port], held.memory, JOINTS)
    held.file.write_text(text)
    assert not held.found()


def test_address_file_that_is_a_link_is_not_followed(held: Held):
    publish([held.port], held.memory, JOINTS)
    elsewhere = held.folder.with_name("elsewhere")  # in the same file system
    held.file.rename(elsewhere)
    link = Path(publish([held.port], held.memory, JOINTS)[0])
    link.unlink()
    link.symlink_to(elsewhere)
    assert not held.found()


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give files away")
def test_address_file_of_another_user_is_ignored(held: Held):
    publish([held.port], held.memory, JOINTS)
    os.chown(held.file, NOBODY, NOBODY)
    assert not held.found()


def test_shared_memory_of_other_programs_is_not_taken_for_a_supervisor(held: Held):
    """Memory or files of equal size with a running clock do not count."""
    octets = memory_size(JOINTS)
    copy = bytes(map_memory(held.memory, octets))
    foreign = os.memfd_create("other")
    file = os.open(held.folder.with_name("kinesic"), os.O_CREAT | os.O_RDWR)
    for descriptor in (foreign, file):
        os.ftruncate(descriptor, octets)
        with mmap.mmap(descriptor, octets) as memory:
            memory[:] = copy
        publish([held.port], descriptor, JOINTS)
        assert not held.found()
        os.close(descriptor)
    publish([held.port], held.memory, JOINTS)
    assert held.found()


def test_only_processes_of_this_user_are_searched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Processes of other users must not receive commands for a supervisor."""
    for process, memory in (("123", "4"), ("124", "5"), ("self", "6")):
        (tmp_path / process / "fd").mkdir(parents=True)
        (tmp_path / process / "fd" / memory).write_bytes(bytes(memory_size(JOINTS)))
    (tmp_path / "125").mkdir()
    monkeypatch.setattr(address, "PROCESS_FOLDER", tmp_path)
    monkeypatch.setattr(address, "_is_channel", lambda memory: memory.name != "5")
    assert list(address.search_processes()) == [(123, 4, JOINTS)]
    monkeypatch.setattr(os, "geteuid", lambda: NOBODY)
    assert list(address.search_processes()) == []


def test_user_without_account_has_no_home_folder(monkeypatch: pytest.MonkeyPatch):
    def fail(user: int) -> None:
        raise KeyError(user)

    assert account_home(os.geteuid()) == Path(pwd.getpwuid(os.geteuid()).pw_dir)
    monkeypatch.setattr(pwd, "getpwuid", fail)
    assert account_home(NOBODY) is None
