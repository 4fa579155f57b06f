"""What eyes do by themselves and for a gaze: they blink, flit about, and look at something before the head does.

Blinks come by chance, 4 s apart on average (A. R. Bentivoglio et al., Analysis of blink rate patterns in normal
subjects, Movement Disorders 1997, has 17 in a minute at rest), with wide turns of the gaze, and when somebody begins to
speak (W. S. Condon and W. D. Ogston, A segmentation of behavior, J. Psychiatric Research 1967). A saccade takes
21 ms + 2.2 ms per degree (A. T. Bahill, M. R. Clark and L. Stark, The main sequence, Mathematical Biosciences 1975).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees, radians

import numpy as np

from kinesic.bml.block import Gaze, HeadDirectionShift, Timeline
from kinesic.body.action_units import ASIDE, DOWNWARD, INWARD, UPWARD, channels
from kinesic.body.arrays import Floats
from kinesic.expressivity.behaviours import stays
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.gaze import STRAIGHT, aim, from_eyes
from kinesic.expressivity.keyframes import BodyMove
from kinesic.expressivity.turns import UPRIGHT, add_turns, departure_time
from kinesic.motion.easing import ease

CLOSING, SHUT, OPENING = 0.06, 0.02, 0.10  # [s] of a blink
LEAST_GAP, MEAN_GAP = 1.2, 4.0  # [s] between blinks
WIDE_TURN = radians(20)  # of the gaze, that brings a blink with it
FLITTING = radians(2.5)  # spread of saccades about what is looked at
EARLY = 0.3  # [s] that eyes leave before a stroke for what it shows, where the head does not turn with them
HALF_APART = 0.03  # [m] of the eyes from the middle between them
VERGENCE = 0.16  # [s] that eyes take to meet nearer or farther away
LEAST_REST, MEAN_REST = 0.5, 1.6  # [s] that eyes rest between them


@dataclass(frozen=True)
class GazeDirection:
    """A direction that the gaze takes for a while, or for good."""

    start: float  # [s]
    left: float  # [rad] in the world, + left
    up: float  # [rad] + up
    end: float = np.inf  # [s] when the eyes leave it
    away: float = np.inf  # [m] how far from the eyes what is looked at is

    @property
    def angle(self) -> float:
        """[rad] off straight ahead."""
        return float(np.hypot(self.left, self.up))

    @property
    def inward(self) -> float:
        """[rad] that each eye turns towards the other, to meet it at what is looked at."""
        return float(np.arctan(HALF_APART / self.away))


STRAIGHT_AHEAD = GazeDirection(
    -np.inf, 0.0, 0.0
)  # where eyes are, whatever the head does, when nothing else is looked at


@dataclass(frozen=True)
class Habits:
    """What the eyes do when nothing is asked."""

    seed: int = 0  # of what is left to chance; the same seed gives the same motion
    blinks: bool = True
    saccades: bool = True


@dataclass(frozen=True, eq=False)
class Eyes:
    """What moves the eyes: habit, the gaze, and the head that carries them."""

    habits: Habits | None = None  # None: they do nothing unasked
    looks: Sequence[GazeDirection] = ()  # directions of the gaze
    head: Floats | None = None  # (m, 2) [rad] left and up, where the head points in the world; None: straight ahead


def looks(timeline: Timeline, context: BlockContext) -> tuple[GazeDirection, ...]:
    """Lists the gazes of a block in order; a direction that stays lasts until the next look.

    Args:
        timeline: behaviours with times.
        context: of their block; the eyes of a robot without a neck look straight ahead.
    """
    if not context.robot.joints("neck"):
        return ()
    found: list[GazeDirection] = []
    base = STRAIGHT
    for timed in sorted(timeline.timed, key=lambda each: each.times["start"]):
        action = timed.behaviour.action
        if not isinstance(action, Gaze | HeadDirectionShift):
            continue
        aimed = aim(action, context, base)
        if aimed is not None:
            base = aimed if stays(action) else base
            end = np.inf if stays(action) else timed.times["relax"]
            there = add_turns(aimed.head, aimed.eyes)
            place = context.find_target(action.target) if action.target else None
            away = np.inf if place is None else float(np.linalg.norm(from_eyes(place, context.robot)))
            found.append(GazeDirection(timed.times["start"], there.torsion, -there.tilt, end, away))
    return tuple(found)


def gesture_looks(timeline: Timeline, bodies: Mapping[str, BodyMove]) -> tuple[GazeDirection, ...]:
    """Lists where eyes look with gestures: they leave as the head does, else a little before the stroke begins.

    Args:
        timeline: behaviours with times.
        bodies: id of a gesture -> what the body does beside it.
    """
    found = []
    for timed in timeline.timed:
        move, times = bodies.get(timed.behaviour.id), timed.times
        if move is not None and move.eyes is not None:
            late = times["strokeStart"] - (EARLY if move.head == UPRIGHT else np.inf)
            start = departure_time(max(times["start"], late), times["strokeStart"], EARLY)
            found.append(GazeDirection(start, move.eyes.torsion, -move.eyes.tilt, times["relax"]))
    return tuple(found)


def headings(directions: Floats) -> Floats:
    """Converts (m, 3) directions in the world to (m, 2) [rad] left and up."""
    x, y, z = directions.T
    return np.stack([np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))], axis=1)


def blink_times(
    span: tuple[float, float], looks: Sequence[GazeDirection], seed: int, *, also: Sequence[float] = ()
) -> tuple[float, ...]:
    """Chooses when blinks begin [s], in order, at least `LEAST_GAP` apart; wide turns of the gaze come first.

    Args:
        span: [s] from and to; a longer one has the same blinks and more.
        looks: of the gaze.
        seed: of the chance.
        also: [s] other moments that bring a blink.
    """
    chance = np.random.default_rng((seed, 1))
    turns = [moment for look in looks if look.angle > WIDE_TURN for moment in (look.start, look.end)] + [*also]
    found: list[float] = []
    for moment in sorted(turns):
        if span[0] <= moment < span[1] and (not found or moment - found[-1] >= LEAST_GAP):
            found.append(moment)
    wanted = np.array(found)
    now = span[0] + float(chance.exponential(MEAN_GAP - LEAST_GAP))
    while now < span[1]:
        if not np.any(np.abs(wanted - now) < LEAST_GAP):
            found.append(now)
        now += LEAST_GAP + float(chance.exponential(MEAN_GAP - LEAST_GAP))
    return tuple(sorted(found))


def blinking(begins: Sequence[float], times: Floats) -> Mapping[str, Floats]:
    """Shows blinks as action units: key of Command.face -> (m,) 0..1 at (m,) times [s]."""
    closed = np.zeros(len(times))
    for begin in begins:
        since = times - begin
        shut = ease("minimum_jerk", since / CLOSING)
        open_again = ease("minimum_jerk", (since - CLOSING - SHUT) / OPENING)
        np.maximum(closed, shut - open_again, out=closed)
    return dict.fromkeys(channels(45), closed)


def flitting(span: tuple[float, float], times: Floats, seed: int) -> Floats:
    """Makes small saccades about what eyes look at: (m, 2) [rad] left and up.

    Args:
        span: [s] in which they do.
        times: (m,) [s].
        seed: of the chance.
    """
    chance = np.random.default_rng((seed, 2))
    found = np.zeros((len(times), 2))
    now, place = span[0], np.zeros(2)
    while now < span[1]:
        now += LEAST_REST + float(chance.exponential(MEAN_REST - LEAST_REST))
        away = chance.normal(0.0, FLITTING, 2) * (1.0, 0.5) * (chance.uniform() < 0.6)  # as often as not back again
        step = np.clip(away, -2 * FLITTING, 2 * FLITTING) - place
        found += step * _saccade(times, now, float(np.hypot(*step)))[:, None]
        place = place + step
    return found


def looking(looks: Sequence[GazeDirection], times: Floats, head: Floats) -> Floats:
    """Computes eye angles in the head that lead it to a gaze and hold the target: (m, 2) [rad] left and up.

    Args:
        looks: of the gaze, in order; a later one takes the place of an earlier one.
        times: (m,) [s].
        head: (m, 2) [rad] left and up in the world, where the head points at these times.
    """
    found = np.zeros((len(times), 2))
    for look in looks:
        there = _saccade(times, look.start, look.angle) - _saccade(times, look.end, look.angle)
        wanted = np.array([look.left, look.up]) - head
        found += there[:, None] * (wanted - found)
    return found


def meeting(looks: Sequence[GazeDirection], times: Floats) -> Mapping[str, Floats]:
    """Turns both eyes towards what is near: key of Command.face -> (m,) 0..1 at (m,) times [s].

    Args:
        looks: of the gaze, in order; a later one takes the place of an earlier one.
        times: (m,) [s].
    """
    found = np.zeros(len(times))
    for look in looks:
        begun, left = (
            np.zeros(len(times)) if moment == np.inf else ease("minimum_jerk", (times - moment) / VERGENCE)
            for moment in (look.start, look.end)
        )
        found += (begun - left) * (look.inward - found)
    return {"66": np.clip(found / INWARD, 0.0, 1.0)}


def gaze_units(angles: Floats) -> Mapping[str, Floats]:
    """Converts angles of the eyes to action units.

    Args:
        angles: (m, 2) [rad] left and up in the head; cut to what eyes can.

    Returns:
        Key of Command.face -> (m,) 0..1.
    """
    left, up = angles.T
    turns = {"61": left / ASIDE, "62": -left / ASIDE, "63": up / UPWARD, "64": -up / DOWNWARD}
    return {channel: np.clip(values, 0.0, 1.0) for channel, values in turns.items()}


def _saccade(times: Floats, start: float, angle: float) -> Floats:
    """(m,) shares of a saccade by some angle [rad]; of one that never starts 0."""
    if start == np.inf:
        return np.zeros(len(times))
    return ease("minimum_jerk", (times - start) / (0.021 + 0.0022 * degrees(angle)))
