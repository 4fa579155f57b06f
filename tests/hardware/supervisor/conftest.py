"""Small robot under a supervisor in virtual time.

It runs on kinesic's virtual servos or on the independent ones.
"""

import json
import mmap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.supervisor.channel import Channel, Status, memory_size
from kinesic.hardware.supervisor.context import SupervisorContext
from kinesic.hardware.supervisor.manifest import Manifest, Member
from kinesic.hardware.supervisor.notes import Note
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.supervisor.status import EventLog
from kinesic.hardware.supervisor.supervisor import Supervisor
from kinesic.hardware.virtual.faults import NO_FAULTS, FaultPlan, PlannedFault
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, describe_cables

from ..conftest import BUILDERS
from .judged import Room

PERIOD = 0.01
QUICK_SETTINGS = SupervisorSettings(pace=3.0, patience=0.5, slow=0.2)  # fast moves and short waits
MODEL = "xm430_w350"
GAINS = {
    MODEL: (800, 0),
    "sts3215": (16, 32),
    "scs0009": (15, 0),
    "ax12": (0, 0),
    "mx28": (32, 0),
}  # P and D gain by servo model


@pytest.fixture(params=["kinesic", pytest.param("manual", marks=pytest.mark.soak)])
def servos(request: pytest.FixtureRequest) -> str:
    """Name of the implementation of virtual servos under test.

    Every run tests the independent servos in tests/hardware/proof.
    """
    return str(request.param)


@pytest.fixture(scope="session")
def robot() -> Robot:
    """Return a robot with five servos on two wires."""
    return Robot.load(Path(__file__).with_name("little.toml"))


class Desk:
    """Supervisor with its servos, as seen by a planner."""

    def __init__(
        self,
        manifest: Manifest,
        wires: Sequence[Cable],
        log: Path,
        *,
        settings: SupervisorSettings = QUICK_SETTINGS,
        servos: str = "kinesic",
        assemble: Callable | None = None,  # builds kinesic's virtual servos with other physics
    ) -> None:
        self.manifest, self.settings, self.log, self.alive = manifest, settings, log, True
        self.servos, (build, self.wire) = servos, BUILDERS[servos]
        self.plant, self.buses = (assemble or build)(wires)
        self.jumps: list[float] = []
        self.dropped: list[str] = []  # hinges whose torque was taken while they were raised
        self.journal_file: EventLog | None = None
        self.start()

    def start(self) -> None:
        """Start a new supervisor on the same servos."""
        joints = len(self.manifest.rest)
        self.end()
        self.journal_file = EventLog(self.log)
        self.channel = Channel(mmap.mmap(-1, memory_size(joints)), joints)
        self.wires = {name: self.wire(bus, name=name, time=self.plant.time) for name, bus in self.buses.items()}
        self.supervisor = Supervisor(
            self.manifest,
            SupervisorContext(self.wires.__getitem__, self.channel, lambda: self.alive, self.journal_file),
            self.settings,
            watchdog=self.settings.watchdog,
        )

    def end(self) -> None:
        if self.journal_file is not None:
            self.journal_file.close()

    def open(self) -> None:
        self.supervisor.open()

    @property
    def stage(self) -> Stage:
        return self.supervisor.state.stage

    @property
    def status(self) -> Status:
        return self.channel.status()

    def true(self, register: Register) -> Ticks:
        """Return actual register values in manifest order."""
        return np.array([servo.memory[register] for servo in self.plant.servos])

    @property
    def present_position(self) -> Ticks:
        return np.array([servo.electronics.present_position() for servo in self.plant.servos])

    def cycle(self) -> None:
        """Run one period, and check that no servo jumps at torque on."""
        supervisor, torque = self.supervisor, self.true(Register.TORQUE_ENABLE)
        due = supervisor.now() + self.settings.period
        supervisor.step()
        self._look_at_torque(torque, self.true(Register.TORQUE_ENABLE))
        supervisor.sleep(due)
        self.pass_time(0.0)

    def _look_at_torque(self, before: Ticks, after: Ticks) -> None:
        """Record servos energised away from their goals or released while raised.

        Unless he has failed, reboots, or a person wanted it.
        """
        if (before == after).all():
            return
        came, lost = (before == 0) & (after != 0), (before != 0) & (after == 0) & self.raised
        self.jumps += np.abs(self.true(Register.GOAL_POSITION) - self.present_position)[came].tolist()
        if self.channel.word("confirm") or self.channel.word("estop") == 2:
            return
        for k in np.flatnonzero(lost):
            firmware = self.plant.servos[k].electronics
            if firmware.up and not firmware.latched:
                self.dropped.append(self.manifest.members[k].hinge)

    def pass_time(self, seconds: float) -> None:
        """Let time pass without commands."""
        for wire in self.wires.values():
            wire.sleep(wire.now() + seconds)
        self.plant.advance(max(wire.now() for wire in self.wires.values()))

    @property
    def raised(self) -> np.ndarray:
        """Return which servos (m,) are more than 5 degrees from rest."""
        away = (
            self.manifest.scale.angles(self.present_position.astype(float)) - self.manifest.rest[self.manifest.joints]
        )
        return np.abs(away) > np.radians(5.0)

    def consent(self) -> None:
        """Request a resume after an emergency stop, as a person does."""
        self.channel.set("estop", 0)
        self.channel.set("resume", self.channel.word("resume") + 1)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / self.settings.period)):
            if self.supervisor.done:
                return
            self.cycle()

    def until(self, *stages: Stage, within: float = 30.0) -> float:
        """Run until one of the stages, and return the duration [s]."""
        began = self.supervisor.now()
        while self.stage not in stages and not (Stage.CLOSED in stages and self.supervisor.done):
            assert self.supervisor.now() - began < within, (self.stage, self.kinds()[-12:])
            assert not self.supervisor.done, self.kinds()[-12:]
            self.cycle()
        return self.supervisor.now() - began

    def expose(self, *faults: PlannedFault, bus: str = "") -> None:
        """Apply faults from now on, to the first wire or the given bus."""
        self.buses[bus or next(iter(self.buses))].expose(FaultPlan(faults, seed=3))

    def perform(self, seconds: float, *, amplitude: float = 0.4, begin: float = 0.0) -> None:
        """Write a motion from rest to rest into the channel, far ahead."""
        for k in range(round(seconds / PERIOD) + 1):
            time = k * PERIOD
            assert self.channel.write(begin + time, self.goals(time, seconds, amplitude))

    def goals(self, time: float, seconds: float, amplitude: float = 0.4) -> Floats:
        """Return goals (n,) [rad] that move all joints from rest and back."""
        phase = (1 - np.cos(2 * np.pi * time / seconds)) / 2
        return np.asarray(self.manifest.rest + amplitude * phase)

    def active(self, seconds: float = 3.0) -> "Desk":
        """Bring the supervisor into the middle of a performance."""
        self.open()
        self.perform(seconds)
        self.until(Stage.ACTIVE)
        self.run(0.3)
        assert self.stage is Stage.ACTIVE
        return self

    def journal(self) -> list[dict[str, object]]:
        return [json.loads(line) for line in self.log.read_text().splitlines()]

    def kinds(self) -> list[str]:
        return [f"{line['kind']}: {line['text']}" for line in self.journal()]

    def notes(self) -> tuple[Note, ...]:
        return self.channel.notes()


@pytest.fixture
def desk(robot: Robot, tmp_path: Path, servos: str) -> Iterator[Callable[..., Desk]]:
    """Return a function that creates an unstarted supervisor of the small robot."""
    desks: list[Desk] = []

    def made(faults: FaultPlan = NO_FAULTS, settings: SupervisorSettings = QUICK_SETTINGS) -> Desk:
        first, second = describe_cables(robot)
        wires = (replace(first, faults=faults), second)
        desks.append(Desk(Manifest.of(robot), wires, tmp_path / "events.jsonl", settings=settings, servos=servos))
        return desks[-1]

    yield made
    for each in desks:
        each.end()
        assert not each.dropped


@pytest.fixture
def crowd(tmp_path: Path, servos: str) -> Iterator[Callable[..., Desk]]:
    """Create a supervisor of several servos on one wire, one per hinge."""
    desks: list[Desk] = []

    def made(
        count: int,
        *,
        baud: int = 1_000_000,
        faults: FaultPlan = NO_FAULTS,
        settings: SupervisorSettings = QUICK_SETTINGS,
        model: str = MODEL,
    ) -> Desk:
        fittings = tuple(ServoFitting(k + 1, model=model) for k in range(count))
        wires = (Cable("body", fittings, baud=baud, faults=faults),)
        desks.append(
            Desk(manifest_of(count, baud, model), wires, tmp_path / "events.jsonl", settings=settings, servos=servos)
        )
        return desks[-1]

    yield made
    for each in desks:
        each.end()
        assert not each.dropped


def manifest_of(count: int, baud: int, model: str = MODEL) -> Manifest:
    members = [
        Member(
            bus="body",
            servo=Servo(k + 1, SERVO_MODELS[model]),
            hinge=f"hinge{k}",
            joint=k,
            zero=2048,
            turns=1.0,
            lower=1000,
            upper=3000,
            speed=4.8,
            gains=GAINS[model],
            full=141.0,
        )
        for k in range(count)
    ]
    return Manifest(
        robot="crowd",
        bauds={"body": baud},
        members=tuple(members),
        rest=np.zeros(count),
        lower=np.full(count, -1.5),
        upper=np.full(count, 1.5),
        chains=tuple(frozenset({k}) for k in range(count)),
    )


@pytest.fixture
def manifest(robot: Robot) -> Manifest:
    """Return the manifest of the small robot."""
    return Manifest.of(robot)


@pytest.fixture
def room(manifest: Manifest) -> Room:
    """Return a monitor of the small robot's servos."""
    return Room(manifest)
