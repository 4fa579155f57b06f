"""Plan a block in the standing posture of its style."""

from dataclasses import replace

import numpy as np

from kinesic.bml.block import Block
from kinesic.body.robot import Robot
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.style.style import Style
from kinesic.planning.certify import certify
from kinesic.planning.clearance import Conditioner
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup
from kinesic.planning.standing import standing_robot, vary_standing


def plan_standing_block(block: Block, setup: Setup, *, conditioned: Conditioner = certify) -> Plan:
    """Plan a block in the standing posture of its style.

    A hand before the body can be in the way of a gesture. If gestures are dropped, the block is planned again with
    hanging arms, and this plan is returned if it performs more of them.

    Args:
        block: to be planned.
        setup: of the performance.
        conditioned: turns desired motions into motions within the limits.

    Raises:
        BmlError: a `required` behaviour cannot be performed.
    """
    style = BlockContext(block, setup.context).bearing
    standing = _take_posture(style, setup)
    plan = plan_block(block, standing, conditioned=conditioned)
    if _count_dropped(plan) == 0 or (lowered := _lower_hands(style, standing)) is None:
        return plan
    lowered_plan = plan_block(block, lowered, conditioned=conditioned)
    return lowered_plan if _count_dropped(lowered_plan) < _count_dropped(plan) else plan


def _take_posture(style: Style, setup: Setup) -> Setup:
    """Return the setup with the standing posture of a style."""
    return setup if setup.unstyled is None or style is setup.style else _stand(setup.unstyled, style, setup)


def _lower_hands(style: Style, setup: Setup) -> Setup | None:
    """Return the setup with hanging arms, or None if they hang already."""
    if setup.unstyled is None:
        return None
    lowered = _stand(setup.unstyled, style, setup, hands_hang=True)
    return None if np.array_equal(lowered.robot.skeleton.rest, setup.robot.skeleton.rest) else lowered


def _stand(unstyled: Robot, style: Style, setup: Setup, *, hands_hang: bool = False) -> Setup:
    """Return the setup in which a robot stands in a style."""
    robot = standing_robot(unstyled, style, setup.lexicon, setup.distances)
    robot = vary_standing(robot, style, setup.variation, setup.distances, hands_hang=hands_hang)
    return replace(setup, robot=robot, shared_limits=setup.limits)


def _count_dropped(plan: Plan) -> int:
    """Count the behaviours that a plan drops."""
    return sum(outcome.kind == "dropped" for outcome in plan.keyframes.outcomes.values())
