"""What the servos draw and how warm they get, by the law of a DC motor behind a PWM bridge.

A servo's stall figures are those of its motor at full duty: current per torque is stall current over stall torque, and
the winding's resistance is the voltage over the stall current. The bridge draws the motor's current for the share of
time that it is on. What a braking motor gives back is not counted: most supplies cannot take it.
"""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.command import Power
from kinesic.body.servo import Drives


@dataclass(frozen=True, eq=False)
class DriveEffort:
    """What the servos' law says for each step of the physics, in joint order."""

    duties: Floats  # (s, n) demanded, may exceed 1
    applied: Floats  # (s, n) within -1..1
    loads: Floats  # (s, n) torque over stall torque, which is motor current over stall current


def effort(drives: Drives, errors: Floats, speeds: Floats) -> DriveEffort:
    """Computes demanded duty, applied duty and share of stall torque of each drive at each step of the physics.

    Args:
        drives: in joint order.
        errors: (s, n) [rad] goals minus angles.
        speeds: (s, n) [rad/s].
    """
    duties = drives.gain * errors - drives.rate_gain / drives.stall * speeds
    applied = np.clip(duties, -1.0, 1.0)
    return DriveEffort(duties, applied, applied - speeds / drives.no_load)


def power(names: tuple[str, ...], drives: Drives, given: DriveEffort, *, spans: Floats, counts: list[int]) -> Power:
    """Sums up what the servos took from the supply.

    Args:
        names: of the hinges.
        drives: in joint order.
        given: what the servos did on each step.
        spans: (s,) [s] how long each step was.
        counts: (m,) steps so far at each command.
    """
    drawn = np.maximum(given.applied * given.loads, 0.0) * drives.stall_current + drives.idle_current  # (s, n) [A]
    current = drawn.sum(axis=1)
    edges = _edges(counts)
    lasting = np.add.reduceat(np.append(spans, 0.0), edges)[::2]
    mean = current[edges[1::2] - 1]  # of an interval without length, as on the step before
    np.divide(np.add.reduceat(np.append(current * spans, 0.0), edges)[::2], lasting, out=mean, where=lasting > 0.0)
    lost = given.loads**2 * drives.volt * drives.servo_current  # (s, n) [W] of one servo
    return Power(
        mean=sealed(mean),
        peak=sealed(np.maximum.reduceat(np.append(current, 0.0), edges)[::2]),
        energy=float(spans @ drawn @ drives.volt),
        warming={
            name: sealed(_warming(drive.servo.thermal, losses, spans)[edges[1::2] - 1])
            for name, drive, losses in zip(names, drives, lost.T, strict=True)
            if drive.servo.thermal is not None
        },
    )


def _edges(counts: list[int]) -> Indices:
    """(2 m,) first step and end of each command's interval; of one without length, the step before."""
    ends = np.array(counts, dtype=np.intp)
    return np.stack([np.minimum(np.concatenate([[0], ends[:-1]]), ends - 1), ends], axis=1).ravel()


def _warming(thermal: tuple[float, float], losses: Floats, spans: Floats) -> Floats:
    """(s,) [K] rise of a winding that was cold, from what its copper loses, (s,) [W] over spans (s,) [s]."""
    resistance, capacity = thermal
    settled = losses * resistance  # [K] where each loss alone would lead
    kept = np.exp(-spans / (resistance * capacity))
    rises, rise = np.empty(len(spans)), 0.0
    for k, (goal, share) in enumerate(zip(settled, kept, strict=True)):
        rise = goal + (rise - goal) * share
        rises[k] = rise
    return rises
