"""Judges the servos by their records: who answers, who has failed, and how much slower hard work makes all.

The temperature sensor sits far from the winding, which heats within seconds: so the square of the current is remembered
too. Its time constant and the shares are assumed, no servo was measured.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.hardware.bus.cycle import Records
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.axes import Snapshot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.preflight import Table

MEMORY = 10.0  # [s] over which the square of the current is averaged
EASY, HARD = 0.5, 0.8  # of the current's square at its limit: where slowing begins, and where motion ends
COOL, HOT = 10.0, 3.0  # [C] below the servo's limit, likewise
BEHIND = 1.1  # of the error that gives full power, from goal to servo
STUCK = 0.3  # [s] of being so far behind without moving
MOVES = 3  # [PRESENT_VELOCITY] below which a servo does not move
LOAD_FULL = 1000.0  # PRESENT_CURRENT at stall of a servo without current sensor
WEIGH = 0.05  # [s] between two looks at currents and temperatures


@dataclass(frozen=True, eq=False)
class LoadRatings:
    """What servos bear, by members."""

    celsius: Floats  # (m,) [C] where a servo shuts down
    current: Floats  # (m,) raw, at the limit
    full: Floats  # (m,) [ticks] of error at which a servo gives full power

    @classmethod
    def of(cls, tables: Sequence[Table]) -> "LoadRatings":
        """Reads the ratings from the servos' own limits."""
        return cls(
            celsius=sealed([table[Register.TEMPERATURE_LIMIT] for table in tables]),
            current=sealed([_current(table) for table in tables]),
            full=sealed([table.member.full for table in tables]),
        )


def _current(table: Table) -> float:
    return LOAD_FULL if table.member.model.amperes is None else max(1.0, float(table[Register.CURRENT_LIMIT]))


@dataclass(frozen=True, eq=False)
class LoadState:
    """How hard servos have been working, by members."""

    work: Floats  # (m,) mean square of the current, of its limit's
    stalled: Floats  # (m,) [s] far from the goal without moving

    @classmethod
    def none(cls, count: int) -> "LoadState":
        """Makes the state of servos that have rested."""
        return cls(sealed(np.zeros(count)), sealed(np.zeros(count)))

    @property
    def stuck(self) -> Flags:
        """(m,) who cannot move."""
        return self.stalled >= STUCK


def update_load(load: LoadState, records: Records, goals: Floats, seconds: float, ratings: LoadRatings) -> LoadState:
    """Adds a moment to the load of servos.

    Args:
        load: before.
        records: (m,) of this moment.
        goals: (m,) [ticks].
        seconds: that passed.
        ratings: of the servos.
    """
    share = np.minimum(np.abs(records["current"].astype(float)) / ratings.current, 1.0)
    work = load.work + (share**2 - load.work) * min(seconds / MEMORY, 1.0)
    far = np.abs(goals - records["position"]) >= BEHIND * ratings.full
    halted = far & (np.abs(records["velocity"].astype(float)) < MOVES) & (records["torque"] != 0)
    return LoadState(sealed(work), sealed(np.where(halted, load.stalled + seconds, 0.0)))


def derate(load: LoadState, records: Records, ratings: LoadRatings) -> Floats:
    """Computes (m,) the largest time scale, 0..1, that each servo's load and heat allow; 1: as planned."""
    by_work = (HARD - load.work) / (HARD - EASY)
    by_heat = (ratings.celsius - HOT - records["temperature"]) / (COOL - HOT)
    share: Floats = np.maximum(0.0, np.minimum(np.minimum(by_work, by_heat), 1.0))  # clip takes several times as long
    return share


class CommunicationMonitor:
    """Judges every cycle; how hard servos work changes slowly, and is judged every few."""

    def __init__(self, manifest: Manifest, tables: Sequence[Table]) -> None:
        """Knows nothing of the servos yet.

        Args:
            manifest: of the servos.
            tables: their registers, in its order; none if they are not known yet.
        """
        count = len(manifest.members)
        nobody: Flags = np.zeros(count, dtype=np.bool_)
        self._manifest, self._ratings = manifest, LoadRatings.of(tables)
        self._load, self._since = LoadState.none(count), WEIGH  # [s] since it was looked at
        self._signature = b""  # of what was judged last
        self.records: Records | None = None  # (m,) the last ones; None before the first
        self.present: Floats = np.full(count, np.nan)  # (m,) [ticks]; NaN for who has not answered lately
        self.taken: Floats = self.present  # (m,) [s] when that was so
        self.scale = 0.0  # how fast, 0..1, the hardest-working servo lets the performance be
        self.lost = False  # whether a port is gone
        self.answering = False  # whether all have answered lately
        self.everybody = False  # whether all have, be a port gone since
        self.answered: Flags = nobody  # (m,) who has answered lately
        self.energised: Flags = nobody  # (m,) who had torque in the last record
        self.stuck: Flags = nobody  # (m,) who could not move, once
        self.failed: Flags = nobody  # (m,) who has a hardware error, or is stuck
        self.limp: Flags = nobody  # (m,) who could have torque, and has none
        self.any_energised = self.all_energised = self.any_limp = False
        self.tripped = False  # whether servos with torque were stopped by their watchdog
        self._fit = False  # whether all have torque, and none has failed

    def look(self, snapshot: Snapshot, goals: Floats | None, seconds: float) -> None:
        """Judges one more cycle; goals are (m,) [ticks]."""
        self.records, recent = snapshot.records, snapshot.recent
        self.everybody = everybody = bool(recent.all())
        self.present = snapshot.positions if everybody else np.where(recent, snapshot.positions, np.nan)
        self.taken = snapshot.times if everybody else np.where(recent, snapshot.times, np.nan)
        self._since += seconds
        weighed = self._since >= WEIGH
        if weighed:
            self._weigh_load(snapshot, goals)
        settled = everybody and self.answering and not weighed and not snapshot.lost
        if not settled or snapshot.signature != self._signature:
            self._judge(snapshot)

    def _weigh_load(self, snapshot: Snapshot, goals: Floats | None) -> None:
        if goals is not None:
            self._load = update_load(self._load, snapshot.records, goals, self._since, self._ratings)
            self.stuck = self.stuck | (self._load.stuck & snapshot.torque)
        self.scale = float(derate(self._load, snapshot.records, self._ratings).min())
        self._since = 0.0

    def _judge(self, snapshot: Snapshot) -> None:
        self._signature, self.lost, self.answered = snapshot.signature, snapshot.lost, snapshot.recent
        self.answering = self.everybody and not snapshot.lost
        self.energised = snapshot.torque
        self.failed = snapshot.errors | self.stuck
        self.limp = self.answered & ~self.energised & ~self.failed
        self.any_energised, self.all_energised = bool(self.energised.any()), bool(self.energised.all())
        self.any_limp = bool(self.limp.any())
        self.tripped = bool((snapshot.tripped & self.energised).any())
        self._fit = bool((self.energised & ~self.failed).all()) and not self.tripped

    @property
    def well(self) -> bool:
        """Whether the performance may go on."""
        return self.answering and self._fit and self.scale > 0.0

    @property
    def holding_joints(self) -> frozenset[int]:
        """Joints that must not move: the chains of those who have failed."""
        joints = {int(joint) for joint in self._manifest.joints[self.failed]}
        return frozenset().union(*(chain for chain in self._manifest.chains if chain & joints))
