"""Joint limits applied from end to root (thesis 7.3.3).

The algorithm prints the parent's share as q' / q, the way back from the cut-off rotation, which would take the hand
further away; its figure 7.4 and "Arc = alpha L1 = beta L2" mean q / q', which is used here.
"""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.rotation import rotation_to_vector, vector_to_rotation
from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.rotations import Carrier, ChainPosture, stance_of

MIN_LEVER_RATIO = 1e-9  # [chain lengths] smallest parent-target distance at which parents compensate limits


def within_limits(chain: BallChain, stance: ChainPosture, target: Floats, carrier: Carrier) -> ChainPosture:
    """Clip joint rotations to limits, compensated by rotations of the parent joints.

    A joint p_i that loses the turn alpha moves the hand by an arc alpha |t - p_i|; its parent turns by
    beta = alpha |t - p_i| / |t - p_i-1| about the same axis to bring the hand back. The root's excess is lost.

    Args:
        chain: at rest; without limits the stance comes back unchanged.
        stance: posture that follows the relaxed masses, without limits.
        target: (3,) [m].
        carrier: base of the chain.

    Returns:
        A stance inside the limits.
    """
    if chain.limits is None:
        return stance
    rotations = stance.rotations.copy()
    arms = np.linalg.norm(target - stance.points[:-1], axis=1)
    for k in range(len(rotations) - 1, -1, -1):
        clamped = chain.limits.clamp(rotations[k], k)
        if clamped is rotations[k]:
            continue
        if k > 0 and arms[k - 1] > MIN_LEVER_RATIO * chain.size:
            into_parent = chain.frames[k - 1].T @ chain.frames[k]
            excess = into_parent @ rotation_to_vector(rotations[k] @ clamped.T)
            rotations[k - 1] = rotations[k - 1] @ _arc(excess, float(arms[k] / arms[k - 1]))
        rotations[k] = clamped
    return stance_of(chain, rotations, carrier)


def _arc(excess: Floats, ratio: float) -> Floats:
    """Return the parent's rotation matrix that compensates a clipped child rotation."""
    angle = float(np.linalg.norm(excess)) * ratio
    return vector_to_rotation(excess * ratio * np.pi / max(angle, np.pi))
