"""Monitoring of servo health, with slower motion for overloaded servos.

The temperature sensor is far from the winding, which heats within seconds, so the mean square of the current is tracked
as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.hardware.bus.cycle import Records
from kinesic.hardware.bus.telemetry import Telemetry
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, HardwareError, Register
from kinesic.hardware.supervisor.axes import Snapshot
from kinesic.hardware.supervisor.manifest import REST_TOLERANCE, Manifest
from kinesic.hardware.supervisor.preflight import RegisterTable

STALL_LOAD = 1000.0  # [0.1 %] value of PRESENT_CURRENT at stall, if the servo has no current sensor


@dataclass(frozen=True)
class LoadTuning:
    """Thresholds for load, heat and blockage, assumed without measurement."""

    time_constant: float = 10.0  # [s] time constant of the mean square current
    slowing_load: float = 0.5  # mean square current / squared limit at which performance time begins to slow down
    stopping_load: float = 0.8  # mean square current / squared limit at which the performance stops
    slowing_margin: float = 10.0  # [C] margin to the temperature limit at which performance time begins to slow down
    stopping_margin: float = 3.0  # [C] margin to the temperature limit at which the performance stops
    stuck_error_ratio: float = 1.1  # position error of a stuck servo / position error at full power
    stuck_time: float = 0.3  # [s] time with such an error and without motion until a servo counts as stuck
    min_moving_velocity: int = 3  # [counts of PRESENT_VELOCITY] a slower servo counts as standing still
    interval: float = 0.05  # [s] time between evaluations of currents and temperatures
    max_record_gap: float = 0.15  # [s] longest time between two records, after which stall times restart


LOAD_TUNING = LoadTuning()  # load thresholds of every supervisor


@dataclass(frozen=True, eq=False)
class LoadRatings:
    """Shutdown temperature, current limit and full-power position error, by servo."""

    celsius: Floats  # (m,) [C] shutdown temperature
    current: Floats  # (m,) [counts] current limit
    full: Floats  # (m,) [ticks] position error at full power

    @classmethod
    def of(cls, tables: Sequence[RegisterTable]) -> "LoadRatings":
        """Read the ratings from the servos' register tables."""
        return cls(
            celsius=sealed([table[Register.TEMPERATURE_LIMIT] for table in tables]),
            current=sealed([_current(table) for table in tables]),
            full=sealed([table.member.full for table in tables]),
        )


def _current(table: RegisterTable) -> float:
    return STALL_LOAD if table.member.model.amperes is None else max(1.0, float(table[Register.CURRENT_LIMIT]))


@dataclass(frozen=True, eq=False)
class LoadState:
    """Recent load of each servo: mean square current and stall time."""

    work: Floats  # (m,) mean square current / squared current limit
    stalled: Floats  # (m,) [s] time without motion while far from the goal
    taken: Floats  # (m,) [s] of the last evaluated record

    @classmethod
    def none(cls, count: int) -> "LoadState":
        """Create the state of servos without load."""
        return cls(sealed(np.zeros(count)), sealed(np.zeros(count)), sealed(np.full(count, -np.inf)))

    @property
    def stuck(self) -> Flags:
        """Whether each servo is stuck (m,): stalled far from its goal."""
        return self.stalled >= LOAD_TUNING.stuck_time


def update_load(load: LoadState, records: Records, taken: Floats, goals: Floats, ratings: LoadRatings) -> LoadState:
    """Update the load of servos with new records.

    Records that are not new change nothing. Stall times restart after a gap.

    Args:
        load: previous load.
        records: (m,) last records.
        taken: (m,) [s] their times; minus infinity: none.
        goals: (m,) [ticks].
        ratings: limits of the servos.
    """
    fresh = taken > load.taken
    since = np.where(fresh, taken, 0.0) - np.where(fresh, load.taken, 0.0)
    seconds = np.minimum(since, LOAD_TUNING.max_record_gap)
    current_ratio = np.minimum(np.abs(records["current"].astype(float)) / ratings.current, 1.0)
    work = load.work + (current_ratio**2 - load.work) * np.minimum(seconds / LOAD_TUNING.time_constant, 1.0)
    far = np.abs(goals - records["position"]) >= LOAD_TUNING.stuck_error_ratio * ratings.full
    free = (records["torque"] != 0) & (records["watchdog"] != WATCHDOG_TRIPPED)
    halted = (
        far
        & free
        & (np.abs(records["velocity"].astype(float)) < LOAD_TUNING.min_moving_velocity)
        & (since <= LOAD_TUNING.max_record_gap)
    )
    stalled = np.where(fresh, np.where(halted, load.stalled + seconds, 0.0), load.stalled)
    return LoadState(sealed(work), sealed(stalled), sealed(np.maximum(taken, load.taken)))


def derate(load: LoadState, records: Records, ratings: LoadRatings) -> Floats:
    """Compute each servo's time scale 0..1 (m,) from load and temperature."""
    by_work = (LOAD_TUNING.stopping_load - load.work) / (LOAD_TUNING.stopping_load - LOAD_TUNING.slowing_load)
    by_heat = (ratings.celsius - LOAD_TUNING.stopping_margin - records["temperature"]) / (
        LOAD_TUNING.slowing_margin - LOAD_TUNING.stopping_margin
    )
    scale: Floats = np.maximum(0.0, np.minimum(np.minimum(by_work, by_heat), 1.0))  # np.clip is several times slower
    return scale


class CommunicationMonitor:
    """Monitor of servo replies, faults and load in every bus cycle.

    Loads are evaluated every few cycles.
    """

    def __init__(self, manifest: Manifest, tables: Sequence[RegisterTable]) -> None:
        """Start the monitor before any servo has replied.

        Args:
            manifest: the servos.
            tables: their registers in its order; empty if they are not read yet.
        """
        count = len(manifest.members)
        no_member: Flags = np.zeros(count, dtype=np.bool_)
        self._manifest, self._ratings = manifest, LoadRatings.of(tables)
        self._load, self._since = LoadState.none(count), LOAD_TUNING.interval  # [s] since the last evaluation
        self._signature = b""  # signature of the last judged records
        self._goals: Floats | None = None  # (m,) [ticks]
        self.records: Records | None = None  # (m,) last records; None before the first
        self.present: Floats = np.full(count, np.nan)  # (m,) [ticks] positions; NaN for silent servos
        self.taken: Floats = self.present  # (m,) [s] times of these positions
        self.scale = 0.0  # time scale, 0..1, allowed by load and heat of all servos
        self.lost = False  # whether a port is gone
        self.answering = False  # whether all servos have answered recently and all ports are open
        self.all_answered = False  # whether all servos have answered recently
        self.answered: Flags = no_member  # (m,) servos that have answered recently
        self.energised: Flags = no_member  # (m,) servos with torque in the last record
        self.stuck: Flags = no_member  # (m,) servos that were blocked since torque came on
        self.failed: Flags = no_member  # (m,) servos with a hardware error, or stuck
        self.weak = False  # whether a servo reports a supply error and no other
        self.limp: Flags = no_member  # (m,) answering servos without torque that have not failed
        self.any_energised = self.all_energised = self.any_limp = False
        self.tripped = False  # whether a watchdog has stopped servos with torque
        self._fit = False  # whether all servos have torque and none has failed

    def limit_power(self, duties: Floats) -> None:
        """Scale the position error of a stuck servo by capped duties (m,)."""
        self._ratings = replace(self._ratings, full=sealed(duties * self._manifest.full))

    def look(self, snapshot: Snapshot, goals: Floats | None, seconds: float) -> None:
        """Update the states of all servos with the records of one cycle.

        Args:
            snapshot: records of the cycle.
            goals: (m,) [ticks]; None: unknown.
            seconds: [s] since the last cycle.
        """
        self.records, self._goals, recent = snapshot.records, goals, snapshot.recent
        self.all_answered = everybody = bool(recent.all())
        self.present = snapshot.positions if everybody else np.where(recent, snapshot.positions, np.nan)
        self.taken = snapshot.times if everybody else np.where(recent, snapshot.times, np.nan)
        self._since += seconds
        is_due = self._since >= LOAD_TUNING.interval
        if is_due:
            self._update_load(snapshot, goals)
        settled = everybody and self.answering and not is_due and not snapshot.lost
        if not settled or snapshot.signature != self._signature:
            self._judge(snapshot)

    def _update_load(self, snapshot: Snapshot, goals: Floats | None) -> None:
        if goals is not None:
            self._load = update_load(self._load, snapshot.records, snapshot.times, goals, self._ratings)
            self.stuck = (self.stuck | self._load.stuck) & snapshot.torque
        self.scale = float(derate(self._load, snapshot.records, self._ratings).min())
        self._since = 0.0

    def _judge(self, snapshot: Snapshot) -> None:
        self._signature, self.lost, self.answered = snapshot.signature, snapshot.lost, snapshot.recent
        self.answering = self.all_answered and not snapshot.lost
        self.energised = snapshot.torque
        errors = snapshot.records["hardware_error"]
        has_supply_error = errors == HardwareError.VOLTAGE.value  # does not switch torque off, see SHUTDOWN_MASK
        self.failed, self.weak = ((errors != 0) & ~has_supply_error) | self.stuck, bool(has_supply_error.any())
        self.limp = self.answered & ~self.energised & ~self.failed
        self.any_energised, self.all_energised = bool(self.energised.any()), bool(self.energised.all())
        self.any_limp = bool(self.limp.any())
        self.tripped = bool((snapshot.tripped & self.energised).any())
        self._fit = bool((self.energised & ~self.failed).all()) and not self.tripped

    @property
    def well(self) -> bool:
        """Whether servo replies, health and load let the performance continue."""
        return self.answering and self._fit and self.scale > 0.0

    def telemetry(self, clock: float) -> Telemetry:
        """Return the newest telemetry of all servos, with a clock time [s]."""
        if self.records is None:
            return Telemetry(clock)
        turns = self._manifest.scale.turns
        return Telemetry.of(clock, self.records, self.answered, full=self._ratings.current, turns=turns)

    @property
    def holding_joints(self) -> frozenset[int]:
        """Joints of all chains with a failed servo whose torque is on.

        They must not move, because such a servo is probably blocked. If a servo has lost its torque, the others of its
        chain may still bring the limb to rest.
        """
        joints = {int(joint) for joint in self._manifest.joints[self.failed & self.energised]}
        return frozenset().union(*(chain for chain in self._manifest.chains if chain & joints))

    @property
    def raised(self) -> Flags:
        """Flags (m,) of energised servos that may be away from rest.

        A silent servo counts as raised if its last position or its goal is away from rest.
        """
        if self.records is None or not self.any_energised:
            return np.zeros(len(self.energised), dtype=np.bool_)
        distances = self._distances(self.records["position"].astype(float))
        if self._goals is not None and not self.all_answered:
            distances = np.where(self.answered, distances, np.maximum(distances, self._distances(self._goals)))
        return self.energised & (distances > REST_TOLERANCE)

    def _distances(self, ticks: Floats) -> Floats:
        """Compute the distances (m,) [rad] from the rest posture."""
        return np.abs(self._manifest.scale.angles(ticks) - self._manifest.rest[self._manifest.joints])

    def trouble(self) -> str:
        """Describe why the performance may not continue, or return ""."""
        if self.lost:
            return "a port is gone"
        if not self.all_answered:
            return f"{self._names(~self.answered)}: silent"
        if self.failed.any():
            return f"{self._names(self.failed)}: shut down or blocked"
        if not self.all_energised:
            return f"{self._names(~self.energised)}: without torque"
        if self.tripped:
            return "servos were stopped by their bus watchdog"
        return "" if self.scale > 0.0 else "a servo is too hot or overloaded"

    def _names(self, members: Flags) -> str:
        if members.all():
            return "all servos"
        return ", ".join(sorted({self._manifest.members[k].hinge for k in np.flatnonzero(members)}))
