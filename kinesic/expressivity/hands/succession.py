"""Succession: people's shoulders set out before their elbows and wrists, and one hand of two is a little later.

How much differs from gesture to gesture as all of them do (`kinesic.expressivity.variation`), and with the manner:
fluid arms swing along, stiff ones and those of somebody forceful move as one piece. Hands that come together, touch
something, or have a place to be at, do so at one time.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from kinesic.bml.block import Behaviour
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.hands.poses import Poses
from kinesic.expressivity.hands.strokes import HandStroke
from kinesic.expressivity.keyframes import NO_SUCCESSION, Hand, Succession
from kinesic.expressivity.style.style import Expressivity
from kinesic.expressivity.variation import Deviation

NEAR_HANDS = 0.3  # [arm lengths] from wrist to wrist, below which two hands stay together
FLUID = 0.6  # by which full fluidity makes arms looser, and full stiffness firmer
FIRM = 0.7  # that full power or tension takes away


def find_successions(works: Iterable[HandStroke], context: BlockContext) -> Mapping[str, Succession]:
    """Finds what moves later than what, in everything that hands do.

    Args:
        works: what both hands do.
        context: of their block.

    Returns:
        Behaviour id -> succession; of what does not vary all moves together.
    """
    behaviours = {behaviour.id: behaviour for behaviour in context.block.behaviours}
    return {work.id: _succession(work, behaviours[work.id], context) for work in works}


def _succession(work: HandStroke, behaviour: Behaviour, context: BlockContext) -> Succession:
    deviation = context.deviations.get(work.id)
    if deviation is None:
        return NO_SUCCESSION
    found = _asked(deviation, context.manner(behaviour))
    return found if _apart(work.poses, context.robot) else replace(found, behind=0.0)


def _asked(deviation: Deviation, manner: Expressivity) -> Succession:
    firm = 1.0 - FIRM * max(manner.power, manner.tension, 0.0)
    ease = firm * (1.0 + FLUID * manner.fluidity)
    return Succession(deviation.leader, firm * deviation.behind, ease * deviation.loose)


def _apart(poses: Poses, robot: Robot) -> bool:
    """Whether there are two hands, which touch nothing and never come near one another."""
    rows = [poses.hands.get(side, ()) for side in SIDES]
    return all(rows) and all(_distance(*pair) > NEAR_HANDS * robot.arm_length for pair in zip(*rows, strict=True))


def _distance(one: Hand, other: Hand) -> float:
    """From hand to hand [m]; none where one of them touches something or rests."""
    if one.reach is None or other.reach is None or one.touch or other.touch:
        return 0.0
    return float(np.linalg.norm(one.reach.position - other.reach.position))
