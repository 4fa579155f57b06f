"""Hand motion of the lexicon's gestures, each planned alone.

The hand with the longer path is measured.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE, list_tasks
from kinesic.bench.naturalness.body import BodyMeasures, measure_body
from kinesic.bench.naturalness.likeness import STROKE_SAMPLES, measure_appearance
from kinesic.bench.naturalness.measures import GestureMeasures, measure_hand
from kinesic.bench.naturalness.places import measure_place_distance
from kinesic.bench.plan import count_violations
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.legibility_table import legibility_table
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.variation import Variation
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import BEHAVIOUR_ID, plan_gesture, stroke_error
from kinesic.tasks.engine import current_engine
from kinesic.tasks.processes import WorkerCrash

STROKE_TIME = 8.0  # [s] requested stroke time, late enough for the slowest preparation
SAMPLE_PERIOD = 0.01  # [s] interval between samples of the measured motion
MIN_DYNAMIC_PATH = 0.25  # [arm lengths] shortest hand path of a dynamic stroke; shorter strokes are poses

GestureTask = tuple[str, str]  # gesture id and style name


@dataclass(frozen=True)
class MeasuredGesture:
    """Motion measures of one gesture in one style."""

    gesture: str
    category: str
    style: str
    keys: int  # number of keys of its stroke
    hand: GestureMeasures | None  # None: the gesture was dropped
    body: BodyMeasures  # motion of head, trunk and clavicles
    stroke_error: float  # [s] delay of the planned stroke after its requested time; NaN without a stroke
    violations: int  # exceeded limits at 1 kHz
    seen: Floats | None = field(default=None, compare=False, repr=False)  # (m, p, 3) [m] from `measure_appearance`
    place: float | None = None  # [m] distance of the hand from its required position; None: no required position

    @property
    def is_dynamic(self) -> bool:
        """Whether the stroke is a path rather than a pose."""
        return self.keys > 1 and self.hand is not None and (self.hand.stroke_path or 0.0) > MIN_DYNAMIC_PATH

    @property
    def is_late(self) -> bool:
        """Whether the stroke was moved from its requested time."""
        return abs(self.stroke_error) > SHIFT_TO_WARN


def measure_lexicon(tasks: Sequence[GestureTask]) -> list[MeasuredGesture]:
    """Measure gestures of the lexicon with the current task engine.

    Raises:
        RuntimeError: a worker process crashed.
    """
    return _measure(tasks, set_up)


def measure_varied(seed: int) -> list[MeasuredGesture]:
    """Measure all gestures in the neutral style with their default variation.

    Args:
        seed: seed of the variation.

    Raises:
        RuntimeError: a worker process crashed.
    """
    return _measure(list_tasks((NEUTRAL_STYLE,)), partial(_set_up_varied, seed))


def group_by_style(gestures: Iterable[MeasuredGesture]) -> dict[str, list[MeasuredGesture]]:
    """Group gestures by style, the neutral style first."""
    groups: dict[str, list[MeasuredGesture]] = {}
    for gesture in sorted(gestures, key=lambda gesture: (gesture.style != NEUTRAL_STYLE, gesture.style)):
        groups.setdefault(gesture.style, []).append(gesture)
    return groups


def measure_gesture(form: GestureForm, setup: Setup) -> MeasuredGesture:
    """Plan one gesture alone and measure its motion."""
    planned = plan_gesture(form, setup, stroke=STROKE_TIME)
    late = stroke_error(planned)
    return MeasuredGesture(
        gesture=form.id,
        category=form.category,
        style=setup.style.name,
        keys=len(form.keys),
        hand=None if np.isnan(late) else _measure_plan(planned),
        body=measure_body(planned.setup.robot, planned.trajectory.sample(_times(planned))[0]),
        stroke_error=late,
        violations=count_violations(planned),
        seen=None if np.isnan(late) else _measure_stroke(planned),
        place=None if np.isnan(late) else measure_place(form, planned),
    )


def _measure(tasks: Sequence[GestureTask], make_setup: Callable[[], Setup]) -> list[MeasuredGesture]:
    results = []
    for (gesture, style), result in current_engine().run(tasks, partial(_prepare, make_setup), preload=__name__):
        if isinstance(result, WorkerCrash):
            raise RuntimeError(f"{gesture} in style {style}: {result.reason}")
        results.append(result)
    return results


def _set_up_varied(seed: int) -> Setup:
    return replace(set_up(), variation=Variation(1.0, seed))


def _prepare(make_setup: Callable[[], Setup]) -> Callable[[GestureTask], MeasuredGesture]:
    setup = make_setup()
    forms = {form.id: form for form in setup.lexicon.forms}
    return lambda task: measure_gesture(forms[task[0]], replace(setup, style=Style.load(task[1])))


def _measure_plan(planned: Plan) -> GestureMeasures:
    """Measure the hand with the longer path in a plan."""
    robot, times = planned.setup.robot, _times(planned)
    angles = planned.trajectory.sample(times)[0]
    syncs = _find_sync_times(planned)
    results = [measure_hand(times, _trace_wrist(robot, side, angles), syncs, robot.arm_length) for side in SIDES]
    return max(results, key=lambda hand: hand.path)


def _measure_stroke(planned: Plan) -> Floats:
    """Return the compared body points (m, p, 3) [m] during the stroke."""
    syncs = _find_sync_times(planned)
    times = np.linspace(syncs["strokeStart"], syncs["strokeEnd"], STROKE_SAMPLES)
    return measure_appearance(planned.setup.robot, planned.trajectory.sample(times)[0])


def measure_place(form: GestureForm, planned: Plan) -> float | None:
    """Return the distance [m] of the performing hand from its required position.

    Of two hands the right one counts. The result is None if the gesture requires no position.
    """
    requirement = legibility_table().places.get(form.id)
    if requirement is None:
        return None
    angles = planned.trajectory.sample(np.array([_find_sync_times(planned)[requirement.when]]))[0][0]
    side: Side = "r" if "r_hand" in planned.keyframes.uses[BEHAVIOUR_ID] else "l"
    return measure_place_distance(planned.setup.robot, angles, side, requirement)


def _find_sync_times(planned: Plan) -> dict[str, float]:
    """Return the sync points' times [s] in the planned motion."""
    return {sync.sync: planned.trajectory.zero + sync.planned for sync in planned.syncs}


def _times(planned: Plan) -> Floats:
    return np.arange(0.0, planned.trajectory.duration + SAMPLE_PERIOD / 2, SAMPLE_PERIOD)


def _trace_wrist(robot: Robot, side: Side, angles: Floats) -> Floats:
    """Return the wrist's path relative to the chest, (m, 3) [m]."""
    origins = robot.skeleton.frames(angles).origins
    path: Floats = origins[:, robot.arm(side).wrist] - origins[:, robot.skeleton.segment(robot.arms[side].base)]
    return path
