"""The whole body in gestures: head, trunk and eyes go along with the hands, and give way to what is asked of them.

Like the hands they begin with the preparation, are there at the stroke, stay while the hands are held and go home with
them; between gestures that follow one another they do not go home, but the head turns back where a hand waits for the
next. They do no more than what time allows, so that no stroke waits for them. An axis that a behaviour of the document
turns meanwhile is left to it.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import copysign, radians

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.expressivity.gaze import towards
from kinesic.expressivity.hands.phases import NEIGHBOUR
from kinesic.expressivity.hands.strokes import HandStroke
from kinesic.expressivity.keyframes import BodyMove, Turn
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm, LookAt
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import Expressivity, Phase, passage_of
from kinesic.expressivity.turns import (
    MERGE,
    UPRIGHT,
    Layer,
    TurnKey,
    add_turns,
    clip_turn,
    departure_time,
    room,
    scale_turn,
    turn_angles,
)

HASTE = 0.5  # share of the time from key to key that head and trunk may need
EASE, HOME = 0.5, 0.8  # [s] of the way there and back, where the document leaves none
LONG_WAIT = 0.8  # [s] from one gesture to the next, in which the head turns back to the listener
WAITING = 0.3  # share of its turn that it keeps meanwhile
FAR = 1.0  # [m] of what a hand points at, where nothing is named
LARGEST_LOOK: Mapping[LookAt, float] = {"hands": radians(14), "place": radians(35)}  # that the head turns to look
LEAD_IN = 0.3  # of a nod that the head goes up before it
SHAKE_TIME = 0.30  # [s] of a shake to one side, at ease
SWINGS = 4  # at most
TRUNK_SHARE = 0.5  # of the way to what is looked at, that the trunk turns at most
BEYOND = 2.0  # times as far as the head, that eyes look away
NO_MOVE = BodyMove()

Span = tuple[float, float]  # [s] from and to
Spans = tuple[Sequence[Span], Sequence[Span], Sequence[Span]]  # torsion, tilt, roll
FREE: Spans = ((), (), ())


@dataclass(frozen=True)
class BodyDemands:
    """The times at which behaviours of a document need parts of the body."""

    head: Spans = FREE
    torso: Spans = FREE
    eyes: Sequence[Span] = ()
    face: Sequence[Span] = ()


@dataclass(frozen=True, eq=False)
class Accompanied:
    """The hands of one gesture, and the manners of what goes along with them."""

    work: HandStroke
    head: Expressivity
    torso: Expressivity


@dataclass(frozen=True, eq=False)
class WholeBody:
    """What goes along with all gestures of a block."""

    head: Layer
    torso: Layer
    moves: Mapping[str, BodyMove]  # by gesture


@dataclass(frozen=True, eq=False)
class _Course:
    """One part in one gesture."""

    start: float  # [s] leaves
    keys: Sequence[tuple[float, Turn]]  # [s] and rotation, to the last of which it then holds on
    leave: float  # [s] goes home
    back: float  # [s]
    manner: Expressivity


def axes_used(layers: Iterable[Layer]) -> Spans:
    """Finds when layers turn each axis; where one stays away from upright for good, it needs it no longer."""
    spans: tuple[list[Span], list[Span], list[Span]] = ([], [], [])
    for layer in layers:
        for a, b in pairwise(layer):
            for axis, turns in enumerate(zip(turn_angles(a.turn), turn_angles(b.turn), strict=True)):
                if any(turns):
                    spans[axis].append((a.time, b.time))
    return spans


def accompany(gestures: Sequence[Accompanied], asked: BodyDemands, pace: Pace) -> WholeBody:
    """Makes layers of head and torso that go along with the hands.

    Args:
        gestures: of a block, in the order of their strokes.
        asked: what the document asks of the body.
        pace: of the robot; a part that it lacks does nothing.
    """
    works = [each.work for each in gestures]
    found = [
        (each, _body_move(each.work, span, asked, pace.robot))
        for each, span in zip(gestures, _spans(works), strict=True)
    ]
    moving = [(each, move) for each, move in found if move != NO_MOVE]
    trunks = [_trunk_course(each, move) for each, move in moving if move.trunk != UPRIGHT]
    heads = [course for each, move in moving if (course := _head_course(each, move, pace)).keys]
    return WholeBody(
        head=_join(heads, pace, "neck") if pace.robot.joints("neck") else (),
        torso=_join(trunks, pace, "torso") if pace.robot.joints("torso") else (),
        moves={each.work.id: move for each, move in moving},
    )


def _spans(works: Sequence[HandStroke]) -> list[Span]:
    """Finds for each gesture from when to when the body may leave upright: to the next gesture if that is soon [s]."""
    ends = [max(work.at("end"), max(work.at("relax"), work.at("strokeEnd")) + HOME) for work in works]
    spans: list[Span] = []
    for k, (work, end) in enumerate(zip(works, ends, strict=True)):
        follows = [other.at("start") for other in works[k + 1 : k + 2] if other.at("start") < end + NEIGHBOUR]
        spans.append((min(work.at("start"), work.at("strokeStart") - EASE), max([end, *follows])))
    return spans


def _body_move(work: HandStroke, span: Span, asked: BodyDemands, robot: Robot) -> BodyMove:
    """What the body does in a gesture, without what the document needs meanwhile."""
    body = work.poses.body
    if body == NO_BODY or work.stroke.rest:
        return NO_MOVE
    place = _place(work, body)
    seen = UPRIGHT if place is None else towards(place, robot)
    beside = copysign(min(abs(seen.torsion) * TRUNK_SHARE, body.towards), seen.torsion)
    wished = {
        "head": clip_turn(add_turns(body.head, _looked(seen, body)), room(robot, "neck")),
        "nod": clip_turn(Turn(tilt=body.nod), room(robot, "neck")),
        "shake": clip_turn(Turn(torsion=body.shake), room(robot, "neck")),
        "trunk": clip_turn(add_turns(body.trunk, Turn(torsion=beside)), room(robot, "torso")),
    }
    taken = {part: asked.torso if part == "trunk" else asked.head for part in wished}
    free = {part: _left_free(turn, taken[part], span) for part, turn in wished.items()}
    eyes = scale_turn(free["head"], BEYOND) if body.gaze == "away" else None if place is None else seen
    looks, shows = not _meet(asked.eyes, span), not _meet(asked.face, span)
    away = [part for part in wished if free[part] != wished[part]]
    return BodyMove(
        head=free["head"],
        nod=free["nod"].tilt,
        shake=free["shake"].torsion,
        trunk=free["trunk"],
        shoulders=body.shoulders if any(robot.arm(side).lifting for side in work.poses.hands) else 0.0,
        eyes=eyes if looks else None,
        face=body.face if shows else (),
        gave_way=(*away, *["eyes"] * (eyes is not None and not looks), *["face"] * bool(body.face and not shows)),
    )


def _place(work: HandStroke, body: BodyForm) -> Floats | None:
    """(3,) [m] what is looked at, in the world; None: nothing but the listener."""
    if body.gaze not in ("hands", "place"):
        return None
    hands = [row[work.poses.stroke] for row in work.poses.hands.values()]
    places = []
    for hand in hands:
        if hand.reach is None:
            continue
        beyond = FAR * hand.reach.pointing if body.gaze == "place" and hand.reach.pointing is not None else 0.0
        places.append(hand.aim if hand.aim is not None else hand.reach.position + beyond)
    return np.mean(places, axis=0) if places else None


def _looked(seen: Turn, body: BodyForm) -> Turn:
    """The head's share of a gaze."""
    most = LARGEST_LOOK.get(body.gaze, 0.0)
    torsion, tilt, _ = (min(max(body.look * angle, -most), most) for angle in turn_angles(seen))
    return Turn(torsion, tilt)


def _left_free(turn: Turn, taken: Spans, span: Span) -> Turn:
    """Keeps the axes that nothing else turns in a span."""
    return Turn(*(0.0 if _meet(spans, span) else angle for angle, spans in zip(turn_angles(turn), taken, strict=True)))


def _meet(spans: Sequence[Span], span: Span) -> bool:
    return any(begin < span[1] and span[0] < end for begin, end in spans)


def _trunk_course(each: Accompanied, move: BodyMove) -> _Course:
    return _course(each.work, [(each.work.at("stroke"), move.trunk)], each.torso)


def _head_course(each: Accompanied, move: BodyMove, pace: Pace) -> _Course:
    """The head turns, and nods at each stroke or shakes while it lasts."""
    work, looking = each.work, move.eyes is not None
    strokes = {work.moments[k] for k in (work.poses.stroke, *work.poses.again)} if move.nod else set[float]()
    keys: dict[float, Turn] = {}
    if looking or move.nod:
        lead = Turn(tilt=-LEAD_IN * move.nod)
        keys[work.at("strokeStart")] = add_turns(scale_turn(move.head, 1.0 if looking else 0.5), lead)
    for moment in work.moments[1:] if move.nod else ():
        keys[moment] = add_turns(move.head, Turn(tilt=move.nod)) if moment in strokes else move.head
    if move.nod or move.head != UPRIGHT:
        keys.setdefault(work.at("stroke"), move.head)
    if move.nod:
        keys.setdefault(max(work.at("strokeEnd"), work.at("relax")), move.head)
    if move.shake:
        keys |= _shakes(work, move, pace)
    return _course(work, sorted(keys.items(), key=lambda key: key[0]), each.head)


def _shakes(work: HandStroke, move: BodyMove, pace: Pace) -> dict[float, Turn]:
    """To and fro from the beginning of the stroke, as often as there is time for, and then straight.

    After a short stroke the head may go on while the hands go home.
    """
    begin, held = work.at("strokeStart"), max(work.at("relax"), work.at("strokeEnd"))
    end = max(held, min(begin + 3 * SHAKE_TIME, work.at("end")))
    least = pace.least_turn_time("neck", Turn(torsion=2 * move.shake)) / HASTE
    count = min(SWINGS, int((end - begin) / max(least, SHAKE_TIME)))
    times = np.linspace(begin, end, count + 1).tolist() if count >= 2 else []
    sides = [move.shake * (-1) ** k for k in range(count)]
    return {time: add_turns(move.head, Turn(torsion=side)) for time, side in zip(times, (*sides, 0.0), strict=False)}


def _course(work: HandStroke, keys: Sequence[tuple[float, Turn]], manner: Expressivity) -> _Course:
    first = keys[0][0] if keys else work.at("stroke")
    leave = max(work.at("relax"), keys[-1][0] if keys else work.at("stroke"))
    return _Course(departure_time(work.at("start"), first, EASE), keys, leave, work.at("end"), manner)


def _join(courses: Sequence[_Course], pace: Pace, chain: str) -> Layer:
    """Goes from one gesture to the next, and home where none follows soon; nowhere faster than is easy for the part."""
    keys: list[TurnKey] = []
    last: _Course | None = None

    def add(time: float, turn: Turn, manner: Expressivity, phase: Phase) -> None:
        if keys and time < keys[-1].time + MERGE:
            return
        if keys:
            turn = pace.manageable_turn(chain, keys[-1].turn, turn, time - keys[-1].time, HASTE)
        keys.append(TurnKey(time, turn, passage_of(manner, phase)))

    def go_home(course: _Course) -> None:
        leave = max(course.leave, keys[-1].time)
        add(leave, keys[-1].turn, course.manner, "hold")
        least = pace.least_turn_time(chain, keys[-1].turn) / HASTE
        keys.append(
            TurnKey(max(course.back, leave + max(least, MERGE)), UPRIGHT, passage_of(course.manner, "retraction"))
        )

    for course in courses:
        if last is not None and course.start >= last.back + NEIGHBOUR:
            go_home(last)
            last = None
        if last is None:
            add(course.start, UPRIGHT, course.manner, "retraction")
        else:
            add(min(last.leave, course.start), keys[-1].turn, last.manner, "hold")
            if chain == "neck" and course.start - keys[-1].time >= LONG_WAIT:
                add(keys[-1].time + EASE, scale_turn(keys[-1].turn, WAITING), last.manner, "retraction")
                add(course.start, keys[-1].turn, last.manner, "hold")
        for time, turn in course.keys:
            add(time, turn, course.manner, "stroke")
        last = course
    if last is not None:
        go_home(last)
    return tuple(keys)
