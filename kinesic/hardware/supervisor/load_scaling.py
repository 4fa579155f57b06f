"""How hard servos work, and how much slower the performance must be so that none of them shuts down by itself.

The sensor sits far from the winding, which heats within seconds: so the square of the current is remembered too. Its
time constant and the shares are assumed, no servo was measured.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.hardware.bus.health import Records
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.preflight import Table

MEMORY = 10.0  # [s] over which the square of the current is averaged
EASY, HARD = 0.5, 0.8  # of the current's square at its limit: where slowing begins, and where motion ends
COOL, HOT = 10.0, 3.0  # [C] below the servo's limit, likewise
BEHIND = 1.1  # of the error that gives full power, from goal to servo
STUCK = 0.3  # [s] of being so far behind without moving
MOVES = 3  # [PRESENT_VELOCITY] below which a servo does not move
LOAD_FULL = 1000.0  # PRESENT_CURRENT at stall of a servo without current sensor


@dataclass(frozen=True, eq=False)
class LoadRatings:
    """What servos bear, by members."""

    celsius: Floats  # (m,) [C] where a servo shuts down
    current: Floats  # (m,) raw, at the limit
    full: Floats  # (m,) [ticks] of error at which a servo gives full power

    @classmethod
    def of(cls, tables: Sequence[Table]) -> "LoadRatings":
        """By the servos' own limits."""
        return cls(
            celsius=sealed([table[Register.TEMPERATURE_LIMIT] for table in tables]),
            current=sealed([_current(table) for table in tables]),
            full=sealed([table.member.full for table in tables]),
        )


def _current(table: Table) -> float:
    return LOAD_FULL if table.member.model.amperes is None else max(1.0, float(table[Register.CURRENT_LIMIT]))


@dataclass(frozen=True, eq=False)
class LoadState:
    """How servos have been working."""

    work: Floats  # (m,) mean square of the current, of its limit's
    stalled: Floats  # (m,) [s] far from the goal without moving

    @classmethod
    def none(cls, count: int) -> "LoadState":
        """Of servos that have rested."""
        return cls(sealed(np.zeros(count)), sealed(np.zeros(count)))

    @property
    def stuck(self) -> Flags:
        """(m,) who cannot move."""
        return self.stalled >= STUCK


def update_load(strain: LoadState, records: Records, goals: Floats, seconds: float, strength: LoadRatings) -> LoadState:
    """What a moment adds.

    Args:
        strain: before.
        records: (m,) of this moment.
        goals: (m,) [ticks].
        seconds: that passed.
        strength: of the servos.
    """
    share = np.minimum(np.abs(records["current"].astype(float)) / strength.current, 1.0)
    work = strain.work + (share**2 - strain.work) * min(seconds / MEMORY, 1.0)
    far = np.abs(goals - records["position"]) >= BEHIND * strength.full
    halted = far & (np.abs(records["velocity"].astype(float)) < MOVES) & (records["torque"] != 0)
    return LoadState(sealed(work), sealed(np.where(halted, strain.stalled + seconds, 0.0)))


def derate(strain: LoadState, records: Records, strength: LoadRatings) -> Floats:
    """(m,) how fast, 0..1, each servo lets the performance be; 1: as planned."""
    by_work = (HARD - strain.work) / (HARD - EASY)
    by_heat = (strength.celsius - HOT - records["temperature"]) / (COOL - HOT)
    share: Floats = np.maximum(0.0, np.minimum(np.minimum(by_work, by_heat), 1.0))  # clip takes several times as long
    return share
