"""Sweep of servo variants over one document.

Only the physics differs between variants.

A variant costs little more than its physics: there are no reports, and steps are of 5 ms. The best of many variants
deserve a dry run with all checks.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import nan

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.controller.dry_run import dry_runs
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan
from kinesic.sim.servo_factors import Factors
from kinesic.tasks.engine import current_engine
from kinesic.tasks.processes import WorkerCrash

# Angles differ by at most 0.3 deg, 0.03 deg on average, from those with 1 ms steps.
PHYSICS_STEP = 0.005  # [s] time step of the simulation
GROUP_SIZE = 16  # number of variants per task, with a common feed-forward

Group = tuple[Factors, ...]


@dataclass(frozen=True, eq=False)
class ServoSweep:
    """Measured results of all servo variants, one array entry per variant."""

    variants: Group
    tracking: Floats  # [rad] RMS error of the moving joints
    lateness: Floats  # [s] of the latest stroke; NaN: one never arrived
    clearance: Floats  # [m] smallest distance of two segments
    duty: Floats  # largest duty, may exceed 1
    current: Floats  # [A] largest total current of all servos


def sweep_servos(
    text: str, variants: Sequence[Factors], make_setup: Callable[[], Setup], *, step: float = PHYSICS_STEP
) -> ServoSweep:
    """Perform a document in twins with all servo variants.

    Args:
        text: BML document.
        variants: deviations of servos and masses from the description, all different.
        make_setup: called once in each worker; picklable.
        step: largest physics step [s].

    Raises:
        ConfigError: a variant crashes its worker.
    """
    groups = list(_groups(variants))
    rows: dict[Group, Floats] = {}
    for group, result in current_engine().run(groups, partial(_prepare, make_setup, text, step), preload=__name__):
        if isinstance(result, WorkerCrash):
            raise ConfigError(
                f"variants {', '.join(variant.text().strip() or 'unchanged' for variant in group)}: {result.reason}"
            )
        rows[group] = result
    columns = np.concatenate([rows[group] for group in groups]).T if groups else np.empty((5, 0))
    return ServoSweep(tuple(variants), *(sealed(column) for column in columns))


def _groups(variants: Sequence[Factors]) -> Iterator[Group]:
    return (tuple(variants[k : k + GROUP_SIZE]) for k in range(0, len(variants), GROUP_SIZE))


def _prepare(make_setup: Callable[[], Setup], text: str, step: float) -> Callable[[Group], Floats]:
    return partial(perform_variants, plan(text, make_setup()), step=step)


def perform_variants(planned: Plan, variants: Group, *, step: float = PHYSICS_STEP) -> Floats:
    """Perform one plan with all servo variants and return results (k, 5).

    The columns are the arrays of `ServoSweep` in order.

    Args:
        planned: plan to perform.
        variants: servo variants.
        step: largest physics step [s].
    """
    return np.array([_row(run) for run in dry_runs(planned, variants, watch=False, step=step)])


def _row(run: DryRun) -> tuple[float, ...]:
    lags = [
        nan if lag is None else sync.planned + lag - sync.requested for sync, lag in run.lags.items() if sync.is_stroke
    ]
    measured = run.measured
    return (
        float(np.sqrt(np.nanmean(run.errors**2))) if run.reference.moving.any() else 0.0,
        float(np.max(lags, initial=0.0)),
        float(measured.clearance.distances.min()),
        float(np.abs(measured.duties).max()),
        float(measured.power.peak.max()),
    )
