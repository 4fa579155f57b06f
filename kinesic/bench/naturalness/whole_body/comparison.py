"""Metrics that compare whole-body motion with captured sets."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.bench.naturalness.bars import kolmogorov_smirnov
from kinesic.bench.naturalness.whole_body.classifier import (
    Sample,
    Scorer,
    Separation,
    score_logistic,
    score_neighbours,
    separate_samples,
    separate_unseen,
)
from kinesic.bench.naturalness.whole_body.features import MeasuredSet, motion_sample, posture_sample
from kinesic.body.arrays import Floats

METRIC_PREFIX = "naturalness.people"
# Captured sets to which constants were fitted.
TUNED_SETS = frozenset(("Gestures", "Gestures2", "MaleGestures", "FemaleGestures"))
ADULT_ARM = 540.0  # [mm] arm length of an adult; converts shoulder displacements in arm lengths to mm
MIN_TRUNK_ROTATION = 0.5  # [deg] trunk rotation below which a trunk counts as still
BREATH_SPEED = 2.5  # [deg/s] largest rotation speed of the trunk from breath and sway alone
MIN_FREE_ARM_RATIO = 0.02  # path of the free arm / path of the main arm, below which the free arm counts as still
MIN_DYNAMIC_PATH = 0.25  # [arm lengths] shortest path of a dynamic stroke
MAX_KS_DISTANCE = 0.3  # goal for Kolmogorov-Smirnov distances
MAX_AUC = 0.85  # goal for the ROC area of the classifier of whole-body motion
MAX_ACCURACY = 0.65  # goal for the accuracy of classifying first frames
COMPARED_MEASURES = ("trunk", "stroke_speed", "flow", "path")  # measures whose distributions are compared
CLASSIFIER_SCORERS: Mapping[str, Scorer] = {
    "": score_logistic,
    "_neighbours": score_neighbours,
}  # suffix of the metric names -> scores of the classifier
SPEED_UNIT = "arm lengths/s"
REST_AXES = ("out", "forward", "down")  # posture features of the wrist position

SampleOf = Callable[..., Sample]


@dataclass(frozen=True)
class Summary:
    """Definition of a statistic of a set of gestures, with its goal."""

    label: str
    unit: str
    goal: float | None
    better: Literal["lower", "higher"]
    value_of: Callable[[MeasuredSet], float]


def _median(name: str, scale: float = 1.0) -> Callable[[MeasuredSet], float]:
    return lambda measured: scale * _quantile(measured.values(name))


def _fraction_below(name: str, limit: float) -> Callable[[MeasuredSet], float]:
    return lambda measured: float((measured.values(name) < limit).mean())


def _dynamic_stroke(measured: MeasuredSet) -> float:
    speeds = [
        gesture.stroke_speed
        for gesture in measured.gestures
        if gesture.stroke_speed is not None and (gesture.stroke_path or 0.0) > MIN_DYNAMIC_PATH
    ]
    return _quantile(np.array(speeds))


def measure_rest_spread(measured: MeasuredSet) -> float:
    """Return the spread of the resting wrists [arm lengths].

    It is the root sum square of the wrist position's standard deviations along the three axes.
    """
    spreads = [float(measured.posture_values(name).std()) for name in REST_AXES]
    return float(np.linalg.norm(spreads))


FEATURE_SUMMARIES: Mapping[str, Summary] = {
    "trunk": Summary("largest rotation of the trunk", "deg", 3.0, "higher", _median("trunk")),
    "trunk_still": Summary(
        "gestures with a trunk under 0.5 deg", "", 0.05, "lower", _fraction_below("trunk", MIN_TRUNK_ROTATION)
    ),
    "trunk_speed": Summary("largest speed of the trunk", "deg/s", None, "higher", _median("trunk_speed")),
    "trunk_slow": Summary(
        "gestures with a trunk no faster than breath", "", None, "lower", _fraction_below("trunk_speed", BREATH_SPEED)
    ),
    "head": Summary("largest rotation of the head", "deg", 9.0, "higher", _median("head")),
    "head_speed": Summary("largest speed of the head", "deg/s", None, "higher", _median("head_speed")),
    "collar": Summary("shoulder displacement, of an adult", "mm", None, "higher", _median("collar", ADULT_ARM)),
    "free_arm": Summary("path of the free arm / main arm", "", None, "higher", _median("free_arm")),
    "free_arm_still": Summary(
        "gestures with a free arm under 2 %", "", 0.05, "lower", _fraction_below("free_arm", MIN_FREE_ARM_RATIO)
    ),
    "hand_turning": Summary("largest rotation speed of the hand", "deg/s", None, "higher", _median("hand_turning")),
    "stroke_speed": Summary("largest speed of the stroke", SPEED_UNIT, None, "higher", _median("stroke_speed")),
    "stroke_dynamic": Summary("the same of dynamic strokes", SPEED_UNIT, 1.6, "higher", _dynamic_stroke),
    "flow": Summary("flow at strokeStart", "", 0.4, "higher", _median("flow")),
    "path": Summary("path of the wrist", "arm lengths", None, "higher", _median("path")),
    "elbow_range": Summary("range of the elbow", "deg", None, "lower", _median("elbow_range")),
    "wrist_range": Summary("range of the wrist", "deg", None, "lower", _median("wrist_range")),
    "units_per_second": Summary("movement units per second", "1/s", None, "lower", _median("units_per_second")),
    "rest_spread": Summary("spread of resting wrists", "arm lengths", None, "higher", measure_rest_spread),
}


def split_sets(captured: Sequence[MeasuredSet]) -> tuple[list[MeasuredSet], list[MeasuredSet]]:
    """Split captured sets into sets used for fitting constants and unseen sets."""
    tuned = [measured for measured in captured if measured.name in TUNED_SETS]
    return tuned, [measured for measured in captured if measured.name not in TUNED_SETS]


def merge_sets(name: str, sets: Sequence[MeasuredSet]) -> MeasuredSet:
    """Merge sets of measured gestures and rests under a new name."""
    return MeasuredSet(
        name,
        tuple(gesture for measured in sets for gesture in measured.gestures),
        tuple(performance for measured in sets for performance in measured.performances),
        tuple(posture for measured in sets for posture in measured.postures),
        tuple(rest for measured in sets for rest in measured.rests),
    )


def compare_body(ours: MeasuredSet, captured: Sequence[MeasuredSet]) -> list[Metric]:
    """Compare the gestures of one body with captured sets.

    Args:
        ours: gestures on one body.
        captured: captured sets, those in `TUNED_SETS` and unseen ones.
    """
    part = f"{METRIC_PREFIX}.{ours.name}"
    tuned, unseen = split_sets(captured)
    both = merge_sets("tuned", tuned), merge_sets("unseen", unseen)
    return [
        *(_summary_metric(f"{part}.{name}", summary, ours, *both) for name, summary in FEATURE_SUMMARIES.items()),
        *(_distance(part, name, ours, people) for people in both for name in COMPARED_MEASURES),
        *separation_metrics(part, ours, tuned, unseen, MAX_AUC, MAX_ACCURACY),
    ]


def compare_sets(captured: Sequence[MeasuredSet], known: Sequence[MeasuredSet]) -> list[Metric]:
    """Compare each captured set with all other sets, without goals.

    Args:
        captured: measured sets.
        known: sets that each of them is compared with, except those of its own name.
    """
    metrics: list[Metric] = []
    for measured in (measured for measured in captured if measured.gestures):
        part = f"{METRIC_PREFIX}.{measured.name.replace(' ', '_')}"
        tag = "tuned on" if measured.name in TUNED_SETS else "unseen"
        metrics.append(Metric(f"{part}.gestures", float(len(measured.gestures)), "gestures", None, "higher", tag))
        for name, summary in FEATURE_SUMMARIES.items():
            value = _finite(summary.value_of(measured))
            metrics.append(Metric(f"{part}.{name}", value, summary.unit, None, summary.better, tag))
        others = [other for other in known if other.name != measured.name]
        tuned, unseen = split_sets(others)
        both = merge_sets("tuned", tuned), merge_sets("unseen", unseen)
        metrics += [
            replace(_distance(part, name, measured, people), goal=None)
            for people in both
            for name in COMPARED_MEASURES
            if measured.values(name).size and people.values(name).size
        ]
        if tuned and unseen and len(set(measured.performances)) > 1 and len(set(measured.rests)) > 1:
            metrics += separation_metrics(part, measured, tuned, unseen, None, None)
    several = [measured for measured in captured if len(set(measured.performances)) > 1]
    for a, b in combinations(several, 2):
        auc = separate_samples(motion_sample([a]), motion_sample([b])).auc
        name = f"{METRIC_PREFIX}.{a.name}.auc_from.{b.name}".replace(" ", "_")
        metrics.append(Metric(name, auc, "", None, "lower", "cross-validated by performance"))
    return metrics


def separation_metrics(
    part: str,
    ours: MeasuredSet,
    tuned: Sequence[MeasuredSet],
    unseen: Sequence[MeasuredSet],
    goal_auc: float | None,
    goal_accuracy: float | None,
) -> list[Metric]:
    """Return AUC and accuracy of classifiers of our against captured gestures.

    Each classifier is tried twice: trained on tuned sets and tested on unseen ones, and tested on every left-out set.
    """
    metrics: list[Metric] = []
    for suffix, scorer in CLASSIFIER_SCORERS.items():
        is_goal = suffix == ""
        for tested, result in _separations(motion_sample, ours, tuned, unseen, scorer).items():
            goal = goal_auc if is_goal else None
            metrics.append(Metric(f"{part}.motion_auc_{tested}{suffix}", result.auc, "", goal, "lower"))
        for tested, result in _separations(posture_sample, ours, tuned, unseen, scorer).items():
            goal = goal_accuracy if is_goal else None
            metrics.append(Metric(f"{part}.first_frame_accuracy_{tested}{suffix}", result.accuracy, "", goal, "lower"))
    return metrics


def _separations(
    sample_of: SampleOf,
    ours: MeasuredSet,
    tuned: Sequence[MeasuredSet],
    unseen: Sequence[MeasuredSet],
    scorer: Scorer,
) -> Mapping[str, Separation]:
    sample = sample_of([ours])
    return {
        "unseen": separate_unseen(sample, sample_of(tuned), sample_of(unseen), scorer),
        "left_out": separate_samples(sample, sample_of([*tuned, *unseen], whole_sets=True), scorer),
    }


def _summary_metric(title: str, summary: Summary, ours: MeasuredSet, tuned: MeasuredSet, unseen: MeasuredSet) -> Metric:
    value, *people = (summary.value_of(measured) for measured in (ours, tuned, unseen))
    note = f"people: tuned sets {people[0]:.2f}, unseen sets {people[1]:.2f}"
    return Metric(title, _finite(value), summary.unit, summary.goal, summary.better, note)


def _distance(part: str, name: str, ours: MeasuredSet, people: MeasuredSet) -> Metric:
    distance = kolmogorov_smirnov(ours.values(name), people.values(name))
    goal = MAX_KS_DISTANCE if people.name == "unseen" else None
    return Metric(
        f"{part}.ks_{people.name}_{name}", distance, "", goal, "lower", f"{len(people.values(name))} captured"
    )


def _quantile(sample: Floats) -> float:
    return float(np.median(sample)) if sample.size else float("nan")


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
