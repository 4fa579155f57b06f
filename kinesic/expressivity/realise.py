"""Realises behaviours with times as key frames of the whole upper body."""

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
    refusal,
)
from kinesic.bml.timing.constraints import placed_points
from kinesic.bml.timing.words import find_words
from kinesic.body.robot import PartName
from kinesic.expressivity.behaviours import (
    BehaviourWarning,
    Move,
    drop_behaviour,
    gesture_move,
    head_move,
    look_moves,
    pointing_move,
    stays,
    torso_move,
    without_upright,
)
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.face.tracks import outcome
from kinesic.expressivity.gather import HANDS, PRIORITIES, Sequences, SyncPoint, gather_frames
from kinesic.expressivity.hands.coarticulation import NO_CLASHES
from kinesic.expressivity.hands.engaged import Clashes
from kinesic.expressivity.hands.fingers import finger_keys
from kinesic.expressivity.hands.phases import Arranged, arrange_hands
from kinesic.expressivity.hands.succession import find_successions
from kinesic.expressivity.idle import add_idle_motion
from kinesic.expressivity.keyframes import HeldTurns, KeyFrames, Outcome
from kinesic.expressivity.posture import posture_moves
from kinesic.expressivity.trunk import turn_trunk_along
from kinesic.expressivity.turns import add_turns
from kinesic.expressivity.whole_body import Accompanied, BodyDemands, WholeBody, accompany, axes_used

ALL: Mapping[str, str] = MappingProxyType({})  # nothing is left out


def keyframes(
    timeline: Timeline, context: BlockContext, *, without: Mapping[str, str] = ALL, clashes: Clashes = NO_CLASHES
) -> KeyFrames:
    """Makes the key frames of a block, and says what becomes of each of its behaviours.

    Args:
        timeline: behaviours with times.
        context: of their block.
        without: ids of behaviours to leave out, and why.
        clashes: behaviours whose strokes one hand cannot both do, though they do not overlap.

    Raises:
        BmlError: a behaviour inside `required` cannot be performed.
    """
    moves = _moves([timed for timed in timeline.timed if timed.behaviour.id not in without], context)
    moves |= {id: drop_behaviour(why) for id, why in without.items()}
    spoken = {behaviour for behaviour, sync in find_words(timeline) if sync.partition(":")[0] == "stroke"}
    strokes = [replace(stroke, spoken=stroke.id in spoken) for move in moves.values() for stroke in move.strokes]
    placed = placed_points(timeline.block)
    hands = arrange_hands(strokes, context.pace, placed, engaged=context.engaged, clashes=clashes)
    moves = {id: _with_hands(id, move, hands) for id, move in moves.items()}
    outcomes = {drop.behaviour.id: Outcome("dropped", drop.why) for drop in timeline.dropped}
    outcomes |= {id: move.outcome for id, move in moves.items()}
    _check_required(timeline.block, outcomes)
    uses = {id: _uses(id, move, hands) for id, move in moves.items()}
    done = {work.id: work.poses.times for work in hands.works} | _still_heads(moves)
    timeline = replace(timeline, timed=tuple(_actual_syncs(timed, hands.times, done) for timed in timeline.timed))
    syncs = [
        SyncPoint(time, timed.behaviour.id, sync)
        for timed in timeline.timed
        if uses[timed.behaviour.id]
        for sync, time in timed.times.items()
    ]
    notices = [
        Notice(warned.type, f"{timeline.block.id}:{id}", warned.text)
        for id, move in moves.items()
        for warned in move.warnings
    ]
    beside = _whole_body(timeline, context, moves, hands)
    sequences = _sequences(timeline, context, moves, hands, beside)
    shapes = {id: move.shapes for id, move in moves.items() if move.shapes}
    fingers = finger_keys(sequences.hands, hands.works, context.pace)
    frames = gather_frames(sequences, syncs, context.robot, PRIORITIES[context.shared.gathering])
    successions = find_successions(hands.works, context)
    notices = [*timeline.notices, *notices]
    held = _held_turns(timeline, moves)
    return KeyFrames(timeline, frames, outcomes, uses, tuple(notices), beside.moves, fingers, shapes, successions, held)


def _held_turns(timeline: Timeline, moves: Mapping[str, Move]) -> dict[str, HeldTurns]:
    """Collect the held rotations of each behaviour, ordered by start."""
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


def _whole_body(timeline: Timeline, context: BlockContext, moves: Mapping[str, Move], hands: Arranged) -> WholeBody:
    """Moves the body along with the hands of gestures, where no other behaviour needs it."""
    behaviours = {timed.behaviour.id: timed.behaviour for timed in timeline.timed}
    gestures = [
        Accompanied(work, context.manner(behaviour, "head"), context.manner(behaviour, "torso"))
        for work in hands.works
        if isinstance((behaviour := behaviours[work.id]).action, Gesture | Pointing)
    ]
    performed = [timed for timed in timeline.timed if moves[timed.behaviour.id].outcome.kind != "dropped"]
    asked = BodyDemands(
        head=axes_used(layer for move in moves.values() for layer in move.head),
        torso=axes_used(layer for move in moves.values() for layer in move.torso),
        eyes=[_span(timed) for timed in performed if isinstance(timed.behaviour.action, Gaze | HeadDirectionShift)],
        face=[_span(timed) for timed in performed if isinstance(timed.behaviour.action, Face)],
    )
    return accompany(gestures, asked, context.pace)


def _span(timed: TimedBehaviour) -> tuple[float, float]:
    return min(timed.times.values()), max(timed.times.values())


def _sequences(
    timeline: Timeline, context: BlockContext, moves: Mapping[str, Move], hands: Arranged, beside: WholeBody
) -> Sequences:
    """Joins all moves part by part, with the body's share in gestures, and idle motion in the pauses."""
    trunk = [
        turn_trunk_along(work, context.manner(timed.behaviour, "torso"), context.pace)
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Gesture)
        for work in hands.works
        if work.id == timed.behaviour.id
    ]
    sequences = Sequences(
        torso=(*(layer for move in moves.values() for layer in move.torso), *filter(None, (*trunk, beside.torso))),
        head=(*(layer for move in moves.values() for layer in move.head), *filter(None, (beside.head,))),
        hands=hands.hands,
    )
    return add_idle_motion(sequences, (timeline.start, timeline.end), context.shared.idling, context.robot)


def _still_heads(moves: Mapping[str, Move]) -> dict[str, int]:
    """Of behaviours whose head stays upright: one stroke, whatever was asked."""
    return {id: 1 for id, move in moves.items() if move.head and not any(map(without_upright, move.head))}


def _actual_syncs(
    timed: TimedBehaviour, moved: Mapping[str, Mapping[str, float]], done: Mapping[str, int]
) -> TimedBehaviour:
    """Moves the sync points that neighbours of its hands changed, and leaves out strokes that are not done again."""
    id, action = timed.behaviour.id, timed.behaviour.action
    times = {**timed.times, **moved.get(id, {})}
    known = done.get(id, 1 if isinstance(action, Gesture) else inf)
    strokes = [sync for sync in times if isinstance(action, Gesture | Head) and sync.startswith("stroke:")]
    beyond = {sync for sync in strokes if int(sync.partition(":")[2]) > known}
    return replace(timed, times={sync: time for sync, time in times.items() if sync not in beyond})


def _moves(timed: list[TimedBehaviour], context: BlockContext) -> dict[str, Move]:
    looks = [one for one in timed if isinstance(one.behaviour.action, Gaze | HeadDirectionShift)]
    postures = [one for one in timed if isinstance(one.behaviour.action, Posture)]
    together = {**look_moves(looks, context), **posture_moves(postures, context)}
    return {one.behaviour.id: together.get(one.behaviour.id) or _move(one, context) for one in timed}


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
            return drop_behaviour(f"nothing is known of {name}", NoticeType.CUSTOM_BEHAVIOUR_NOT_SUPPORTED)
    why = f"no part of robot {context.robot.name} does {timed.behaviour.type}"
    return drop_behaviour(why, NoticeType.BEHAVIOR_TYPE_NOT_SUPPORTED)


def _face_move(action: Face) -> Move:
    """A face moves no hinge; `face.tracks` computes what it shows."""
    found = outcome(action)
    if found.kind == "dropped":
        return drop_behaviour(found.why)
    beyond = "" if 0.0 <= action.amount <= 1.0 else f"amount {action.amount:g} is cut to the range from 0 to 1"
    texts = filter(None, (found.why, beyond))
    return Move(found, warnings=tuple(BehaviourWarning(NoticeType.CANNOT_CREATE_BEHAVIOR, text) for text in texts))


def _with_hands(id: str, move: Move, hands: Arranged) -> Move:
    """Adds what became of a behaviour when the hands were given out."""
    remarks = (BehaviourWarning(NoticeType.IMPOSSIBLE_TO_SCHEDULE, text) for text in hands.remarks.get(id, ()))
    move, outcome = replace(move, warnings=(*move.warnings, *remarks)), hands.outcomes.get(id)
    if outcome is None:
        return move
    if outcome.kind == "dropped":
        return drop_behaviour(outcome.why, NoticeType.IMPOSSIBLE_TO_SCHEDULE)
    why = "; ".join(filter(None, [move.outcome.why, outcome.why]))
    warned = BehaviourWarning(NoticeType.CANNOT_CREATE_BEHAVIOR, outcome.why)  # it has its time, in another form
    return replace(move, outcome=Outcome("substituted", why), warnings=(*move.warnings, warned))


def _uses(id: str, move: Move, hands: Arranged) -> frozenset[PartName]:
    parts: set[PartName] = {HANDS[side] for side in hands.sides.get(id, ())}
    if move.torso:
        parts.add("torso")
    if move.head:
        parts.add("head")
    return frozenset(parts)


def _check_required(block: Block, outcomes: Mapping[str, Outcome]) -> None:
    """Refuses the block when a behaviour inside `required` is dropped."""
    for behaviour in block.behaviours:
        outcome = outcomes.get(behaviour.id)
        if behaviour.required and outcome is not None and outcome.kind == "dropped":
            what = f"{behaviour.type} {behaviour.id} is required and cannot be performed: {outcome.why}"
            remedy = "outside <required> the rest would be performed without it"
            raise refusal(block.source, behaviour.place, what, remedy)
