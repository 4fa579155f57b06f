"""Delays of elbow and wrist after the shoulder, and between the hands.

People's shoulders set out before their elbows and wrists, and one of two hands is a little later. The delays vary
from gesture to gesture (`kinesic.expressivity.variation`), and with the expressivity: fluid arms swing along, stiff
and forceful ones move as one piece. Hands that come together, touch something or rest have no delay between them.
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

NEAR_DISTANCE = 0.3  # [arm lengths] distance between the wrists below which both hands move at the same time
FLUIDITY_GAIN = 0.6  # relative increase of the joint delays at a fluidity of 1, decrease at -1
FIRMNESS_GAIN = 0.7  # relative reduction of all delays at full power or tension


def find_successions(works: Iterable[HandStroke], context: BlockContext) -> Mapping[str, Succession]:
    """Return the joint and hand delays of every stroke.

    Args:
        works: strokes of both hands.
        context: of their block.

    Returns:
        Behaviour id -> delays; all joints of behaviours without variation move together.
    """
    behaviours = {behaviour.id: behaviour for behaviour in context.block.behaviours}
    return {work.id: _succession(work, behaviours[work.id], context) for work in works}


def _succession(work: HandStroke, behaviour: Behaviour, context: BlockContext) -> Succession:
    deviation = context.deviations.get(work.id)
    if deviation is None:
        return NO_SUCCESSION
    delays = _varied_delays(deviation, context.manner(behaviour))
    return delays if _are_apart(work.poses, context.robot) else replace(delays, behind=0.0)


def _varied_delays(deviation: Deviation, manner: Expressivity) -> Succession:
    firmness = 1.0 - FIRMNESS_GAIN * max(manner.power, manner.tension, 0.0)
    looseness = firmness * (1.0 + FLUIDITY_GAIN * manner.fluidity)
    return Succession(deviation.leader, firmness * deviation.behind, looseness * deviation.loose)


def _are_apart(poses: Poses, robot: Robot) -> bool:
    """Return whether both hands move without contact and far apart."""
    rows = [poses.hands.get(side, ()) for side in SIDES]
    return all(rows) and all(_distance(*pair) > NEAR_DISTANCE * robot.arm_length for pair in zip(*rows, strict=True))


def _distance(one: Hand, other: Hand) -> float:
    """Return the distance between two hands [m].

    It is 0 if one of them touches something or rests.
    """
    if one.reach is None or other.reach is None or one.touch or other.touch:
        return 0.0
    return float(np.linalg.norm(one.reach.position - other.reach.position))
