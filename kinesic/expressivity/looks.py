"""Conversion of gazes and head directions to head and torso layers."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest

from kinesic.bml.block import Gaze, HeadDirectionShift, NoticeType, TimedBehaviour
from kinesic.expressivity import gaze
from kinesic.expressivity.behaviours import (
    BehaviourWarning,
    Move,
    drop_behaviour,
    missing_part,
    stays,
    substitution_outcome,
    without_upright,
)
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.gather import SAME_FRAME
from kinesic.expressivity.turns import (
    UPRIGHT_TURN,
    add_turns,
    layers_of_holds,
    rest_head_turn,
    scale_turn,
    set_passages,
)

GAZE_HEAD_FRACTION = 0.5  # fraction of the standing head posture that a gaze behaviour straightens


def look_moves(looks: Sequence[TimedBehaviour], context: BlockContext) -> Mapping[str, Move]:
    """Convert gaze and head direction behaviours to head and torso layers.

    Args:
        looks: behaviours with a Gaze or HeadDirectionShift, in any order.
        context: of their block.
    """
    if not context.robot.joints("neck"):
        return {timed.behaviour.id: missing_part("neck", context) for timed in looks}
    moves: dict[str, Move] = {}
    aims: list[gaze.Aim] = []
    performed: list[TimedBehaviour] = []
    base = gaze.STRAIGHT_AIM
    for timed, other in _by_start(looks):
        action = timed.behaviour.action
        if other is not None:
            why = f"{other.behaviour.id} starts another gaze at the same time"
            moves[timed.behaviour.id] = drop_behaviour(why, NoticeType.IMPOSSIBLE_TO_SCHEDULE)
            continue
        if not isinstance(action, Gaze | HeadDirectionShift):
            raise TypeError(f"{timed.behaviour.id} is a {type(action).__name__}, neither a gaze nor a head direction")
        aim = gaze.aim(action, context, base)
        if aim is None:
            why = context.unknown_target(action.target or "")
            moves[timed.behaviour.id] = drop_behaviour(why, NoticeType.NO_SUCH_TARGET)
            continue
        base = aim if stays(action) else base
        aims.append(aim)
        performed.append(timed)
    return moves | _perform_looks(performed, aims, context)


def _by_start(looks: Sequence[TimedBehaviour]) -> Iterator[tuple[TimedBehaviour, TimedBehaviour | None]]:
    """Yield gazes sorted by start, each with a simultaneous gaze or None.

    Only gazes of the same kind are paired.
    """
    ordered = sorted(looks, key=lambda timed: timed.times["start"])
    for timed, other in zip_longest(ordered, ordered[1:]):
        action = timed.behaviour.action
        is_same_kind = other is not None and type(other.behaviour.action) is type(action) and not stays(action)
        is_simultaneous = is_same_kind and other.times["start"] - timed.times["start"] < SAME_FRAME
        yield timed, other if is_simultaneous else None


def _perform_looks(looks: Sequence[TimedBehaviour], aims: Sequence[gaze.Aim], context: BlockContext) -> dict[str, Move]:
    head_holds, trunk_holds = (
        [
            gaze.hold_gaze(
                _from_standing(aim, context),
                timed.times,
                part=part,
                stays=stays(timed.behaviour.action),
                pace=context.pace,
            )
            for aim, timed in zip(aims, looks, strict=True)
        ]
        for part in gaze.GAZE_PARTS
    )
    head, lower_layers = layers_of_holds(head_holds), layers_of_holds(trunk_holds)
    moves: dict[str, Move] = {}
    for k, (timed, aim) in enumerate(zip(looks, aims, strict=True)):
        outcome, warnings = substitution_outcome(aim.substitute, aim.clipped, aim.missing)
        if k + 1 < len(head_holds) and (leave := head_holds[k].leave) is not None and head_holds[k + 1].start < leave:
            text = f"gives way to {looks[k + 1].behaviour.id} at {head_holds[k + 1].start:.2f} s"
            warnings += (BehaviourWarning(NoticeType.IMPOSSIBLE_TO_SCHEDULE, text),)
        manner = context.manner(timed.behaviour)
        head_key_layer, torso_layers = (
            set_passages(head[k], manner),
            without_upright(set_passages(lower_layers[k], manner)),
        )
        moves[timed.behaviour.id] = Move(outcome, head=(head_key_layer,), torso=torso_layers, warnings=warnings)
    return moves


def _from_standing(aim: gaze.Aim, context: BlockContext) -> gaze.Aim:
    """Subtract a fraction of the standing head posture from a gaze.

    The fraction is `GAZE_HEAD_FRACTION`. A gaze with an upright head stays unchanged.
    """
    if aim.head == UPRIGHT_TURN:
        return aim
    return replace(aim, head=add_turns(aim.head, scale_turn(rest_head_turn(context.robot), -GAZE_HEAD_FRACTION)))
