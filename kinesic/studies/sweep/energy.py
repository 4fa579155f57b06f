"""Kinetic energy of a motion, by the inverse dynamics that planning has already."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Dynamics


def kinetic_energy(dynamics: Dynamics, angles: Floats, speeds: Floats) -> Floats:
    """Kinetic energy of links and rotors: half of speed times mass matrix times speed.

    The product of mass matrix and speed is the torque that would accelerate the resting robot by as much as its speed
    is, beyond the torque that holds it.

    Args:
        dynamics: of the robot.
        angles: (m, n) [rad].
        speeds: (m, n) [rad/s].

    Returns:
        (m,) [J].
    """
    still = np.zeros_like(angles)
    momenta = dynamics.torques(angles, still, speeds) - dynamics.torques(angles, still, still)
    energies: Floats = 0.5 * np.vecdot(speeds, momenta)
    return energies
