"""Servo sink: forwarding of commands, telemetry, arming and disarming."""

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

HINGE_ANGLES = np.array([0.2])  # [rad] angle of the only hinge


class Far:
    """Distances without any collision."""

    def clearance(self, angles):
        return Clearance(np.full(len(angles), 1.0), [("arm", "wall")] * len(angles))

    def gaps(self, angles):
        return np.ones_like(angles)


class Driven:
    """Stub servos whose supervisor records its calls."""

    def __init__(self) -> None:
        self.status = Status(Stage.LIMP, 100.0, nan)
        self.running, self.done, self.commands = True, list[str](), list[Command]()
        self.past: tuple[Status, ...] = ()
        self.fault, self.paces = "", list[float]()
        self.during = lambda: None
        model = SimpleNamespace(
            name="xm430_w210", factory_value=lambda register: {"TEMPERATURE_LIMIT": 80}[register.name]
        )
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
    """Opener of stub servos with a record of all opened ones."""

    def __init__(self, *, armed: bool = True) -> None:
        self.opened: list[Driven] = []
        self.sink = RealServos(self.open, distances=Far(), min_clearance=0.01, armed=armed)

    def open(self) -> Driven:
        self.opened.append(Driven())
        return self.opened[-1]

    @property
    def servos(self) -> Driven:
        return self.opened[-1]


def command(time: float) -> Command:
    return Command(time, HINGE_ANGLES, HINGE_ANGLES, HINGE_ANGLES, HINGE_ANGLES)


def test_commands_are_forwarded_only_to_armed_servos():
    cabinet = Cabinet(armed=False)
    cabinet.sink.write(command(0.0))
    assert not cabinet.servos.commands
    cabinet.sink.arm()
    cabinet.sink.write(command(0.01))
    assert [each.time for each in cabinet.servos.commands] == [0.01]


def test_servo_measurement_is_available_only_during_a_performance():
    cabinet = Cabinet()
    assert cabinet.sink.measurement() is None
    cabinet.servos.status = Status(Stage.ACTIVE, 100.0, 5.0, 1.0, angles=HINGE_ANGLES)
    assert cabinet.sink.measurement() == (5.0, HINGE_ANGLES)


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
def test_servo_sink_reports_the_operating_state(armed: bool, stage: Stage, state: str):
    cabinet = Cabinet(armed=armed)
    cabinet.servos.status = Status(stage, 100.0, 5.0)
    assert cabinet.sink.state == state
    cabinet.servos.running = False
    assert cabinet.sink.state == "ended"


def test_servo_sink_reports_bus_id_hinge_model_and_telemetry_of_each_servo():
    cabinet = Cabinet()
    (place,) = cabinet.sink.members
    assert (place.bus, place.id, place.hinge, place.model, place.hottest) == ("body", 4, "neck", "xm430_w210", 80)
    cabinet.servos.status = Status(
        Stage.ACTIVE, 100.0, 5.0, 1.0, angles=HINGE_ANGLES, hottest=41.0, volts=11.5, faulty=True
    )
    health = cabinet.sink.health()
    assert (health.hottest, health.volts, health.faulty) == (41.0, 11.5, True)
    assert np.array_equal(health.angles, HINGE_ANGLES)
    report = health.servos
    assert (report.state, report.celsius, report.load, report.volts) == ("armed", (40.0,), (0.123,), (11.988,))
    assert (report.errors, report.torque) == ((0.0,), (1.0,))


def test_disarm_folds_and_reopens_servos_with_torque_off():
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


def test_servos_that_cannot_fold_stay_open_without_commands():
    cabinet = Cabinet()
    cabinet.servos.fault = "a limb is held"
    with pytest.raises(BusError, match="a limb is held"):
        cabinet.sink.disarm()
    assert len(cabinet.opened) == 1
    assert cabinet.servos.done == ["release"]
    assert cabinet.sink.state == "limp"


@pytest.mark.parametrize("running", [True, False])
def test_only_servos_without_supervisor_are_reopened(running: bool):
    cabinet = Cabinet()
    cabinet.servos.running = running
    cabinet.sink.revive()
    assert len(cabinet.opened) == (1 if running else 2)


@pytest.mark.parametrize("waits", ["", "consent"])
def test_resume_request_is_passed_only_to_held_servos_that_wait_for_it(waits: str):
    cabinet = Cabinet()
    cabinet.servos.status = Status(Stage.HOLD, 100.0, 5.0, waits=waits)
    assert cabinet.sink.needs_resume() == bool(waits)
    cabinet.sink.resume()
    assert cabinet.servos.done == ["resume"] * bool(waits)


@pytest.mark.parametrize("waits", ["", "consent"])
def test_closing_the_servo_sink_releases_servos_first_if_they_wait_for_a_resume(waits: str):
    cabinet = Cabinet()
    cabinet.servos.status = Status(Stage.HOLD, 100.0, 5.0, waits=waits)
    cabinet.sink.close()
    assert cabinet.servos.done == ["release"] * bool(waits) + ["close"]


def test_closing_the_servo_sink_waits_for_a_running_disarm():
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


def test_servo_sink_returns_each_supervisor_cycle_once():
    cabinet = Cabinet()
    cabinet.servos.status = Status(
        Stage.ACTIVE, 100.0, 5.0, 1.0, angles=HINGE_ANGLES, setpoints=HINGE_ANGLES, taken=np.array([100.0])
    )
    cabinet.servos.past = (cabinet.servos.status,) * 3
    cabinet.sink.write(command(5.0))
    assert cabinet.sink.time(100.0) == 5.0
    assert len(cabinet.sink.take_cycles()) == 3
    assert cabinet.sink.take_cycles() == ()
