"""Servos as a sink that owns the time."""

from math import nan

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.body.dynamics import Clearance
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.serve.sinks.servos import RealServos


class Wall:
    """One metre per radian from a wall at 0."""

    def clearance(self, angles: Floats) -> Clearance:
        return Clearance(angles[:, 0], [("arm", "wall")] * len(angles))

    def gaps(self, angles: Floats) -> Floats:
        return angles


class Told:
    """Servos whose supervisor says this."""

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
def test_time_is_the_supervisors_where_it_runs_and_where_it_stands(status: Status, time: float | None):
    """Whoever stood still meanwhile learns where it stands: only what comes after that can still be performed."""
    servos = RealServos(lambda: Told(status), distances=Wall(), least=0.01)
    assert servos.time(100.2) == (time if time is None else pytest.approx(time))


class Straying(Told):
    """Servos that stay where they are while their commands go on, cycle by cycle."""

    def __init__(self, angle: float) -> None:
        super().__init__(Status())
        self.angle, self.cycles, self.paces, self.stops = angle, 0, [], 0

    def write(self, command: Command) -> None:
        self.cycles += 1
        time = command.time
        taken = 100.0 + time
        rows = [np.array([value]) for value in (self.angle, 0.0, taken)]
        self._status = Status(Stage.ACTIVE, taken, time, 1.0, angles=rows[0], goals=rows[1], taken=rows[2])

    def history(self) -> tuple[Status, ...]:
        return (self._status,) if self.cycles else ()

    def slow_to(self, pace: float) -> None:
        self.paces.append(pace)

    def stop(self) -> None:
        self.stops += 1


@pytest.mark.parametrize(
    ("angle", "slows", "stops"), [(0.02, False, False), (0.0335, True, False), (0.002, True, True)]
)
def test_servos_that_stray_are_slowed_down_and_stopped(angle: float, slows: bool, stops: bool):
    told = Straying(angle)
    servos = RealServos(lambda: told, distances=Wall(), least=0.01)
    for k in range(20):
        row = np.array([0.02])
        servos.write(Command(k / 100, row, row, row, row))
        servos.time(100.0 + k / 100)
    assert (min(told.paces) < 1.0, told.stops > 0) == (slows, stops)
