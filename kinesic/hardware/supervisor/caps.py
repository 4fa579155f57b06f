"""Caps of servo velocity and power near people.

The planner computes the caps once per block. PROFILE_VELOCITY and GOAL_PWM are written only if they change, so caps
take no time on the wire in other cycles. Without caps, nothing is written.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.hardware.protocol.registers import TICK_ANGLE, VELOCITY_UNIT, Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.supervisor.axes import Axes
from kinesic.hardware.supervisor.goals import GoalSteering
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.monitor import CommunicationMonitor
from kinesic.hardware.supervisor.preflight import RegisterTable

CAP_WRITES = 2  # number of cycles in which a changed cap is written, because servos do not acknowledge it
BRAKING_TIME = 0.3  # [s] time of full power from the start of a quick stop


@dataclass(frozen=True, eq=False)
class ServoCaps:
    """Largest setpoint velocity and duty of each joint in a motion."""

    velocities: Floats  # (n,) [rad/s] largest velocity of the setpoints
    duties: Floats  # (n,) largest duty, as a fraction of full PWM
    holding: Floats  # (n,) duty that holds the joint in any posture


class CapWriter:
    """Writer of the caps to the servos that have torque."""

    def __init__(self, manifest: Manifest, tables: Sequence[RegisterTable]) -> None:
        """Start without caps.

        Args:
            manifest: the servos.
            tables: their registers in its order; empty if they are not read yet.
        """
        self._manifest = manifest
        self._limits: Ticks = np.array([table[Register.PWM_LIMIT] for table in tables], dtype=np.int64)
        self._caps: ServoCaps | None = None
        self._written: Ticks = np.full((2, len(manifest.members)), -1, dtype=np.int64)  # -1: not known
        self._writes_left: Ticks = np.zeros(len(manifest.members), dtype=np.int64)
        self._braking_left = 0.0  # [s] remaining time of full power

    @property
    def power(self) -> Ticks:
        """GOAL_PWM (m,) of each servo in normal motion."""
        return self._limits if self._caps is None else self._power(self._caps.duties)

    def take(self, caps: ServoCaps | None, monitor: CommunicationMonitor, steering: GoalSteering) -> None:
        """Replace the caps, and adapt the estimates that depend on them.

        Args:
            caps: new caps; None: unchanged.
            monitor: its servos count as stuck at the position error at which their power is exhausted.
            steering: its goals compensate the lag of the profiles.
        """
        if caps is None:
            return
        self._caps = caps
        monitor.limit_power(caps.duties[self._manifest.joints])
        steering.set_profile_velocities(sealed(self._profiles(caps) * VELOCITY_UNIT / TICK_ANGLE))

    def forget(self) -> None:
        """Write all caps again, because a procedure has changed the registers."""
        self._written = np.full_like(self._written, -1)

    def write(self, axes: Axes, monitor: CommunicationMonitor, *, seconds: float, braking: bool) -> None:
        """Queue the changed caps of servos with torque for this cycle.

        A chain that holds after a failure gets no more power than it needs to hold.

        Args:
            axes: the servos.
            monitor: their torque and failures.
            seconds: [s] since the last cycle.
            braking: whether a quick stop begins or continues, for which servos get full power.
        """
        if self._caps is None:
            return
        self._braking_left = BRAKING_TIME if braking else max(0.0, self._braking_left - seconds)
        energised, is_held = monitor.energised, np.isin(self._manifest.joints, list(monitor.holding_joints))
        power = self._limits if self._braking_left > 0.0 else self.power
        power = np.where(is_held, self._power(self._caps.holding), power)
        wanted = np.array([self._profiles(self._caps), power])
        self._writes_left[(wanted != self._written).any(axis=0)] = CAP_WRITES
        places = np.flatnonzero((self._writes_left > 0) & energised).tolist()
        for register, values in zip((Register.PROFILE_VELOCITY, Register.GOAL_PWM), wanted.tolist(), strict=True):
            axes.put(register, {k: values[k] for k in places})
        self._writes_left[places] -= 1
        self._written = np.where(energised, wanted, -1)

    def _power(self, duties: Floats) -> Ticks:
        """Convert duties (n,) to GOAL_PWM (m,), at most PWM_LIMIT."""
        members = self._manifest.members
        full = np.array([member.model.factory_value(Register.PWM_LIMIT) for member in members])
        counts = np.ceil(duties[self._manifest.joints] * full).astype(np.int64)
        power: Ticks = np.minimum(counts, self._limits)
        return power

    def _profiles(self, caps: ServoCaps) -> Ticks:
        """Return PROFILE_VELOCITY (m,), at most that without caps."""
        members, scale = self._manifest.members, self._manifest.scale
        counts = np.ceil(caps.velocities[self._manifest.joints] * np.abs(scale.turns) / VELOCITY_UNIT)
        usual = np.array([member.ram_values.get(Register.PROFILE_VELOCITY, 1) for member in members])
        profiles: Ticks = np.maximum(1, np.minimum(counts, usual)).astype(np.int64)
        return profiles
