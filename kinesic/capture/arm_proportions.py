"""Adaptation of captured arms to the proportions of a robot's arm.

If wrists are at equal places, elbows differ where the upper arm is another fraction of the arm. If all bones have equal
directions, wrists differ. A small displacement of the wrist lowers the error of the upper arm's direction.
"""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.capture.clip import ArmPath

MAX_WRIST_SHIFT = 0.02  # [arm lengths] bound of the wrist's displacement, the wrist tolerance of arm smoothing
MIN_LENGTH = 1e-9  # [arm lengths] lower bound of bone lengths as divisors


def fit_proportions(path: ArmPath, chain: Chain, length: float) -> ArmPath:
    """Move wrists slightly towards places that keep the directions of all bones.

    Args:
        path: (m, 3) elbows and wrists of the actor [arm lengths].
        chain: the robot's arm.
        length: [m] of the arm.

    Returns:
        The same elbows, and wrists displaced by less than `MAX_WRIST_SHIFT`.
    """
    upper, fore = chain.lengths[-3:-1] / length
    aligned = upper * _unit(path.elbow) + fore * _unit(path.wrist - path.elbow)
    shift = aligned - path.wrist
    distance = np.linalg.norm(shift, axis=1, keepdims=True)
    return ArmPath(path.elbow, sealed(path.wrist + shift * MAX_WRIST_SHIFT / (MAX_WRIST_SHIFT + distance)))


def _unit(vectors: Floats) -> Floats:
    units: Floats = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), MIN_LENGTH)
    return units
