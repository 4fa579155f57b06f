"""Bus watchdogs and time scale on a host with late cycles."""

from collections.abc import Callable

import pytest

from kinesic.hardware.bus import host
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.state_machine import Stage

Make = Callable  # of a desk, see conftest
WATCHDOG = Register.BUS_WATCHDOG


@pytest.mark.parametrize(("late", "counts", "scale"), [(0.03, 10, 1.0), (0.06, 20, 0.5)])
def test_late_cycles_lengthen_watchdogs_and_very_late_cycles_also_slow_the_performance(
    desk: Make, late: float, counts: int, scale: float
):
    made = desk().active(20.0)
    assert set(made.true(WATCHDOG).tolist()) == {5}
    for _ in range(40):
        made.pass_time(late - 0.01)
        made.cycle()
    assert set(made.true(WATCHDOG).tolist()) == {counts}
    assert made.status.scale == pytest.approx(scale, abs=0.01)
    assert made.stage is Stage.ACTIVE
    assert [line for line in made.kinds() if line.startswith("host: cycles begin up to")]


def test_watchdogs_return_to_their_normal_duration_after_punctual_cycles(desk: Make, monkeypatch: pytest.MonkeyPatch):
    """The return takes ten seconds, which this test shortens to one."""
    monkeypatch.setattr(host, "GAP_MEMORY", 1.0)
    made = desk().active(20.0)
    made.pass_time(0.03)
    made.run(0.1)
    assert set(made.true(WATCHDOG).tolist()) == {10}
    made.run(0.8)
    assert set(made.true(WATCHDOG).tolist()) == {10}
    made.run(0.7)
    assert set(made.true(WATCHDOG).tolist()) == {5}
    assert made.stage is Stage.ACTIVE


def test_deviating_watchdog_time_of_a_servo_is_corrected(desk: Make):
    made = desk().active(20.0)
    made.plant.servos[1].memory[WATCHDOG] = 100
    made.run(0.05)
    assert set(made.true(WATCHDOG).tolist()) == {5}
