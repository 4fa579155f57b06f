"""Judges the servos by their records: who answers, has failed, is raised, and how much slower hard work makes all.

The temperature sensor sits far from the winding, which heats within seconds: so the square of the current is remembered
too. Its time constant and the shares are assumed, no servo was measured.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.hardware.bus.cycle import Records
from kinesic.hardware.bus.telemetry import Telemetry
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, HardwareError, Register
from kinesic.hardware.supervisor.axes import Snapshot
from kinesic.hardware.supervisor.manifest import REST, Manifest
from kinesic.hardware.supervisor.preflight import Table

MEMORY = 10.0  # [s] over which the square of the current is averaged
EASY, HARD = 0.5, 0.8  # of the current's square at its limit: where slowing begins, and where motion ends
COOL, HOT = 10.0, 3.0  # [C] below the servo's limit, likewise
BEHIND = 1.1  # of the error that gives full power, from goal to servo
STUCK = 0.3  # [s] of being so far behind without moving
MOVES = 3  # [PRESENT_VELOCITY] below which a servo does not move
LOAD_FULL = 1000.0  # PRESENT_CURRENT at stall of a servo without current sensor
WEIGH = 0.05  # [s] between two looks at currents and temperatures
GAP = 0.15  # [s] between two records beyond which nobody knows what was between them


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
    taken: Floats  # (m,) [s] of the last record that was weighed

    @classmethod
    def none(cls, count: int) -> "LoadState":
        """Makes the state of servos that have rested."""
        return cls(sealed(np.zeros(count)), sealed(np.zeros(count)), sealed(np.full(count, -np.inf)))

    @property
    def stuck(self) -> Flags:
        """(m,) who cannot move."""
        return self.stalled >= STUCK


def update_load(load: LoadState, records: Records, taken: Floats, goals: Floats, ratings: LoadRatings) -> LoadState:
    """Adds what new records tell to the load of servos; an old record tells nothing, and after a gap it begins anew.

    Args:
        load: before.
        records: (m,) the last ones.
        taken: (m,) [s] when they were; minus infinity: never.
        goals: (m,) [ticks].
        ratings: of the servos.
    """
    fresh = taken > load.taken
    since = np.where(fresh, taken, 0.0) - np.where(fresh, load.taken, 0.0)
    seconds = np.minimum(since, GAP)
    share = np.minimum(np.abs(records["current"].astype(float)) / ratings.current, 1.0)
    work = load.work + (share**2 - load.work) * np.minimum(seconds / MEMORY, 1.0)
    far = np.abs(goals - records["position"]) >= BEHIND * ratings.full
    free = (records["torque"] != 0) & (records["watchdog"] != WATCHDOG_TRIPPED)
    halted = far & free & (np.abs(records["velocity"].astype(float)) < MOVES) & (since <= GAP)
    stalled = np.where(fresh, np.where(halted, load.stalled + seconds, 0.0), load.stalled)
    return LoadState(sealed(work), sealed(stalled), sealed(np.maximum(taken, load.taken)))


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
        self._goals: Floats | None = None  # (m,) [ticks]
        self.records: Records | None = None  # (m,) the last ones; None before the first
        self.present: Floats = np.full(count, np.nan)  # (m,) [ticks]; NaN for who has not answered lately
        self.taken: Floats = self.present  # (m,) [s] when that was so
        self.scale = 0.0  # how fast, 0..1, the hardest-working servo lets the performance be
        self.lost = False  # whether a port is gone
        self.answering = False  # whether all have answered lately
        self.everybody = False  # whether all have, be a port gone since
        self.answered: Flags = nobody  # (m,) who has answered lately
        self.energised: Flags = nobody  # (m,) who had torque in the last record
        self.stuck: Flags = nobody  # (m,) who could not move since torque came
        self.failed: Flags = nobody  # (m,) who has a hardware error, or is stuck
        self.weak = False  # whether one complains of its supply, and of nothing else
        self.limp: Flags = nobody  # (m,) who could have torque, and has none
        self.any_energised = self.all_energised = self.any_limp = False
        self.tripped = False  # whether servos with torque were stopped by their watchdog
        self._fit = False  # whether all have torque, and none has failed

    def look(self, snapshot: Snapshot, goals: Floats | None, seconds: float) -> None:
        """Judges one more cycle; goals are (m,) [ticks]."""
        self.records, self._goals, recent = snapshot.records, goals, snapshot.recent
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
            self._load = update_load(self._load, snapshot.records, snapshot.times, goals, self._ratings)
            self.stuck = (self.stuck | self._load.stuck) & snapshot.torque
        self.scale = float(derate(self._load, snapshot.records, self._ratings).min())
        self._since = 0.0

    def _judge(self, snapshot: Snapshot) -> None:
        self._signature, self.lost, self.answered = snapshot.signature, snapshot.lost, snapshot.recent
        self.answering = self.everybody and not snapshot.lost
        self.energised = snapshot.torque
        errors = snapshot.records["hardware_error"]
        complains = errors == HardwareError.VOLTAGE.value  # which takes no torque away: see SHUTDOWN
        self.failed, self.weak = ((errors != 0) & ~complains) | self.stuck, bool(complains.any())
        self.limp = self.answered & ~self.energised & ~self.failed
        self.any_energised, self.all_energised = bool(self.energised.any()), bool(self.energised.all())
        self.any_limp = bool(self.limp.any())
        self.tripped = bool((snapshot.tripped & self.energised).any())
        self._fit = bool((self.energised & ~self.failed).all()) and not self.tripped

    @property
    def well(self) -> bool:
        """Whether the performance may go on."""
        return self.answering and self._fit and self.scale > 0.0

    def telemetry(self, clock: float) -> Telemetry:
        """Returns how every servo is at a time [s]; `records` must be there."""
        if self.records is None:
            return Telemetry(clock)
        turns = self._manifest.scale.turns
        return Telemetry.of(clock, self.records, self.answered, full=self._ratings.current, turns=turns)

    @property
    def holding_joints(self) -> frozenset[int]:
        """Joints that must not move: the chains of those who have failed with torque, so that something is in the way.

        Where a servo has lost its torque, the others of its chain may still bring the limb to rest.
        """
        joints = {int(joint) for joint in self._manifest.joints[self.failed & self.energised]}
        return frozenset().union(*(chain for chain in self._manifest.chains if chain & joints))

    @property
    def raised(self) -> Flags:
        """(m,) who has torque, or had when it was heard last, and is not near rest; or may not be, as it is silent."""
        if self.records is None or not self.any_energised:
            return np.zeros(len(self.energised), dtype=np.bool_)
        away = self._away(self.records["position"].astype(float))
        if self._goals is not None and not self.everybody:
            away = np.where(self.answered, away, np.maximum(away, self._away(self._goals)))
        return self.energised & (away > REST)

    def _away(self, ticks: Floats) -> Floats:
        """(m,) [rad] from rest."""
        return np.abs(self._manifest.scale.angles(ticks) - self._manifest.rest[self._manifest.joints])

    def trouble(self) -> str:
        """Says why the performance may not go on; empty if it may."""
        if self.lost:
            return "a port is gone"
        if not self.everybody:
            return f"{self._names(~self.answered)}: silent"
        if self.failed.any():
            return f"{self._names(self.failed)}: shut down, or cannot move"
        if not self.all_energised:
            return f"{self._names(~self.energised)}: without torque"
        if self.tripped:
            return "servos were stopped by their bus watchdog"
        return "" if self.scale > 0.0 else "a servo is too hot, or works too hard"

    def _names(self, who: Flags) -> str:
        if who.all():
            return "all servos"
        return ", ".join(sorted({self._manifest.members[k].hinge for k in np.flatnonzero(who)}))
