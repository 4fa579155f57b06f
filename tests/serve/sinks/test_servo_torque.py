"""Servos as a sink: who gets commands, how servos are told to be, and how torque comes and goes."""

from math import nan
from threading import Event, Thread
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.dynamics import Clearance
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.serve.sinks.servos import RealServos

ROW = np.array([0.2])


class Far:
    """Nothing ever meets."""

    def clearance(self, angles):
        return Clearance(np.full(len(angles), 1.0), [("arm", "wall")] * len(angles))

    def gaps(self, angles):
        return np.ones_like(angles)


class Driven:
    """Servos of a supervisor that keeps what it is told."""

    def __init__(self) -> None:
        self.status = Status(Stage.LIMP, 100.0, nan)
        self.running, self.done, self.commands = True, list[str](), list[Command]()
        self.past: tuple[Status, ...] = ()
        self.fault, self.paces = "", list[float]()
        self.during = lambda: None
        model = SimpleNamespace(name="xm430_w210", starts=lambda register: {"TEMPERATURE_LIMIT": 80}[register.name])
        self.members = (SimpleNamespace(bus="body", id=4, hinge="neck", model=model),)

    def state(self) -> Status:
        return self.status

    def history(self) -> tuple[Status, ...]:
        past, self.past = self.past, ()
        return past

    def telemetry(self) -> SimpleNamespace:
        figures = {"celsius": 40.0, "load": 0.12345, "volts": 11.98765, "errors": 0.0, "torque": 1.0}
        return SimpleNamespace(**{name: np.array([value]) for name, value in figures.items()})

    def write(self, command: Command) -> None:
        self.commands.append(command)

    def release(self) -> None:
        self.done.append("release")
        self.during()
        if self.fault:
            raise BusError(self.fault)

    def resume(self) -> None:
        self.done.append("resume")

    def slow_to(self, pace: float) -> None:
        self.paces.append(pace)

    def close(self) -> None:
        self.done.append("close")
        self.running = False


class Cabinet:
    """Opens servos, and keeps all that it opened."""

    def __init__(self, *, armed: bool = True) -> None:
        self.opened: list[Driven] = []
        self.sink = RealServos(self.open, distances=Far(), least=0.01, armed=armed)

    def open(self) -> Driven:
        self.opened.append(Driven())
        return self.opened[-1]

    @property
    def servos(self) -> Driven:
        return self.opened[-1]


def command(time: float) -> Command:
    return Command(time, ROW, ROW, ROW, ROW)


def test_commands_are_handed_on_only_to_servos_that_follow():
    cabinet = Cabinet(armed=False)
    cabinet.sink.write(command(0.0))
    assert not cabinet.servos.commands
    cabinet.sink.arm()
    cabinet.sink.write(command(0.01))
    assert [each.time for each in cabinet.servos.commands] == [0.01]


def test_what_is_seen_is_what_the_supervisor_measured_while_it_performs():
    cabinet = Cabinet()
    assert cabinet.sink.seen() is None
    cabinet.servos.status = Status(Stage.ACTIVE, 100.0, 5.0, 1.0, angles=ROW)
    assert cabinet.sink.seen() == (5.0, ROW)


@pytest.mark.parametrize(
    ("armed", "stage", "state"),
    [
        (False, Stage.LIMP, "limp"),
        (False, Stage.ACTIVE, "limp"),
        (True, Stage.LIMP, "arming"),
        (True, Stage.ACTIVE, "armed"),
        (True, Stage.HOLD, "armed"),
    ],
)
def test_the_state_is_told(armed: bool, stage: Stage, state: str):
    cabinet = Cabinet(armed=armed)
    cabinet.servos.status = Status(stage, 100.0, 5.0)
    assert cabinet.sink.state == state
    cabinet.servos.running = False
    assert cabinet.sink.state == "ended"


def test_every_servo_is_told_with_its_place_and_its_figures():
    cabinet = Cabinet()
    (place,) = cabinet.sink.members
    assert (place.bus, place.id, place.hinge, place.model, place.hottest) == ("body", 4, "neck", "xm430_w210", 80)
    cabinet.servos.status = Status(Stage.ACTIVE, 100.0, 5.0, 1.0, angles=ROW, hottest=41.0, volts=11.5, faulty=True)
    health = cabinet.sink.health()
    assert (health.hottest, health.volts, health.faulty) == (41.0, 11.5, True)
    assert np.array_equal(health.angles, ROW)
    report = health.servos
    assert (report.state, report.celsius, report.load, report.volts) == ("armed", (40.0,), (0.123,), (11.988,))
    assert (report.errors, report.torque) == ((0.0,), (1.0,))


def test_torque_is_taken_after_folding_and_the_servos_are_opened_anew_and_limp():
    cabinet = Cabinet()
    states, first = [], cabinet.servos
    first.during = lambda: states.append((cabinet.sink.state, cabinet.sink.armed))
    cabinet.sink.disarm()
    assert states == [("releasing", False)]
    assert first.done == ["release", "close"]
    assert len(cabinet.opened) == 2
    assert cabinet.sink.servos is cabinet.servos
    assert cabinet.sink.state == "limp"
    cabinet.sink.write(command(0.0))
    assert not cabinet.servos.commands


def test_servos_that_cannot_fold_stay_open_and_get_no_commands():
    cabinet = Cabinet()
    cabinet.servos.fault = "a limb is held"
    with pytest.raises(BusError, match="a limb is held"):
        cabinet.sink.disarm()
    assert len(cabinet.opened) == 1
    assert cabinet.servos.done == ["release"]
    assert cabinet.sink.state == "limp"


@pytest.mark.parametrize("running", [True, False])
def test_only_servos_that_nobody_drives_are_opened_anew(running: bool):
    cabinet = Cabinet()
    cabinet.servos.running = running
    cabinet.sink.revive()
    assert len(cabinet.opened) == (1 if running else 2)


@pytest.mark.parametrize("waits", ["", "consent"])
def test_servos_that_wait_for_consent_go_on_when_it_comes(waits: str):
    cabinet = Cabinet()
    cabinet.servos.status = Status(Stage.HOLD, 100.0, 5.0, waits=waits)
    assert cabinet.sink.waits() == bool(waits)
    cabinet.sink.resume()
    assert cabinet.servos.done == ["resume"] * bool(waits)


@pytest.mark.parametrize("waits", ["", "consent"])
def test_at_the_end_servos_fold_and_nobody_has_to_consent(waits: str):
    cabinet = Cabinet()
    cabinet.servos.status = Status(Stage.HOLD, 100.0, 5.0, waits=waits)
    cabinet.sink.close()
    assert cabinet.servos.done == ["release"] * bool(waits) + ["close"]


def test_the_end_waits_until_torque_was_taken():
    cabinet, going, may = Cabinet(), Event(), Event()
    first = cabinet.servos

    def hold() -> None:
        going.set()
        may.wait(10.0)

    first.during = hold
    taking = Thread(target=cabinet.sink.disarm)
    taking.start()
    assert going.wait(10.0)
    closing = Thread(target=cabinet.sink.close)
    closing.start()
    assert first.done == ["release"]
    may.set()
    taking.join(10.0)
    closing.join(10.0)
    assert first.done == ["release", "close"]
    assert cabinet.servos.done == ["close"]


def test_cycles_of_the_supervisor_are_told_once():
    cabinet = Cabinet()
    cabinet.servos.status = Status(Stage.ACTIVE, 100.0, 5.0, 1.0, angles=ROW, goals=ROW, taken=np.array([100.0]))
    cabinet.servos.past = (cabinet.servos.status,) * 3
    cabinet.sink.write(command(5.0))
    assert cabinet.sink.time(100.0) == 5.0
    assert len(cabinet.sink.cycles()) == 3
    assert cabinet.sink.cycles() == ()
