"""Postures, duties, torques and power from a log of physics steps."""

from dataclasses import dataclass

import numpy as np

from kinesic._kernel import sim as kernel
from kinesic.body.arrays import Floats, Indices, seal_in_place
from kinesic.body.command import Power
from kinesic.body.servo import Drives
from kinesic.sim.power import Spent, list_windings
from kinesic.sim.stepping.step_log import LoggedSteps


@dataclass(frozen=True, eq=False)
class DrivenMotion:
    """Postures of all steps, and servo quantities at each command.

    The servo quantities belong to the setpoints in force at the command.
    """

    postures: Floats  # (s, n) [rad] after each step
    angles: Floats  # (m, n) [rad] at each command
    velocities: Floats  # (m, n) [rad/s] at each command
    duties: Floats  # (m, n) demanded duty cycle, may exceed 1
    torques: Floats  # (m, n) [Nm] at each command
    power: Power  # its energy includes previous windows
    spent: Spent  # at the last step


@dataclass(frozen=True, eq=False)
class HingePlaces:
    """Indices of the hinges' motor and backlash joints in the physics model."""

    motors: Indices  # (n,) joints driven by servos
    play: Indices  # (n,) backlash joints; (0,) if gears have no backlash


def measure_drives(
    log: LoggedSteps, places: HingePlaces, names: tuple[str, ...], drives: Drives, previous: Spent | None = None
) -> DrivenMotion:
    """Compute postures, servo quantities and power of one window of a motion.

    The window ends at its last command.

    Args:
        log: Logged steps of the physics.
        places: Indices of the hinges.
        names: Names of the hinges.
        drives: Drives in joint order.
        previous: Charge and temperature rise at the end of the previous window, whose last step is the first one here.
    """
    shape, windings = (len(log.ends), len(drives)), list_windings(names, drives)
    postures, rows = np.empty((len(log.spans), len(drives))), np.empty((4, *shape))
    currents, rises = np.empty((2, shape[0])), np.empty((len(windings), shape[0]))
    charge, warmth = (
        (previous.charge, previous.warmth) if previous else (np.zeros(len(drives)), np.zeros(len(windings)))
    )
    charge, warmth = charge.copy(), warmth.copy()
    servo_parameters = (
        drives.gain,
        drives.rate_gain / drives.stall,
        drives.no_load,
        drives.stall_current,
        drives.idle_current,
    )
    kernel.measure_drives(
        (log.angles, log.velocities, log.spans, log.supplied, log.aims),
        (log.begins, log.ends, places.motors, places.play, np.array([w.hinge for w in windings], dtype=np.intp)),
        np.stack(servo_parameters),
        np.array([(w.loss, w.resistance) for w in windings]).reshape(-1, 2),
        np.array([w.remaining_fraction(log.spans) for w in windings]).reshape(-1, len(log.spans)),
        0 if previous is None else 1,
        (postures, rows, currents, rises, warmth, charge),
    )
    volts = float(log.supplied.min() * drives.volt.max())
    mean, peak = (seal_in_place(row) for row in currents)
    temperature_rises = {w.name: seal_in_place(rise) for w, rise in zip(windings, rises, strict=True)}
    power = Power(mean=mean, peak=peak, energy=float(charge @ drives.volt), volts=volts, warming=temperature_rises)
    rows[3] *= drives.stall
    angles, velocities, duties, torques = (seal_in_place(row) for row in rows)
    spent = Spent(seal_in_place(charge), seal_in_place(warmth))
    return DrivenMotion(seal_in_place(postures), angles, velocities, duties, torques, power, spent)
