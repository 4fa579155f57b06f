"""Eye motion: saccades, and gaze shifts ahead of the head.

A saccade takes 21 ms + 2.2 ms per degree (A. T. Bahill, M. R. Clark and L. Stark, The main sequence, Mathematical
Biosciences 1975).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees, radians

import numpy as np

from kinesic.bml.block import Gaze, HeadDirectionShift, Timeline
from kinesic.body.action_units import (
    MAX_EYE_CONVERGENCE,
    MAX_EYE_DEPRESSION,
    MAX_EYE_ELEVATION,
    MAX_EYE_YAW,
)
from kinesic.body.arrays import Floats
from kinesic.expressivity.behaviours import stays
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.gaze import STRAIGHT_AIM, aim, from_eyes
from kinesic.expressivity.keyframes import BodyMove
from kinesic.expressivity.style.standing import FRONTAL_GAZE, GazeHabit
from kinesic.expressivity.turns import UPRIGHT_TURN, add_turns, departure_time
from kinesic.motion.easing import ease

SACCADE_SPREAD = radians(2.5)  # [rad] standard deviation of lateral saccades around the target; vertical: half
GAZE_LEAD_TIME = 0.3  # [s] advance of a gesture's gaze shift before the gesture's stroke, if the head does not turn
HALF_EYE_DISTANCE = 0.03  # [m] distance from an eye to the midpoint of both
VERGENCE_TIME = 0.16  # [s] duration of a change of vergence
MIN_SACCADE_INTERVAL = 0.5  # [s] shortest time between two spontaneous saccades
CONTACT_TIME = 0.8, 1.6  # [s] shortest and longest glance at the listener between averted gazes
MEAN_SACCADE_INTERVAL = 1.6  # [s] mean time between two spontaneous saccades


@dataclass(frozen=True)
class GazeDirection:
    """Gaze direction in the world, with the time span of the gaze."""

    start: float  # [s]
    left: float  # [rad] direction in the world, + left
    up: float  # [rad] direction in the world, + up
    end: float = np.inf  # [s] end of the gaze
    away: float = np.inf  # [m] distance of the target from the eyes

    @property
    def angle(self) -> float:
        """Angle between the gaze and straight ahead [rad]."""
        return float(np.hypot(self.left, self.up))

    @property
    def inward(self) -> float:
        """Vergence angle of each eye at the gaze target [rad]."""
        return float(np.arctan(HALF_EYE_DISTANCE / self.away))


STRAIGHT_AHEAD = GazeDirection(-np.inf, 0.0, 0.0)  # gaze straight ahead in the world, without a target


@dataclass(frozen=True)
class Habits:
    """Switches and random seed of blinks and spontaneous saccades."""

    seed: int = 0  # seed of the random generator; the same seed gives the same motion
    blinks: bool = True  # whether the eyes blink at random
    saccades: bool = True  # whether the eyes make spontaneous saccades


@dataclass(frozen=True, eq=False)
class Eyes:
    """Input of the eye motion: habits, gaze directions and head angles."""

    habits: Habits | None = None  # None: no spontaneous motion
    looks: Sequence[GazeDirection] = ()  # gaze directions
    head: Floats | None = None  # (m, 2) [rad] left and up, direction of the head in the world; None: straight ahead
    gaze: GazeHabit = FRONTAL_GAZE  # gaze while no behaviour sets the gaze


def block_gazes(timeline: Timeline, context: BlockContext) -> tuple[GazeDirection, ...]:
    """Return the gaze directions of a block in time order.

    A direction that stays lasts until the next gaze.

    Args:
        timeline: behaviours with times.
        context: of their block; the eyes of a robot without a neck look straight ahead.
    """
    if not context.robot.joints("neck"):
        return ()
    directions: list[GazeDirection] = []
    base = STRAIGHT_AIM
    for timed in sorted(timeline.timed, key=lambda timed_behaviour: timed_behaviour.times["start"]):
        action = timed.behaviour.action
        if not isinstance(action, Gaze | HeadDirectionShift):
            continue
        aimed = aim(action, context, base)
        if aimed is not None:
            base = aimed if stays(action) else base
            end = np.inf if stays(action) else timed.times["relax"]
            rotation = add_turns(aimed.head, aimed.eyes)
            place = context.find_target(action.target) if action.target else None
            away = np.inf if place is None else float(np.linalg.norm(from_eyes(place, context.robot)))
            directions.append(GazeDirection(timed.times["start"], rotation.torsion, -rotation.tilt, end, away))
    return tuple(directions)


def gesture_gazes(timeline: Timeline, bodies: Mapping[str, BodyMove]) -> tuple[GazeDirection, ...]:
    """Return the gaze directions that accompany gestures.

    The eyes leave with the head, or a little before the stroke begins.

    Args:
        timeline: behaviours with times.
        bodies: id of a gesture -> accompanying body motion.
    """
    result = []
    for timed in timeline.timed:
        move, times = bodies.get(timed.behaviour.id), timed.times
        if move is not None and move.eyes is not None:
            late = times["strokeStart"] - (GAZE_LEAD_TIME if move.head == UPRIGHT_TURN else np.inf)
            start = departure_time(max(times["start"], late), times["strokeStart"], GAZE_LEAD_TIME)
            result.append(GazeDirection(start, move.eyes.torsion, -move.eyes.tilt, times["relax"]))
    return tuple(result)


def averted_gazes(times: Floats, habit: GazeHabit, seed: int) -> list[GazeDirection]:
    """Return gazes away from the listener, interrupted by glances at the listener.

    Args:
        times: (m,) [s] of the block.
        habit: angles and fraction of the averted gaze.
        seed: of the random generator.
    """
    if habit.averted <= 0.0 or not len(times):
        return []
    generator, directions = np.random.default_rng((seed, 3)), list[GazeDirection]()
    start, side = float(times[0]) - CONTACT_TIME[1], 1.0 if generator.uniform() < 0.5 else -1.0
    while start < times[-1]:
        contact = float(generator.uniform(*CONTACT_TIME))
        away = np.inf if habit.averted >= 1.0 else contact * habit.averted / (1.0 - habit.averted)
        directions.append(GazeDirection(start, side * habit.aside, -habit.down, start + away))
        start, side = start + away + contact, side if generator.uniform() < 0.5 else -side
    return directions


def direction_angles(directions: Floats) -> Floats:
    """Convert world directions (m, 3) to angles (m, 2) [rad].

    The angles are left and up.
    """
    x, y, z = directions.T
    return np.stack([np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))], axis=1)


def saccade_offsets(span: tuple[float, float], times: Floats, seed: int) -> Floats:
    """Return random saccade offsets (m, 2) [rad] around the gaze target.

    Args:
        span: begin and end of the saccades [s].
        times: (m,) [s].
        seed: of the random generator.

    Returns:
        (m, 2) [rad] left and up.
    """
    generator = np.random.default_rng((seed, 2))
    offsets = np.zeros((len(times), 2))
    time, place = span[0], np.zeros(2)
    while time < span[1]:
        time += MIN_SACCADE_INTERVAL + float(generator.exponential(MEAN_SACCADE_INTERVAL - MIN_SACCADE_INTERVAL))
        away = (
            generator.normal(0.0, SACCADE_SPREAD, 2) * (1.0, 0.5) * (generator.uniform() < 0.6)
        )  # otherwise back to the target
        step = np.clip(away, -2 * SACCADE_SPREAD, 2 * SACCADE_SPREAD) - place
        offsets += step * _saccade(times, time, float(np.hypot(*step)))[:, None]
        place = place + step
    return offsets


def eye_angles(looks: Sequence[GazeDirection], times: Floats, head: Floats) -> Floats:
    """Return eye angles (m, 2) [rad] that fixate the gaze target.

    The eyes arrive before the head.

    Args:
        looks: gaze directions in order; a later one overrides an earlier one.
        times: (m,) [s].
        head: (m, 2) head angles left and up in the world at these times [rad].

    Returns:
        (m, 2) [rad] left and up.
    """
    angles = np.zeros((len(times), 2))
    for look in looks:
        progress = _saccade(times, look.start, look.angle) - _saccade(times, look.end, look.angle)
        target = np.array([look.left, look.up]) - head
        angles += progress[:, None] * (target - angles)
    return angles


def vergence_units(looks: Sequence[GazeDirection], times: Floats) -> Mapping[str, Floats]:
    """Return the vergence of both eyes as an action unit.

    Args:
        looks: gaze directions in order; a later one overrides an earlier one.
        times: (m,) [s].

    Returns:
        Key of Command.face -> (m,) 0..1.
    """
    angle = np.zeros(len(times))
    for look in looks:
        arrived, departed = (
            np.zeros(len(times)) if time == np.inf else ease("minimum_jerk", (times - time) / VERGENCE_TIME)
            for time in (look.start, look.end)
        )
        angle += (arrived - departed) * (look.inward - angle)
    return {"66": np.clip(angle / MAX_EYE_CONVERGENCE, 0.0, 1.0)}


def gaze_units(angles: Floats) -> Mapping[str, Floats]:
    """Convert eye angles to the gaze action units 61 to 64.

    Args:
        angles: (m, 2) [rad] left and up in the head; clipped to the range of the eyes.

    Returns:
        Key of Command.face -> (m,) 0..1.
    """
    left, up = angles.T
    wide_shifts = {
        "61": left / MAX_EYE_YAW,
        "62": -left / MAX_EYE_YAW,
        "63": up / MAX_EYE_ELEVATION,
        "64": -up / MAX_EYE_DEPRESSION,
    }
    return {channel: np.clip(values, 0.0, 1.0) for channel, values in wide_shifts.items()}


def _saccade(times: Floats, start: float, angle: float) -> Floats:
    """Return the progress (m,) of a saccade, from 0 to 1.

    It is 0 for a saccade that never starts.
    """
    if start == np.inf:
        return np.zeros(len(times))
    return ease("minimum_jerk", (times - start) / (0.021 + 0.0022 * degrees(angle)))
