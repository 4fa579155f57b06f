"""Finds the posture for a hand that somebody drags, and what keeps it from going farther."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.ik.arm.refine import refine_posture
from kinesic.ik.solve import REACHED, solve
from kinesic.planning.collision import Spacing, separate
from kinesic.planning.setup import Setup
from kinesic.serve.desk.helper import Unanswered
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import ReachQuestion
from kinesic.serve.wire.quotas import Quotas

DIGITS = 4  # of angles [rad] and lengths [m]
AT_LIMIT = 1e-3  # [rad] from the end of its range, where a hinge is at its limit


@dataclass(frozen=True, eq=False)
class HandPosture:
    """A posture that brings a hand as near to a place as it can, and what stops it there."""

    angles: Floats  # (n,) [rad]
    residual: float  # [m] from the hand to the place
    limits: tuple[str, ...]  # hinges of the arm at an end of their range, where the hand does not arrive
    contact: tuple[str, str] | None  # segments that would come too near to each other, where that is the reason

    @property
    def reached(self) -> bool:
        """Whether the hand arrives."""
        return self.residual <= REACHED


def reach_posture(robot: Robot, distances: Distances, side: Side, target: Floats, start: Floats) -> HandPosture:
    """Finds the posture that brings a hand to a place; the torso and the other arm stay as they are.

    Args:
        robot: whose hand.
        distances: between its segments.
        side: of the hand.
        target: (3,) [m] of the wrist's centre, in the world.
        start: (n,) [rad] posture to stay close to.

    Returns:
        The posture; where the hand does not arrive, it is as near as it can be. The body keeps clear of itself:
        elbows swing aside, or the hand stays away.
    """
    chain, posture = robot.arms[side], np.array(robot.skeleton.clamp(start))
    frames, base = robot.skeleton.frames(posture), robot.skeleton.segment(chain.base)
    in_base = sealed(frames.rotations[base].T @ (target - frames.origins[base]))
    joints = list(chain.indices)
    near = posture.copy()
    posture[joints] = solve(chain, Reach(in_base), start=posture[joints]).angles
    posture = np.array(refine_posture(robot, side, Reach(sealed(target)), posture, near=near))
    clearance = distances.clearance(posture[None])
    contact = clearance.pairs[0] if clearance.distances[0] < robot.least_clearance else None
    if contact is not None:
        spacing = Spacing(robot.least_clearance)
        clear = separate(posture, robot.arm(side).joints, robot, distances, spacing)
        posture = near if clear is None else np.array(clear)
    hand = robot.skeleton.frames(posture).origins[robot.arm(side).wrist]
    residual = float(np.linalg.norm(hand - target))
    arrives = residual <= REACHED
    limits = () if arrives or contact is not None else tuple(_at_limit(robot, posture, side))
    return HandPosture(sealed(posture), residual, limits, None if arrives else contact)


def _at_limit(robot: Robot, posture: Floats, side: Side) -> Iterator[str]:
    skeleton = robot.skeleton
    for joint in robot.arm(side).joints:
        if min(posture[joint] - skeleton.lower[joint], skeleton.upper[joint] - posture[joint]) < AT_LIMIT:
            yield skeleton.names[joint]


def answer_reach(question: ReachQuestion, setup: Setup, _rules: Quotas) -> str:
    """Answers a client that asks how a hand reaches a place."""
    robot, rest = setup.robot, setup.robot.skeleton.rest
    start = rest if question.posture is None else np.array(question.posture, dtype=np.float64)
    if start.shape != rest.shape:
        return _refusal(question, f"posture has {len(start)} angles, {robot.name} has {len(rest)} hinges")
    target = np.array(question.target, dtype=np.float64)
    side = next(side for side in SIDES if question.side.startswith(side))
    found = reach_posture(robot, setup.distances, side, target, start)
    return json_answer(
        "reach",
        id=question.id,
        angles=[round(float(angle), DIGITS) for angle in found.angles],
        residual=round(found.residual, DIGITS),
        reached=found.reached,
        limits=found.limits,
        contact=found.contact,
    )


def unanswered_reach(question: ReachQuestion, why: Unanswered) -> str:
    """Answers a question of which the posture was not found."""
    if why is Unanswered.OUTDATED:
        return json_answer("reach", id=question.id, outdated=True)
    return _refusal(question, why.value)


def _refusal(question: ReachQuestion, why: str) -> str:
    return json_answer("refused", do="reach", id=question.id, why=why)
