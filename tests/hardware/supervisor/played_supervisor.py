"""Servos whose supervisor process is simulated by the test."""

import os
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.hardware import servos as servos_module
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.channel import Channel, Status, map_memory, memory_size
from kinesic.hardware.supervisor.notes import Note
from kinesic.hardware.supervisor.state_machine import Stage

JOINTS = 4
PORTS = {"left": "/dev/left", "right": Path("/dev/right")}


class PlayedSupervisor:
    """Simulated process that answers in the channel when the test permits."""

    def __init__(self, arguments: list[str], *, stdin: int, pass_fds: tuple[int, ...], start_new_session: bool) -> None:
        self.arguments, self.session, self.pid = arguments, start_new_session, 4711
        (memory,) = pass_fds
        self.channel = Channel(map_memory(memory, memory_size(JOINTS)), JOINTS)
        reader, writer = os.pipe()
        self.stdin, self.reader = os.fdopen(writer, "wb"), os.fdopen(reader, "rb")
        self.returncode: int | None = None
        self.waits = 0
        self.schedule: list[Callable[[PlayedSupervisor], object]] = []  # one call per sleep of the planner

    def poll(self) -> int | None:
        return self.returncode

    def wait(self) -> None:
        self.waits += 1
        self.returncode = 2

    def tell(self, stage: Stage = Stage.LIMP, **status: object) -> None:
        self.channel.write_status(Status(**{"stage": stage, **standing(), **status}))

    def note(self, kind: str, text: str) -> None:
        self.channel.note(Note(1.0, -1, kind, text))

    def end(self, code: int = 0, **status: object) -> None:
        self.tell(Stage.CLOSED, **status)
        self.returncode = code


def standing() -> dict[str, object]:
    zero = np.zeros(JOINTS)
    return {"angles": zero, "setpoints": zero, "taken": zero}


class Rig:
    """Servos with their simulated supervisor."""

    def __init__(self, robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
        self.robot = robot
        self.supervisors: list[PlayedSupervisor] = []
        self.clock, self.sleeps = 100.0, list[float]()
        self.found: dict[str, Channel] = {}
        self.searched: list[tuple[object, int]] = []
        self.start_schedule: list[Callable[[PlayedSupervisor], object]] = [lambda supervisor: supervisor.tell()]
        monkeypatch.setattr(servos_module.subprocess, "Popen", self._start)
        monkeypatch.setattr(servos_module, "find_supervisor", self._find)
        monkeypatch.setattr(servos_module, "time", SimpleNamespace(sleep=self._sleep, monotonic=lambda: self.clock))

    @property
    def supervisor(self) -> PlayedSupervisor:
        return self.supervisors[-1]

    def _start(self, *arguments: object, **options: object) -> PlayedSupervisor:
        self.supervisors.append(PlayedSupervisor(*arguments, **options))
        self.supervisor.schedule = list(self.start_schedule)
        return self.supervisor

    def _find(self, path: object, joints: int) -> Channel | None:
        self.searched.append((path, joints))
        return self.found.get(str(path))

    def _sleep(self, seconds: float) -> None:
        self.sleeps.append(seconds)
        self.clock += seconds
        if self.supervisor.schedule:
            self.supervisor.schedule.pop(0)(self.supervisor)

    def open(self, **options: object) -> tuple[Servos, PlayedSupervisor]:
        servos = Servos(self.robot, PORTS, **options)
        return servos, self.supervisor

    def command(self, time: float, angle: float = 0.0, velocity: float = 0.0) -> Command:
        still = np.zeros(JOINTS)
        return Command(time, still, np.full(JOINTS, velocity), still, np.full(JOINTS, angle))
