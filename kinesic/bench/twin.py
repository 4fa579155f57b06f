"""Benchmark of the twin: simulation speed, tracking errors and clearance.

The table compares plans with and without feed-forward and correction. Gain and delay of a twin are identified from its
first document; the setpoints of all later documents compensate for them. The same runs without identification are
listed for comparison.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import inf, pi
from statistics import median
from time import process_time

import numpy as np

from kinesic.bench.blocks import find_corpus, plan_corpus, write_passage
from kinesic.bench.metric import Metric
from kinesic.body.arrays import Floats
from kinesic.body.choices import InvertedTerms
from kinesic.controller.dry_run import dry_run, dry_runs
from kinesic.controller.learned_gains import identify_servos
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.checks import checks
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.log import make_log
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors, join_factors

CORPUS_BLOCKS = 50  # number of corpus documents to perform
LOOSE_PLAY = pi / 360  # [rad] backlash of the twin with worn gears: half a degree
REFERENCE_TWINS: tuple[tuple[str, Factors], ...] = (("nominal", NOMINAL_FACTORS), ("pessimistic", PESSIMISTIC_FACTORS))
DETUNED_TWINS: tuple[tuple[str, Factors], ...] = (  # twins that each differ from nominal in one factor
    ("gain_0.5", Factors(gain=0.5)),
    ("gain_2", Factors(gain=2.0)),
    ("latency_15_ms", Factors(latency=0.015)),
    ("play_0.5_deg", Factors(play=LOOSE_PLAY)),
    ("supply_0.8", Factors(supply=0.8)),
    ("stall_0.7", Factors(stall=0.7)),
    ("friction_2", Factors(friction=2.0)),
    ("armature_1.5", Factors(armature=1.5)),
    ("mass_1.25", Factors(mass=1.25)),
    ("sag_0.2_ohm", Factors(resistance=0.2)),
)
# Twin with half the gain, 15 ms of latency, backlash and a weak supply.
SOFT_LATE_LOOSE_FACTORS = Factors(gain=0.5, latency=0.015, play=LOOSE_PLAY, resistance=0.2)
WORST_TWINS: tuple[
    tuple[str, Factors], ...
] = (  # twins with several wrong factors at once, which must only be free of collisions
    ("supply_3_a", Factors(resistance=0.1, amps=3.0)),
    ("weak_and_heavy", Factors(stall=0.7, friction=2.0, armature=1.5, mass=1.25)),
    ("soft_late_and_loose", SOFT_LATE_LOOSE_FACTORS),
    ("pessimistic_soft_late_and_loose", join_factors(PESSIMISTIC_FACTORS, SOFT_LATE_LOOSE_FACTORS)),
)


@dataclass(frozen=True)
class TrackingAid:
    """Combination of tracking aids: feed-forward, correction, identification."""

    suffix: str  # suffix of the metric names
    terms: InvertedTerms
    correction: bool = False
    identifies: bool = False  # whether gain and delay are identified from the first document


TRACKING_AIDS: tuple[TrackingAid, ...] = (
    TrackingAid("", "full", correction=True, identifies=True),
    TrackingAid("_unidentified", "full", correction=True),
    TrackingAid("_feedforward_only", "full"),
    TrackingAid("_without", "none"),
)
METRIC_GOALS: dict[str, float | None] = {  # goals in `METRIC_UNITS`; None: reported without a goal
    "rmse": 1.0,
    "p95": 2.5,
    "max": 5.0,
    "stroke_median": 15.0,
    "stroke_p95": 30.0,
    "stroke_max": None,
    "stroke_lost": 0.0,
}
METRIC_UNITS = dict.fromkeys(("rmse", "p95", "max"), "deg") | {
    "stroke_lost": "strokes"
}  # units of the metrics that are not in ms
CLEARANCE_METRIC = "clearance"  # name of the metric of the smallest distance [mm], which has a goal in every twin
MIN_CLEARANCE = 0.0  # [mm] goal of the clearance in every twin
MAX_NOMINAL_RMSE = 0.2  # [deg] goal for the nominal twin's tracking error
PASSAGE_RUNS = 7  # number of timed dry runs of the passage


@dataclass(frozen=True, eq=False)
class Errors:
    """Tracking and stroke errors of several performances."""

    angles: Floats  # (k,) [rad] absolute errors of all moving joints
    strokes: Floats  # (s,) [s] errors of strokes that arrived and were planned at the requested time
    lost: int  # number of strokes that never arrived
    min_distance: float  # [m] smallest distance between two segments

    @classmethod
    def from_performances(cls, performances: Iterable[DryRun]) -> "Errors":
        """Collect tracking and stroke errors of several performances."""
        angles: list[Floats] = []
        strokes: list[float] = []
        lost, min_distance = 0, inf
        for performance in performances:
            min_distance = min(min_distance, float(performance.measured.clearance.distances.min()))
            angles.append(np.abs(performance.errors[performance.reference.moving]))
            lags = [(sync, lag) for sync, lag in performance.lags.items() if sync.is_stroke]
            lost += sum(lag is None for _, lag in lags)
            strokes += [
                abs(sync.planned + lag - sync.requested)
                for sync, lag in lags
                if lag is not None and abs(sync.planned - sync.requested) <= SHIFT_TO_WARN
            ]
        return cls(np.concatenate(angles), np.array(strokes), lost, min_distance)

    @property
    def metrics(self) -> dict[str, float]:
        """Statistics by metric name: tracking [deg], strokes [ms], clearance [mm]."""
        degrees = np.degrees(self.angles)
        return {
            "rmse": float(np.sqrt(np.mean(degrees**2))),
            "p95": float(np.percentile(degrees, 95)),
            "max": float(degrees.max()),
            "stroke_median": 1000 * float(np.median(self.strokes)),
            "stroke_p95": 1000 * float(np.percentile(self.strokes, 95)),
            "stroke_max": 1000 * float(self.strokes.max()),
            "stroke_lost": float(self.lost),
            CLEARANCE_METRIC: 1000 * self.min_distance,
        }


def tracking_metrics(setup: Setup, blocks: int = CORPUS_BLOCKS) -> list[Metric]:
    """Measure tracking metrics for combinations of twins and tracking aids.

    Only the first combination, with identification, has goals. It and the second are also measured in the detuned
    twins.
    """
    folder = find_corpus()
    plans = plan_corpus(folder, setup, blocks) if folder else ()
    why = "" if plans else "no corpus of BML documents (KINESIC_CORPUS)"
    return [
        _metric(name, twin, aids.suffix, value, why)
        for aids in TRACKING_AIDS
        for twin, factors in ((*REFERENCE_TWINS, *DETUNED_TWINS, *WORST_TWINS) if aids.correction else REFERENCE_TWINS)
        for name, value in _metrics(plans, factors, aids).items()
    ]


def _metrics(plans: Iterable[Plan], factors: Factors, aids: TrackingAid) -> dict[str, float | None]:
    if not plans:
        return dict.fromkeys((*METRIC_GOALS, CLEARANCE_METRIC))
    return {**Errors.from_performances(_perform_all(plans, factors, aids)).metrics}


def _perform_all(plans: Iterable[Plan], factors: Factors, aids: TrackingAid) -> Iterator[DryRun]:
    believed = NOMINAL_FACTORS
    for number, planned in enumerate(plans):
        corrects = aids.correction
        run = dry_run(
            planned,
            twin=factors,
            feedforward=aids.terms,
            correction=corrects,
            watch=corrects,
            believed=believed,
        )
        if aids.identifies and number == 0:
            believed = identify_servos(make_log(run.measured), planned.setup.robot).estimate
        yield run


def _metric(name: str, twin: str, kind: str, value: float | None, why: str) -> Metric:
    if name == CLEARANCE_METRIC:
        return Metric(f"twin.{name}_{twin}{kind}", value, "mm", None if kind else MIN_CLEARANCE, "higher", why)
    goal = None if kind or twin in dict(WORST_TWINS) else METRIC_GOALS[name]
    if (name, twin, kind) == ("rmse", "nominal", ""):
        goal = MAX_NOMINAL_RMSE
    return Metric(f"twin.{name}_{twin}{kind}", value, METRIC_UNITS.get(name, "ms"), goal, "lower", why)


def bench() -> list[Metric]:
    """Measure simulation speed, clearance and tracking errors of the twin.

    The speed is simulated time over the CPU time of feed-forward, physics and checks, for one and for both twins.
    """
    setup = set_up()
    plans = [plan(write_passage(repetition), setup) for repetition in range(PASSAGE_RUNS)]
    all_twins = tuple(factors for _, factors in REFERENCE_TWINS)
    _time_dry_run(plans[0], all_twins)
    one = [_time_dry_run(planned, all_twins[:1]) for planned in plans]
    both = [_time_dry_run(planned, all_twins) for planned in plans]
    runs = [performance for _, performances in both for performance in performances]
    clearance = min(float(performance.measured.clearance.distances.min()) for performance in runs)
    return [
        Metric("twin.real_time", median(speed_ratio for speed_ratio, _ in one), "x", 100.0, "higher"),
        Metric("twin.real_time_both", median(speed_ratio for speed_ratio, _ in both), "x", 60.0, "higher"),
        Metric("twin.clearance", 1000 * clearance, "mm", 10.0, "higher"),
        *tracking_metrics(setup, CORPUS_BLOCKS),
    ]


def _time_dry_run(planned: Plan, twins: tuple[Factors, ...]) -> tuple[float, tuple[DryRun, ...]]:
    """Perform dry runs and return their real-time factor and results."""
    began = process_time()
    performances = dry_runs(planned, twins)
    for performance in performances:
        checks(performance)
    spent = process_time() - began
    return float(performances[0].measured.times[-1]) / spent, performances
