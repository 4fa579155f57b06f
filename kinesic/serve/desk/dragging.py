"""Answers to reach queries while a client drags a body part."""

import numpy as np

from kinesic.body.robot import SIDES, Robot
from kinesic.planning.setup import Setup
from kinesic.serve.desk.drag import Part, drag_part
from kinesic.serve.desk.helper import Unanswered
from kinesic.serve.desk.reach import reach_posture
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import ReachQuestion
from kinesic.serve.wire.quotas import Quotas

ANSWER_DIGITS = 4  # decimal places of angles [rad] and lengths [m]


def answer_reach(question: ReachQuestion, setup: Setup, _rules: Quotas) -> str:
    """Return the reached posture with its obstacles, or a refusal, as JSON."""
    robot, rest = setup.robot, setup.robot.skeleton.rest
    start = rest if question.posture is None else np.array(question.posture, dtype=np.float64)
    if start.shape != rest.shape:
        return _refusal(question, f"posture has {len(start)} angles, {robot.name} has {len(rest)} hinges")
    target = np.array(question.target, dtype=np.float64)
    side = next(side for side in SIDES if question.side.startswith(side))
    if question.part == "hand":
        result = reach_posture(robot, setup.distances, side, target, start)
    elif missing := _lacks(robot, question.part):
        return _refusal(question, f"{robot.name} has no {missing}")
    else:
        result = drag_part(robot, setup.distances, question.part, side, target, start)
    return json_answer(
        "reach",
        id=question.id,
        angles=[round(float(angle), ANSWER_DIGITS) for angle in result.angles],
        residual=round(result.residual, ANSWER_DIGITS),
        reached=result.reached,
        limits=result.limits,
        contact=result.contact,
    )


def reach_failure(question: ReachQuestion, why: Unanswered) -> str:
    """Return the answer to a reach query that was not processed."""
    if why is Unanswered.OUTDATED:
        return json_answer("reach", id=question.id, outdated=True)
    return _refusal(question, why.value)


def _refusal(question: ReachQuestion, why: str) -> str:
    return json_answer("refused", do="reach", id=question.id, why=why)


def _lacks(robot: Robot, part: Part) -> str:
    """Return the kinematic chain that the robot lacks for a dragged part.

    Empty if there is none.
    """
    needs = {"elbow": (), "trunk": ("torso", "neck"), "gaze": ("neck",)}[part]
    return next((chain for chain in needs if not robot.joints(chain)), "")
