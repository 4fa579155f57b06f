"""Measures what hinges and servos did: postures of all steps of the physics, and the law of the servos on each.

The compiled kernel does it in one pass over the steps; without it NumPy does the same.
"""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, Indices, seal_own
from kinesic.body.command import Power
from kinesic.body.servo import Drives
from kinesic.sim.kinematics import KERNEL
from kinesic.sim.model import of_hinges
from kinesic.sim.power import Spent, effort, power, windings_of
from kinesic.sim.stepping.step_log import KeptSteps

if KERNEL == "compiled":
    from kinesic.sim import _kernel


@dataclass(frozen=True, eq=False)
class DrivenMotion:
    """Postures of all steps; the rest at the step of each command, for the goals that were in force."""

    postures: Floats  # (s, n) [rad]
    angles: Floats  # (m, n) [rad]
    speeds: Floats  # (m, n) [rad/s]
    duties: Floats  # (m, n) demanded, may exceed 1
    torques: Floats  # (m, n) [Nm]
    power: Power  # its energy is that of the stretches before, too
    spent: Spent  # up to the last step


@dataclass(frozen=True, eq=False)
class HingePlaces:
    """Where hinges are among the joints of the physics."""

    motors: Indices  # (n,) joints that servos drive
    play: Indices  # (n,) joints of the gears' play; (0,) where they have none


def measure_drives(
    kept: KeptSteps, places: HingePlaces, names: tuple[str, ...], drives: Drives, before: Spent | None = None
) -> DrivenMotion:
    """Measures a stretch of a motion up to its last command.

    Args:
        kept: all that the steps left.
        places: of the hinges.
        names: of the hinges.
        drives: in joint order.
        before: what was spent in the stretch before, whose last step is the first of these.
    """
    if KERNEL == "compiled":
        return _measure_compiled(kept, places, names, drives, before)
    at, spans = kept.ends - 1, kept.spans
    halves = kept.angles - (spans / 2)[:, None] * kept.speeds
    postures, speeds = (of_hinges(values, places.motors, places.play) for values in (halves, kept.speeds))
    in_force = np.repeat(kept.aims, np.diff(np.append(kept.begins, len(spans))), axis=0)
    given = effort(drives, in_force - postures, speeds, supplied=kept.supplied)
    drawn, spent = power(names, drives, given, spans=spans, counts=kept.ends.tolist(), before=before)
    return DrivenMotion(
        postures=seal_own(postures),
        angles=seal_own(postures[at]),
        speeds=seal_own(speeds[at]),
        duties=seal_own(given.duties[at]),
        torques=seal_own(given.loads[at] * drives.stall),
        power=drawn,
        spent=spent,
    )


def _measure_compiled(
    kept: KeptSteps, places: HingePlaces, names: tuple[str, ...], drives: Drives, before: Spent | None
) -> DrivenMotion:
    shape, windings = (len(kept.ends), len(drives)), windings_of(names, drives)
    postures, rows = np.empty((len(kept.spans), len(drives))), np.empty((4, *shape))
    currents, rises = np.empty((2, shape[0])), np.empty((len(windings), shape[0]))
    charge, warmth = (before.charge, before.warmth) if before else (np.zeros(len(drives)), np.zeros(len(windings)))
    charge, warmth = charge.copy(), warmth.copy()
    law = (drives.gain, drives.rate_gain / drives.stall, drives.no_load, drives.stall_current, drives.idle_current)
    _kernel.measure_drives(
        (kept.angles, kept.speeds, kept.spans, kept.supplied, kept.aims),
        (kept.begins, kept.ends, places.motors, places.play, np.array([w.hinge for w in windings], dtype=np.intp)),
        np.stack(law),
        np.array([(w.loss, w.resistance) for w in windings]).reshape(-1, 2),
        np.array([w.kept(kept.spans) for w in windings]).reshape(-1, len(kept.spans)),
        0 if before is None else 1,
        (postures, rows, currents, rises, warmth, charge),
    )
    volts = float(kept.supplied.min() * drives.volt.max())
    mean, peak = (seal_own(row) for row in currents)
    warming = {w.name: seal_own(rise) for w, rise in zip(windings, rises, strict=True)}
    drawn = Power(mean=mean, peak=peak, energy=float(charge @ drives.volt), volts=volts, warming=warming)
    rows[3] *= drives.stall
    angles, speeds, duties, torques = (seal_own(row) for row in rows)
    spent = Spent(seal_own(charge), seal_own(warmth))
    return DrivenMotion(seal_own(postures), angles, speeds, duties, torques, drawn, spent)
