"""Both hands and the torso as one problem: six rows, the torso's hinges shared (thesis 7.3, several targets).

The compiled kernel answers where there is one; what stands here is its specification. The arms are independent but for
the torso. So each attempt takes a torso posture, solves the arms on it, and lets
all hinges together remove what is left; the first attempt begins with the present torso, so that it moves little.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.ik.arm.compiled import KERNEL, arm_of
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.box_lm import Box, Descent, ErrorFunction, descend
from kinesic.ik.solve import as_floats, solve
from kinesic.ik.strand import Strand, strand_to
from kinesic.kernels import Kernel

if TYPE_CHECKING:
    from kinesic.ik import _kernel

REACHED = 1e-3  # [m]
TOLERANCE = 1e-6  # of the arm's length, at which an attempt ends
TORSO_WEIGHT = 0.15
SPREAD = (0.25, 0.75)  # of each torso hinge's range: where attempts begin beside the present posture
YIELDING = (0.1, 0.01, 0.001)  # weights of the hand that yields, one after another


@dataclass(frozen=True, eq=False)
class Both:
    """A posture of the whole robot for two hands."""

    angles: Floats  # (n,) [rad] inside the ranges; hinges outside torso and arms as at the start
    residuals: Mapping[Side, float]  # [m] from each hand to its target
    torso_travel: float  # [rad] sum over the torso's hinges, from the start
    reached: bool  # both within 1 mm
    rounds: int  # of the descents


def reach_both(
    robot: Robot,
    hands: Mapping[Side, Floats],
    *,
    start: Floats,
    torso_weight: float = TORSO_WEIGHT,
    priority: Side | None = None,
    kernel: Kernel = KERNEL,
) -> Both:
    """Finds one posture of torso and arms for both hands.

    Args:
        robot: whose hands.
        hands: (3,) [m] of each wrist's centre, in the world.
        start: (n,) [rad] of the whole robot, to stay close to; clipped to the ranges.
        torso_weight: how readily the torso helps: 1 like an arm, less = it moves late, 0 = it stays.
        priority: the hand that comes first where not both can be had.
        kernel: which implementation answers; "numpy" is the specification of the other.

    Returns:
        The first posture found in which both hands are there, else the best.

    Raises:
        ValueError: a hand is missing, a shape is wrong or a number is not finite.
    """
    if set(hands) != set(SIDES):
        raise ValueError(f"hands are {sorted(hands)}; both are needed: l and r (for one hand: solve)")
    if not 0.0 <= torso_weight <= 1.0:
        raise ValueError(f"torso_weight is {torso_weight}; it must be between 0 (stays) and 1 (like an arm)")
    targets = {side: as_floats(f"target of hand {side}", hands[side], (3,)) for side in SIDES}
    begun = as_floats("start", start, robot.skeleton.rest.shape)
    if kernel == "compiled":
        first = -1 if priority is None else SIDES.index(priority)
        answer = _pair_of(robot).reach(targets["l"], targets["r"], begun, torso_weight, first)
        if answer is not None:
            angles, left, right, travel, rounds = answer
            return Both(angles, {"l": left, "r": right}, travel, max(left, right) <= REACHED, rounds)
    return _specified(robot, targets, robot.skeleton.clamp(begun), torso_weight, priority)


@lru_cache(maxsize=8)
def _pair_of(robot: Robot) -> "_kernel.Pair":
    """Packs a robot for the kernel."""
    from kinesic.ik import _kernel  # noqa: PLC0415 - exists only where there was a compiler

    skeleton, chains = robot.skeleton, [robot.arms[side] for side in ("l", "r")]
    return _kernel.Pair(
        lower=skeleton.lower.tolist(),
        upper=skeleton.upper.tolist(),
        torso=list(robot.joints("torso")),
        length=robot.arm_length,
        arms=[arm_of(chain) for chain in chains],
        joints=[list(chain.indices) for chain in chains],
        bases=[_parts(strand_to(skeleton, chain.base, whole=True)) for chain in chains],
        hands=[_parts(strand_to(skeleton, chain.joints[-1].name)) for chain in chains],
    )


def _parts(strand: Strand) -> "_kernel.Parts":
    return [(part.offset, part.hinges) for part in strand.segments]


def _specified(
    robot: Robot, targets: Mapping[Side, Floats], present: Floats, torso_weight: float, priority: Side | None
) -> Both:
    box = _box(robot, present, torso_weight)
    attempts: list[Descent] = []
    for torso in _torsos(robot, present, torso_weight):
        begun = _with_arms(robot, torso, targets)
        attempts.append(descend(_errors(robot, targets), begun, box, tolerance=TOLERANCE))
        if attempts[-1].miss <= TOLERANCE:
            break
    found = min(attempts, key=lambda attempt: attempt.miss).angles
    rounds = sum(attempt.rounds for attempt in attempts)
    if priority is not None and attempts[-1].miss > TOLERANCE:
        for weight in YIELDING:
            yielded = descend(_errors(robot, targets, priority, weight), found, box, tolerance=TOLERANCE)
            found, rounds = yielded.angles, rounds + yielded.rounds
    residuals = {side: float(np.linalg.norm(_hand(robot, side, found)[0] - targets[side])) for side in SIDES}
    torso_joints = list(robot.joints("torso"))
    travel = float(np.abs(found - present)[torso_joints].sum())
    return Both(found, residuals, travel, max(residuals.values()) <= REACHED, rounds)


def _torsos(robot: Robot, present: Floats, weight: float) -> Iterator[Floats]:
    """Postures that differ in the torso: as it is, then spread over its ranges."""
    yield present
    joints = list(robot.joints("torso"))
    if not joints or weight <= 0.0:
        return
    lower, upper = robot.skeleton.lower[joints], robot.skeleton.upper[joints]
    for shares in product(SPREAD, repeat=len(joints)):
        torso = present.copy()
        torso[joints] = lower + (upper - lower) * np.array(shares)
        yield torso


def _with_arms(robot: Robot, posture: Floats, targets: Mapping[Side, Floats]) -> Floats:
    solved, frames = posture.copy(), robot.skeleton.frames(posture)
    for side in SIDES:
        chain = robot.arms[side]
        base = robot.skeleton.segment(chain.base)
        target_in_base = frames.rotations[base].T @ (targets[side] - frames.origins[base])
        joints = list(chain.indices)
        found = solve(chain, Reach(target_in_base), start=posture[joints], kernel="numpy").angles
        moving = linkage_of(chain).links[-1].first
        solved[joints[:moving]] = found[:moving]
    return solved


def _hand(robot: Robot, side: Side, angles: Floats) -> tuple[Floats, Floats]:
    """(3,) [m] a hand in the world and (3, n) how it moves."""
    strand = strand_to(robot.skeleton, robot.arms[side].joints[-1].name)
    place, columns = strand.end(angles.tolist())
    motion = np.zeros((3, len(angles)))
    motion[:, list(strand.joints)] = columns.T
    return np.array(place), motion


def _errors(
    robot: Robot, targets: Mapping[Side, Floats], priority: Side | None = None, weight: float = 1.0
) -> ErrorFunction:
    """Three rows for each hand, in arm lengths; those of the hand that yields times a weight."""
    scales = {side: (1.0 if priority in (None, side) else weight) / robot.arm_length for side in SIDES}

    def errors(angles: Floats) -> tuple[Floats, Floats]:
        hands = {side: _hand(robot, side, angles) for side in SIDES}
        error = np.concatenate([scales[side] * (targets[side] - hands[side][0]) for side in SIDES])
        return error, np.concatenate([scales[side] * hands[side][1] for side in SIDES])

    return errors


def _box(robot: Robot, present: Floats, torso_weight: float) -> Box:
    """Torso and arms are drawn to the present posture; all other hinges stay."""
    mobility = np.zeros(len(present))
    mobility[list(robot.joints("torso"))] = torso_weight
    for chain in robot.arms.values():
        linkage = linkage_of(chain)
        moving = linkage.links[-1].first
        mobility[list(chain.indices[:moving])] = linkage.mobility[:moving]
    return Box(robot.skeleton.lower, robot.skeleton.upper, sealed(present), sealed(mobility))
