"""Upper arm direction errors, and the least that body proportions allow.

If a robot's wrist is where the actor's is, in arm lengths, then shoulder, elbow and wrist form a triangle with given
sides. Its angle at the shoulder differs from the actor's if the upper arm is another fraction of the arm.
"""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.capture.certification import angles_between
from kinesic.capture.clip import ArmPath

MIN_DISTANCE = 1e-6  # [arm lengths] lower bound of the shoulder-wrist distance as a divisor


def measure_elbow_errors(desired: ArmPath, reached: ArmPath) -> tuple[Floats, Floats]:
    """Return upper-arm direction errors (m,) [deg]: actual, and least for exact wrists.

    Args:
        desired: elbows and wrists of the clip.
        reached: those of the robot at the same times.
    """
    upper = np.linalg.norm(reached.elbow, axis=1)
    fore = np.linalg.norm(reached.wrist - reached.elbow, axis=1)
    distance = np.maximum(np.linalg.norm(desired.wrist, axis=1), MIN_DISTANCE)
    cosines = (upper**2 + distance**2 - fore**2) / (2.0 * upper * distance)
    robot_angles = np.arccos(np.clip(cosines, -1.0, 1.0))
    least = np.abs(robot_angles - angles_between(desired.elbow, desired.wrist))
    return np.degrees(angles_between(desired.elbow, reached.elbow)), np.degrees(least)
