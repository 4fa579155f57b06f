"""Conversion of a timed block to upper-body key frames."""

from collections.abc import Mapping
from dataclasses import replace
from math import inf
from types import MappingProxyType

from kinesic.bml.block import (
    Activate,
    Block,
    Custom,
    Face,
    Gaze,
    Gesture,
    Head,
    HeadDirectionShift,
    Interrupt,
    Notice,
    NoticeType,
    ParameterChange,
    Pointing,
    Posture,
    Speech,
    TimedBehaviour,
    Timeline,
    Torso,
    Wait,
    document_error,
)
from kinesic.bml.timing.constraints import find_constrained_points
from kinesic.bml.timing.words import find_tied_words
from kinesic.body.robot import PartName
from kinesic.expressivity.axis_spans import axes_used
from kinesic.expressivity.behaviours import (
    BehaviourWarning,
    Move,
    drop_behaviour,
    gesture_move,
    head_move,
    pointing_move,
    stays,
    torso_move,
    without_upright,
)
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.face.tracks import face_outcome
from kinesic.expressivity.gather import HAND_PARTS, PART_PRIORITIES, Sequences, SyncPoint, gather_frames
from kinesic.expressivity.hands.busy_hands import Clashes
from kinesic.expressivity.hands.coarticulation import NO_CLASHES
from kinesic.expressivity.hands.fingers import finger_keys
from kinesic.expressivity.hands.phases import HandArrangement, arrange_hands
from kinesic.expressivity.hands.succession import find_successions
from kinesic.expressivity.idle import add_idle_motion
from kinesic.expressivity.keyframes import HeldTurns, KeyFrames, Outcome
from kinesic.expressivity.looks import look_moves
from kinesic.expressivity.posture import posture_moves
from kinesic.expressivity.trunk import turn_trunk_along
from kinesic.expressivity.turns import add_turns
from kinesic.expressivity.whole_body import AccompaniedGesture, BodyDemands, WholeBody, accompany_gestures

NONE_DROPPED: Mapping[str, str] = MappingProxyType({})  # default: no dropped behaviours (id -> reason), empty


def make_keyframes(
    timeline: Timeline,
    context: BlockContext,
    *,
    without: Mapping[str, str] = NONE_DROPPED,
    clashes: Clashes = NO_CLASHES,
) -> KeyFrames:
    """Create the key frames and outcomes of a block.

    Args:
        timeline: behaviours with times.
        context: of their block.
        without: ids of behaviours to drop, with the reason.
        clashes: behaviours with strokes that one hand cannot both perform, though they do not overlap.

    Raises:
        BmlError: a behaviour inside `required` cannot be performed.
    """
    moves = _moves([timed for timed in timeline.timed if timed.behaviour.id not in without], context)
    moves |= {id: drop_behaviour(why) for id, why in without.items()}
    spoken = {behaviour for behaviour, sync in find_tied_words(timeline) if sync.partition(":")[0] == "stroke"}
    strokes = [replace(stroke, spoken=stroke.id in spoken) for move in moves.values() for stroke in move.strokes]
    fixed_syncs = find_constrained_points(timeline.block)
    hands = arrange_hands(strokes, context.pace, fixed_syncs, busy_hands=context.busy_hands, clashes=clashes)
    moves = {id: _apply_hands(id, move, hands) for id, move in moves.items()}
    outcomes = {drop.behaviour.id: Outcome("dropped", drop.reason) for drop in timeline.dropped}
    outcomes |= {id: move.outcome for id, move in moves.items()}
    _check_required(timeline.block, outcomes)
    uses = {id: _uses(id, move, hands) for id, move in moves.items()}
    stroke_counts = {work.id: work.poses.stroke_count for work in hands.works} | _upright_stroke_counts(moves)
    timeline = replace(
        timeline, timed=tuple(_actual_syncs(timed, hands.times, stroke_counts) for timed in timeline.timed)
    )
    syncs = [
        SyncPoint(time, timed.behaviour.id, sync)
        for timed in timeline.timed
        if uses[timed.behaviour.id]
        for sync, time in timed.times.items()
    ]
    notices = [
        Notice(warning.type, f"{timeline.block.id}:{id}", warning.text)
        for id, move in moves.items()
        for warning in move.warnings
    ]
    body = _whole_body(timeline, context, moves, hands)
    sequences = _sequences(timeline, context, moves, hands, body)
    shapes = {id: move.shapes for id, move in moves.items() if move.shapes}
    fingers = finger_keys(sequences.hands, hands.works, context.pace)
    frames = gather_frames(sequences, syncs, context.robot, PART_PRIORITIES[context.shared.gathering])
    successions = find_successions(hands.works, context)
    notices = [*timeline.notices, *notices]
    held = _held_turns(timeline, moves)
    return KeyFrames(timeline, frames, outcomes, uses, tuple(notices), body.moves, fingers, shapes, successions, held)


def _held_turns(timeline: Timeline, moves: Mapping[str, Move]) -> dict[str, HeldTurns]:
    """Return the rotations that remain after permanent gazes and postures, by id."""
    totals: dict[str, HeldTurns] = {"look": HeldTurns("look"), "posture": HeldTurns("posture")}
    held: dict[str, HeldTurns] = {}
    for timed in sorted(timeline.timed, key=lambda timed: timed.times["start"]):
        id, move = timed.behaviour.id, moves[timed.behaviour.id]
        if stays(timed.behaviour.action) and move.outcome.kind != "dropped":
            kind = "posture" if isinstance(timed.behaviour.action, Posture) else "look"
            before = totals[kind]  # the layers of one kind are relative to one another
            torso, head = before.torso, before.head
            for layer in move.torso:
                torso = add_turns(torso, layer[-1].turn)
            for layer in move.head:
                head = add_turns(head, layer[-1].turn)
            totals[kind] = held[id] = replace(before, torso=torso, head=head)
    return held


def _whole_body(
    timeline: Timeline, context: BlockContext, moves: Mapping[str, Move], hands: HandArrangement
) -> WholeBody:
    """Add body motion to gestures unless another behaviour needs the body."""
    behaviours = {timed.behaviour.id: timed.behaviour for timed in timeline.timed}
    gestures = [
        AccompaniedGesture(work, context.manner(behaviour, "head"), context.manner(behaviour, "torso"))
        for work in hands.works
        if isinstance((behaviour := behaviours[work.id]).action, Gesture | Pointing)
    ]
    performed = [timed for timed in timeline.timed if moves[timed.behaviour.id].outcome.kind != "dropped"]
    demands = BodyDemands(
        head=axes_used(layer for move in moves.values() for layer in move.head),
        torso=axes_used(layer for move in moves.values() for layer in move.torso),
        eyes=[_span(timed) for timed in performed if isinstance(timed.behaviour.action, Gaze | HeadDirectionShift)],
        face=[_span(timed) for timed in performed if isinstance(timed.behaviour.action, Face)],
    )
    return accompany_gestures(gestures, demands, context.pace)


def _span(timed: TimedBehaviour) -> tuple[float, float]:
    return min(timed.times.values()), max(timed.times.values())


def _sequences(
    timeline: Timeline, context: BlockContext, moves: Mapping[str, Move], hands: HandArrangement, body: WholeBody
) -> Sequences:
    """Collect all motion of a block as key sequences per body part."""
    trunk = [
        turn_trunk_along(work, context.manner(timed.behaviour, "torso"), context.pace)
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Gesture)
        for work in hands.works
        if work.id == timed.behaviour.id
    ]
    sequences = Sequences(
        torso=(*(layer for move in moves.values() for layer in move.torso), *filter(None, (*trunk, body.torso))),
        head=(*(layer for move in moves.values() for layer in move.head), *filter(None, (body.head,))),
        hands=hands.hands,
    )
    return add_idle_motion(sequences, (timeline.start, timeline.end), context.shared.idling, context.robot)


def _upright_stroke_counts(moves: Mapping[str, Move]) -> dict[str, int]:
    """Return a stroke count of 1 for head behaviours without motion."""
    return {id: 1 for id, move in moves.items() if move.head and not any(map(without_upright, move.head))}


def _actual_syncs(
    timed: TimedBehaviour, moved: Mapping[str, Mapping[str, float]], stroke_counts: Mapping[str, int]
) -> TimedBehaviour:
    """Apply moved sync times, and remove sync points of dropped repetitions."""
    id, action = timed.behaviour.id, timed.behaviour.action
    times = {**timed.times, **moved.get(id, {})}
    stroke_count = stroke_counts.get(id, 1 if isinstance(action, Gesture) else inf)
    strokes = [sync for sync in times if isinstance(action, Gesture | Head) and sync.startswith("stroke:")]
    dropped_syncs = {sync for sync in strokes if int(sync.partition(":")[2]) > stroke_count}
    return replace(timed, times={sync: time for sync, time in times.items() if sync not in dropped_syncs})


def _moves(timed: list[TimedBehaviour], context: BlockContext) -> dict[str, Move]:
    looks = [
        timed_behaviour
        for timed_behaviour in timed
        if isinstance(timed_behaviour.behaviour.action, Gaze | HeadDirectionShift)
    ]
    postures = [timed_behaviour for timed_behaviour in timed if isinstance(timed_behaviour.behaviour.action, Posture)]
    joint_moves = {**look_moves(looks, context), **posture_moves(postures, context)}
    return {
        timed_behaviour.behaviour.id: joint_moves.get(timed_behaviour.behaviour.id) or _move(timed_behaviour, context)
        for timed_behaviour in timed
    }


def _move(timed: TimedBehaviour, context: BlockContext) -> Move:
    match timed.behaviour.action:
        case Gesture() as action:
            return gesture_move(timed, action, context)
        case Pointing() as action:
            return pointing_move(timed, action, context)
        case Head() as action:
            return head_move(timed, action, context)
        case Torso() as action:
            return torso_move(timed, action, context)
        case Face() as action:
            return _face_move(action)
        case Speech() | Wait() | Interrupt() | Activate() | ParameterChange():
            return Move()
        case Custom(name):
            return drop_behaviour(f"custom behaviour {name} is unknown", NoticeType.CUSTOM_BEHAVIOUR_NOT_SUPPORTED)
    why = f"no part of robot {context.robot.name} performs {timed.behaviour.type}"
    return drop_behaviour(why, NoticeType.BEHAVIOR_TYPE_NOT_SUPPORTED)


def _face_move(action: Face) -> Move:
    """Return the outcome of a face behaviour, which moves no joint.

    `face.tracks` computes its action units.
    """
    face_result = face_outcome(action)
    if face_result.kind == "dropped":
        return drop_behaviour(face_result.why)
    dropped_syncs = "" if 0.0 <= action.amount <= 1.0 else f"amount {action.amount:g} is cut to the range from 0 to 1"
    texts = filter(None, (face_result.why, dropped_syncs))
    return Move(
        face_result, warnings=tuple(BehaviourWarning(NoticeType.CANNOT_CREATE_BEHAVIOR, text) for text in texts)
    )


def _apply_hands(id: str, move: Move, hands: HandArrangement) -> Move:
    """Add outcome and warnings of the hand assignment to a behaviour's motion."""
    remarks = (BehaviourWarning(NoticeType.IMPOSSIBLE_TO_SCHEDULE, text) for text in hands.remarks.get(id, ()))
    move, outcome = replace(move, warnings=(*move.warnings, *remarks)), hands.outcomes.get(id)
    if outcome is None:
        return move
    if outcome.kind == "dropped":
        return drop_behaviour(outcome.why, NoticeType.IMPOSSIBLE_TO_SCHEDULE)
    why = "; ".join(filter(None, [move.outcome.why, outcome.why]))
    warning = BehaviourWarning(NoticeType.CANNOT_CREATE_BEHAVIOR, outcome.why)  # in time, but in another form
    return replace(move, outcome=Outcome("substituted", why), warnings=(*move.warnings, warning))


def _uses(id: str, move: Move, hands: HandArrangement) -> frozenset[PartName]:
    parts: set[PartName] = {HAND_PARTS[side] for side in hands.sides.get(id, ())}
    if move.torso:
        parts.add("torso")
    if move.head:
        parts.add("head")
    return frozenset(parts)


def _check_required(block: Block, outcomes: Mapping[str, Outcome]) -> None:
    """Reject the block if a required behaviour is dropped.

    Raises:
        BmlError: a required behaviour is dropped.
    """
    for behaviour in block.behaviours:
        outcome = outcomes.get(behaviour.id)
        if behaviour.required and outcome is not None and outcome.kind == "dropped":
            problem = f"{behaviour.type} {behaviour.id} is required and cannot be performed: {outcome.why}"
            remedy = "outside <required> the rest would be performed without it"
            raise document_error(block.source, behaviour.place, problem, remedy)
