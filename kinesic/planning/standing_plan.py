"""Planning of blocks in the standing posture of their style."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from kinesic.bml.block import Block
from kinesic.body.robot import Robot
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.variation import NO_VARIATION, Variation
from kinesic.planning.certify import certify
from kinesic.planning.clearance import Conditioner
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup
from kinesic.planning.standing import standing_robot, vary_standing
from kinesic.planning.timely_strokes import keep_strokes_in_time


def plan_standing_block(block: Block, setup: Setup, *, conditioned: Conditioner = certify) -> Plan:
    """Plan a block in the standing posture of its style.

    A hand before the body or an uneven stance can be in the way of a gesture. If gestures are dropped, the block is
    planned again with hanging arms, then in the even stance of the style, then upright. The plan that performs most is
    returned. Near people, gestures whose strokes would be late are planned again with less amplitude or power.

    Args:
        block: to be planned.
        setup: of the performance.
        conditioned: turns desired motions into motions within the limits.

    Raises:
        BmlError: a `required` behaviour cannot be performed.
    """
    best = _plan_in_stances(block, setup, conditioned)
    return keep_strokes_in_time(best, lambda reduced: plan_block(reduced, best.setup, conditioned=conditioned))


def _plan_in_stances(block: Block, setup: Setup, conditioned: Conditioner) -> Plan:
    """Plan a block in the stance with the fewest dropped behaviours."""
    style = BlockContext(block, setup.context).bearing
    standing = _take_posture(style, setup)
    best = plan_block(block, standing, conditioned=conditioned)
    for other in _propose_stances(style, standing):
        if _count_dropped(best) == 0:
            break
        best = min(best, plan_block(block, other, conditioned=conditioned), key=_count_dropped)
    return best


def _take_posture(style: Style, setup: Setup) -> Setup:
    """Return the setup with the standing posture of a style."""
    if setup.unstyled is None or style is setup.style:
        return setup
    return _stand(setup.unstyled, style, setup, setup.variation)


def _propose_stances(style: Style, setup: Setup) -> Iterator[Setup]:
    """Yield setups with other stances that obstruct gestures less.

    The first has hanging arms, the second no random variation, the third not even the posture of the style. Equal ones
    are left out.
    """
    if setup.unstyled is None:
        return
    tried = [setup.robot.skeleton.rest]
    upright = replace(style, posture=0.0)
    stances = ((style, setup.variation, True), (style, NO_VARIATION, False), (upright, NO_VARIATION, False))
    for stance, variation, hands_hang in stances:
        other = _stand(setup.unstyled, stance, setup, variation, hands_hang=hands_hang)
        if not any(np.array_equal(other.robot.skeleton.rest, rest) for rest in tried):
            tried.append(other.robot.skeleton.rest)
            yield other


def _stand(unstyled: Robot, style: Style, setup: Setup, variation: Variation, *, hands_hang: bool = False) -> Setup:
    """Return the setup with a style's standing posture and a stance variation."""
    robot = standing_robot(unstyled, style, setup.lexicon, setup.distances)
    robot = vary_standing(robot, style, variation, setup.distances, hands_hang=hands_hang)
    return replace(setup, robot=robot, shared_limits=setup.limits)


def _count_dropped(plan: Plan) -> int:
    """Count the behaviours that a plan drops."""
    return sum(outcome.kind == "dropped" for outcome in plan.keyframes.outcomes.values())
