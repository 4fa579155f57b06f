"""Servo sink as the source of the performance time."""

from math import nan

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.body.dynamics import Clearance
from kinesic.hardware.supervisor.caps import ServoCaps
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.serve.sinks.servos import RealServos


class Wall:
    """Distances that shrink by one metre per radian, zero at 0 rad."""

    def clearance(self, angles: Floats) -> Clearance:
        return Clearance(angles[:, 0], [("arm", "wall")] * len(angles))

    def gaps(self, angles: Floats) -> Floats:
        return angles


class Told:
    """Stub servos with a fixed supervisor status."""

    def __init__(self, status: Status) -> None:
        self._status = status

    def state(self) -> Status:
        return self._status

    def history(self) -> tuple[Status, ...]:
        return ()


@pytest.mark.parametrize(
    ("status", "time"),
    [
        (Status(stage=Stage.LIMP, clock=100.0, time=nan), None),
        (Status(stage=Stage.ACTIVE, clock=100.0, time=5.0, scale=1.0), 5.2),
        (Status(stage=Stage.DEGRADED, clock=100.0, time=5.0, scale=0.5), 5.1),
        (Status(stage=Stage.HOLD, clock=100.0, time=5.0, scale=0.0), 5.0),
    ],
)
def test_performance_time_of_the_servo_sink_is_extrapolated_from_the_supervisor_status(
    status: Status, time: float | None
):
    """The time of a halted supervisor is the earliest for new commands."""
    servos = RealServos(lambda: Told(status), distances=Wall(), min_clearance=0.01)
    assert servos.time(100.2) == (time if time is None else pytest.approx(time))


class Straying(Told):
    """Stub servos that stay in place while commands continue."""

    def __init__(self, angle: float) -> None:
        super().__init__(Status())
        self.angle, self.cycles, self.paces, self.stops = angle, 0, [], 0

    def write(self, command: Command) -> None:
        self.cycles += 1
        time = command.time
        taken = 100.0 + time
        rows = [np.array([value]) for value in (self.angle, 0.0, taken)]
        self._status = Status(Stage.ACTIVE, taken, time, 1.0, angles=rows[0], setpoints=rows[1], taken=rows[2])

    def history(self) -> tuple[Status, ...]:
        return (self._status,) if self.cycles else ()

    def slow_to(self, pace: float) -> None:
        self.paces.append(pace)

    def stop(self) -> None:
        self.stops += 1


@pytest.mark.parametrize(
    ("angle", "slows", "stops"), [(0.02, False, False), (0.0335, True, False), (0.002, True, True)]
)
def test_servos_are_slowed_or_stopped_depending_on_the_tracking_error(angle: float, slows: bool, stops: bool):
    result = Straying(angle)
    servos = RealServos(lambda: result, distances=Wall(), min_clearance=0.01)
    for k in range(20):
        row = np.array([0.02])
        servos.write(Command(k / 100, row, row, row, row))
        servos.time(100.0 + k / 100)
    assert (min(result.paces) < 1.0, result.stops > 0) == (slows, stops)


class Capped(Told):
    """Stub servos that record their caps."""

    def __init__(self) -> None:
        super().__init__(Status())
        self.caps: list[ServoCaps] = []
        self.running, self.settings = False, SupervisorSettings(pace=0.3)

    def limit(self, caps: ServoCaps) -> None:
        self.caps.append(caps)


def test_servo_sink_keeps_its_caps_when_the_servos_are_reopened():
    opened = [Capped(), Capped()]
    made = iter(opened)
    servos = RealServos(lambda: next(made), distances=Wall(), min_clearance=0.01)
    caps = ServoCaps(np.zeros(1), np.zeros(1), np.zeros(1))
    servos.limit(caps)
    servos.revive()
    assert [each.caps for each in opened] == [[caps], [caps]]
    assert servos.pace == 0.3
