"""Simultaneous inverse kinematics of both hands and the torso (thesis 7.3).

The arms are coupled only by the torso. Each attempt therefore takes a torso posture, solves the arms on it, and reduces
the remaining errors with all hinges together. The first attempt begins with the current torso, so that it moves little.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from kinesic._kernel import ik as kernel
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.solve import as_floats
from kinesic.ik.strand import Strand, strand_to

REACHED_DISTANCE = 1e-3  # [m] largest distance at which a hand target counts as reached
TORSO_WEIGHT = 0.15  # default mobility of the torso relative to the arms


@dataclass(frozen=True, eq=False)
class Both:
    """Solved posture of the whole robot for two hand targets."""

    angles: Floats  # (n,) [rad] inside the ranges; hinges outside torso and arms as at the start
    residuals: Mapping[Side, float]  # [m] from each hand to its target
    torso_travel: float  # [rad] sum over the torso's hinges, from the start
    reached: bool  # both within 1 mm
    rounds: int  # total number of Levenberg-Marquardt iterations


def reach_both(
    robot: Robot,
    hands: Mapping[Side, Floats],
    *,
    start: Floats,
    torso_weight: float = TORSO_WEIGHT,
    priority: Side | None = None,
) -> Both:
    """Solve torso and arms for two hand targets together.

    Args:
        robot: with both arms.
        hands: (3,) [m] of each wrist's centre, in the world.
        start: (n,) [rad] of the whole robot, to stay close to; clipped to the ranges.
        torso_weight: mobility of the torso: 1 as an arm, lower moves it less, 0 fixes it.
        priority: the hand that is preferred if not both targets are reachable.

    Returns:
        The first posture that reaches both targets, or the best one.

    Raises:
        ValueError: a hand is missing, a shape is wrong or a number is not finite.
    """
    if set(hands) != set(SIDES):
        raise ValueError(f"hands are {sorted(hands)}; both are needed: l and r (for one hand: solve)")
    if not 0.0 <= torso_weight <= 1.0:
        raise ValueError(f"torso_weight is {torso_weight}; it must be between 0 (stays) and 1 (like an arm)")
    targets = {side: as_floats(f"target of hand {side}", hands[side], (3,)) for side in SIDES}
    start_angles = as_floats("start", start, robot.skeleton.rest.shape)
    first = -1 if priority is None else SIDES.index(priority)
    angles, left, right, travel, rounds = _pair_of(robot).reach(
        targets["l"], targets["r"], start_angles, torso_weight, first
    )
    return Both(angles, {"l": left, "r": right}, travel, max(left, right) <= REACHED_DISTANCE, rounds)


@lru_cache(maxsize=8)
def _pair_of(robot: Robot) -> kernel.Pair:
    """Convert a robot's torso and arms to solver data."""
    skeleton, chains = robot.skeleton, [robot.arms[side] for side in ("l", "r")]
    return kernel.Pair(
        lower=skeleton.lower.tolist(),
        upper=skeleton.upper.tolist(),
        torso=list(robot.joints("torso")),
        length=robot.arm_length,
        arms=[arm_of(chain) for chain in chains],
        joints=[list(chain.indices) for chain in chains],
        bases=[_parts(strand_to(skeleton, chain.base, whole=True)) for chain in chains],
        hands=[_parts(strand_to(skeleton, chain.joints[-1].name)) for chain in chains],
    )


def _parts(strand: Strand) -> "kernel.Parts":
    return [(part.offset, part.hinges) for part in strand.segments]
