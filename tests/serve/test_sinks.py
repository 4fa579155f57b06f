"""Servos as a sink that owns the time."""

from math import nan

import pytest

from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.serve.sinks import RealServos


class Told:
    """Servos whose supervisor says this."""

    def __init__(self, status: Status) -> None:
        self._status = status

    def state(self) -> Status:
        return self._status


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
    assert RealServos(Told(status)).time(100.2) == (time if time is None else pytest.approx(time))
