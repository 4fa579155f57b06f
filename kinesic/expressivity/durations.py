"""Natural durations: how long each phase of each behaviour takes when the document does not say."""

from collections.abc import Mapping
from itertools import pairwise
from types import MappingProxyType

from kinesic.bml.block import Behaviour, Face, Gaze, Gesture, Head, HeadDirectionShift, Pointing, Posture, Torso
from kinesic.bml.timing.syllables import find_syllables
from kinesic.body.robot import Side
from kinesic.body.utterance import Utterance
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.gaze import aim, look_time
from kinesic.expressivity.hands.poses import REST, Poses, pointing_poses, pose_distance, poses, resting_hands
from kinesic.expressivity.hands.strokes import natural_times
from kinesic.expressivity.head import head_form, swing_time
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.posture import pose
from kinesic.expressivity.style.effort import Effort
from kinesic.expressivity.style.pace import HASTE, Pace
from kinesic.expressivity.style.style import Expressivity
from kinesic.expressivity.trunk import named_lean

NOTHING_SAID: Mapping[str, Utterance] = MappingProxyType({})
LEAST_LEAN = 0.3  # [s] at ease
GAZE_HOLD = 1.0  # [s] that a gaze or a head direction is held
POSTURE = 2.0  # [s] that a posture or a lean is held
ATTACK, DECAY = 0.3, 0.4  # [s] in which an expression of the face comes and goes
NODDING = 1.1  # times what the neck needs at least, in which a nod comes up again to end with its syllable
FACE_SHIFT = 0.8  # [s] in which one that stays comes


def spans(
    context: BlockContext, utterances: Mapping[str, Utterance] = NOTHING_SAID
) -> Mapping[str, Mapping[str, float]]:
    """Finds the natural time from the previous sync point to each, for the behaviours that move something [s].

    Phases of a gesture take the times of its `Effort`. Temporal extent makes all of them shorter or longer, power the
    strokes, but no way is shorter than the servos need. Sync points that a mapping leaves out take no time.

    Args:
        context: of the block whose behaviours are timed.
        utterances: of its speeches: a nod whose stroke meets a word ends with the accented syllable.

    Returns:
        Behaviour id -> sync point -> [s].
    """
    found = {behaviour.id: _spans(behaviour, context) for behaviour in context.block.behaviours}
    syllables = find_syllables(context.block, utterances)
    for behaviour in context.block.behaviours:
        if isinstance(behaviour.action, Head) and (behaviour.id, "stroke") in syllables:
            left = syllables[behaviour.id, "stroke"]
            found[behaviour.id] = _end_nod(found[behaviour.id], behaviour.action, left, context, behaviour)
    return {id: natural for id, natural in found.items() if natural}


def stroke_spans(work: Poses, effort: Effort, *, holds: bool = True) -> dict[str, float]:
    """Finds how long each phase of a gesture takes, from rest to rest [s].

    How long the hand is held stays temporal extent's, whatever power does to the stroke.

    Args:
        work: the stroke keys of the gesture.
        effort: of the gesture.
        holds: whether a post-stroke hold follows.
    """
    ways = natural_times(work, effort)
    strokes = [0, work.stroke, *work.again]
    first, *more = (sum(ways[before:key], 0.0) for before, key in pairwise(strokes))
    return {
        "ready": effort.preparation_time(_way(work, 0, effort.pace)),
        "strokeStart": 0.0,
        "stroke": first,
        **{f"stroke:{k}": time for k, time in enumerate(more, 2)},
        "strokeEnd": sum(ways[strokes[-1] :], 0.0),
        "relax": effort.hold_time(sum(natural_times(work, effort.plain)) / work.times) if holds else 0.0,
        "end": effort.return_time(_way(work, -1, effort.pace)),
    }


def _way(work: Poses, key: int, pace: Pace) -> float:
    """Way between rest and one key, of the hand that goes farther [m]."""
    rest = resting_hands(pace.robot)
    return max(pose_distance(REST, row[key], rest[side]) for side, row in work.hands.items())


def _spans(behaviour: Behaviour, context: BlockContext) -> Mapping[str, float]:
    """Natural seconds of one behaviour; empty when it moves nothing."""
    robot, pace, manner = context.robot, context.pace, context.manner(behaviour)
    weight = context.styles[behaviour.id].effort
    match behaviour.action:
        case Gesture() as gesture:
            match = context.find_gesture(behaviour, gesture)
            if match is None or not match.form.keys:
                return {}
            work = poses(match.form, robot, manner).with_effort(weight)
            return stroke_spans(work, Effort(pace, work.nature, manner), holds=not match.form.rest)
        case Pointing(target):
            place = context.find_target(target)
            if place is None:
                return {}
            side: Side = "l" if place[1] > 0 else "r"
            pointing = pointing_poses(place, side, robot).with_effort(weight)
            return stroke_spans(pointing, Effort(pace, pointing.nature, manner))
        case Head() as head:
            return _head_spans(head, pace, manner)
        case Gaze() | HeadDirectionShift() as look:
            aimed = aim(look, context) if robot.joints("neck") else None
            return {} if aimed is None else _look_spans(look, look_time(aimed, pace, manner.temporal))
        case Torso() as torso:
            leaned = named_lean(torso, robot, manner.spatial)
            return _lean_spans(leaned.turn, pace, manner) if leaned else {}
        case Face(shift=shift):
            haste = HASTE**manner.temporal
            return {"end": FACE_SHIFT / haste} if shift else {"attackPeak": ATTACK / haste, "end": DECAY / haste}
        case Posture() as posture:
            return _posture_spans(posture, context, manner, context.manner(behaviour, "torso"))
    return {}


def _end_nod(
    natural: Mapping[str, float], head: Head, left: float, context: BlockContext, behaviour: Behaviour
) -> Mapping[str, float]:
    """Lets a single nod come up again by the end of a syllable, so many seconds after its stroke, if the neck can."""
    form = head_form(head, context.robot, context.manner(behaviour))
    if form is None or form.kind != "nod" or len(form.swings) > 2:
        return natural
    return {**natural, "strokeEnd": max(left, NODDING * context.pace.least_turn_time("neck", form.peak))}


def _look_spans(look: Gaze | HeadDirectionShift, way: float) -> dict[str, float]:
    if isinstance(look, Gaze):
        return {"end": way} if look.shift else {"ready": way, "relax": GAZE_HOLD, "end": way}
    return {"ready": way, "relax": 0.0, "end": 0.0}


def _head_spans(head: Head, pace: Pace, manner: Expressivity) -> dict[str, float]:
    form = head_form(head, pace.robot, manner)
    if form is None:
        return {}
    swing = swing_time(form, pace, manner)
    if form.kind == "direction":
        return {"ready": 0.85 * swing, "stroke": 0.15 * swing, "relax": GAZE_HOLD, "end": swing}
    strokes = {f"stroke:{k}": 2 * swing for k in range(2, form.repetition + 1)}
    last = (1 if form.kind == "nod" else 3) + 2 * form.more
    return {"stroke": swing, **strokes, "strokeEnd": last * swing}


def _lean_spans(turn: Turn, pace: Pace, manner: Expressivity) -> dict[str, float]:
    there = pace.turn_time("torso", turn, manner.temporal, manner.power, usual=LEAST_LEAN)
    return {"ready": there, "relax": POSTURE, "end": pace.turn_time("torso", turn, manner.temporal, usual=LEAST_LEAN)}


def _posture_spans(
    posture: Posture, context: BlockContext, manner: Expressivity, trunk: Expressivity
) -> dict[str, float]:
    pace, posed = context.pace, pose(posture, context.lexicon, context.robot)
    if posed is None:
        return {}
    works = [poses(form, pace.robot, manner) for form in posed.arms if not isinstance(form, str)]
    ways = [Effort(pace, work.nature, manner).preparation_time(_way(work, -1, pace)) for work in works]
    turns = [pace.turn_time("torso", posed.lean.turn, trunk.temporal, usual=LEAST_LEAN)]
    turns.append(pace.turn_time("neck", posed.head, trunk.temporal, usual=LEAST_LEAN))
    way = max([*turns, *ways])
    return {"end": way} if posture.shift else {"ready": way, "relax": POSTURE, "end": way}
