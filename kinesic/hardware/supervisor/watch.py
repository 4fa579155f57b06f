"""What the records say about the servos as a whole: who answers, who works too hard, who has failed."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.health import Records
from kinesic.hardware.supervisor.axes import Snapshot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.preparing import Table
from kinesic.hardware.supervisor.strain import Strain, Strength, derating, strained


class Watch:
    """Looks at every cycle."""

    def __init__(self, manifest: Manifest, tables: Sequence[Table]) -> None:
        """Nobody has been heard yet.

        Args:
            manifest: of the servos.
            tables: their registers, in its order; none if they are not known yet.
        """
        count = len(manifest.members)
        self._manifest, self._strength = manifest, Strength.of(tables)
        self._strain = Strain.none(count)
        self._snapshot: Snapshot | None = None
        self._nobody: Flags = np.zeros(count, dtype=np.bool_)
        self._stuck = self._nobody

    def look(self, snapshot: Snapshot, goals: Floats | None, seconds: float) -> None:
        """One more cycle; goals are (m,) [ticks]."""
        self._snapshot = snapshot
        if goals is not None:
            self._strain = strained(self._strain, snapshot.records, goals, seconds, self._strength)
            self._stuck = self._stuck | (self._strain.stuck & snapshot.torque)

    @property
    def records(self) -> Records | None:
        """(m,) the last ones; None before the first."""
        return self._snapshot.records if self._snapshot is not None else None

    @property
    def lost(self) -> bool:
        """Whether a port is gone."""
        return self._snapshot is not None and bool(self._snapshot.lost.any())

    @property
    def heard(self) -> Flags:
        """(m,) who has answered lately."""
        return self._snapshot.recent if self._snapshot is not None else self._nobody

    @property
    def answering(self) -> bool:
        """Whether all have."""
        return bool(self.heard.all()) and not self.lost

    @property
    def energised(self) -> Flags:
        """(m,) who had torque when heard last."""
        return self._snapshot.torque if self._snapshot is not None else self._nobody

    @property
    def failed(self) -> Flags:
        """(m,) who has a hardware error, or cannot move."""
        errors = self._snapshot.errors if self._snapshot is not None else self._stuck
        return np.asarray(errors | self._stuck)

    @property
    def stuck(self) -> Flags:
        """(m,) who cannot move, once."""
        return self._stuck

    @property
    def limp(self) -> Flags:
        """(m,) who could have torque, and has none."""
        return np.asarray(self.heard & ~self.energised & ~self.failed)

    @property
    def tripped(self) -> bool:
        """Whether servos with torque were stopped by their watchdog."""
        return self._snapshot is not None and bool((self._snapshot.tripped & self.energised).any())

    @property
    def scale(self) -> float:
        """How fast, 0..1, the hardest-working servo lets the performance be."""
        if self._snapshot is None:
            return 0.0
        return float(derating(self._strain, self._snapshot.records, self._strength).min())

    @property
    def well(self) -> bool:
        """Whether the performance may go on."""
        fit = self.energised & ~self.failed
        return self.answering and bool(fit.all()) and not self.tripped and self.scale > 0.0

    @property
    def present(self) -> Floats:
        """(m,) [ticks]; NaN for who has not answered lately."""
        if self._snapshot is None:
            return np.full(len(self._nobody), np.nan)
        return np.where(self.heard, self._snapshot.positions, np.nan)

    @property
    def held_joints(self) -> frozenset[int]:
        """Joints that must not move: the chains of those who have failed."""
        joints = {int(joint) for joint in self._manifest.joints[self.failed]}
        return frozenset().union(*(chain for chain in self._manifest.chains if chain & joints))
