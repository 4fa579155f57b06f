"""Compare the whole body with captured sets and write the result into docs/benchmarks/naturalness.md."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from kinesic.bench.metric import Metric
from kinesic.bench.naturalness import COMPARED_ROBOTS, people_metrics
from kinesic.bench.naturalness.whole_body.comparison import (
    CLASSIFIER_SCORERS,
    COMPARED_MEASURES,
    FEATURE_SUMMARIES,
    METRIC_PREFIX,
    compare_sets,
    split_sets,
)
from kinesic.bench.naturalness.whole_body.features import MOTION_FEATURES
from kinesic.bench.naturalness.whole_body.stored import read_captured_sets

GESTURE_STEP = 3  # every third gesture of the lexicon
PAGE = Path(__file__).parents[1] / "benchmarks/naturalness.md"
BEGIN = "<!-- whole body -->"
END = "<!-- end of whole body -->"
KS_LABELS = {"trunk": "trunk", "stroke_speed": "stroke speed", "flow": "flow", "path": "path in arm lengths"}
SEPARATIONS = {
    "motion_auc": "motion, AUC",
    "first_frame_accuracy": "first frame, accuracy",
}
TESTED = {"unseen": "trained on tuned sets, tested on unseen ones", "left_out": "each captured set left out in turn"}
SUFFIXES = {"": "logistic regression", "_neighbours": "nearest neighbours"}
HEAD = """## How the whole body moves

`docs/make/whole_body.py` writes this section from every third gesture; `kinesic bench naturalness` plans all of them.
Gestures are planned alone, in the neutral style with the default amounts of idle motion and variation, with 24 seeds.
Captured clips are measured in the same way: from the start to a third of a second after `relax`, at 30 Hz, smoothed.
Lengths are in arm lengths.

Captured clips are of two kinds. Constants of kinesic were fitted on the **tuned** sets: Gestures and Gestures2 (one
actor, several initial poses), MaleGestures and FemaleGestures of SmartBody. **Unseen** sets were used for no fit:
PNGestures (30 gestures, another performer in a motion capture suit, 24 Hz) and nine BVH files (four with gestures, cut
into windows of 2.7 s; four catches and a walk, which count only in first frames). The clips are not part of kinesic;
`kinesic/configs/captured_bodies.toml` has their measures, and `--capture FOLDER` measures any folder of clips
(.skm with .sk or .bvh skeletons, and .bvh files).

- **Trunk** and **head**: largest rotation since the first frame, in the world. A trunk is no faster than breath below
  2.5 deg/s.
- **Free arm**: path of the wrist that moves less, divided by that of the other one, relative to the chest.
- **Hand turning**: largest rotation speed of the hand relative to the chest.
- **Classifiers** are tested on performances that they were not trained on. For motion they get {features} measures of
  trunk, head, collar bones, free arm, hand, elbow and wrist. For the first frame of clips that start at rest they get
  the places of wrists and elbows from the shoulders, the flexion of the elbows, differences between both arms, and the
  rotation of head and shoulders.
- An AUC of 0.5 and an accuracy of 0.5 mean that clips cannot be told apart. Columns of people tell how well the same
  classifier tells one captured set from the others: lowest and highest of the tuned sets, and PNGestures.

Some measures depend on the skeleton itself. The collar's displacement depends on where a skeleton has its shoulder, so
it has no goal. The head's pitch and the breadth of the shoulders are left out of the classifiers. A captured set has
few initial poses, so classifiers tell most captured sets from each other by the first frame.
"""


def section(metrics: Sequence[Metric]) -> str:
    """Return the text and the table in Markdown."""
    return "\n".join([HEAD.format(features=len(MOTION_FEATURES)), *_table({metric.name: metric for metric in metrics})])


def _table(metrics: Mapping[str, Metric]) -> Iterator[str]:
    tuned, _ = split_sets(read_captured_sets())
    names = [measured.name for measured in tuned]
    yield f"| measure | unit | {' | '.join(COMPARED_ROBOTS)} | tuned sets | PNGestures | goal |"
    yield "|---|---|" + "---|" * (len(COMPARED_ROBOTS) + 3)
    for row, label in _rows():
        ours = [metrics[f"{METRIC_PREFIX}.{robot}.{row}"] for robot in COMPARED_ROBOTS]
        people = [metrics.get(f"{METRIC_PREFIX}.{name}.{row}") for name in (*names, "PNGestures")]
        goal = ours[0].goal
        sign = ">=" if ours[0].better == "higher" else "<="
        cells = [
            label,
            ours[0].unit,
            *(_format(metric) + (" (missed)" if metric.ok is False else "") for metric in ours),
            _format_range(people[:-1]),
            _format(people[-1]),
            "" if goal is None else f"{sign} {goal:g}",
        ]
        yield f"| {' | '.join(cells)} |"


def _rows() -> Iterator[tuple[str, str]]:
    for name, summary in FEATURE_SUMMARIES.items():
        yield name, summary.label
    for people in ("tuned", "unseen"):
        for name in COMPARED_MEASURES:
            yield f"ks_{people}_{name}", f"Kolmogorov-Smirnov distance from {people} sets: {KS_LABELS[name]}"
    for kind, label in SEPARATIONS.items():
        for suffix in CLASSIFIER_SCORERS:
            for tested, words in TESTED.items():
                yield f"{kind}_{tested}{suffix}", f"{label}: {SUFFIXES[suffix]}, {words}"


def _format(metric: Metric | None) -> str:
    return "" if metric is None or metric.value is None else f"{metric.value:.3g}"


def _format_range(metrics: Sequence[Metric | None]) -> str:
    values = [metric.value for metric in metrics if metric is not None and metric.value is not None]
    return f"{min(values):.3g} to {max(values):.3g}" if values else ""


if __name__ == "__main__":
    captured = read_captured_sets()
    written = section([*people_metrics(COMPARED_ROBOTS, GESTURE_STEP), *compare_sets(captured, captured)])
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    PAGE.write_text(f"{before}{BEGIN}\n\n{written}\n\n{END}{rest.split(END)[1]}", encoding="utf-8")
