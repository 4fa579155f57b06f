"""The lexicon: each gesture alone in the twin, in the neutral style and in every other, and told from the others."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.bench.plan import count_wrong_warnings, violations
from kinesic.body.config import names_of
from kinesic.controller.perform import dry_run, set_up
from kinesic.controller.performance import Performance
from kinesic.expressivity.hands.appearance import look, twins
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.checks.plan import penetrations
from kinesic.studies.gestures.isolated import plan_gesture
from kinesic.tasks.engine import engine_in_use
from kinesic.tasks.processes import WorkerCrash

LEAST_GESTURES = 150.0
MOST_MISS = 30.0  # [mm] that a wrist may stay from where the gesture wants it

NEUTRAL_STYLE = "neutral"

Task = tuple[str, str]  # a gesture's id, a style's name


@dataclass(frozen=True)
class GestureResult:
    """What came of one gesture in one style."""

    gesture: str
    style: str
    dropped: bool
    clearance: float  # [m] smallest of plan and twin
    penetrations: int  # samples of plan and twin
    violations: int  # of limits, in the plan at 1 kHz
    stroke_error: float  # [s] from asked to performed in the twin; infinite when it never arrived
    on_time: bool  # the plan has the stroke where it was asked
    reported: bool  # no sync point was moved, and nothing dropped, without a warning
    miss: float  # [m] from where the gesture wants a wrist


def bench() -> list[Figure]:
    """Counts the lexicon, and plays each gesture once in every style."""
    return lexicon_figures(list(play_gestures(every(names_of("style")))))


def lexicon_figures(results: Sequence[GestureResult]) -> list[Figure]:
    """Sums up performances in several styles: those in the neutral style, and all."""
    neutral = [result for result in results if result.style == NEUTRAL_STYLE]
    return [
        *_counts(Lexicon.load()),
        *(_figures("expressivity.lexicon", neutral, neutral=True) if neutral else ()),
        *_figures("expressivity.styles", results, neutral=False),
    ]


def every(styles: Iterable[str]) -> list[Task]:
    """Lists all gestures of the lexicon in each of the styles."""
    forms = Lexicon.load().forms
    return [(form.id, style) for style in styles for form in forms]


def sample(tasks: Sequence[Task], *, share: float, seed: int) -> list[Task]:
    """Chooses a seeded share (0..1) of the tasks, in their order."""
    count = max(1, round(share * len(tasks)))
    chosen = np.random.default_rng(seed).choice(len(tasks), size=count, replace=False)
    return [tasks[k] for k in sorted(chosen)]


def play_gestures(tasks: Sequence[Task]) -> Iterable[GestureResult]:
    """Plays gestures by the engine in use; results come as they are ready.

    Raises:
        RuntimeError: a process died.
    """
    for task, result in engine_in_use().run(tasks, partial(_prepare, set_up), preload=__name__):
        if isinstance(result, WorkerCrash):
            raise RuntimeError(f"{task[0]} in style {task[1]}: {result.reason}")
        yield result


def judge_gesture(gesture: str, style: str, known: Setup) -> GestureResult:
    """Plays one gesture in one style, planned and in the nominal twin."""
    styled = replace(known, style=Style.load(style))
    form = next(form for form in styled.lexicon.forms if form.id == gesture)
    planned = plan_gesture(form, styled)
    performance = dry_run(planned)
    strokes = [sync for sync in planned.syncs if sync.sync == "stroke"]
    dropped = any(outcome.kind == "dropped" for outcome in planned.keyframes.outcomes.values())
    return GestureResult(
        gesture=gesture,
        style=style,
        dropped=dropped,
        clearance=min(float(found.distances.min()) for found in (planned.clearance, performance.measured.clearance)),
        penetrations=penetrations(performance),
        violations=violations(planned),
        stroke_error=_late(performance),
        on_time=all(abs(sync.planned - sync.asked) <= SHIFT_TO_WARN for sync in strokes),
        reported=count_wrong_warnings(planned) == (0, 0) and bool(planned.notices if dropped else strokes),
        miss=max(planned.postures.misses.values(), default=0.0),
    )


def _late(performance: Performance) -> float:
    found = [
        np.inf if lag is None else abs(sync.planned + lag - sync.asked)
        for sync, lag in performance.lags.items()
        if sync.sync == "stroke"
    ]
    return float(max(found, default=np.inf))


def _prepare(make_setup: Callable[[], Setup]) -> Callable[[Task], GestureResult]:
    known = make_setup()
    return lambda task: judge_gesture(*task, known)


def _counts(lexicon: Lexicon) -> list[Figure]:
    """How many gestures there are, and how many are like no other."""
    pace = set_up().pace
    same = twins((form.id, look(form, pace)) for form in lexicon.forms)
    count = float(len(lexicon.forms))
    why = "" if not same else "like another: " + ", ".join(f"{name} ({other})" for name, other in same)
    return [
        Figure("expressivity.lexicon.gestures", count, "gestures", LEAST_GESTURES, "higher"),
        Figure("expressivity.lexicon.distinct", count - len(same), "gestures", LEAST_GESTURES, "higher", why),
    ]


def _figures(part: str, results: Sequence[GestureResult], *, neutral: bool) -> list[Figure]:
    """What came of many; strokes must be where they were asked in the neutral style, in others moves must be told."""
    errors = 1000 * np.array([result.stroke_error for result in results])
    late = [f"{result.gesture} ({result.style})" for result in results if not result.on_time]
    tight, miss = min(result.clearance for result in results), max(result.miss for result in results)
    return [
        Figure(f"{part}.played", float(len(results)), "performances", None, "higher"),
        Figure(f"{part}.dropped", _sum(result.dropped for result in results), "gestures", 0.0, "lower"),
        Figure(f"{part}.penetrations", _sum(result.penetrations for result in results), "samples", 0.0, "lower"),
        Figure(f"{part}.clearance", 1000 * tight, "mm", 10.0, "higher"),
        Figure(f"{part}.violations", _sum(result.violations for result in results), "limits", 0.0, "lower"),
        Figure(f"{part}.unreported", _sum(not result.reported for result in results), "gestures", 0.0, "lower"),
        Figure(f"{part}.stroke_moved", float(len(late)), "strokes", 0.0 if neutral else None, "lower", ", ".join(late)),
        Figure(f"{part}.stroke_p95_ms", float(np.percentile(errors, 95)), "ms", 10.0 if neutral else None, "lower"),
        Figure(f"{part}.miss", 1000 * miss, "mm", MOST_MISS if neutral else None, "lower"),
    ]


def _sum(values: Iterable[float]) -> float:
    return float(sum(values))
