"""Changes of the rest posture in long pauses, such as weight shifts."""

from collections.abc import Iterator
from itertools import pairwise
from math import ceil, radians

import numpy as np

from kinesic.body.arrays import Floats, find_runs
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.idle import Span
from kinesic.expressivity.style.standing import Standing, choose_rest
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.offset_bumps import OffsetBump
from kinesic.planning.setup import Setup
from kinesic.planning.standing import draw_rest, take_rest

MIN_REST_SPAN = 6.0  # [s] shortest rest of both arms in which the rest posture changes
REST_DURATION = 15.0  # [s] usual duration of one rest posture; people change it every 10 to 20 s
CHANGE_DURATIONS = 1.2, 1.9  # [s] shortest and longest transition between two rest postures
OTHER_REST_PROBABILITY = 0.5  # probability that a change moves the hands to another rest gesture of the style
HELD_SHIFT_FRACTION = 0.4  # factor on the weight shift if the hands move to another rest gesture
REST_MARGIN = 0.4  # [s] time at rest before the first and after the last transition
REST_TOLERANCE = 0.02  # [rad] largest distance of a resting arm from the rest posture
WEIGHT_SHIFT = radians(2.6), radians(1.2)  # [rad] largest and smallest trunk roll in a weight shift
TRUNK_TORSION = radians(3.0)  # [rad] largest trunk torsion in a weight shift


def make_rest_changes(
    motion: Trajectory, span: Span, setup: Setup, standing: Standing, chance: np.random.Generator
) -> Iterator[OffsetBump]:
    """Yield offsets that change the rest posture in long rests.

    Each is kept for 10 to 20 s, less in short rests, and passes into the next. Some put the hands into
    another rest of the style.

    Args:
        motion: with the rests.
        span: [s] begin and end of the motion.
        setup: robot, and amount of idle motion: 0 none .. 1 like a person.
        standing: of the style, with its rests in pauses.
        chance: random generator of the postures.
    """
    robot, amount = setup.robot, setup.idling.amount
    for begin, end in _find_rests(motion, span, robot):
        count = max(1, ceil((end - begin) / REST_DURATION - 0.5))
        times = np.linspace(begin + REST_MARGIN, end - REST_MARGIN - CHANGE_DURATIONS[1], count + 1).tolist()
        for start, stop in pairwise(times):
            rise, fall = chance.uniform(*CHANGE_DURATIONS, 2).tolist()
            offsets = amount * _draw_posture(setup, standing, chance)
            hands = _change_hands(setup, standing, chance) if chance.uniform() < OTHER_REST_PROBABILITY else None
            if hands is not None:
                offsets = min(amount, 1.0) * hands + HELD_SHIFT_FRACTION * _without_arms(offsets, robot)
            yield OffsetBump(start, start + rise, stop + fall, offsets, max(stop - start - rise, 0.0))


def _find_rests(motion: Trajectory, span: Span, robot: Robot) -> Iterator[Span]:
    """Yield spans of at least `MIN_REST_SPAN` [s] with both arms resting."""
    joints = [joint for side in SIDES for joint in robot.arm(side).joints]
    first, last = (round((time - motion.start) / KNOT_INTERVAL) for time in span)
    rows = np.clip(np.arange(first, last + 1), 0, len(motion.controls) - 1)
    angles = motion.controls[rows][:, joints]
    is_resting = np.abs(angles - robot.skeleton.rest[joints]).max(axis=1) < REST_TOLERANCE
    for begin, end in find_runs(is_resting):
        if (end - 1 - begin) * KNOT_INTERVAL >= MIN_REST_SPAN:
            yield span[0] + begin * KNOT_INTERVAL, span[0] + (end - 1) * KNOT_INTERVAL


def _change_hands(setup: Setup, standing: Standing, chance: np.random.Generator) -> Floats | None:
    """Return the offset (n,) [rad] to another rest pose, or None.

    Returns:
        None if the style names none, or the body cannot take it.
    """
    name = choose_rest(standing.pauses, chance)
    posture = None if name is None else take_rest(name, setup, chance)
    return None if posture is None else posture - setup.robot.skeleton.rest


def _without_arms(offsets: Floats, robot: Robot) -> Floats:
    """Return the offsets (n,) [rad] of trunk and head alone."""
    kept = offsets.copy()
    kept[[joint for side in SIDES for joint in robot.arm(side).joints]] = 0.0
    return kept


def _draw_posture(setup: Setup, standing: Standing, chance: np.random.Generator) -> Floats:
    """Draw a random offset (n,) [rad] from the usual rest posture.

    The head stays level over the shifted trunk.
    """
    robot = setup.robot
    roll = float(chance.uniform(WEIGHT_SHIFT[1], WEIGHT_SHIFT[0])) * (1.0 if chance.uniform() < 0.5 else -1.0)
    torsion = float(chance.uniform(-1.0, 1.0)) * TRUNK_TORSION
    if not robot.joints("torso"):
        roll = torsion = 0.0
    posture = draw_rest(robot, standing, setup.distances, chance, roll=roll, torsion=torsion)
    return np.asarray(posture - robot.skeleton.rest)
