"""Servo model, currents and temperatures of all physics steps in NumPy."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.command import Power
from kinesic.body.servo import Drives
from kinesic.sim.model import sum_hinge_values
from kinesic.sim.power import Spent, Winding, list_windings
from kinesic.sim.stepping.driven_motion import DrivenMotion, HingePlaces
from kinesic.sim.stepping.step_log import LoggedSteps

FULL_SUPPLY = sealed([1.0])  # supply voltage / open-circuit voltage of a supply without resistance


def measure_drives(kept: LoggedSteps, places: HingePlaces, names, drives: Drives, before: Spent | None = None):
    """Compute the result of `driven_motion.measure_drives`."""
    at, spans = kept.ends - 1, kept.spans
    halves = kept.angles - (spans / 2)[:, None] * kept.velocities
    postures, speeds = (sum_hinge_values(values, places.motors, places.play) for values in (halves, kept.velocities))
    in_force = np.repeat(kept.aims, np.diff(np.append(kept.begins, len(spans))), axis=0)
    given = effort(drives, in_force - postures, speeds, supplied=kept.supplied)
    drawn, spent = power(names, drives, given, spans=spans, counts=kept.ends.tolist(), before=before)
    return DrivenMotion(
        postures=postures,
        angles=postures[at],
        velocities=speeds[at],
        duties=given.duties[at],
        torques=given.loads[at] * drives.stall,
        power=drawn,
        spent=spent,
    )


@dataclass(frozen=True, eq=False)
class DriveEffort:
    """Duties and loads of the servo model in each physics step."""

    duties: Floats  # (s, n) demanded duty, may exceed 1
    applied: Floats  # (s, n) applied duty within -1..1
    loads: Floats  # (s, n) torque / stall torque, which equals motor current / stall current
    supplied: Floats  # (s,) or (1,) supply voltage / open-circuit voltage


def effort(drives: Drives, errors: Floats, speeds: Floats, *, supplied: Floats = FULL_SUPPLY) -> DriveEffort:
    """Return duties and loads of each drive in each physics step.

    Args:
        drives: in joint order.
        errors: (s, n) [rad] goals minus angles.
        speeds: (s, n) [rad/s].
        supplied: (s,) or (1,) fraction of its open voltage that the supply has.
    """
    duties = drives.demanded_duties(errors, speeds)
    applied = np.clip(duties, -1.0, 1.0)
    return DriveEffort(duties, applied, drives.torque_ratios(applied, speeds, supplied), supplied)


def power(
    names: tuple[str, ...],
    drives: Drives,
    given: DriveEffort,
    *,
    spans: Floats,
    counts: list[int],
    before: Spent | None = None,
) -> tuple[Power, Spent]:
    """Return the electrical power, and the energy and heat up to each step.

    Args:
        names: of the hinges.
        drives: in joint order.
        given: duties and loads of each step.
        spans: (s,) [s] durations of the steps.
        counts: (m,) number of steps up to each command.
        before: energy and heat up to the first step, if the first step is already counted.
    """
    windings, new = list_windings(names, drives), 0 if before is None else 1
    charge, warmth = (before.charge, before.warmth) if before else (0.0, np.zeros(len(windings)))
    drawn = given.applied * given.loads
    np.maximum(drawn, 0.0, out=drawn)
    drawn *= drives.stall_current
    drawn += drives.idle_current  # (s, n) [A]
    current = drawn.sum(axis=1)
    edges = _edges(counts, new)
    lasting = np.add.reduceat(np.append(spans, 0.0), edges)[::2]
    mean = current[edges[1::2] - 1]  # of an interval without length, as on the step before
    np.divide(np.add.reduceat(np.append(current * spans, 0.0), edges)[::2], lasting, out=mean, where=lasting > 0.0)
    charge = charge + (spans * given.supplied)[new:] @ drawn[new:]
    rises = [
        np.append([rise] * new, warm(each, given.loads[new:, each.hinge], spans[new:], rise))
        for each, rise in zip(windings, warmth.tolist(), strict=True)
    ]
    spent = Spent(sealed(charge), sealed([rise[-1] for rise in rises]))
    return Power(
        mean=sealed(mean),
        peak=sealed(np.maximum.reduceat(np.append(current, 0.0), edges)[::2]),
        energy=float(spent.charge @ drives.volt),
        volts=float(given.supplied.min() * drives.volt.max()),
        warming={each.name: sealed(rise[edges[1::2] - 1]) for each, rise in zip(windings, rises, strict=True)},
    ), spent


def _edges(counts: list[int], first: int) -> Indices:
    """Return the first and last physics step of each command, (2 m,)."""
    ends = np.array(counts, dtype=np.intp)
    return np.stack([np.minimum(np.concatenate([[first], ends[:-1]]), ends - 1), ends], axis=1).ravel()


def warm(winding: Winding, loads, spans, rise: float):
    """Return the temperature rise (s,) [K] of a motor winding."""
    settled = winding.loss * loads**2 * winding.resistance  # [K] steady-state rise of each loss
    rises = []
    for goal, share in zip(settled.tolist(), winding.remaining_fraction(spans).tolist(), strict=True):
        rise = goal + (rise - goal) * share
        rises.append(rise)
    return np.array(rises)
