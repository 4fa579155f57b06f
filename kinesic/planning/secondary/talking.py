"""Head and trunk motion during speech.

The head nods on accents; head and trunk drift slowly from phrase to phrase. Requested head motion is left unchanged.
"""

from collections.abc import Iterator, Mapping, Sequence
from math import radians

import numpy as np

from kinesic.bml.block import Gaze, Head, HeadDirectionShift, Speech, Timeline
from kinesic.body.robot import Robot
from kinesic.body.utterance import Utterance
from kinesic.expressivity.idle import Span, pauses
from kinesic.expressivity.prosody import NO_PROSODY, Accent, Prosody, choose_accents
from kinesic.planning.secondary.offset_bumps import OffsetBump
from kinesic.planning.torso import set_turn

DIP_ANGLES = radians(1.2), radians(2.4)  # [rad] range of the head dip on an accent
DIP_DOWN_TIME = 0.25  # [s] time from the start of a head dip to its lowest point
DIP_UP_TIME = 0.45  # [s] time from the lowest point of a head dip to its end
DRIFT_PERIODS = 2.5, 4.5  # [s] range of durations of one sway of head and trunk
PEAK_FRACTIONS = 0.35, 0.6  # range of the peak time, as fractions of the sway
MIN_DRIFT_TIME = 1.2  # [s] shortest sway of head and trunk
MAX_HEAD_DRIFT = radians(3.0), radians(1.2), radians(2.0)  # [rad] largest torsion, tilt and roll of the swaying head
MAX_TRUNK_DRIFT = radians(0.9), radians(0.3), radians(0.7)  # [rad] largest torsion, tilt and roll of the swaying trunk


def make_speech_motion(
    timeline: Timeline,
    utterances: Mapping[str, Utterance],
    amount: float,
    robot: Robot,
    chance: np.random.Generator,
    *,
    prosody: Prosody = NO_PROSODY,
) -> Iterator[OffsetBump]:
    """Yield offsets of head and trunk during speech.

    Times are block times [s].

    Args:
        timeline: of the block.
        utterances: by speech id.
        amount: of the sway, 0 none .. 1 like a person.
        robot: parts that it lacks stay still.
        chance: random generator of the sway.
        prosody: amount of the nods on accents.
    """
    busy_spans = [
        (min(timed.times.values()), max(timed.times.values()))
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Gaze | Head | HeadDirectionShift)
    ]
    for timed in timeline.timed:
        utterance, action = utterances.get(timed.behaviour.id), timed.behaviour.action
        if not isinstance(action, Speech) or utterance is None:
            continue
        begin, end = timed.times["start"], timed.times["end"]
        accents = choose_accents(timed.behaviour.id, utterance, action.script, prosody.seed)
        nodding = np.random.default_rng((prosody.seed, len(accents)))
        for span in pauses(busy_spans, (begin, end)):
            if amount > 0.0:
                yield from _straying(span, amount, robot, chance)
            if prosody.amount > 0.0:
                yield from _dips(accents, begin, span, prosody.amount, robot, nodding)


def _straying(span: Span, amount: float, robot: Robot, chance: np.random.Generator) -> Iterator[OffsetBump]:
    begin = span[0]
    while span[1] - begin >= MIN_DRIFT_TIME:
        end = begin + float(chance.uniform(*DRIFT_PERIODS))
        if span[1] - end < MIN_DRIFT_TIME:
            end = span[1]
        peak = amount * min(1.0, (end - begin) / DRIFT_PERIODS[0])
        for chain, max_angles in (("neck", MAX_HEAD_DRIFT), ("torso", MAX_TRUNK_DRIFT)):
            offsets = np.zeros(len(robot.skeleton.hinges))
            set_turn(robot, chain, peak * np.array(max_angles) * chance.uniform(-1.0, 1.0, 3), offsets)
            yield OffsetBump(begin, begin + float(chance.uniform(*PEAK_FRACTIONS)) * (end - begin), end, offsets)
        begin = end


def _dips(
    accents: Sequence[Accent], start: float, span: Span, amount: float, robot: Robot, chance: np.random.Generator
) -> Iterator[OffsetBump]:
    """Yield the head dips on a speech's accents within a span.

    The speech begins at `start` [s].
    """
    for accent in accents:
        time, angle = start + accent.time, amount * accent.nod * float(chance.uniform(*DIP_ANGLES))
        if angle > 0.0 and time - DIP_DOWN_TIME >= span[0] and time + DIP_UP_TIME <= span[1]:
            offsets = np.zeros(len(robot.skeleton.hinges))
            set_turn(robot, "neck", np.array([0.0, angle, 0.0]), offsets)
            yield OffsetBump(time - DIP_DOWN_TIME, time, time + DIP_UP_TIME, offsets)
