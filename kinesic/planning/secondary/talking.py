"""Talking: head and trunk are never still while somebody speaks.

The head dips a little on accented syllables, and it and the trunk stray slowly from phrase to phrase. What a document
asks of the head meanwhile is left alone.
"""

from collections.abc import Iterator, Mapping, Sequence
from math import radians

import numpy as np

from kinesic.bml.block import Gaze, Head, HeadDirectionShift, Speech, Timeline
from kinesic.bml.timing.syllables import accented_vowels
from kinesic.body.robot import Robot
from kinesic.body.utterance import Utterance
from kinesic.expressivity.idle import Span, pauses
from kinesic.planning.secondary.swells import Swell
from kinesic.planning.torso import set_turn

DIP = radians(1.2), radians(2.4)  # that the head goes down on an accent
DOWN, UP = 0.25, 0.45  # [s] of a dip
SPACING = 0.9, 2.2  # [s] from one dip to the next
PHRASE = 2.5, 4.5  # [s] that head and trunk take to stray and come back
FARTHEST_AT = 0.35, 0.6  # share of it, at which they are farthest
LEAST_PHRASE = 1.2  # [s] that is worth it
HEAD_STRAY = radians(3.0), radians(1.2), radians(2.0)  # torsion, tilt and roll that the head strays at most
TRUNK = radians(0.9), radians(0.3), radians(0.7)  # likewise the trunk


def talking(
    timeline: Timeline, utterances: Mapping[str, Utterance], amount: float, robot: Robot, chance: np.random.Generator
) -> Iterator[Swell]:
    """Moves head and trunk a little through all that is said; times are block time [s].

    Args:
        timeline: of the block.
        utterances: of its speeches, by their ids.
        amount: 0 not at all .. 1 as people do.
        robot: a part that it lacks stays still.
        chance: when and where to.
    """
    taken = [
        (min(timed.times.values()), max(timed.times.values()))
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Gaze | Head | HeadDirectionShift)
    ]
    for timed in timeline.timed:
        said = utterances.get(timed.behaviour.id)
        if not isinstance(timed.behaviour.action, Speech) or said is None:
            continue
        begin, end = timed.times["start"], timed.times["end"]
        for span in pauses(taken, (begin, end)):
            yield from _straying(span, amount, robot, chance)
            yield from _dips([begin + time for time in accented_vowels(said.phonemes)], span, amount, robot, chance)


def _straying(span: Span, amount: float, robot: Robot, chance: np.random.Generator) -> Iterator[Swell]:
    begin = span[0]
    while span[1] - begin >= LEAST_PHRASE:
        end = begin + float(chance.uniform(*PHRASE))
        if span[1] - end < LEAST_PHRASE:
            end = span[1]
        farthest = amount * min(1.0, (end - begin) / PHRASE[0])
        for chain, widest in (("neck", HEAD_STRAY), ("torso", TRUNK)):
            away = np.zeros(len(robot.skeleton.hinges))
            set_turn(robot, chain, farthest * np.array(widest) * chance.uniform(-1.0, 1.0, 3), away)
            yield Swell(begin, begin + float(chance.uniform(*FARTHEST_AT)) * (end - begin), end, away)
        begin = end


def _dips(
    accents: Sequence[float], span: Span, amount: float, robot: Robot, chance: np.random.Generator
) -> Iterator[Swell]:
    earliest = span[0] + DOWN
    for accent in accents:
        if accent >= earliest and accent + UP <= span[1]:
            away = np.zeros(len(robot.skeleton.hinges))
            set_turn(robot, "neck", np.array([0.0, amount * float(chance.uniform(*DIP)), 0.0]), away)
            yield Swell(accent - DOWN, accent, accent + UP, away)
            earliest = accent + float(chance.uniform(*SPACING))
