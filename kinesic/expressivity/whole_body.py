"""Motion of head, trunk and eyes that accompanies gestures.

Like the hands it begins with the preparation, peaks at the stroke, holds while the hands are held and returns with
them. Between successive gestures it does not return, but the head turns back where a hand waits for the next. It is
limited to the available time, so that no stroke waits for it. An axis that another behaviour of the document uses at
the same time is excluded.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import copysign, radians

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.expressivity.axis_spans import NO_SPANS, Span, Spans, overlap, unused_axes
from kinesic.expressivity.gaze import towards
from kinesic.expressivity.hands.phases import NEIGHBOUR_INTERVAL
from kinesic.expressivity.hands.poses import resting_hands
from kinesic.expressivity.hands.strokes import HandStroke
from kinesic.expressivity.keyframes import BodyMove, Turn
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm, LookAt
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.passage import Phase, passage_of
from kinesic.expressivity.style.style import Expressivity
from kinesic.expressivity.trunk_following import HEAD_NOD_GAIN, follow_hands, turn_head_along
from kinesic.expressivity.turns import (
    MIN_KEY_SPACING,
    UPRIGHT_TURN,
    Layer,
    TurnKey,
    add_turns,
    clip_turn,
    departure_time,
    rotation_range,
    scale_turn,
    turn_angles,
)

MAX_TIME_FRACTION = 0.5  # largest fraction of a key interval that a head or trunk rotation may need
DEPARTURE_TIME = 0.5  # [s] duration of the movement to the stroke if the document leaves no time
MAX_RISE_TIME = 0.7  # [s] longest movement from upright to the first key, as of captured trunks and heads
RETURN_TIME = 0.8  # [s] shortest duration of the movement back to upright after the hold
LONG_PAUSE = 0.8  # [s] gap between gestures above which the head turns back to the listener
WAITING_FRACTION = 0.3  # fraction of the rotation that the head keeps in a pause between gestures
POINTED_DISTANCE = 1.0  # [m] assumed distance from hand to pointed place, without a target
# [rad] largest head rotation about each axis, by gaze target
LARGEST_LOOK: Mapping[LookAt, float] = {"hands": radians(14), "place": radians(35)}
NOD_PREPARATION = 0.3  # upward rotation before a nod / nod angle
SHAKE_SWING_TIME = 0.30  # [s] natural duration of a shake to one side
MAX_SHAKE_SWINGS = 4  # largest number of head rotations to a side in one gesture's shake
MIN_TRUNK_TIME = 0.3  # [s] shortest trunk movement to the next gesture after waiting for held hands
TRUNK_FRACTION = 0.5  # largest fraction of the gaze torsion that the trunk performs
AVERTED_EYE_RATIO = 2.0  # eye rotation / head rotation of an averted gaze
NO_MOVE = BodyMove()  # body motion of gestures that move only the hands


@dataclass(frozen=True)
class BodyDemands:
    """Time spans in which other behaviours move head, torso, eyes or face."""

    head: Spans = NO_SPANS
    torso: Spans = NO_SPANS
    eyes: Sequence[Span] = ()
    face: Sequence[Span] = ()


@dataclass(frozen=True, eq=False)
class AccompaniedGesture:
    """Gesture with its stroke and the expressivity of head and torso."""

    work: HandStroke
    head: Expressivity
    torso: Expressivity


@dataclass(frozen=True, eq=False)
class WholeBody:
    """Head, torso, gaze and face motion that accompanies gestures."""

    head: Layer
    torso: Layer
    moves: Mapping[str, BodyMove]  # accompanying motion by gesture id


@dataclass(frozen=True, eq=False)
class _Course:
    """Rotation keys of one body part during one gesture."""

    start: float  # [s] departure from the current rotation
    keys: Sequence[tuple[float, Turn]]  # time [s] and rotation; the last one is held
    leave: float  # [s] begin of the return
    back: float  # [s] end of the return
    manner: Expressivity


def accompany_gestures(gestures: Sequence[AccompaniedGesture], demands: BodyDemands, pace: Pace) -> WholeBody:
    """Create head and torso layers that accompany the hands.

    Args:
        gestures: of a block, in the order of their strokes.
        demands: time spans in which behaviours need the body.
        pace: of the robot; parts that it lacks do not move.
    """
    works = [gesture.work for gesture in gestures]
    all_moves = [
        (gesture, _body_move(gesture.work, span, demands, pace.robot))
        for gesture, span in zip(gestures, _spans(works), strict=True)
    ]
    body_moves = [(gesture, move) for gesture, move in all_moves if move != NO_MOVE]
    trunks = [_trunk_course(gesture, move) for gesture, move in body_moves if move.trunk != UPRIGHT_TURN]
    heads = [course for gesture, move in body_moves if (course := _head_course(gesture, move, pace)).keys]
    return WholeBody(
        head=_join_courses(heads, pace, "neck") if pace.robot.joints("neck") else (),
        torso=_join_courses(trunks, pace, "torso") if pace.robot.joints("torso") else (),
        moves={gesture.work.id: move for gesture, move in body_moves},
    )


def _spans(works: Sequence[HandStroke]) -> list[Span]:
    """Return the time span of each gesture's body motion [s].

    It extends to the next gesture if that follows soon.
    """
    ends = [max(work.at("end"), max(work.at("relax"), work.at("strokeEnd")) + RETURN_TIME) for work in works]
    spans: list[Span] = []
    for k, (work, end) in enumerate(zip(works, ends, strict=True)):
        follows = [other.at("start") for other in works[k + 1 : k + 2] if other.at("start") < end + NEIGHBOUR_INTERVAL]
        spans.append((min(work.at("start"), work.at("strokeStart") - DEPARTURE_TIME), max([end, *follows])))
    return spans


def _body_move(work: HandStroke, span: Span, demands: BodyDemands, robot: Robot) -> BodyMove:
    """Return the body motion of a gesture.

    Axes that other behaviours use are excluded.
    """
    body = work.poses.body
    if body == NO_BODY or work.stroke.rest:
        return NO_MOVE
    place = _place(work, body)
    gaze = UPRIGHT_TURN if place is None else towards(place, robot)
    trunk_torsion = copysign(min(abs(gaze.torsion) * TRUNK_FRACTION, body.towards), gaze.torsion)
    trunk, rest = add_turns(body.trunk, Turn(torsion=trunk_torsion)), resting_hands(robot)
    following = [follow_hands(work.poses, key, rest, robot) for key in (0, work.poses.stroke)]
    start, stroke = (add_turns(trunk, turn) for turn in following)
    look = add_turns(_head_look(gaze, body), UPRIGHT_TURN if place is not None else turn_head_along(following[1]))
    nod = body.nod * (1.0 + HEAD_NOD_GAIN if body.along > 0.0 else 1.0)
    requested = {
        "head": clip_turn(add_turns(body.head, look), rotation_range(robot, "neck")),
        "nod": clip_turn(Turn(tilt=nod), rotation_range(robot, "neck")),
        "shake": clip_turn(Turn(torsion=body.shake), rotation_range(robot, "neck")),
        "trunk": clip_turn(stroke, rotation_range(robot, "torso")),
    }
    used_axes = {part: demands.torso if part == "trunk" else demands.head for part in requested}
    unused = {part: unused_axes(turn, used_axes[part], span) for part, turn in requested.items()}
    eyes = scale_turn(unused["head"], AVERTED_EYE_RATIO) if body.gaze == "away" else None if place is None else gaze
    eyes_free, face_free = not overlap(demands.eyes, span), not overlap(demands.face, span)
    yielding = [part for part in requested if unused[part] != requested[part]]
    return BodyMove(
        head=unused["head"],
        nod=unused["nod"].tilt,
        shake=unused["shake"].torsion,
        trunk=unused["trunk"],
        trunk_start=unused_axes(clip_turn(start, rotation_range(robot, "torso")), demands.torso, span)
        if body.along > 0.0 and work.poses.stroke > 0 and not work.poses.again
        else None,
        shoulders=body.shoulders if any(robot.arm(side).shoulder_lift_joints for side in work.poses.hands) else 0.0,
        eyes=eyes if eyes_free else None,
        face=body.face if face_free else (),
        gave_way=(
            *yielding,
            *["eyes"] * (eyes is not None and not eyes_free),
            *["face"] * bool(body.face and not face_free),
        ),
    )


def _place(work: HandStroke, body: BodyForm) -> Floats | None:
    """Return the gaze target (3,) [m] during a gesture, if any.

    Returns:
        None when the gaze stays on the listener.
    """
    if body.gaze not in ("hands", "place"):
        return None
    hands = [row[work.poses.stroke] for row in work.poses.hands.values()]
    places = []
    for hand in hands:
        if hand.reach is None:
            continue
        pointing_offset = (
            POINTED_DISTANCE * hand.reach.pointing if body.gaze == "place" and hand.reach.pointing is not None else 0.0
        )
        places.append(hand.aim if hand.aim is not None else hand.reach.position + pointing_offset)
    return np.mean(places, axis=0) if places else None


def _head_look(gaze: Turn, body: BodyForm) -> Turn:
    """Return the part of a gaze rotation that the head performs."""
    largest = LARGEST_LOOK.get(body.gaze, 0.0)
    torsion, tilt, _ = (min(max(body.look * angle, -largest), largest) for angle in turn_angles(gaze))
    return Turn(torsion, tilt)


def _trunk_course(gesture: AccompaniedGesture, move: BodyMove) -> _Course:
    keys = [(gesture.work.at("stroke"), move.trunk)]
    if move.trunk_start is not None:
        keys.insert(0, (gesture.work.at("strokeStart"), move.trunk_start))
    return _course(gesture.work, keys, gesture.torso)


def _head_course(gesture: AccompaniedGesture, move: BodyMove, pace: Pace) -> _Course:
    """Return the head keys of a gesture.

    The head nods at the strokes, or shakes.
    """
    work, looking = gesture.work, move.eyes is not None
    stroke_times = {work.moments[k] for k in (work.poses.stroke, *work.poses.again)} if move.nod else set[float]()
    keys: dict[float, Turn] = {}
    if looking or move.nod:
        raised = Turn(tilt=-NOD_PREPARATION * move.nod)
        keys[work.at("strokeStart")] = add_turns(scale_turn(move.head, 1.0 if looking else 0.5), raised)
    for time in work.moments[1:] if move.nod else ():
        keys[time] = add_turns(move.head, Turn(tilt=move.nod)) if time in stroke_times else move.head
    if move.nod or move.head != UPRIGHT_TURN:
        keys.setdefault(work.at("stroke"), move.head)
    if move.nod:
        keys.setdefault(max(work.at("strokeEnd"), work.at("relax")), move.head)
    if move.shake:
        keys |= _shake_keys(work, move, pace)
    return _course(work, sorted(keys.items(), key=lambda key: key[0]), gesture.head)


def _shake_keys(work: HandStroke, move: BodyMove, pace: Pace) -> dict[float, Turn]:
    """Return the head rotations of shakes in a stroke by time [s].

    There are as many shakes as fit.

    After a short stroke the head may continue while the hands retract.
    """
    start, hold_end = work.at("strokeStart"), max(work.at("relax"), work.at("strokeEnd"))
    end = max(hold_end, min(start + 3 * SHAKE_SWING_TIME, work.at("end")))
    minimum_time = pace.least_turn_time("neck", Turn(torsion=2 * move.shake)) / MAX_TIME_FRACTION
    count = min(MAX_SHAKE_SWINGS, int((end - start) / max(minimum_time, SHAKE_SWING_TIME)))
    times = np.linspace(start, end, count + 1).tolist() if count >= 2 else []
    sides = [move.shake * (-1) ** k for k in range(count)]
    return {time: add_turns(move.head, Turn(torsion=side)) for time, side in zip(times, (*sides, 0.0), strict=False)}


def _course(work: HandStroke, keys: Sequence[tuple[float, Turn]], manner: Expressivity) -> _Course:
    first = keys[0][0] if keys else work.at("stroke")
    leave = max(work.at("relax"), keys[-1][0] if keys else work.at("stroke"))
    return _Course(departure_time(work.at("start"), first, DEPARTURE_TIME), keys, leave, work.at("end"), manner)


def _join_courses(courses: Sequence[_Course], pace: Pace, chain: str) -> Layer:
    """Join the body motion of successive gestures into one layer.

    It returns to upright where no gesture follows soon.
    """
    keys: list[TurnKey] = []
    previous: _Course | None = None

    def add_key(time: float, turn: Turn, manner: Expressivity, phase: Phase) -> None:
        if keys and time < keys[-1].time + MIN_KEY_SPACING:
            return
        if keys:
            turn = pace.manageable_turn(chain, keys[-1].turn, turn, time - keys[-1].time, MAX_TIME_FRACTION)
        eased = replace(manner, tension=min(manner.tension, 0.0)) if chain == "torso" else manner
        keys.append(TurnKey(time, turn, passage_of(eased, phase)))

    def return_upright(course: _Course) -> None:
        leave = max(course.leave, keys[-1].time)
        add_key(leave, keys[-1].turn, course.manner, "hold")
        minimum_time = pace.least_turn_time(chain, keys[-1].turn) / MAX_TIME_FRACTION
        keys.append(
            TurnKey(
                max(course.back, leave + max(minimum_time, MIN_KEY_SPACING)),
                UPRIGHT_TURN,
                passage_of(course.manner, "retraction"),
            )
        )

    for course in courses:
        if previous is not None and course.start >= previous.back + NEIGHBOUR_INTERVAL:
            return_upright(previous)
            previous = None
        if previous is None:
            start = max(course.start, course.keys[0][0] - MAX_RISE_TIME)
            add_key(start, UPRIGHT_TURN, course.manner, "retraction")
        else:
            waits = chain == "torso" and previous.leave <= course.keys[0][0] - MIN_TRUNK_TIME  # for held hands
            leave = previous.leave if waits else min(previous.leave, course.start)
            add_key(leave, keys[-1].turn, previous.manner, "hold")
            if chain == "neck" and course.start - keys[-1].time >= LONG_PAUSE:
                add_key(
                    keys[-1].time + DEPARTURE_TIME,
                    scale_turn(keys[-1].turn, WAITING_FRACTION),
                    previous.manner,
                    "retraction",
                )
                add_key(course.start, keys[-1].turn, previous.manner, "hold")
        for time, turn in course.keys:
            add_key(time, turn, course.manner, "stroke")
        previous = course
    if previous is not None:
        return_upright(previous)
    return tuple(keys)
