"""Head movements that return: nods, shakes, and the directions that a lexeme's words name."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import radians

import numpy as np

from kinesic.bml.block import Head
from kinesic.body.robot import Robot
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon.movement_words import HeadKind, amplitude_factor, read_head_name
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import Expressivity, passage_of
from kinesic.expressivity.turns import (
    MERGE,
    UPRIGHT,
    Layer,
    TurnKey,
    arrival,
    clip_turn,
    departure_time,
    excess,
    room,
    scale_turn,
)

NOD = radians(20)  # peak of a nod of amount 1
SHAKE = radians(25)  # of a shake of amount 1, to each side
DIRECTION = radians(30)  # of a direction of amount 1, on each axis that it names
NOD_TIME = 0.17  # [s] one way, at ease
MORE = 2  # nods or shakes that full repetition adds

_AHEAD = 0.85  # of a direction: where the head is when ready


@dataclass(frozen=True)
class HeadForm:
    """What a head does in one stroke."""

    kind: HeadKind
    peak: Turn
    repetition: int = 1
    substitute: str = ""  # why it is not the lexeme itself
    clipped: str = ""  # what the neck's range took away
    more: int = 0  # times that the manner adds

    @property
    def swings(self) -> tuple[float, ...]:
        """Shares of the peak from `stroke` to `strokeEnd`: a nod goes down and back, a shake to both sides."""
        if self.kind == "direction":
            return (1.0,)
        if self.kind == "nod":
            return (1.0, 0.0) * (self.repetition + self.more)
        return (1.0, -1.0) * (self.repetition + self.more) + (1.0, 0.0)


def head_form(head: Head, robot: Robot, manner: Expressivity) -> HeadForm | None:
    """Finds the form of a head movement, inside the range of the neck; None when its name means nothing here.

    A nod of amount a peaks at a x 20 deg, a shake at a x 25 deg to each side, a direction at a x 30 deg on each
    axis that its words name: up and down tilt, left and right turn, and roll when the word is aside or tilt. A
    direction that is repeated is gone to and left again, as a nod is. A head that stays upright is held, once.
    Spatial extent from -1 to 1 makes all of them up to half smaller or larger; repetition nods or shakes up to
    `MORE` times more.

    Args:
        head: the behaviour.
        robot: whose neck moves.
        manner: of the head; spatial extent and repetition are used.
    """
    name = read_head_name(head.lexeme)
    if name is None:
        return None
    kind, peak = (
        name.kind,
        {"nod": Turn(tilt=NOD), "shake": Turn(torsion=SHAKE)}.get(name.kind) or direction(name.words),
    )
    peak = scale_turn(peak, head.amount * amplitude_factor(name.words) * (1 + 0.5 * manner.spatial))
    within, strokes, substitute = room(robot, "neck"), max(1, head.repetition), name.stands_for
    lost = excess(peak, within)
    if strokes > 1 and clip_turn(peak, within) == UPRIGHT:
        strokes, substitute = 1, "an upright head is held: its strokes would be no motion"
    if kind == "direction" and strokes > 1:
        kind = "nod"
    why = f"{lost:.1f} deg beyond the neck's range are left out" if lost > 0.05 else ""
    more = 0 if kind == "direction" else round(MORE * max(0.0, manner.repetition))
    return HeadForm(kind, clip_turn(peak, within), strokes, substitute, why, more)


def swing_time(form: HeadForm, pace: Pace, manner: Expressivity) -> float:
    """Finds the natural time of one swing from upright to the peak [s], under temporal extent and power."""
    return pace.turn_time("neck", form.peak, manner.temporal, manner.power, usual=NOD_TIME)


def direction(words: tuple[str, ...]) -> Turn:
    """Finds the rotation that words such as up, left and aside name, one `DIRECTION` on each axis."""
    named = frozenset(words)
    tilt = DIRECTION * (bool(named & {"down", "forward", "bow"}) - bool(named & {"up", "back", "toss"}))
    side = DIRECTION * (("left" in named) - ("right" in named))
    if named & {"aside", "tilt", "lean", "roll", "incline"}:
        return Turn(tilt=tilt, roll=-side if side or tilt else DIRECTION)
    return Turn(torsion=side, tilt=tilt)


def head_layer(form: HeadForm, times: Mapping[str, float], pace: Pace, manner: Expressivity) -> Layer:
    """Times a head movement.

    A nod or shake swings between `strokeStart` and `strokeEnd`, first at its peak at `stroke`; of the times that the
    manner adds only as many as the neck can do by then. A direction is nearly there at `ready`, there at `stroke`,
    and held until `relax`.

    Args:
        form: of the movement.
        times: the seven sync points of a gesture [s].
        pace: of the robot whose neck moves.
        manner: of the head.
    """
    natural = swing_time(form, pace, manner)
    if form.kind == "direction":
        return _hold_direction(form, times, natural, manner)
    least = pace.least_turn_time("neck", form.peak)
    return _swing(_drop_added(form, times, least), times, natural, manner)


def _hold_direction(form: HeadForm, times: Mapping[str, float], natural: float, manner: Expressivity) -> Layer:
    there, hold, back = (passage_of(manner, phase) for phase in ("stroke", "hold", "retraction"))
    start = departure_time(times["start"], times["stroke"], natural)
    leave = max(times["relax"], times["stroke"])
    keys = [TurnKey(start, UPRIGHT, back)]
    if times["ready"] - start >= MERGE and times["stroke"] - times["ready"] >= MERGE:
        keys.append(TurnKey(times["ready"], scale_turn(form.peak, _AHEAD), passage_of(manner, "preparation")))
    keys.append(TurnKey(times["stroke"], form.peak, there))
    if leave - times["stroke"] >= MERGE:
        keys.append(TurnKey(leave, form.peak, hold))
    keys.append(TurnKey(arrival(keys[-1].time, times["end"], natural), UPRIGHT, back))
    return tuple(keys)


def _swing(form: HeadForm, times: Mapping[str, float], natural: float, manner: Expressivity) -> Layer:
    there, hold = passage_of(manner, "stroke"), passage_of(manner, "hold")
    swings = form.swings
    pinned = _pin_swings(times, len(swings) - 1, natural)
    moments = [float(time) for time in np.interp(range(len(swings)), list(pinned), list(pinned.values()))]
    start = departure_time(times["strokeStart"], moments[0], natural)
    early = [TurnKey(times["start"], UPRIGHT, hold)] if start - times["start"] >= MERGE else []
    peaks = [TurnKey(time, scale_turn(form.peak, swing), there) for time, swing in zip(moments, swings, strict=True)]
    late = [TurnKey(times["end"], UPRIGHT, hold)] if times["end"] - moments[-1] >= MERGE else []
    return (*early, TurnKey(start, UPRIGHT, hold), *peaks, *late)


def _drop_added(form: HeadForm, times: Mapping[str, float], least: float) -> HeadForm:
    """Leaves out added times for which the neck has no time [s]."""
    span = times["strokeEnd"] - times["stroke"]
    while form.more > 0 and span < least * (len(form.swings) - 1):
        form = replace(form, more=form.more - 1)
    return form


def _pin_swings(times: Mapping[str, float], last: int, natural: float) -> dict[int, float]:
    """Times that sync points give to swings [s]: every second one is a stroke, the last ends the stroke."""
    pinned = {0: times["stroke"]}
    for k in range(2, last, 2):
        time = times.get(f"stroke:{k // 2 + 1}")
        before = max(pinned)
        if time is not None and time - pinned[before] >= MERGE * (k - before):
            pinned[k] = time
    before = max(pinned)
    least = pinned[before] + MERGE * (last - before)
    ends = [times[sync] for sync in ("strokeEnd", "relax", "end") if times[sync] >= least]
    pinned[last] = ends[0] if ends else pinned[before] + natural * (last - before)
    return pinned
