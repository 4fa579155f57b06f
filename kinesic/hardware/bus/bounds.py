"""Plausible value ranges of the registers in a servo's record.

A value outside its bounds is never accepted, however often it is repeated. The bounds follow from the servo model and
its hinge. They are wide, because a rejected record tells nothing about its servo: they only keep out nonsense, and
the monitor judges hot, fast and weak servos.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.bus.cycle import FieldName, Records
from kinesic.hardware.protocol.models import Model
from kinesic.hardware.protocol.registers import TICK_ANGLE, VELOCITY_UNIT, Register

TickRange = tuple[int, int]  # [ticks] lowest and highest

MAX_PUSHED_VELOCITY = 2 * TICKS_PER_TURN  # [ticks/s] velocity that is always plausible, as a person may push a servo
LIMIT_FACTOR = 2.0  # largest plausible velocity or current, as a multiple of the servo model's factory limit
RANGE_MARGIN = TICKS_PER_TURN // 8  # [ticks] largest distance of a pushed servo with torque beyond its goal range
MAX_WOUND_POSITION = 8 * TICKS_PER_TURN  # [ticks] largest plausible distance from 0 of a servo turned without torque
STALL_LOAD = 1000  # [0.1 %] value of PRESENT_CURRENT at stall, if the servo has no current sensor
MIN_VOLTAGE = 25  # [0.1 V] lowest supply voltage at which a servo's processor works
MAX_SUPPLY_RATIO = 1.5  # largest plausible supply voltage, as a multiple of the servo's factory voltage limit
MAX_TEMPERATURE = 125  # [C] largest plausible temperature, the end of the sensor's range
ERROR_BITS = 0x3F  # Valid bits of HARDWARE_ERROR_STATUS

CHECKED_FIELDS: tuple[FieldName, ...] = (  # fields of a record with bounds that do not depend on torque
    "torque",
    "watchdog",
    "current",
    "velocity",
    "volts",
    "temperature",
    "hardware_error",
)


@dataclass(frozen=True, eq=False)
class RecordBounds:
    """Smallest and largest plausible register values of several servos."""

    lower: Floats  # (7, n) smallest plausible value of each field in CHECKED_FIELDS
    upper: Floats  # (7, n) largest plausible value of each field in CHECKED_FIELDS
    torque_range: Floats  # (2, n) [ticks] position range of a servo with torque
    max_velocity: Floats  # (n,) [ticks/s] largest plausible velocity of each servo

    @classmethod
    def of(cls, models: Sequence[Model], spans: Sequence[TickRange]) -> "RecordBounds":
        """Derive the bounds of record values from servo models and goal ranges.

        Args:
            models: servo models.
            spans: [ticks] range of goal positions of each servo.
        """
        limits = np.array([model.factory_value(Register.VELOCITY_LIMIT) for model in models], dtype=np.float64)
        max_velocity = np.maximum(LIMIT_FACTOR * limits * VELOCITY_UNIT / TICK_ANGLE, MAX_PUSHED_VELOCITY)
        current = LIMIT_FACTOR * np.array([_largest_current(model) for model in models])
        volts = MAX_SUPPLY_RATIO * np.array([model.factory_value(Register.MAX_VOLTAGE_LIMIT) for model in models])
        max_counts = np.ceil(max_velocity * TICK_ANGLE / VELOCITY_UNIT)
        ends = np.array(spans, dtype=np.float64).reshape(-1, 2).T
        return cls(
            lower=sealed(np.broadcast_arrays(0, -1, -current, -max_counts, MIN_VOLTAGE, 0, 0)),
            upper=sealed(np.broadcast_arrays(1, 127, current, max_counts, volts, MAX_TEMPERATURE, ERROR_BITS)),
            torque_range=sealed(ends + np.array([[-RANGE_MARGIN], [RANGE_MARGIN]])),
            max_velocity=sealed(max_velocity),
        )

    def outside(self, records: Records) -> Flags:
        """Return which records (n,) have a value outside the plausible bounds."""
        values = np.array([records[name] for name in CHECKED_FIELDS])
        positions, torque = records["position"], records["torque"] != 0
        lower = np.where(torque, self.torque_range[0], -MAX_WOUND_POSITION)
        upper = np.where(torque, self.torque_range[1], MAX_WOUND_POSITION)
        wrong = (values < self.lower).any(axis=0) | (values > self.upper).any(axis=0)
        outside: Flags = wrong | (positions < lower) | (positions > upper)
        return outside

    def reason(self, index: int, record: np.void) -> str:
        """Describe a record's first value outside its bounds, or return ""."""
        spans = {name: (self.lower[k, index], self.upper[k, index]) for k, name in enumerate(CHECKED_FIELDS)}
        place = (
            (self.torque_range[0, index], self.torque_range[1, index])
            if record["torque"]
            else (-MAX_WOUND_POSITION, MAX_WOUND_POSITION)
        )
        for name, (lower, upper) in {**spans, "position": place}.items():
            if not lower <= record[name] <= upper:
                return f"{name} is {record[name]}, must be {lower:.0f}..{upper:.0f}"
        return ""


def _largest_current(model: Model) -> int:
    return STALL_LOAD if model.amperes is None else model.factory_value(Register.CURRENT_LIMIT)
