"""Whole-body motion of the lexicon's gestures with default options."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE
from kinesic.bench.naturalness.measures import PROFILE_RATE
from kinesic.bench.naturalness.whole_body.motion import BodyMotion, make_motion
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import BEHAVIOUR_ID, plan_gesture
from kinesic.tasks.engine import current_engine
from kinesic.tasks.processes import WorkerCrash

STROKE_TIME = 8.0  # [s] requested stroke time, late enough for the slowest preparation
PERFORMANCE_COUNT = 24  # number of random seeds; the gestures of one seed count as one performance

GestureTask = tuple[str, int]  # gesture id and seed


def list_seeded_gestures(every: int = 1) -> list[GestureTask]:
    """List gestures of the lexicon, distributed over several seeds.

    Args:
        every: 1 for all gestures, 3 for every third one.
    """
    return [(form.id, k % PERFORMANCE_COUNT) for k, form in enumerate(Lexicon.load().forms[::every])]


def perform_gestures(robot: str, tasks: Sequence[GestureTask], style: str = NEUTRAL_STYLE) -> list[BodyMotion]:
    """Return the motion of each feasible gesture, planned alone.

    Raises:
        RuntimeError: a worker process crashed.
    """
    motions = []
    for (gesture, _), motion in current_engine().run(tasks, partial(_prepare, robot, style), preload=__name__):
        if isinstance(motion, WorkerCrash):
            raise RuntimeError(f"{gesture} on {robot}: {motion.reason}")
        if motion is not None:
            motions.append(motion)
    return sorted(motions, key=lambda motion: motion.name)


def _prepare(robot: str, style: str) -> Callable[[GestureTask], BodyMotion | None]:
    return lambda task: _perform(robot, style, *task)


def _perform(robot: str, style: str, gesture: str, seed: int) -> BodyMotion | None:
    """Plan one gesture and return its motion, None if dropped."""
    setup = set_up(robot, style=style, idle=1.0, variation=1.0, seed=seed)
    form = next(form for form in setup.lexicon.forms if form.id == gesture)
    planned = plan_gesture(form, setup, stroke=STROKE_TIME)
    if planned.keyframes.outcomes[BEHAVIOUR_ID].kind == "dropped":
        return None
    syncs = {
        sync.sync: planned.trajectory.zero + sync.planned for sync in planned.syncs if sync.behaviour == BEHAVIOUR_ID
    }
    begin = syncs["start"]
    times = begin + np.arange(0.0, syncs["end"] - begin + 1e-9, 1.0 / PROFILE_RATE)
    syncs = {name: time - begin for name, time in syncs.items()}
    return make_motion(setup.robot, planned.trajectory.sample(times)[0], syncs, gesture, f"seed {seed}")
