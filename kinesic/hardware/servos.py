"""Motion output that drives servos through a separate supervisor process.

A crash of this process cannot stop the supervisor.
"""

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
from kinesic.body.servo import tracking_lags
from kinesic.hardware.bus.telemetry import Telemetry
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.address import find_supervisor
from kinesic.hardware.supervisor.caps import ServoCaps
from kinesic.hardware.supervisor.channel import Channel, Status, map_memory, memory_file, memory_size
from kinesic.hardware.supervisor.manifest import Manifest, Member, describe_raised_joints
from kinesic.hardware.supervisor.notes import Note
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS, Policy, SupervisorOrder, SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.supervisor.wiring_check import check_bus_loads, explain_missing_watchdog

START_TIMEOUT = 30.0  # [s] time limit for the supervisor to become ready
UNWATCHED_KIND = "no watchdog"  # kind of the event that servos have no bus watchdog
POLL_INTERVAL = 0.005  # [s] pause between two checks of the supervisor's state
READY_STAGES = frozenset({Stage.LIMP, Stage.HOLD})  # Stages in which the supervisor accepts commands


class Servos:
    """Servos of a robot, driven through a supervisor process.

    `write` never waits. `close` waits until the robot has folded and torque is off.
    """

    def __init__(
        self,
        robot: Robot,
        ports: Mapping[str, str | Path],
        *,
        settings: SupervisorSettings = DEFAULT_SETTINGS,
        log: Path | None = None,
    ) -> None:
        """Start the supervisor, which checks and configures the servos.

        Torque stays off until the first command.

        Args:
            robot: robot with [[bus]] tables.
            ports: bus name -> path of its device.
            settings: settings of the supervisor.
            log: file to which events are appended, one JSON object per line.

        Raises:
            ConfigError: the robot has no servos on wires, or their description is invalid.
            BusError: a port or a servo is missing or unsuitable; one line each.
        """
        manifest = Manifest.of(robot)
        check_ports(robot, manifest, ports)
        check_bus_loads(manifest, period=settings.period)
        self._manifest, self._joints = manifest, len(manifest.rest)
        check_ports_free(ports.values(), self._joints)
        octets = memory_size(self._joints)
        memory = memory_file(octets)
        self._channel = Channel(map_memory(memory, octets), self._joints)
        self.settings = settings
        self._lock = Lock()  # another thread may read the state while one waits in `close`
        self._lags = tracking_lags(robot.drives)
        self._waiting: deque[tuple[float, Floats, Floats]] = deque()  # commands that did not fit into the channel
        unwatched = explain_missing_watchdog(manifest)
        self._notes = [Note(time.monotonic(), -1, UNWATCHED_KIND, unwatched)] if unwatched else []
        self._reasons: list[str] = []  # reasons of refused or failed servos
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
            start_new_session=True,  # Ctrl-C in the terminal must not reach it
        )
        os.close(memory)
        if self._process.stdin is not None:
            self._process.stdin.write(msgspec.json.encode(order) + b"\n")
            self._process.stdin.flush()
        self._wait_until_ready()

    @property
    def pid(self) -> int:
        """Process id of the supervisor."""
        return self._process.pid

    def limit(self, caps: ServoCaps) -> None:
        """Cap velocity and power of the servos from the next cycle on."""
        self._channel.write_caps(caps)

    @property
    def running(self) -> bool:
        """Whether the supervisor process is alive."""
        return self._process.poll() is None

    def write(self, command: Command, /) -> None:
        """Pass one command to the supervisor without waiting.

        Commands that do not fit into the channel yet are queued here.

        Raises:
            BusError: the supervisor has ended, or the setpoints are not one finite number per joint.
        """
        if command.setpoints.shape != (self._joints,) or not np.isfinite(command.setpoints).all():
            raise BusError(
                f"setpoints at {command.time:.3f} s are {command.setpoints}, must be {self._joints} finite numbers"
            )
        self._waiting.append((command.time, command.setpoints, self._lags * command.velocities))
        self._pass_on()
        if not self.running or self._channel.status().waits == "confirmation":
            raise BusError(self._explain_end())

    def positions(self) -> Floats:
        """Return the measured angles (n,) [rad].

        NaN for a silent servo.
        """
        return self.state().angles

    def state(self) -> Status:
        """Return the latest status of the supervisor."""
        self._pass_on()
        return self._channel.status()

    def telemetry(self) -> Telemetry:
        """Return the latest telemetry of all servos.

        It is updated 20 times a second, in the order of `members`.
        """
        return self._channel.telemetry()

    @property
    def members(self) -> tuple[Member, ...]:
        """All servos with their hinges."""
        return self._manifest.members

    def history(self) -> tuple[Status, ...]:
        """Return the status of every cycle since the last call.

        Reports and parameter fits use its setpoints and angles.
        """
        return self._channel.history()

    def events(self) -> tuple[Note, ...]:
        """Return the supervisor's events since the last call."""
        self._collect()
        with self._lock:
            notes, self._notes = tuple(self._notes), []
        return notes

    def stop(self, policy: Policy = "hold") -> None:
        """Request an emergency stop of the servos.

        Args:
            policy: hold the position until `resume` or `release`, or switch torque off.
        """
        self._channel.stop(policy)

    def slow_to(self, pace: float) -> None:
        """Set an upper limit of the time scale, 0..1."""
        self._channel.slow_to(pace)

    def resume(self) -> None:
        """Resume after an emergency stop, or an interruption of over 1 s.

        The caller must have checked that nobody is near the robot. The call has no effect while a fault persists.
        """
        self._channel.set("estop", 0)
        self._channel.set("resume", self._channel.word("resume") + 1)

    def release(self) -> None:
        """End the performance now: move to the rest posture, switch torque off.

        This also works after an emergency stop.
        """
        self._channel.set("release", self._channel.word("release") + 1)

    def close(self) -> None:
        """Finish all commands, move to the rest posture, and switch torque off.

        The call returns when that is done. Ctrl-C, or an earlier `release`, makes the robot fold at once. The call also
        returns if a limb is raised and cannot fold: the supervisor then keeps holding it and outlives this process.

        Raises:
            BusError: a limb is held, or torque may still be on.
        """
        if self._channel.word("estop"):
            self.release()
        try:
            while self.running and not self._channel.word("ended"):
                self._pass_on()
                if self._waiting and not self._channel.word("release"):
                    time.sleep(POLL_INTERVAL)
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
            raise BusError(self._explain_end())

    def _wait_until_over(self) -> None:
        """Wait until the supervisor has ended, or waits for a confirmation."""
        while self.running and self._channel.status().waits != "confirmation":
            time.sleep(POLL_INTERVAL)

    def _leave(self) -> None:
        """Close the pipe, so that the supervisor moves the arms to rest."""
        if self._process.stdin is not None:
            self._process.stdin.close()

    def _pass_on(self) -> None:
        with self._lock:
            while self._waiting and self._channel.write(*self._waiting[0]):
                self._waiting.popleft()

    def _collect(self) -> None:
        with self._lock:
            notes = self._channel.notes()
            self._notes += notes
            self._reasons += [note.text for note in notes if note.kind in ("refused", "failed")]

    def _wait_until_ready(self) -> None:
        limit = time.monotonic() + START_TIMEOUT
        while self._channel.status().stage not in READY_STAGES:
            if not self.running or time.monotonic() > limit:
                self._leave()
                self._process.wait()
                self._collect()
                lost = f"the supervisor did not start (exit code {self._process.returncode})"
                raise BusError("\n".join(self._reasons) or lost)
            time.sleep(POLL_INTERVAL)

    def _explain_end(self) -> str:
        self._collect()
        code, why = self._process.poll(), f": {self._reasons[-1]}" if self._reasons else ""
        if code is None:
            falls = ", ".join(describe_raised_joints(self._manifest, self._channel.status().angles)) or "a silent servo"
            return f"the robot cannot fold{why}; held until `kinesic servos release` lets it fall: {falls}"
        if code:
            return (
                f"the supervisor died (exit code {code}); the servos have stopped with torque on: "
                "open them again to take them over, or release them with `kinesic servos release`"
            )
        if self._channel.status().energised:
            return f"the servos hold where they stopped, and may have torque{why}; switch the power off"
        return f"the supervisor has released the servos and ended{why}; open them again"


def check_ports(robot: Robot, manifest: Manifest, ports: Mapping[str, str | Path]) -> None:
    """Check that ports and buses match one to one.

    Raises:
        BusError: a port is missing or unknown.
    """
    mismatched = sorted(set(manifest.bauds) ^ set(ports))
    if mismatched:
        required = ", ".join(f"{name}=PATH" for name in manifest.bauds)
        raise BusError(f"ports are given for {', '.join(ports) or 'no bus'}, but {robot.name} needs {required}")


def check_ports_free(ports: Iterable[str | Path], joints: int) -> None:
    """Check that no supervisor holds the ports of a robot.

    Args:
        ports: paths of the ports.
        joints: number of joints of the robot.

    Raises:
        BusError: a supervisor holds a port; one line per port, with a remedy.
    """
    lines: list[str] = []
    for path in ports:
        if (channel := find_supervisor(path, joints)) is None:
            continue
        status = channel.status()
        if status.waits == "confirmation":
            lines.append(f"{path}: a supervisor holds limbs that cannot fold; `kinesic servos release` lets them fall")
        else:
            reason = f"another program uses this port: a supervisor drives the robot ({status.stage.value})"
            lines.append(f"{path}: {reason}; end it, or use `kinesic servos release`")
    if lines:
        raise BusError("\n".join(lines))
