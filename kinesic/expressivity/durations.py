"""Natural durations of behaviour phases without times in the document."""

from collections.abc import Mapping
from itertools import pairwise
from types import MappingProxyType

from kinesic.bml.block import Behaviour, Face, Gaze, Gesture, Head, HeadDirectionShift, Pointing, Posture, Torso
from kinesic.bml.timing.syllables import find_syllables
from kinesic.body.robot import Side
from kinesic.body.utterance import Utterance
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.gaze import aim, look_time
from kinesic.expressivity.hands.poses import REST_HAND, Poses, pointing_poses, pose_distance, poses, resting_hands
from kinesic.expressivity.hands.strokes import natural_times
from kinesic.expressivity.head import head_form, swing_time
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.posture import pose
from kinesic.expressivity.style.effort import Effort
from kinesic.expressivity.style.pace import TEMPORAL_FACTOR, Pace
from kinesic.expressivity.style.style import Expressivity
from kinesic.expressivity.trunk import named_lean

NO_UTTERANCES: Mapping[str, Utterance] = MappingProxyType({})  # utterances of a block without speech
MIN_LEAN_TIME = 0.3  # [s] shortest natural duration of a lean
GAZE_HOLD_TIME = 1.0  # [s] natural hold time of a gaze or a head direction
POSTURE_HOLD_TIME = 2.0  # [s] natural hold time of a posture or a lean
FACE_ATTACK_TIME = 0.3  # [s] natural rise time of a facial expression
FACE_DECAY_TIME = 0.4  # [s] natural decay time of a facial expression
NOD_RETURN_MARGIN = 1.1  # shortest return time of a nod on a word / minimum time of the neck
FACE_SHIFT_TIME = 0.8  # [s] natural rise time of a permanent facial expression


def natural_durations(
    context: BlockContext, utterances: Mapping[str, Utterance] = NO_UTTERANCES
) -> Mapping[str, Mapping[str, float]]:
    """Return the natural phase durations of all moving behaviours [s].

    Phases of a gesture take the durations of its `Effort`. Temporal extent makes all of them shorter or longer, power
    the strokes, but no movement is shorter than the servos need. Sync points that a mapping omits take no time.

    Args:
        context: of the block whose behaviours are timed.
        utterances: of its speeches: a nod whose stroke meets a word ends with the accented syllable.

    Returns:
        Behaviour id -> sync point -> duration since the previous sync point [s].
    """
    durations_by_id = {behaviour.id: _behaviour_durations(behaviour, context) for behaviour in context.block.behaviours}
    syllables = find_syllables(context.block, utterances)
    for behaviour in context.block.behaviours:
        if isinstance(behaviour.action, Head) and (behaviour.id, "stroke") in syllables:
            time_left = syllables[behaviour.id, "stroke"]
            durations_by_id[behaviour.id] = _end_nod(
                durations_by_id[behaviour.id], behaviour.action, time_left, context, behaviour
            )
    return {id: natural for id, natural in durations_by_id.items() if natural}


def stroke_durations(work: Poses, effort: Effort, *, holds: bool = True) -> dict[str, float]:
    """Return the natural duration of each phase of a gesture [s].

    The hold depends on temporal extent, but not on power.

    Args:
        work: the stroke keys of the gesture.
        effort: of the gesture.
        holds: whether a post-stroke hold follows.
    """
    durations = natural_times(work, effort)
    strokes = [0, work.stroke, *work.again]
    first, *more = (sum(durations[before:key], 0.0) for before, key in pairwise(strokes))
    return {
        "ready": effort.preparation_time(_rest_distance(work, 0, effort.pace)),
        "strokeStart": 0.0,
        "stroke": first,
        **{f"stroke:{k}": time for k, time in enumerate(more, 2)},
        "strokeEnd": sum(durations[strokes[-1] :], 0.0),
        "relax": effort.hold_time(sum(natural_times(work, effort.plain)) / work.stroke_count) if holds else 0.0,
        "end": effort.return_time(_rest_distance(work, -1, effort.pace)),
    }


def _rest_distance(work: Poses, key: int, pace: Pace) -> float:
    """Return the larger distance [m] of both hands from rest."""
    rest = resting_hands(pace.robot)
    return max(pose_distance(REST_HAND, row[key], rest[side]) for side, row in work.hands.items())


def _behaviour_durations(behaviour: Behaviour, context: BlockContext) -> Mapping[str, float]:
    """Return the natural phase durations of one behaviour [s].

    They are empty for a behaviour without motion.
    """
    robot, pace, manner = context.robot, context.pace, context.manner(behaviour)
    weight = context.styles[behaviour.id].effort
    match behaviour.action:
        case Gesture() as gesture:
            match = context.find_gesture(behaviour, gesture)
            if match is None or not match.form.keys:
                return {}
            work = poses(match.form, robot, manner).with_effort(weight)
            return stroke_durations(work, Effort(pace, work.traits, manner), holds=not match.form.rest)
        case Pointing(target):
            place = context.find_target(target)
            if place is None:
                return {}
            side: Side = "l" if place[1] > 0 else "r"
            pointing = pointing_poses(place, side, robot).with_effort(weight)
            return stroke_durations(pointing, Effort(pace, pointing.traits, manner))
        case Head() as head:
            return _head_durations(head, pace, manner)
        case Gaze() | HeadDirectionShift() as look:
            aimed = aim(look, context) if robot.joints("neck") else None
            return {} if aimed is None else _gaze_durations(look, look_time(aimed, pace, manner.temporal))
        case Torso() as torso:
            lean = named_lean(torso, robot, manner.spatial)
            return _lean_durations(lean.turn, pace, manner) if lean else {}
        case Face(shift=shift):
            velocity_factor = TEMPORAL_FACTOR**manner.temporal
            return (
                {"end": FACE_SHIFT_TIME / velocity_factor}
                if shift
                else {"attackPeak": FACE_ATTACK_TIME / velocity_factor, "end": FACE_DECAY_TIME / velocity_factor}
            )
        case Posture() as posture:
            return _posture_durations(posture, context, manner, context.manner(behaviour, "torso"))
    return {}


def _end_nod(
    natural: Mapping[str, float], head: Head, time_left: float, context: BlockContext, behaviour: Behaviour
) -> Mapping[str, float]:
    """Return the durations [s] of a nod that ends with a syllable.

    Repeated nods and other head movements keep their natural durations.

    Args:
        natural: durations of the nod [s].
        head: the behaviour's action.
        time_left: from the stroke to the end of the syllable [s].
        context: of the block.
        behaviour: of the nod.
    """
    form = head_form(head, context.robot, context.manner(behaviour))
    if form is None or form.kind != "nod" or len(form.swings) > 2:
        return natural
    return {**natural, "strokeEnd": max(time_left, NOD_RETURN_MARGIN * context.pace.least_turn_time("neck", form.peak))}


def _gaze_durations(look: Gaze | HeadDirectionShift, duration: float) -> dict[str, float]:
    if isinstance(look, Gaze):
        return {"end": duration} if look.shift else {"ready": duration, "relax": GAZE_HOLD_TIME, "end": duration}
    return {"ready": duration, "relax": 0.0, "end": 0.0}


def _head_durations(head: Head, pace: Pace, manner: Expressivity) -> dict[str, float]:
    form = head_form(head, pace.robot, manner)
    if form is None:
        return {}
    swing = swing_time(form, pace, manner)
    if form.kind == "direction":
        return {"ready": 0.85 * swing, "stroke": 0.15 * swing, "relax": GAZE_HOLD_TIME, "end": swing}
    strokes = {f"stroke:{k}": 2 * swing for k in range(2, form.repetition + 1)}
    last_swings = (1 if form.kind == "nod" else 3) + 2 * form.added_strokes
    return {"stroke": swing, **strokes, "strokeEnd": last_swings * swing}


def _lean_durations(turn: Turn, pace: Pace, manner: Expressivity) -> dict[str, float]:
    duration = pace.turn_time("torso", turn, manner.temporal, manner.power, usual=MIN_LEAN_TIME)
    return {
        "ready": duration,
        "relax": POSTURE_HOLD_TIME,
        "end": pace.turn_time("torso", turn, manner.temporal, usual=MIN_LEAN_TIME),
    }


def _posture_durations(
    posture: Posture, context: BlockContext, manner: Expressivity, trunk: Expressivity
) -> dict[str, float]:
    pace, posed = context.pace, pose(posture, context.lexicon, context.robot)
    if posed is None:
        return {}
    arm_poses = [poses(form, pace.robot, manner) for form in posed.arms if not isinstance(form, str)]
    durations = [
        Effort(pace, work.traits, manner).preparation_time(_rest_distance(work, -1, pace)) for work in arm_poses
    ]
    turns = [pace.turn_time("torso", posed.lean.turn, trunk.temporal, usual=MIN_LEAN_TIME)]
    turns.append(pace.turn_time("neck", posed.head, trunk.temporal, usual=MIN_LEAN_TIME))
    duration = max([*turns, *durations])
    return {"end": duration} if posture.shift else {"ready": duration, "relax": POSTURE_HOLD_TIME, "end": duration}
