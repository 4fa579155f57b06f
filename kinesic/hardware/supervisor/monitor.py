"""What the records say about the servos as a whole: who answers, who works too hard, who has failed."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.bus.health import Records
from kinesic.hardware.supervisor.axes import Snapshot
from kinesic.hardware.supervisor.load_scaling import LoadRatings, LoadState, derate, update_load
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.preflight import Table

WEIGH = 0.05  # [s] between two looks at currents and temperatures


class CommunicationMonitor:
    """Looks at every cycle; at how hard servos work, which changes slowly, at every few."""

    def __init__(self, manifest: Manifest, tables: Sequence[Table]) -> None:
        """Nobody has been heard yet.

        Args:
            manifest: of the servos.
            tables: their registers, in its order; none if they are not known yet.
        """
        count = len(manifest.members)
        nobody: Flags = np.zeros(count, dtype=np.bool_)
        self._manifest, self._strength = manifest, LoadRatings.of(tables)
        self._strain, self._since = LoadState.none(count), WEIGH  # [s] since it was looked at
        self._signature = b""  # of what was judged last
        self.records: Records | None = None  # (m,) the last ones; None before the first
        self.present: Floats = np.full(count, np.nan)  # (m,) [ticks]; NaN for who has not answered lately
        self.taken: Floats = self.present  # (m,) [s] when that was so
        self.scale = 0.0  # how fast, 0..1, the hardest-working servo lets the performance be
        self.lost = False  # whether a port is gone
        self.answering = False  # whether all have answered lately
        self.everybody = False  # whether all have, be a port gone since
        self.heard: Flags = nobody  # (m,) who has answered lately
        self.energised: Flags = nobody  # (m,) who had torque when heard last
        self.stuck: Flags = nobody  # (m,) who could not move, once
        self.failed: Flags = nobody  # (m,) who has a hardware error, or is stuck
        self.limp: Flags = nobody  # (m,) who could have torque, and has none
        self.any_energised = self.all_energised = self.any_limp = False
        self.tripped = False  # whether servos with torque were stopped by their watchdog
        self._fit = False  # whether all have torque, and none has failed

    def look(self, snapshot: Snapshot, goals: Floats | None, seconds: float) -> None:
        """One more cycle; goals are (m,) [ticks]."""
        self.records, recent = snapshot.records, snapshot.recent
        self.everybody = everybody = bool(recent.all())
        self.present = snapshot.positions if everybody else np.where(recent, snapshot.positions, np.nan)
        self.taken = snapshot.times if everybody else np.where(recent, snapshot.times, np.nan)
        self._since += seconds
        weighed = self._since >= WEIGH
        if weighed:
            self._weigh(snapshot, goals)
        settled = everybody and self.answering and not weighed and not snapshot.lost
        if not settled or snapshot.signature != self._signature:
            self._judge(snapshot)

    def _weigh(self, snapshot: Snapshot, goals: Floats | None) -> None:
        """How hard they work."""
        if goals is not None:
            self._strain = update_load(self._strain, snapshot.records, goals, self._since, self._strength)
            self.stuck = self.stuck | (self._strain.stuck & snapshot.torque)
        self.scale = float(derate(self._strain, snapshot.records, self._strength).min())
        self._since = 0.0

    def _judge(self, snapshot: Snapshot) -> None:
        """What follows from all that."""
        self._signature, self.lost, self.heard = snapshot.signature, snapshot.lost, snapshot.recent
        self.answering = self.everybody and not snapshot.lost
        self.energised = snapshot.torque
        self.failed = snapshot.errors | self.stuck
        self.limp = self.heard & ~self.energised & ~self.failed
        self.any_energised, self.all_energised = bool(self.energised.any()), bool(self.energised.all())
        self.any_limp = bool(self.limp.any())
        self.tripped = bool((snapshot.tripped & self.energised).any())
        self._fit = bool((self.energised & ~self.failed).all()) and not self.tripped

    @property
    def well(self) -> bool:
        """Whether the performance may go on."""
        return self.answering and self._fit and self.scale > 0.0

    @property
    def held_joints(self) -> frozenset[int]:
        """Joints that must not move: the chains of those who have failed."""
        joints = {int(joint) for joint in self._manifest.joints[self.failed]}
        return frozenset().union(*(chain for chain in self._manifest.chains if chain & joints))
