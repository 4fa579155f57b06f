"""Answers clients that drag a part of the body."""

import numpy as np

from kinesic.body.robot import SIDES, Robot
from kinesic.planning.setup import Setup
from kinesic.serve.desk.drag import Part, drag_part
from kinesic.serve.desk.helper import Unanswered
from kinesic.serve.desk.reach import reach_posture
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import ReachQuestion
from kinesic.serve.wire.quotas import Quotas

DIGITS = 4  # of angles [rad] and lengths [m]


def answer_reach(question: ReachQuestion, setup: Setup, _rules: Quotas) -> str:
    """Answers a client that asks how a hand reaches a place."""
    robot, rest = setup.robot, setup.robot.skeleton.rest
    start = rest if question.posture is None else np.array(question.posture, dtype=np.float64)
    if start.shape != rest.shape:
        return _refusal(question, f"posture has {len(start)} angles, {robot.name} has {len(rest)} hinges")
    target = np.array(question.target, dtype=np.float64)
    side = next(side for side in SIDES if question.side.startswith(side))
    if question.part == "hand":
        found = reach_posture(robot, setup.distances, side, target, start)
    elif missing := _lacks(robot, question.part):
        return _refusal(question, f"{robot.name} has no {missing}")
    else:
        found = drag_part(robot, setup.distances, question.part, side, target, start)
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


def _lacks(robot: Robot, part: Part) -> str:
    """What a robot has not that a part needs; empty where it has all."""
    needs = {"elbow": (), "trunk": ("torso", "neck"), "gaze": ("neck",)}[part]
    return next((chain for chain in needs if not robot.joints(chain)), "")
