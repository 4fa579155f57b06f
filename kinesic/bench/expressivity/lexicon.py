"""Benchmark of the gesture lexicon: every gesture in every style.

It measures each gesture alone in the twin, in every style.

It also checks that gestures differ from each other.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.bench.plan import count_violations, count_wrong_warnings
from kinesic.body.config import names_of
from kinesic.controller.dry_run import dry_run
from kinesic.expressivity.hands.appearance import look, twins
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.checks.plan import penetrations
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import plan_gesture
from kinesic.tasks.engine import current_engine
from kinesic.tasks.processes import WorkerCrash

MIN_GESTURES = 150.0  # goal for the number of gestures in the lexicon
MAX_POSITION_ERROR = 30.0  # [mm] goal for the largest distance of a wrist from its required position

NEUTRAL_STYLE = "neutral"

GestureTask = tuple[str, str]  # gesture id and style name


@dataclass(frozen=True)
class GestureResult:
    """Stroke error, clearance and exceeded limits of one gesture in one style."""

    gesture: str
    style: str
    dropped: bool
    clearance: float  # [m] smallest clearance in plan and twin
    penetrations: int  # number of samples of plan and twin with colliding segments
    violations: int  # number of limits exceeded in the plan, at 1 kHz
    stroke_error: float  # [s] deviation in the twin from the requested time; infinite if the stroke never arrived
    on_time: bool  # whether the planned stroke is at the requested time
    reported: bool  # whether every moved sync point and every drop has a warning
    miss: float  # [m] largest distance of a wrist from its required position


def bench() -> list[Metric]:
    """Count the lexicon's gestures and measure each in every style."""
    return lexicon_metrics(list(play_gestures(list_tasks(names_of("style")))))


def lexicon_metrics(results: Sequence[GestureResult]) -> list[Metric]:
    """Return lexicon metrics in the neutral style and over all styles."""
    neutral = [result for result in results if result.style == NEUTRAL_STYLE]
    return [
        *_count_gestures(Lexicon.load()),
        *(_summarise("expressivity.lexicon", neutral, neutral=True) if neutral else ()),
        *_summarise("expressivity.styles", results, neutral=False),
    ]


def list_tasks(styles: Iterable[str]) -> list[GestureTask]:
    """List all gestures of the lexicon in the given styles."""
    forms = Lexicon.load().forms
    return [(form.id, style) for style in styles for form in forms]


def play_gestures(tasks: Sequence[GestureTask]) -> Iterable[GestureResult]:
    """Perform gestures on the current task engine and yield their results.

    Raises:
        RuntimeError: a worker process crashed.
    """
    for task, result in current_engine().run(tasks, partial(_prepare, set_up), preload=__name__):
        if isinstance(result, WorkerCrash):
            raise RuntimeError(f"{task[0]} in style {task[1]}: {result.reason}")
        yield result


def judge_gesture(gesture: str, style: str, setup: Setup) -> GestureResult:
    """Measure one gesture in one style, planned and in the nominal twin."""
    styled = replace(setup, style=Style.load(style))
    form = next(form for form in styled.lexicon.forms if form.id == gesture)
    planned = plan_gesture(form, styled)
    performance = dry_run(planned)
    strokes = [sync for sync in planned.syncs if sync.sync == "stroke"]
    dropped = any(outcome.kind == "dropped" for outcome in planned.keyframes.outcomes.values())
    return GestureResult(
        gesture=gesture,
        style=style,
        dropped=dropped,
        clearance=min(
            float(clearance.distances.min()) for clearance in (planned.clearance, performance.measured.clearance)
        ),
        penetrations=penetrations(performance),
        violations=count_violations(planned),
        stroke_error=_stroke_error(performance),
        on_time=all(abs(sync.planned - sync.requested) <= SHIFT_TO_WARN for sync in strokes),
        reported=count_wrong_warnings(planned) == (0, 0) and bool(planned.notices if dropped else strokes),
        miss=max(planned.postures.misses.values(), default=0.0),
    )


def _stroke_error(performance: DryRun) -> float:
    errors = [
        np.inf if lag is None else abs(sync.planned + lag - sync.requested)
        for sync, lag in performance.lags.items()
        if sync.sync == "stroke"
    ]
    return float(max(errors, default=np.inf))


def _prepare(make_setup: Callable[[], Setup]) -> Callable[[GestureTask], GestureResult]:
    setup = make_setup()
    return lambda task: judge_gesture(*task, setup)


def _count_gestures(lexicon: Lexicon) -> list[Metric]:
    """Count all gestures of the lexicon, and visibly distinct gestures."""
    pace = set_up().pace
    same = twins((form.id, look(form, pace)) for form in lexicon.forms)
    count = float(len(lexicon.forms))
    why = "" if not same else "same as another: " + ", ".join(f"{name} ({other})" for name, other in same)
    return [
        Metric("expressivity.lexicon.gestures", count, "gestures", MIN_GESTURES, "higher"),
        Metric("expressivity.lexicon.distinct", count - len(same), "gestures", MIN_GESTURES, "higher", why),
    ]


def _summarise(part: str, results: Sequence[GestureResult], *, neutral: bool) -> list[Metric]:
    """Summarize the results of many performed gestures as metrics.

    In the neutral style strokes must be at the requested times; in other styles moves must be reported.
    """
    errors = 1000 * np.array([result.stroke_error for result in results])
    late = [f"{result.gesture} ({result.style})" for result in results if not result.on_time]
    clearance, miss = min(result.clearance for result in results), max(result.miss for result in results)
    return [
        Metric(f"{part}.played", float(len(results)), "performances", None, "higher"),
        Metric(f"{part}.dropped", _sum(result.dropped for result in results), "gestures", 0.0, "lower"),
        Metric(f"{part}.penetrations", _sum(result.penetrations for result in results), "samples", 0.0, "lower"),
        Metric(f"{part}.clearance", 1000 * clearance, "mm", 10.0, "higher"),
        Metric(f"{part}.violations", _sum(result.violations for result in results), "limits", 0.0, "lower"),
        Metric(f"{part}.unreported", _sum(not result.reported for result in results), "gestures", 0.0, "lower"),
        Metric(f"{part}.stroke_moved", float(len(late)), "strokes", 0.0 if neutral else None, "lower", ", ".join(late)),
        Metric(f"{part}.stroke_p95_ms", float(np.percentile(errors, 95)), "ms", 10.0 if neutral else None, "lower"),
        Metric(f"{part}.miss", 1000 * miss, "mm", MAX_POSITION_ERROR if neutral else None, "lower"),
    ]


def _sum(values: Iterable[float]) -> float:
    return float(sum(values))
