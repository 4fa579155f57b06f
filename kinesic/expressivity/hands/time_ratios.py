"""Ratio of available to natural time of each gesture.

Gestures with little time have neither overshoot nor accents.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import inf

from kinesic.body.reach import Reach
from kinesic.body.robot import Side
from kinesic.expressivity.hands.poses import REST_HAND, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import HandStroke, natural_times
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.turns import MIN_KEY_SPACING


def available_time_ratios(works: Mapping[Side, Sequence[HandStroke]], pace: Pace) -> Mapping[int, float]:
    """Return available / natural time of each stroke.

    It is the smallest of three ratios: of the movements to and from the stroke, and of the stroke itself.

    Args:
        works: strokes of each hand, in time order.
        pace: of the robot.

    Returns:
        Ratio by the stroke's `id()`; two hands of one stroke have the smaller ratio of both.
    """
    ratios: dict[int, float] = {}
    rest = resting_hands(pace.robot)
    for side, row in works.items():
        movement_ratios = [
            *(_movement_ratio(before, work, side, rest[side], pace) for before, work in pairwise((None, *row)) if work),
            inf,
        ]
        for k, work in enumerate(row):
            natural = sum(natural_times(work.poses, work.effort(pace)))
            stroke_ratio = (work.moments[-1] - work.moments[0]) / natural if natural else inf
            ratios[id(work)] = min(movement_ratios[k], stroke_ratio, movement_ratios[k + 1], ratios.get(id(work), inf))
    return ratios


def _movement_ratio(before: HandStroke | None, work: HandStroke, side: Side, rest: Reach, pace: Pace) -> float:
    """Return available / natural time of the movement to a stroke.

    It begins at rest or at the preceding stroke.
    """
    hand, leaves = (before.poses.hands[side][-1], before.moments[-1]) if before else (REST_HAND, work.at("start"))
    effort, distance = work.effort(pace), pose_distance(hand, work.poses.hands[side][0], rest)
    available = work.moments[0] - leaves
    if before:
        return available / effort.joining_time(distance)
    natural_time = min(effort.preparation_time(distance), effort.joining_time(distance))
    return available / natural_time if available >= MIN_KEY_SPACING else 1.0
