"""Performs a document with many variants of the servos: each worker plans it once, and only the physics differ.

A variant takes its physics and little beside: nothing is reported, and steps are of 5 ms. What comes first of many is
worth a dry run with all checks.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import nan

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.controller.perform import dry_runs, plan
from kinesic.controller.performance import Performance
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.sim.servo_factors import Factors
from kinesic.tasks.engine import engine_in_use
from kinesic.tasks.processes import WorkerCrash

PHYSICS_STEP = 0.005  # [s] of the physics: angles stay within 0.3 deg, 0.03 deg on average, of those with steps of 1 ms
GROUP = 16  # variants of a task: they share the feed-forward

Group = tuple[Factors, ...]


@dataclass(frozen=True, eq=False)
class ServoSweep:
    """What each variant made of the document; one entry for each, in their order."""

    variants: Group
    tracking: Floats  # [rad] root mean square of errors, of hinges that move
    lateness: Floats  # [s] of the latest stroke; NaN: one never came
    clearance: Floats  # [m] between the two segments that came closest
    duty: Floats  # largest, may exceed 1
    current: Floats  # [A] largest of all servos together


def sweep_servos(
    text: str, variants: Sequence[Factors], make_setup: Callable[[], Setup], *, step: float = PHYSICS_STEP
) -> ServoSweep:
    """Performs a document in twins with all these servos, by the engine in use.

    Args:
        text: BML.
        variants: how far servos and masses are from the description, each another one.
        make_setup: called once in each worker; picklable.
        step: [s] of the physics, at most.

    Raises:
        ConfigError: a variant kills its process.
    """
    groups = list(_groups(variants))
    rows: dict[Group, Floats] = {}
    for group, found in engine_in_use().run(groups, partial(_prepare, make_setup, text, step), preload=__name__):
        if isinstance(found, WorkerCrash):
            raise ConfigError(
                f"variants {', '.join(each.text().strip() or 'as it is' for each in group)}: {found.reason}"
            )
        rows[group] = found
    columns = np.concatenate([rows[group] for group in groups]).T if groups else np.empty((5, 0))
    return ServoSweep(tuple(variants), *(sealed(column) for column in columns))


def _groups(variants: Sequence[Factors]) -> Iterator[Group]:
    return (tuple(variants[k : k + GROUP]) for k in range(0, len(variants), GROUP))


def _prepare(make_setup: Callable[[], Setup], text: str, step: float) -> Callable[[Group], Floats]:
    return partial(perform_variants, plan(text, make_setup()), step=step)


def perform_variants(planned: Plan, variants: Group, *, step: float = PHYSICS_STEP) -> Floats:
    """(k, 5) columns of `ServoSweep`, of one plan.

    Args:
        planned: what is performed.
        variants: who performs it.
        step: [s] of the physics, at most.
    """
    return np.array([_row(run) for run in dry_runs(planned, variants, watch=False, step=step)])


def _row(run: Performance) -> tuple[float, ...]:
    lags = [nan if lag is None else sync.planned + lag - sync.asked for sync, lag in run.lags.items() if sync.is_stroke]
    measured = run.measured
    return (
        float(np.sqrt(np.nanmean(run.errors**2))) if run.reference.moving.any() else 0.0,
        float(np.max(lags, initial=0.0)),
        float(measured.clearance.distances.min()),
        float(np.abs(measured.duties).max()),
        float(measured.power.peak.max()),
    )
