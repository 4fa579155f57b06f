"""Benchmark of planning by stage, compared with bare banded solves.

The passage is planned as requested, hurried so that times move, and as the overlapping block that takes longest.
"""

from collections.abc import Callable
from functools import partial
from importlib import import_module
from statistics import median

import numpy as np
import scipy

from kinesic.bench.blocks import write_overlapping_block, write_passage
from kinesic.bench.metric import Metric
from kinesic.bench.plan import write_hurried_passage
from kinesic.bench.speed.dry_runs import time_call
from kinesic.child import SLOW_IMPORTS
from kinesic.motion.condition import condition
from kinesic.planning.plan import Plan
from kinesic.planning.postures import solve_postures
from kinesic.planning.syncs import find_bonds
from kinesic.session.documents import read_block
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

PLAN_REPETITIONS = 9  # number of timed plans of each document
WORST_SEED = 194  # seed of the slowest of 200 blocks of overlapping gestures
MAX_UNSHIFTED_TIME = 0.035  # [s] goal for planning a document whose key times are not shifted
MAX_SHIFTED_TIME = 0.150  # [s] goal for planning a document whose key times are shifted
MAX_CROWDED_TIME = 1.0  # [s] goal for planning the slowest block of overlapping gestures
BAND_COUNT = 4  # diagonals of a cubic spline's normal equations


def bench() -> list[Metric]:
    """Measure CPU times of planning whole blocks, and of each planning stage."""
    setup = set_up()
    lexemes = [form.id for form in setup.lexicon.forms]

    def seconds(text_of: Callable[[int], str], count: int = PLAN_REPETITIONS) -> float:
        return median(time_call(partial(plan, text_of(k), setup))[0] for k in range(1, count + 1))

    for library in SLOW_IMPORTS:
        import_module(library)  # imported as in the server's planning processes
    for text in (write_passage(0), write_overlapping_block(WORST_SEED - 1, lexemes)):  # caches one-time data
        plan(text, setup)
    return [
        Metric("speed.plan_asked", 1000 * seconds(write_passage), "ms", 1000 * MAX_UNSHIFTED_TIME, "lower"),
        Metric("speed.plan_moved", 1000 * seconds(write_hurried_passage), "ms", 1000 * MAX_SHIFTED_TIME, "lower"),
        Metric(
            "speed.plan_crowded",
            seconds(lambda k: write_overlapping_block(WORST_SEED, lexemes), 1),
            "s",
            MAX_CROWDED_TIME,
            "lower",
        ),
        *_stages([plan(write_passage(repetition), setup) for repetition in range(1, PLAN_REPETITIONS + 1)]),
    ]


def _stages(plans: list[Plan]) -> list[Metric]:
    rows: dict[str, list[float]] = {}
    for repetition, planned in enumerate(plans, 1):
        setup, frames = planned.setup, planned.keyframes
        text, key_postures, bonds = write_passage(repetition), planned.postures.postures, find_bonds(planned.timeline)
        stages: dict[str, Callable[[], object]] = {
            "read": partial(read_block, text, setup),
            "postures": partial(solve_postures, frames, setup.robot, setup.distances),
            "condition": partial(condition, key_postures, setup.limits, bonds=bonds),
        }
        for name, work in stages.items():
            rows.setdefault(name, []).append(1000 * time_call(work)[0])
    controls = plans[0].trajectory.controls
    limit = f"limit {1000 * _time_banded_solve(*controls.shape):.2g}: one banded solve per joint by LAPACK"
    return [
        Metric(f"speed.plan_{name}", median(values), "ms", None, "lower", limit if name == "condition" else "")
        for name, values in rows.items()
    ]


def _time_banded_solve(size: int, hinges: int) -> float:
    """Return LAPACK's time [s] to solve for all spline control points."""
    bands = np.ones((BAND_COUNT, size))
    bands[-1] = 2.0 * BAND_COUNT
    right_side = np.ones(size)
    return hinges * min(time_call(lambda: scipy.linalg.solveh_banded(bands, right_side))[0] for _ in range(20))
