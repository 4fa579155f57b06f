"""Bounds what a servo's record may say: no repetition makes a value true that no servo of this model can have.

The bounds are those of the model and of the hinge that it turns. They are wide, since a record that is not believed
tells nothing of its servo: they keep out nonsense, and leave hot, fast and weak servos to those who watch them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.bus.cycle import Name, Records
from kinesic.hardware.protocol.models import Model
from kinesic.hardware.protocol.registers import SPEED, TICK, Register

Span = tuple[int, int]  # [ticks]

BY_HAND = 2 * TICKS_PER_TURN  # [ticks/s] that a limp joint may be pushed
SURE = 2.0  # times its limits of speed and current that a servo may seem to have
BEYOND = TICKS_PER_TURN // 8  # [ticks] outside its hinge's range that a servo with torque may be pushed
WOUND = 8 * TICKS_PER_TURN  # [ticks] that a limp servo may count, over whole turns
LOAD_FULL = 1000  # PRESENT_CURRENT at stall of a servo without current sensor
LEAST_VOLTS, SURGE = 25, 1.5  # [0.1 V] below which no servo calculates; share of the largest supply
HOTTEST = 125  # [C] beyond which no sensor measures
ERRORS = 0x3F  # bits of HARDWARE_ERROR_STATUS that may be set

CHECKED: tuple[Name, ...] = ("torque", "watchdog", "current", "velocity", "volts", "temperature", "hardware_error")


@dataclass(frozen=True, eq=False)
class RecordBounds:
    """What records of several servos may hold, ends included."""

    lower: Floats  # (7, n) of the fields in CHECKED
    upper: Floats  # (7, n)
    driven: Floats  # (2, n) [ticks] between which a servo with torque stands
    pace: Floats  # (n,) [ticks/s] that a joint may seem to move

    @classmethod
    def of(cls, models: Sequence[Model], spans: Sequence[Span]) -> "RecordBounds":
        """Takes the bounds of servos.

        Args:
            models: which they are.
            spans: [ticks] between which each may have goals.
        """
        limits = np.array([model.starts(Register.VELOCITY_LIMIT) for model in models], dtype=np.float64)
        pace = np.maximum(SURE * limits * SPEED / TICK, BY_HAND)
        current = SURE * np.array([_largest_current(model) for model in models])
        volts = SURGE * np.array([model.starts(Register.MAX_VOLTAGE_LIMIT) for model in models])
        speed = np.ceil(pace * TICK / SPEED)
        ends = np.array(spans, dtype=np.float64).reshape(-1, 2).T
        return cls(
            lower=sealed(np.broadcast_arrays(0, -1, -current, -speed, LEAST_VOLTS, 0, 0)),
            upper=sealed(np.broadcast_arrays(1, 127, current, speed, volts, HOTTEST, ERRORS)),
            driven=sealed(ends + np.array([[-BEYOND], [BEYOND]])),
            pace=sealed(pace),
        )

    def outside(self, records: Records) -> Flags:
        """Returns (n,) whose record says what cannot be."""
        said = np.array([records[name] for name in CHECKED])
        places, torque = records["position"], records["torque"] != 0
        lower = np.where(torque, self.driven[0], -WOUND)
        upper = np.where(torque, self.driven[1], WOUND)
        wrong = (said < self.lower).any(axis=0) | (said > self.upper).any(axis=0)
        outside: Flags = wrong | (places < lower) | (places > upper)
        return outside

    def reason(self, index: int, record: np.void) -> str:
        """Returns which value of a servo's record cannot be, and its bounds; empty if all can."""
        spans = {name: (self.lower[k, index], self.upper[k, index]) for k, name in enumerate(CHECKED)}
        place = (self.driven[0, index], self.driven[1, index]) if record["torque"] else (-WOUND, WOUND)
        for name, (lower, upper) in {**spans, "position": place}.items():
            if not lower <= record[name] <= upper:
                return f"{name} is {record[name]}, must be {lower:.0f}..{upper:.0f}"
        return ""


def _largest_current(model: Model) -> int:
    return LOAD_FULL if model.amperes is None else model.starts(Register.CURRENT_LIMIT)
