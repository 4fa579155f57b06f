"""Monitor of five servos with records set by the test."""

from dataclasses import dataclass, field

import numpy as np

from kinesic.hardware.bus.cycle import BLOCK_DTYPE, Records, signature
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.axes import Snapshot
from kinesic.hardware.supervisor.manifest import Manifest, Member
from kinesic.hardware.supervisor.monitor import CommunicationMonitor


@dataclass(frozen=True)
class Given:
    """Servo whose register values the test sets."""

    member: Member
    values: dict[Register, int] = field(default_factory=dict)

    def __getitem__(self, register: Register) -> int:
        return self.values[register]


def tables_of(manifest: Manifest) -> list[Given]:
    limits = {Register.TEMPERATURE_LIMIT: 80, Register.CURRENT_LIMIT: 700}
    return [Given(member, limits) for member in manifest.members]


class Room:
    """Monitor of five servos with records set by the test."""

    def __init__(self, manifest: Manifest) -> None:
        self.manifest, self.time, self.lost = manifest, 0.0, False
        self.monitor = CommunicationMonitor(manifest, tables_of(manifest))
        self.recent = np.ones(5, dtype=bool)
        self.goals = manifest.scale.nearest(manifest.rest.take(manifest.joints))
        self.records: Records = np.zeros(5, dtype=BLOCK_DTYPE)
        self.records["torque"], self.records["temperature"], self.records["position"] = 1, 30, np.rint(self.goals)

    def look(self, cycles: int = 1, *, goals: bool = True) -> CommunicationMonitor:
        for _ in range(cycles):
            self.time += 0.01
            kept = self.records.copy()
            times = np.where(self.recent, self.time, -np.inf)
            snapshot = Snapshot(self.time, kept, times, self.recent.copy(), self.lost, signature(kept), ())
            self.monitor.look(snapshot, self.goals if goals else None, 0.01)
        return self.monitor
