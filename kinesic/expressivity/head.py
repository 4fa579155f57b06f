"""Head movements that return to upright: nods, shakes and directions."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import radians

import numpy as np

from kinesic.bml.block import Head
from kinesic.body.robot import Robot
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon.movement_words import HeadKind, amplitude_factor, read_head_name
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.passage import passage_of
from kinesic.expressivity.style.style import Expressivity
from kinesic.expressivity.turns import (
    MIN_KEY_SPACING,
    UPRIGHT_TURN,
    Layer,
    TurnKey,
    arrival_time,
    clip_turn,
    departure_time,
    range_excess,
    rotation_range,
    scale_turn,
)

NOD_ANGLE = radians(20)  # [rad] peak of a nod of amount 1
SHAKE_ANGLE = radians(25)  # [rad] peak of a shake of amount 1, to each side
DIRECTION_ANGLE = radians(30)  # [rad] rotation about each named axis of a head direction of amount 1
NOD_SWING_TIME = 0.17  # [s] shortest natural time between two extremes of a head movement
SHAKE_MARGIN = 1.1  # shortest time between both sides of a shake / minimum time of the neck
MAX_ADDED_STROKES = 2  # nods or shakes added at full repetition

_READY_FRACTION = 0.85  # fraction of a head direction that is reached at `ready`


@dataclass(frozen=True)
class HeadForm:
    """Form of a head movement: kind, peak rotation and repetitions."""

    kind: HeadKind
    peak: Turn
    repetition: int = 1
    substitute: str = ""  # reason for a difference from the lexeme
    clipped: str = ""  # rotation lost to the neck's range
    added_strokes: int = 0  # strokes added by expressivity

    @property
    def swings(self) -> tuple[float, ...]:
        """Rotations between `stroke` and `strokeEnd` as fractions of the peak.

        A nod goes down and back, a shake to both sides.
        """
        if self.kind == "direction":
            return (1.0,)
        if self.kind == "nod":
            return (1.0, 0.0) * (self.repetition + self.added_strokes)
        return (1.0, -1.0) * (self.repetition + self.added_strokes) + (1.0, 0.0)


def head_form(head: Head, robot: Robot, manner: Expressivity) -> HeadForm | None:
    """Create the head movement of a lexeme within the neck's range.

    A nod of amount a peaks at a x 20 deg, a shake at a x 25 deg to each side, a direction at a x 30 deg on each axis
    that its words name: up and down tilt, left and right turn, and roll when the word is aside or tilt. A direction
    that is repeated is approached and left again, like a nod. A head that stays upright is held, once. Spatial extent
    from -1 to 1 makes all of them up to half smaller or larger; repetition adds up to `MAX_ADDED_STROKES` nods or
    shakes.

    Args:
        head: the behaviour's action.
        robot: with the neck.
        manner: expressivity of the head; spatial extent and repetition are used.

    Returns:
        None when the name is unknown.
    """
    name = read_head_name(head.lexeme)
    if name is None:
        return None
    kind, peak = (
        name.kind,
        {"nod": Turn(tilt=NOD_ANGLE), "shake": Turn(torsion=SHAKE_ANGLE)}.get(name.kind) or direction(name.words),
    )
    peak = scale_turn(peak, head.amount * amplitude_factor(name.words) * (1 + 0.5 * manner.spatial))
    neck_range, strokes, substitute = rotation_range(robot, "neck"), max(1, head.repetition), name.stands_for
    lost_angle = range_excess(peak, neck_range)
    if strokes > 1 and clip_turn(peak, neck_range) == UPRIGHT_TURN:
        strokes, substitute = 1, "an upright head is held: its strokes would be no motion"
    if kind == "direction" and strokes > 1:
        kind = "nod"
    why = f"{lost_angle:.1f} deg beyond the neck's range are left out" if lost_angle > 0.05 else ""
    added_strokes = 0 if kind == "direction" else round(MAX_ADDED_STROKES * max(0.0, manner.repetition))
    return HeadForm(kind, clip_turn(peak, neck_range), strokes, substitute, why, added_strokes)


def swing_time(form: HeadForm, pace: Pace, manner: Expressivity) -> float:
    """Return the natural time between two extremes of a head movement [s].

    A shake swings from side to side, which no tempo makes faster than the neck.
    """
    natural = pace.turn_time("neck", form.peak, manner.temporal, manner.power, usual=NOD_SWING_TIME)
    if form.kind != "shake":
        return natural
    return max(natural, SHAKE_MARGIN * pace.least_turn_time("neck", scale_turn(form.peak, 2.0)))


def direction(words: tuple[str, ...]) -> Turn:
    """Return the head rotation for direction words such as up and left.

    It is `DIRECTION_ANGLE` on each axis.
    """
    direction_words = frozenset(words)
    tilt = DIRECTION_ANGLE * (
        bool(direction_words & {"down", "forward", "bow"}) - bool(direction_words & {"up", "back", "toss"})
    )
    side = DIRECTION_ANGLE * (("left" in direction_words) - ("right" in direction_words))
    if direction_words & {"aside", "tilt", "lean", "roll", "incline"}:
        return Turn(tilt=tilt, roll=-side if side or tilt else DIRECTION_ANGLE)
    return Turn(torsion=side, tilt=tilt)


def head_layer(form: HeadForm, times: Mapping[str, float], pace: Pace, manner: Expressivity) -> Layer:
    """Create the layer of a head movement from its sync points.

    A nod or shake swings between `strokeStart` and `strokeEnd`, first at its peak at `stroke`; of the strokes that
    expressivity adds only as many are kept as the neck can perform by then. A direction is nearly reached at `ready`,
    reached at `stroke`, and held until `relax`.

    Args:
        form: of the movement.
        times: the seven sync points of a gesture [s].
        pace: of the robot with the neck.
        manner: expressivity of the head.
    """
    natural = swing_time(form, pace, manner)
    if form.kind == "direction":
        return _hold_direction(form, times, natural, manner)
    minimum = pace.least_turn_time("neck", form.peak)
    return _swing(_drop_added_strokes(form, times, minimum), times, natural, manner)


def _hold_direction(form: HeadForm, times: Mapping[str, float], natural: float, manner: Expressivity) -> Layer:
    stroke_passage, hold_passage, return_passage = (
        passage_of(manner, phase) for phase in ("stroke", "hold", "retraction")
    )
    start = departure_time(times["start"], times["stroke"], natural)
    leave = max(times["relax"], times["stroke"])
    keys = [TurnKey(start, UPRIGHT_TURN, return_passage)]
    if times["ready"] - start >= MIN_KEY_SPACING and times["stroke"] - times["ready"] >= MIN_KEY_SPACING:
        keys.append(TurnKey(times["ready"], scale_turn(form.peak, _READY_FRACTION), passage_of(manner, "preparation")))
    keys.append(TurnKey(times["stroke"], form.peak, stroke_passage))
    if leave - times["stroke"] >= MIN_KEY_SPACING:
        keys.append(TurnKey(leave, form.peak, hold_passage))
    keys.append(TurnKey(arrival_time(keys[-1].time, times["end"], natural), UPRIGHT_TURN, return_passage))
    return tuple(keys)


def _swing(form: HeadForm, times: Mapping[str, float], natural: float, manner: Expressivity) -> Layer:
    stroke_passage, hold_passage = passage_of(manner, "stroke"), passage_of(manner, "hold")
    swings = form.swings
    pinned_times = _pin_swings(times, len(swings) - 1, natural)
    times_of_swings = [
        float(time) for time in np.interp(range(len(swings)), list(pinned_times), list(pinned_times.values()))
    ]
    start = departure_time(times["strokeStart"], times_of_swings[0], natural)
    first_keys = (
        [TurnKey(times["start"], UPRIGHT_TURN, hold_passage)] if start - times["start"] >= MIN_KEY_SPACING else []
    )
    peaks = [
        TurnKey(time, scale_turn(form.peak, swing), stroke_passage)
        for time, swing in zip(times_of_swings, swings, strict=True)
    ]
    last_keys = (
        [TurnKey(times["end"], UPRIGHT_TURN, hold_passage)]
        if times["end"] - times_of_swings[-1] >= MIN_KEY_SPACING
        else []
    )
    return (*first_keys, TurnKey(start, UPRIGHT_TURN, hold_passage), *peaks, *last_keys)


def _drop_added_strokes(form: HeadForm, times: Mapping[str, float], minimum: float) -> HeadForm:
    """Drop added strokes that do not fit into the stroke phase."""
    span = times["strokeEnd"] - times["stroke"]
    while form.added_strokes > 0 and span < minimum * (len(form.swings) - 1):
        form = replace(form, added_strokes=form.added_strokes - 1)
    return form


def _pin_swings(times: Mapping[str, float], last: int, natural: float) -> dict[int, float]:
    """Map indices into `HeadForm.swings` to times [s] fixed by sync points.

    Every second swing is a stroke, and the last one ends the stroke phase.
    """
    pinned_times = {0: times["stroke"]}
    for k in range(2, last, 2):
        time = times.get(f"stroke:{k // 2 + 1}")
        before = max(pinned_times)
        if time is not None and time - pinned_times[before] >= MIN_KEY_SPACING * (k - before):
            pinned_times[k] = time
    before = max(pinned_times)
    minimum = pinned_times[before] + MIN_KEY_SPACING * (last - before)
    ends = [times[sync] for sync in ("strokeEnd", "relax", "end") if times[sync] >= minimum]
    pinned_times[last] = ends[0] if ends else pinned_times[before] + natural * (last - before)
    return pinned_times
