"""Leisure: the share of its natural time that each gesture has. Who has little neither swings nor accents."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import inf

from kinesic.body.reach import Reach
from kinesic.body.robot import Side
from kinesic.expressivity.hands.poses import REST, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import HandStroke, natural_times
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.turns import MERGE


def find_leisure(works: Mapping[Side, Sequence[HandStroke]], pace: Pace) -> Mapping[int, float]:
    """Finds the least of three shares for each work: of the ways to it and from it, and of its stroke.

    Args:
        works: of each hand, in time order.
        pace: of the robot.

    Returns:
        By the work's `id()`; both hands of a work have the leisure of the one that has less.
    """
    found: dict[int, float] = {}
    rest = resting_hands(pace.robot)
    for side, row in works.items():
        gaps = [*(_gap(before, work, side, rest[side], pace) for before, work in pairwise((None, *row)) if work), inf]
        for k, work in enumerate(row):
            natural = sum(natural_times(work.poses, work.effort(pace)))
            inside = (work.moments[-1] - work.moments[0]) / natural if natural else inf
            found[id(work)] = min(gaps[k], inside, gaps[k + 1], found.get(id(work), inf))
    return found


def _gap(before: HandStroke | None, work: HandStroke, side: Side, rest: Reach, pace: Pace) -> float:
    """Time that the hand has to come to a stroke, from rest or from the stroke before, over the natural time."""
    hand, leaves = (before.poses.hands[side][-1], before.moments[-1]) if before else (REST, work.at("start"))
    effort, distance = work.effort(pace), pose_distance(hand, work.poses.hands[side][0], rest)
    given = work.moments[0] - leaves
    if before:
        return given / effort.joining_time(distance)
    usual = min(effort.preparation_time(distance), effort.joining_time(distance))
    return given / usual if given >= MERGE else 1.0
