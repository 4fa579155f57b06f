"""The lexicon, each gesture planned alone from rest to rest, and how the hand that goes farther moves in it."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE, every
from kinesic.bench.naturalness.body import BodyMeasures, measure_body
from kinesic.bench.naturalness.likeness import SAMPLES, measure_appearance
from kinesic.bench.naturalness.measures import GestureMeasures, measure_hand
from kinesic.bench.naturalness.places import place_distance
from kinesic.bench.plan import violations
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.controller.perform import set_up
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.legibility_table import legibility_table
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.variation import Variation
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.studies.gestures.isolated import BEHAVIOUR, plan_gesture, stroke_error
from kinesic.tasks.engine import engine_in_use
from kinesic.tasks.processes import WorkerCrash

STROKE = 8.0  # [s] time enough for whatever comes before the slowest stroke, so that all times are natural
PERIOD = 0.01  # [s] between samples
DYNAMIC = 0.25  # [arm lengths] from which on a path is a dynamic stroke, and not a pose

Task = tuple[str, str]  # a gesture's id, a style's name


@dataclass(frozen=True)
class MeasuredGesture:
    """What came of one gesture in one style."""

    gesture: str
    category: str
    style: str
    keys: int  # of its stroke
    hand: GestureMeasures | None  # None: it was dropped
    body: BodyMeasures  # what head, trunk and collar bones do
    stroke_error: float  # [s] by which the stroke is planned later than asked
    violations: int  # of limits, at 1 kHz
    seen: Floats | None = field(default=None, compare=False, repr=False)  # (m, p, 3) [m] as `measure_appearance` has it
    place: float | None = None  # [m] from where its meaning needs the hand; None: it needs no place

    @property
    def dynamic(self) -> bool:
        """Whether the stroke is a path, and not a pose."""
        return self.keys > 1 and self.hand is not None and (self.hand.stroke_path or 0.0) > DYNAMIC

    @property
    def late(self) -> bool:
        """Whether the stroke is not where it was asked."""
        return abs(self.stroke_error) > SHIFT_TO_WARN


def measure_lexicon(tasks: Sequence[Task]) -> list[MeasuredGesture]:
    """Measures gestures, by the engine in use.

    Raises:
        RuntimeError: a process died.
    """
    return _measure(tasks, set_up)


def measure_varied(seed: int) -> list[MeasuredGesture]:
    """Measures all gestures in the neutral style as they vary by default, by the engine in use.

    Args:
        seed: of the variation.

    Raises:
        RuntimeError: a process died.
    """
    return _measure(every((NEUTRAL_STYLE,)), partial(_set_up_varied, seed))


def by_style(gestures: Iterable[MeasuredGesture]) -> dict[str, list[MeasuredGesture]]:
    """Groups gestures by style, the neutral one first."""
    found: dict[str, list[MeasuredGesture]] = {}
    for each in sorted(gestures, key=lambda each: (each.style != NEUTRAL_STYLE, each.style)):
        found.setdefault(each.style, []).append(each)
    return found


def measure_gesture(form: GestureForm, known: Setup) -> MeasuredGesture:
    """Plans one gesture alone, and measures it."""
    planned = plan_gesture(form, known, stroke=STROKE)
    late = stroke_error(planned)
    return MeasuredGesture(
        gesture=form.id,
        category=form.category,
        style=known.style.name,
        keys=len(form.keys),
        hand=None if np.isnan(late) else _measure_plan(planned),
        body=measure_body(planned.setup.robot, planned.trajectory.sample(_times(planned))[0]),
        stroke_error=late,
        violations=violations(planned),
        seen=None if np.isnan(late) else _measure_stroke(planned),
        place=None if np.isnan(late) else measure_place(form, planned),
    )


def _measure(tasks: Sequence[Task], make_setup: Callable[[], Setup]) -> list[MeasuredGesture]:
    found = []
    for (gesture, style), result in engine_in_use().run(tasks, partial(_prepare, make_setup), preload=__name__):
        if isinstance(result, WorkerCrash):
            raise RuntimeError(f"{gesture} in style {style}: {result.reason}")
        found.append(result)
    return found


def _set_up_varied(seed: int) -> Setup:
    return replace(set_up(), variation=Variation(1.0, seed))


def _prepare(make_setup: Callable[[], Setup]) -> Callable[[Task], MeasuredGesture]:
    known = make_setup()
    forms = {form.id: form for form in known.lexicon.forms}
    return lambda task: measure_gesture(forms[task[0]], replace(known, style=Style.load(task[1])))


def _measure_plan(planned: Plan) -> GestureMeasures:
    """Measures the hand that goes farther in a plan of one gesture."""
    robot, times = planned.setup.robot, _times(planned)
    angles = planned.trajectory.sample(times)[0]
    syncs = _syncs(planned)
    found = [measure_hand(times, _wrist(robot, side, angles), syncs, robot.arm_length) for side in SIDES]
    return max(found, key=lambda hand: hand.path)


def _measure_stroke(planned: Plan) -> Floats:
    """What is seen of the stroke."""
    syncs = _syncs(planned)
    times = np.linspace(syncs["strokeStart"], syncs["strokeEnd"], SAMPLES)
    return measure_appearance(planned.setup.robot, planned.trajectory.sample(times)[0])


def measure_place(form: GestureForm, planned: Plan) -> float | None:
    """Measures how far the hand that performs is from its place [m], of two hands the right one; None without place."""
    asked = legibility_table().places.get(form.id)
    if asked is None:
        return None
    angles = planned.trajectory.sample(np.array([_syncs(planned)[asked.when]]))[0][0]
    side: Side = "r" if "r_hand" in planned.keyframes.uses[BEHAVIOUR] else "l"
    return place_distance(planned.setup.robot, angles, side, asked)


def _syncs(planned: Plan) -> dict[str, float]:
    """Sync points [s] of the motion."""
    return {sync.sync: planned.trajectory.zero + sync.planned for sync in planned.syncs}


def _times(planned: Plan) -> Floats:
    return np.arange(0.0, planned.trajectory.duration + PERIOD / 2, PERIOD)


def _wrist(robot: Robot, side: Side, angles: Floats) -> Floats:
    """(m, 3) [m] of a wrist from the chest, in the axes of the world, as captured motion is measured."""
    origins = robot.skeleton.frames(angles).origins
    path: Floats = origins[:, robot.arm(side).wrist] - origins[:, robot.skeleton.segment(robot.arms[side].base)]
    return path
