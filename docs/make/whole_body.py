"""Compare the whole body with captured sets and write the table of docs/benchmarks/naturalness.md."""

from collections.abc import Mapping, Sequence

from metric_tables import BENCHMARKS, format_goal, format_table, read_definitions, replace_tables

from kinesic.bench.metric import Metric
from kinesic.bench.naturalness import COMPARED_ROBOTS, people_metrics
from kinesic.bench.naturalness.whole_body.comparison import METRIC_PREFIX, compare_sets, split_sets
from kinesic.bench.naturalness.whole_body.stored import read_captured_sets

GESTURE_STEP = 3  # only every third gesture of the lexicon is measured


def body_table(metrics: Mapping[str, Metric]) -> list[str]:
    """Tabulate whole-body motion of each robot with that of captured sets."""
    tuned, _ = split_sets(read_captured_sets())
    rows = []
    for name, label in read_definitions("body-rows").items():
        ours = [metrics[f"{METRIC_PREFIX}.{robot}.{name}"] for robot in COMPARED_ROBOTS]
        people = [metrics.get(f"{METRIC_PREFIX}.{measured.name}.{name}") for measured in tuned]
        unseen = _format_value(metrics.get(f"{METRIC_PREFIX}.PNGestures.{name}"))
        cells = [_format_value(metric) + (" (missed)" if metric.ok is False else "") for metric in ours]
        unit = ours[0].unit.replace("deg", "°")
        measure = f"{label} [{unit}]" if unit else label
        rows.append((measure, *cells, _format_range(people), unseen, format_goal(ours[0])))
    return format_table("measure", *COMPARED_ROBOTS, "tuned sets", "PNGestures", "goal", rows=rows)


def _format_value(metric: Metric | None) -> str:
    return "" if metric is None or metric.value is None else f"{metric.value:.3g}"


def _format_range(metrics: Sequence[Metric | None]) -> str:
    values = [metric.value for metric in metrics if metric is not None and metric.value is not None]
    return f"{min(values):.3g} to {max(values):.3g}" if values else ""


if __name__ == "__main__":
    captured = read_captured_sets()
    measured = [*people_metrics(COMPARED_ROBOTS, GESTURE_STEP), *compare_sets(captured, captured)]
    replace_tables(
        BENCHMARKS / "naturalness.md", {"whole-body": body_table({metric.name: metric for metric in measured})}
    )
