"""Makes servos on wires a sink: commands go to a supervisor in a process of its own, which no crash here can stop."""

import os
import subprocess
import sys
import time
from collections import deque
from collections.abc import Iterable, Mapping
from pathlib import Path
from threading import Lock

import msgspec
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.body.servo import follow_lags
from kinesic.hardware.bus.telemetry import Telemetry
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.address import find_supervisor
from kinesic.hardware.supervisor.channel import Channel, Note, Status, map_memory, memory_file, memory_size
from kinesic.hardware.supervisor.manifest import Manifest, Member, raised_joints
from kinesic.hardware.supervisor.settings import USUAL, Policy, SupervisorOrder, SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage

START = 30.0  # [s] until the supervisor must have told something
LOOK = 0.005  # [s] between two looks while waiting
READY = frozenset({Stage.LIMP, Stage.HOLD})  # what a start ends with


class Servos:
    """The servos of a robot: `write` never waits, `close` waits until the robot has folded and is released."""

    def __init__(
        self,
        robot: Robot,
        ports: Mapping[str, str | Path],
        *,
        settings: SupervisorSettings = USUAL,
        log: Path | None = None,
    ) -> None:
        """Starts the supervisor, which checks and configures the servos. Nothing is energised before a command.

        Args:
            robot: with [[bus]] tables.
            ports: path of the device by the name of each bus.
            settings: figures of the supervisor.
            log: file to which events are added, a JSON object per line.

        Raises:
            ConfigError: the robot has no servos on wires, or they are described wrongly.
            BusError: a port or a servo is missing or wrong; one line each.
        """
        manifest = Manifest.of(robot)
        check_ports(robot, manifest, ports)
        self._manifest, self._joints = manifest, len(manifest.rest)
        check_free(ports.values(), self._joints)
        octets = memory_size(self._joints)
        memory = memory_file(octets)
        self._channel = Channel(map_memory(memory, octets), self._joints)
        self._lock = Lock()  # somebody may look on while another waits in `close`
        self._lags = follow_lags(robot.drives)
        self._waiting: deque[tuple[float, Floats, Floats]] = deque()  # commands for which there was no room
        self._notes: list[Note] = []
        self._reasons: list[str] = []  # why servos were refused, or failed
        order = SupervisorOrder(
            robot=str(robot.path.resolve()),
            ports={name: str(path) for name, path in ports.items()},
            memory=memory,
            settings=settings,
            log=str(log.resolve()) if log is not None else None,
        )
        self._process = subprocess.Popen(
            [sys.executable, "-m", "kinesic.hardware.supervisor"],
            stdin=subprocess.PIPE,
            pass_fds=(memory,),
            start_new_session=True,  # Ctrl-C in the terminal is not for it
        )
        os.close(memory)
        if self._process.stdin is not None:
            self._process.stdin.write(msgspec.json.encode(order) + b"\n")
            self._process.stdin.flush()
        self._wait_until_ready()

    @property
    def pid(self) -> int:
        """Id of the supervisor's process."""
        return self._process.pid

    @property
    def running(self) -> bool:
        """Whether the supervisor lives."""
        return self._process.poll() is None

    def write(self, command: Command, /) -> None:
        """Hands one command on. Never waits: commands for which there is no room yet wait here.

        Raises:
            BusError: there is no supervisor any more, or the goals are not one number for each joint.
        """
        if command.goals.shape != (self._joints,) or not np.isfinite(command.goals).all():
            raise BusError(f"goals at {command.time:.3f} s are {command.goals}, must be {self._joints} finite numbers")
        self._waiting.append((command.time, command.goals, self._lags * command.speeds))
        self._pass_on()
        if not self.running or self._channel.status().waits == "confirmation":
            raise BusError(self._epitaph())

    def positions(self) -> Floats:
        """Returns (n,) [rad] where the joints are; NaN for a servo that did not answer."""
        return self.state().angles

    def state(self) -> Status:
        """Returns the last status of the supervisor."""
        self._pass_on()
        return self._channel.status()

    def telemetry(self) -> Telemetry:
        """Returns how every servo is, in the order of `members`; said anew 20 times a second."""
        return self._channel.telemetry()

    @property
    def members(self) -> tuple[Member, ...]:
        """All servos: which they are, and what each of them turns."""
        return self._manifest.members

    def history(self) -> tuple[Status, ...]:
        """Returns the status in every cycle since the last call: goals and angles for reports and fits."""
        return self._channel.history()

    def events(self) -> tuple[Note, ...]:
        """Returns what has happened since the last call."""
        self._collect()
        with self._lock:
            found, self._notes = tuple(self._notes), []
        return found

    def stop(self, policy: Policy = "hold") -> None:
        """Stops in an emergency: holds where the robot is until `release`, or lets go."""
        self._channel.stop(policy)

    def slow_to(self, pace: float) -> None:
        """Lets the performance run at a pace, 0..1, at most; 1: as planned. It holds until the next call."""
        self._channel.slow_to(pace)

    def resume(self) -> None:
        """Lets the performance go on after an emergency stop, or after an interruption of more than a second.

        Whoever calls this has seen that nobody is in the way. While something is still amiss, it is of no effect.
        """
        self._channel.set("estop", 0)
        self._channel.set("resume", self._channel.word("resume") + 1)

    def release(self) -> None:
        """Ends the performance now: folds to rest, then takes the torque; also after an emergency stop."""
        self._channel.set("release", self._channel.word("release") + 1)

    def close(self) -> None:
        """Lets what was written be performed, then the robot fold and go limp; returns when that is done.

        Ctrl-C meanwhile, or `release` before, makes it fold at once. It returns, too, when a limb is raised and cannot
        fold: the supervisor goes on holding it, and outlives this process.

        Raises:
            BusError: a limb is held, or it is not sure that every servo is limp.
        """
        if self._channel.word("estop"):
            self.release()
        try:
            while self.running and not self._channel.word("ended"):
                self._pass_on()
                if self._waiting and not self._channel.word("release"):
                    time.sleep(LOOK)
                else:
                    self._channel.set("ended", 1)
            self._wait_until_over()
        except KeyboardInterrupt:
            self.release()
            self._wait_until_over()
            raise
        finally:
            self._leave()
        if self.running or self._channel.status().energised:
            raise BusError(self._epitaph())

    def _wait_until_over(self) -> None:
        """Waits until the supervisor has ended, or holds what a person must let fall."""
        while self.running and self._channel.status().waits != "confirmation":
            time.sleep(LOOK)

    def _leave(self) -> None:
        """Lets go of the pipe: the supervisor folds and releases by itself."""
        if self._process.stdin is not None:
            self._process.stdin.close()

    def _pass_on(self) -> None:
        with self._lock:
            while self._waiting and self._channel.write(*self._waiting[0]):
                self._waiting.popleft()

    def _collect(self) -> None:
        with self._lock:
            found = self._channel.notes()
            self._notes += found
            self._reasons += [note.text for note in found if note.kind in ("refused", "failed")]

    def _wait_until_ready(self) -> None:
        limit = time.monotonic() + START
        while self._channel.status().stage not in READY:
            if not self.running or time.monotonic() > limit:
                self._leave()
                self._process.wait()
                self._collect()
                lost = f"the supervisor did not start (exit code {self._process.returncode})"
                raise BusError("\n".join(self._reasons) or lost)
            time.sleep(LOOK)

    def _epitaph(self) -> str:
        self._collect()
        code, why = self._process.poll(), f": {self._reasons[-1]}" if self._reasons else ""
        if code is None:
            falls = ", ".join(raised_joints(self._manifest, self._channel.status().angles)) or "a servo that is silent"
            return f"the robot cannot fold{why}; held until `kinesic servos release` lets it fall: {falls}"
        if code:
            return (
                f"the supervisor died (exit code {code}); the servos have stopped with torque on: "
                "open them anew to take them over, or let them go with `kinesic servos release`"
            )
        if self._channel.status().energised:
            return f"the servos hold where they stopped, and may have torque{why}; switch the power off"
        return f"the supervisor has released the servos and ended{why}; open them anew"


def check_ports(robot: Robot, manifest: Manifest, ports: Mapping[str, str | Path]) -> None:
    """Checks that every bus has a port, and every port a bus.

    Raises:
        BusError: names what is missing.
    """
    wrong = sorted(set(manifest.bauds) ^ set(ports))
    if wrong:
        need = ", ".join(f"{name}=PATH" for name in manifest.bauds)
        raise BusError(f"ports are given for {', '.join(ports) or 'no bus'}, but {robot.name} needs {need}")


def check_free(ports: Iterable[str | Path], joints: int) -> None:
    """Checks that no supervisor holds the ports of a robot with so many joints.

    Raises:
        BusError: one does; a line for each port, and how to get it.
    """
    lines: list[str] = []
    for path in ports:
        if (channel := find_supervisor(path, joints)) is None:
            continue
        status = channel.status()
        if status.waits == "confirmation":
            lines.append(f"{path}: a supervisor holds limbs that cannot fold; `kinesic servos release` lets them fall")
        else:
            what = f"another program uses this port: a supervisor drives the robot ({status.stage.value})"
            lines.append(f"{path}: {what}; end it, or use `kinesic servos release`")
    if lines:
        raise BusError("\n".join(lines))
