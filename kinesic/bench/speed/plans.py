"""Measures what planning takes, stage by stage, beside the banded systems that it has to solve at least.

The passage is planned as asked, hurried so that times have to move, and as the crowd of gestures that takes longest.
"""

from collections.abc import Callable
from functools import partial
from importlib import import_module
from statistics import median

import numpy as np
import scipy

from kinesic.bench.blocks import crowd, passage_text
from kinesic.bench.figure import Figure
from kinesic.bench.plan import hurry
from kinesic.bench.speed.dry_runs import timed
from kinesic.child import SLOW
from kinesic.controller.documents import read_block
from kinesic.controller.perform import plan, set_up
from kinesic.motion.condition import condition
from kinesic.planning.plan import Plan
from kinesic.planning.postures import postures
from kinesic.planning.syncs import find_bonds

REPETITIONS = 9
WORST_CROWD = 194  # the seed, of the first 200, whose block takes most
ASKED, MOVED, CROWDED = 0.035, 0.150, 1.0  # [s] goals
BANDS = 4  # of a cubic spline's normal equations: the diagonal and three beside it


def bench() -> list[Figure]:
    """Measures whole plans, and the stages of the passage."""
    known = set_up()
    lexemes = [form.id for form in known.lexicon.forms]

    def seconds(text_of: Callable[[int], str], count: int = REPETITIONS) -> float:
        return median(timed(partial(plan, text_of(k), known))[0] for k in range(1, count + 1))

    for library in SLOW:
        import_module(library)  # as processes that plan for a server have done
    for text in (passage_text(0), crowd(WORST_CROWD - 1, lexemes)):  # what is read once is read
        plan(text, known)
    return [
        Figure("speed.plan_asked", 1000 * seconds(passage_text), "ms", 1000 * ASKED, "lower"),
        Figure("speed.plan_moved", 1000 * seconds(hurry), "ms", 1000 * MOVED, "lower"),
        Figure("speed.plan_crowded", seconds(lambda k: crowd(WORST_CROWD, lexemes), 1), "s", CROWDED, "lower"),
        *_stages([plan(passage_text(repetition), known) for repetition in range(1, REPETITIONS + 1)]),
    ]


def _stages(plans: list[Plan]) -> list[Figure]:
    rows: dict[str, list[float]] = {}
    for repetition, planned in enumerate(plans, 1):
        known, frames = planned.setup, planned.keyframes
        text, keyed, bonds = passage_text(repetition), planned.postures.postures, find_bonds(planned.timeline)
        stages: dict[str, Callable[[], object]] = {
            "read": partial(read_block, text, known),
            "postures": partial(postures, frames, known.robot, known.distances),
            "condition": partial(condition, keyed, known.limits, bonds=bonds),
        }
        for name, work in stages.items():
            rows.setdefault(name, []).append(1000 * timed(work)[0])
    controls = plans[0].trajectory.controls
    limit = f"limit {1000 * _banded_solve(*controls.shape):.2g}: one banded solve per hinge by LAPACK"
    return [
        Figure(f"speed.plan_{name}", median(values), "ms", None, "lower", limit if name == "condition" else "")
        for name, values in rows.items()
    ]


def _banded_solve(size: int, hinges: int) -> float:
    """[s] that LAPACK takes to solve for the control points of each hinge, once."""
    bands = np.ones((BANDS, size))
    bands[-1] = 2.0 * BANDS
    pull = np.ones(size)
    return hinges * min(timed(lambda: scipy.linalg.solveh_banded(bands, pull))[0] for _ in range(20))
