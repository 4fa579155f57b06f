"""Random faults and outages of virtual servos with raised arms."""

from functools import partial
from pathlib import Path
from random import Random

import pytest

from kinesic.hardware.virtual.faults import PlannedFault

from ..hardware.proof.drill import RAISED_ANGLES, Drill, Strike, drill, random_strike

pytestmark = pytest.mark.soak

SERVO_KINDS = ("kinesic", "manual")  # implementations of virtual servos
OUTAGE_DURATIONS = (0.1, 0.3, 0.6, 1.0, 2.0, 5.0, 10.0)  # [s]


def suffer(made: Drill, strike: Strike) -> None:
    """Apply a fault, and check that no rule is broken."""
    made.suffer(strike)
    made.end()
    assert made.observer.broken == [], strike.name
    assert not (strike.wire and made.called_stuck), made.kinds()


@pytest.mark.parametrize("seed", range(200))
@pytest.mark.parametrize("servos", SERVO_KINDS)
def test_random_servo_faults_break_no_safety_rule(servos: str, tmp_path: Path, seed: int):
    made = drill(servos, tmp_path)
    made.raise_arms()
    suffer(made, random_strike(servos, seed))


@pytest.mark.parametrize("seconds", OUTAGE_DURATIONS)
@pytest.mark.parametrize("kind", ["silent", "all silent", "lost", "unplug"])
@pytest.mark.parametrize("servos", SERVO_KINDS)
def test_bus_outage_is_never_reported_as_a_stuck_servo(servos: str, tmp_path: Path, kind: str, seconds: float):
    made = drill(servos, tmp_path)
    made.raise_arms(RAISED_ANGLES * Random(f"{kind} {seconds}").uniform(0.0, 1.3))
    fault = PlannedFault(kind.removeprefix("all "), (3,) if kind == "silent" else (), seconds=seconds)
    suffer(made, Strike(kind, "left", seconds, partial(expose, fault=fault), wire=True))


def expose(made: Drill, fault: PlannedFault) -> None:
    """Apply a planned fault to the left wire."""
    made.expose(fault, bus="left")
