"""Register records of two servos, and a filter that has accepted the first ones."""

import numpy as np
import pytest

from kinesic.hardware.bus.bounds import RecordBounds
from kinesic.hardware.bus.cycle import BLOCK_DTYPE, Records
from kinesic.hardware.bus.plausibility import PlausibilityFilter
from kinesic.hardware.bus.query import ServoReplies
from kinesic.hardware.protocol.models import SERVO_MODELS

ALL_SERVOS = slice(None)  # index of both servos
PERIOD = 0.01  # [s] period of the bus cycle


def make_filter(model: str = "xm430_w350") -> PlausibilityFilter:
    """Return a plausibility filter for two servos without any record yet."""
    return PlausibilityFilter(RecordBounds.of((SERVO_MODELS[model],) * 2, ((1000, 3000),) * 2), PERIOD)


def blocks(tick: int, place: int = 2048, /, **changes: int) -> Records:
    """Return records of two servos, with the given changes in the second record."""
    made = np.zeros(2, BLOCK_DTYPE)
    made["tick"], made["position"], made["volts"], made["temperature"] = tick, place, 120, 40
    for name, value in changes.items():
        made[name][1] = value
    return made


def answer(made: Records) -> ServoReplies:
    return ServoReplies(made, np.ones(len(made), dtype=np.bool_), True, 0)


@pytest.fixture
def gate() -> PlausibilityFilter:
    opened = make_filter()
    opened.begin()
    opened.admit(ALL_SERVOS, answer(blocks(1000)), 1.0)
    opened.begin()
    return opened


def told(gate: PlausibilityFilter, made: Records, time: float = 1.01) -> list[bool]:
    gate.begin()
    gate.admit(ALL_SERVOS, answer(made), time)
    return [bool(fresh) for fresh in gate.fresh]
