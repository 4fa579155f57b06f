"""Measures the twin: how much faster than real time, and how near servos come to a plan.

The table compares plans with and without feed-forward and correction. Gain and delay of a twin are identified from the
first document that it performs, and goals of all others lead by them; beside it stands what it does without.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import inf, pi
from statistics import median
from time import process_time

import numpy as np

from kinesic.bench.blocks import corpus_folder, passage_text, plan_corpus
from kinesic.bench.figure import Figure
from kinesic.body.arrays import Floats
from kinesic.body.choices import Terms
from kinesic.controller.learned_gains import learn
from kinesic.controller.perform import dry_run, dry_runs, plan, set_up
from kinesic.controller.performance import Performance
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.checks import checks
from kinesic.sim.log import log_of
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors, join_factors

BLOCKS = 50
HALF_A_DEGREE = pi / 360
TWINS: tuple[tuple[str, Factors], ...] = (("nominal", NOMINAL), ("pessimistic", PESSIMISTIC))
WRONG: tuple[tuple[str, Factors], ...] = (  # each in one way
    ("gain_0.5", Factors(gain=0.5)),
    ("gain_2", Factors(gain=2.0)),
    ("latency_15_ms", Factors(latency=0.015)),
    ("play_0.5_deg", Factors(play=HALF_A_DEGREE)),
    ("supply_0.8", Factors(supply=0.8)),
    ("stall_0.7", Factors(stall=0.7)),
    ("friction_2", Factors(friction=2.0)),
    ("armature_1.5", Factors(armature=1.5)),
    ("mass_1.25", Factors(mass=1.25)),
    ("sag_0.2_ohm", Factors(resistance=0.2)),
)
SOFT_LATE_AND_LOOSE = Factors(gain=0.5, latency=0.015, play=HALF_A_DEGREE, resistance=0.2)
TOGETHER: tuple[
    tuple[str, Factors], ...
] = (  # worse than wrong in one way: all that is promised is that nothing touches
    ("supply_3_a", Factors(resistance=0.1, amps=3.0)),
    ("weak_and_heavy", Factors(stall=0.7, friction=2.0, armature=1.5, mass=1.25)),
    ("soft_late_and_loose", SOFT_LATE_AND_LOOSE),
    ("pessimistic_soft_late_and_loose", join_factors(PESSIMISTIC, SOFT_LATE_AND_LOOSE)),
)


@dataclass(frozen=True)
class Help:
    """What helps the servos to follow."""

    suffix: str  # of its figures
    terms: Terms
    correction: bool = False
    identifies: bool = False  # gain and delay, from the first document


HELPS: tuple[Help, ...] = (
    Help("", "full", correction=True, identifies=True),
    Help("_unidentified", "full", correction=True),
    Help("_feedforward_only", "full"),
    Help("_without", "none"),
)
GOALS: dict[str, float | None] = {  # None: only told
    "rmse": 1.0,
    "p95": 2.5,
    "max": 5.0,
    "stroke_median": 15.0,
    "stroke_p95": 30.0,
    "stroke_max": None,
    "stroke_lost": 0.0,
}
UNITS = dict.fromkeys(("rmse", "p95", "max"), "deg") | {"stroke_lost": "strokes"}  # others: ms
NEAREST, APART = "clearance", 0.0  # [mm] the only figure that is the better the higher, and the only goal of all twins
NOMINAL_RMSE = 0.2  # [deg]
REPETITIONS = 7


@dataclass(frozen=True, eq=False)
class Errors:
    """Tracking and stroke errors of several performances together."""

    angles: Floats  # (k,) [rad] of all moving hinges
    strokes: Floats  # (s,) [s] to the asked time, of the strokes that were planned there and that arrived
    lost: int  # strokes that never arrived
    nearest: float  # [m] two segments came

    @classmethod
    def of(cls, performances: Iterable[Performance]) -> "Errors":
        """Gathers the samples that count."""
        angles: list[Floats] = []
        strokes: list[float] = []
        lost, nearest = 0, inf
        for performance in performances:
            nearest = min(nearest, float(performance.measured.clearance.distances.min()))
            angles.append(np.abs(performance.errors[performance.reference.moving]))
            lags = [(sync, lag) for sync, lag in performance.lags.items() if sync.is_stroke]
            lost += sum(lag is None for _, lag in lags)
            strokes += [
                abs(sync.planned + lag - sync.asked)
                for sync, lag in lags
                if lag is not None and abs(sync.planned - sync.asked) <= SHIFT_TO_WARN
            ]
        return cls(np.concatenate(angles), np.array(strokes), lost, nearest)

    @property
    def figures(self) -> dict[str, float]:
        """Error statistics by name, in degrees, milliseconds and counts."""
        degrees = np.degrees(self.angles)
        return {
            "rmse": float(np.sqrt(np.mean(degrees**2))),
            "p95": float(np.percentile(degrees, 95)),
            "max": float(degrees.max()),
            "stroke_median": 1000 * float(np.median(self.strokes)),
            "stroke_p95": 1000 * float(np.percentile(self.strokes, 95)),
            "stroke_max": 1000 * float(self.strokes.max()),
            "stroke_lost": float(self.lost),
            NEAREST: 1000 * self.nearest,
        }


def tracking_figures(known: Setup, blocks: int = BLOCKS) -> list[Figure]:
    """Measures each figure of each twin, with feed-forward and correction, with feed-forward only, and with neither.

    Only the first, whose servos are identified, has goals; it is measured in wrong twins, too, and so is the second.
    """
    where = corpus_folder()
    plans = plan_corpus(where, known, blocks) if where else ()
    why = "" if plans else "no corpus of BML documents (KINESIC_CORPUS)"
    return [
        _figure(name, twin, given.suffix, value, why)
        for given in HELPS
        for twin, factors in ((*TWINS, *WRONG, *TOGETHER) if given.correction else TWINS)
        for name, value in _figures(plans, factors, given).items()
    ]


def _figures(plans: Iterable[Plan], factors: Factors, given: Help) -> dict[str, float | None]:
    if not plans:
        return dict.fromkeys((*GOALS, NEAREST))
    return {**Errors.of(_performed(plans, factors, given)).figures}


def _performed(plans: Iterable[Plan], factors: Factors, given: Help) -> Iterator[Performance]:
    believed = NOMINAL
    for number, planned in enumerate(plans):
        helped = given.correction
        run = dry_run(
            planned, twin=factors, feedforward=given.terms, correction=helped, watch=helped, believed=believed
        )
        if given.identifies and number == 0:
            believed = learn(log_of(run.measured), planned.setup.robot).believed
        yield run


def _figure(name: str, twin: str, kind: str, value: float | None, why: str) -> Figure:
    if name == NEAREST:
        return Figure(f"twin.{name}_{twin}{kind}", value, "mm", None if kind else APART, "higher", why)
    goal = None if kind or twin in dict(TOGETHER) else GOALS[name]
    if (name, twin, kind) == ("rmse", "nominal", ""):
        goal = NOMINAL_RMSE
    return Figure(f"twin.{name}_{twin}{kind}", value, UNITS.get(name, "ms"), goal, "lower", why)


def bench() -> list[Figure]:
    """Measures the passage in both twins: simulated time over feed-forward, physics and checks; then documents."""
    known = set_up()
    plans = [plan(passage_text(repetition), known) for repetition in range(REPETITIONS)]
    everyone = tuple(factors for _, factors in TWINS)
    _timed(plans[0], everyone)
    one = [_timed(planned, everyone[:1]) for planned in plans]
    both = [_timed(planned, everyone) for planned in plans]
    runs = [performance for _, performances in both for performance in performances]
    clearance = min(float(performance.measured.clearance.distances.min()) for performance in runs)
    return [
        Figure("twin.real_time", median(speed for speed, _ in one), "x", 100.0, "higher"),
        Figure("twin.real_time_both", median(speed for speed, _ in both), "x", 60.0, "higher"),
        Figure("twin.clearance", 1000 * clearance, "mm", 10.0, "higher"),
        *tracking_figures(known, BLOCKS),
    ]


def _timed(planned: Plan, twins: tuple[Factors, ...]) -> tuple[float, tuple[Performance, ...]]:
    """Simulated time over time spent, and what was performed."""
    began = process_time()
    performances = dry_runs(planned, twins)
    for performance in performances:
        checks(performance)
    spent = process_time() - began
    return float(performances[0].measured.times[-1]) / spent, performances
