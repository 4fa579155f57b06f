"""Natural durations: how long each phase of each behaviour takes when the document does not say."""

from collections.abc import Mapping

from kinesic.bml.block import (
    Behaviour,
    Block,
    Gaze,
    Gesture,
    Head,
    HeadDirectionShift,
    Pointing,
    Posture,
    Torso,
)
from kinesic.body.arrays import Floats
from kinesic.body.robot import Side
from kinesic.expressivity.gaze import aim, look_time
from kinesic.expressivity.hands import REST, Poses, distance, pointing_poses, poses, resting
from kinesic.expressivity.head import head_form
from kinesic.expressivity.lexicon import Lexicon
from kinesic.expressivity.pace import FLOOR, Pace
from kinesic.expressivity.phases import paths
from kinesic.expressivity.places import NO_TARGETS, find_target
from kinesic.expressivity.style import Style
from kinesic.expressivity.torso import lean, pose

LEAST_SWING = 0.17  # [s] of the head, one way
LEAST_LEAN = 0.3  # [s]
LOOK = 1.0  # [s] that a gaze or a head direction is held
POSTURE = 2.0  # [s] that a posture or a lean is held


def spans(
    block: Block, *, style: Style, lexicon: Lexicon, pace: Pace, targets: Mapping[str, Floats] = NO_TARGETS
) -> Mapping[str, Mapping[str, float]]:
    """Natural seconds after the previous sync point of its type, for the behaviours that move head, torso or hands.

    Ways of the hands take Fitts' time, no less than servos do at ease; a post-stroke hold takes half the stroke
    (Greta's rule). Temporal extent divides all of them, but no way is shorter than the servos need. Sync points that
    a mapping leaves out take no time.

    Args:
        block: whose behaviours are asked.
        style: of the performance; a behaviour's own manner goes over it.
        lexicon: of gestures.
        pace: of the robot that moves.
        targets: (3,) [m] in the world, over those of the robot.

    Returns:
        Behaviour id -> sync point -> [s].
    """
    places = {**pace.robot.targets, **targets}
    found = {
        behaviour.id: _spans(behaviour, block, style.under(behaviour.manner), lexicon, pace, places)
        for behaviour in block.behaviours
    }
    return {id: natural for id, natural in found.items() if natural}


def stroke_spans(work: Poses, pace: Pace, temporal: float, *, held: bool = True) -> dict[str, float]:
    """Phases of a gesture from rest to rest [s].

    Args:
        work: the stroke keys of the gesture.
        pace: of the robot that moves.
        temporal: extent, -1 slow .. 1 fast.
        held: whether a post-stroke hold follows.
    """
    ways = [pace.hand_time(way, temporal) for way in paths(work, resting(pace.robot))]
    first, second = sum(ways[: work.stroke], 0.0), sum(ways[work.stroke :], 0.0)
    return {
        "ready": _way(work, 0, pace, temporal),
        "strokeStart": 0.0,
        "stroke": first,
        "strokeEnd": second,
        "relax": 0.5 * (first + second) if held else 0.0,
        "end": _way(work, -1, pace, temporal),
    }


def _way(work: Poses, key: int, pace: Pace, temporal: float) -> float:
    """Between rest and one key, of the hand that goes farther [s]."""
    rest = resting(pace.robot)
    farthest = max(distance(REST, row[key], rest[side]) for side, row in work.hands.items())
    return max(FLOOR, pace.hand_time(farthest, temporal))


def _spans(
    behaviour: Behaviour, block: Block, style: Style, lexicon: Lexicon, pace: Pace, places: Mapping[str, Floats]
) -> Mapping[str, float]:
    """Natural seconds of one behaviour; empty when it moves nothing."""
    robot = pace.robot
    match behaviour.action:
        case Gesture(lexeme, mode):
            match = lexicon.find(lexeme, mode)
            if match is None or not match.form.keys:
                return {}
            work = poses(match.form, robot, style)
            return stroke_spans(work, pace, style.temporal, held=not match.form.rest)
        case Pointing(target):
            place = find_target(target, places)
            if place is None:
                return {}
            side: Side = "l" if place[1] > 0 else "r"
            return stroke_spans(pointing_poses(place, side, robot), pace, style.temporal)
        case Head() as head:
            return _head_spans(head, pace, style)
        case Gaze() | HeadDirectionShift() as look:
            aimed = aim(look, block=block, robot=robot, targets=places) if robot.joints("neck") else None
            return {} if aimed is None else _look_spans(look, look_time(aimed, pace, style.temporal))
        case Torso() as torso:
            leaned = lean(torso, robot, style.spatial)
            return _held_spans(pace.turn_time("torso", leaned.turn, style.temporal)) if leaned else {}
        case Posture() as posture:
            return _posture_spans(posture, lexicon, pace, style)
    return {}


def _look_spans(look: Gaze | HeadDirectionShift, way: float) -> dict[str, float]:
    if isinstance(look, Gaze):
        return {"end": way} if look.shift else {"ready": way, "relax": LOOK, "end": way}
    return {"ready": way, "relax": 0.0, "end": 0.0}


def _head_spans(head: Head, pace: Pace, style: Style) -> dict[str, float]:
    form = head_form(head, pace.robot, style.spatial)
    swing = max(LEAST_SWING, pace.turn_time("neck", form.peak, style.temporal))
    if form.kind == "direction":
        return {"ready": 0.85 * swing, "stroke": 0.15 * swing, "relax": LOOK, "end": swing}
    strokes = {f"stroke:{k}": 2 * swing for k in range(2, form.repetition + 1)}
    return {"stroke": swing, **strokes, "strokeEnd": swing if form.kind == "nod" else 3 * swing}


def _posture_spans(posture: Posture, lexicon: Lexicon, pace: Pace, style: Style) -> dict[str, float]:
    posed = pose(posture, lexicon, pace.robot)
    if posed is None:
        return {}
    works = [poses(form, pace.robot, style) for form in posed.arms if not isinstance(form, str)]
    ways = [_way(work, -1, pace, style.temporal) for work in works]
    way = max([pace.turn_time("torso", posed.lean.turn, style.temporal), *ways])
    return {"end": max(LEAST_LEAN, way)} if posture.shift else _held_spans(way)


def _held_spans(way: float) -> dict[str, float]:
    return {"ready": max(LEAST_LEAN, way), "relax": POSTURE, "end": max(LEAST_LEAN, way)}
