"""Both hands and the torso by Levenberg-Marquardt, from several torso postures."""

from collections.abc import Iterator, Mapping
from itertools import product

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.box_lm import Box, Descent, ErrorFunction, descend
from kinesic.ik.strand import strand_to
from kinesic.ik.two_hands import REACHED_DISTANCE, TORSO_WEIGHT, Both

from .solve import solve

TOLERANCE = 1e-6  # [arm lengths] error at which an attempt ends
TORSO_FRACTIONS = (0.25, 0.75)  # start values over the range of each torso hinge
YIELD_WEIGHTS = (0.1, 0.01, 0.001)  # successive weights of the error of the hand without priority


def reach_both(
    robot: Robot, hands, *, start: Floats, torso_weight: float = TORSO_WEIGHT, priority: Side | None = None
) -> Both:
    """Compute the result of `ik.two_hands.reach_both` for valid arguments."""
    return _attempted(robot, hands, robot.skeleton.clamp(start), torso_weight, priority)


def _attempted(
    robot: Robot, targets: Mapping[Side, Floats], present: Floats, torso_weight: float, priority: Side | None
) -> Both:
    box = _box(robot, present, torso_weight)
    attempts: list[Descent] = []
    for torso in _torsos(robot, present, torso_weight):
        begun = _with_arms(robot, torso, targets)
        attempts.append(descend(_errors(robot, targets), begun, box, tolerance=TOLERANCE))
        if attempts[-1].miss <= TOLERANCE:
            break
    angles = min(attempts, key=lambda attempt: attempt.miss).angles
    rounds = sum(attempt.rounds for attempt in attempts)
    if priority is not None and attempts[-1].miss > TOLERANCE:
        for weight in YIELD_WEIGHTS:
            yielded = descend(_errors(robot, targets, priority, weight), angles, box, tolerance=TOLERANCE)
            angles, rounds = yielded.angles, rounds + yielded.rounds
    residuals = {side: float(np.linalg.norm(_hand(robot, side, angles)[0] - targets[side])) for side in SIDES}
    torso_joints = list(robot.joints("torso"))
    travel = float(np.abs(angles - present)[torso_joints].sum())
    return Both(angles, residuals, travel, max(residuals.values()) <= REACHED_DISTANCE, rounds)


def _torsos(robot: Robot, present: Floats, weight: float) -> Iterator[Floats]:
    """Yield start postures with different torso angles."""
    yield present
    joints = list(robot.joints("torso"))
    if not joints or weight <= 0.0:
        return
    lower, upper = robot.skeleton.lower[joints], robot.skeleton.upper[joints]
    for shares in product(TORSO_FRACTIONS, repeat=len(joints)):
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
        angles = solve(chain, Reach(target_in_base), start=posture[joints]).angles
        moving = linkage_of(chain).links[-1].first
        solved[joints[:moving]] = angles[:moving]
    return solved


def _hand(robot: Robot, side: Side, angles: Floats) -> tuple[Floats, Floats]:
    """Return a hand's position (3,) [m] and Jacobian (3, n)."""
    strand = strand_to(robot.skeleton, robot.arms[side].joints[-1].name)
    place, columns = strand.end(angles.tolist())
    motion = np.zeros((3, len(angles)))
    motion[:, list(strand.joints)] = columns.T
    return np.array(place), motion


def _errors(
    robot: Robot, targets: Mapping[Side, Floats], priority: Side | None = None, weight: float = 1.0
) -> ErrorFunction:
    """Return the error function of both hands, in arm lengths."""
    scales = {side: (1.0 if priority in (None, side) else weight) / robot.arm_length for side in SIDES}

    def errors(angles: Floats) -> tuple[Floats, Floats]:
        hands = {side: _hand(robot, side, angles) for side in SIDES}
        error = np.concatenate([scales[side] * (targets[side] - hands[side][0]) for side in SIDES])
        return error, np.concatenate([scales[side] * hands[side][1] for side in SIDES])

    return errors


def _box(robot: Robot, present: Floats, torso_weight: float) -> Box:
    """Return ranges, home posture and mobility of all hinges."""
    mobility = np.zeros(len(present))
    mobility[list(robot.joints("torso"))] = torso_weight
    for chain in robot.arms.values():
        linkage = linkage_of(chain)
        moving = linkage.links[-1].first
        mobility[list(chain.indices[:moving])] = linkage.mobility[:moving]
    return Box(robot.skeleton.lower, robot.skeleton.upper, sealed(present), sealed(mobility))
