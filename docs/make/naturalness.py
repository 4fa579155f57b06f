"""Measure the lexicon in every style, write the tables of docs/benchmarks/naturalness.md and draw its pictures."""

import re
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from metric_tables import BENCHMARKS, compared_table, format_table, metric_table, read_definitions, replace_tables

from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE
from kinesic.bench.metric import Metric
from kinesic.bench.naturalness import VARIATION_SEEDS, document_metrics, draw, measured, style_metrics, varied_metrics
from kinesic.bench.naturalness.bars import METRIC_PREFIX
from kinesic.bench.naturalness.body import BODY_PARTS
from kinesic.bench.naturalness.captured_table import read_captured_table
from kinesic.bench.naturalness.lexicon import group_by_style
from kinesic.bench.naturalness.measures import GestureMeasures
from kinesic.bench.naturalness.rows import EFFORT_ROWS, MOTION_ROWS, ROW_PERCENTILES, values
from kinesic.bench.naturalness.story import STORY_STYLES
from kinesic.body.config import names_of
from kinesic.body.robot import Robot

DEFINED_PREFIXES = tuple(f"{METRIC_PREFIX}.{name}" for name in ("ks_", "whole_body", "story."))  # without notes
STORY_COLUMNS = {style: f"{METRIC_PREFIX}.story.{style}." for style in STORY_STYLES}
LEGIBILITY_COLUMNS = {
    "without variation": f"{METRIC_PREFIX}.",
    **{f"variation, seed {seed}": f"{METRIC_PREFIX}.varied.{seed}." for seed in VARIATION_SEEDS},
}
HandsByStyle = Mapping[str, Sequence[GestureMeasures]]
DELAYS = re.compile(r"later: (\S+) \S+ \S+ \S+ (\S+) \(n (\d+)\)")  # percentiles in the note of a delay metric


def hand_table(styles: HandsByStyle) -> list[str]:
    """Tabulate percentiles of captured and neutral-style hand motion."""
    rows = []
    for name, label in hand_labels().items():
        people = read_captured_table().percentiles.get(name)
        neutral = np.percentile(values(name, styles[NEUTRAL_STYLE]), ROW_PERCENTILES).tolist()
        rows.append((label, format_range(people), format_range(neutral)))
    return format_table("quantity", "captured", NEUTRAL_STYLE, rows=rows)


def style_table(styles: HandsByStyle) -> list[str]:
    """Tabulate the medians of hand motion by style."""
    rows = [
        (label, *(f"{np.median(values(name, hands)):.2f}" for hands in styles.values()))
        for name, label in hand_labels().items()
    ]
    return format_table("quantity", *styles, rows=rows)


def hand_labels() -> dict[str, str]:
    """Return the label of each hand-motion measure with its unit."""
    labels = read_definitions("hand-rows")
    return {name: f"{label} [{unit}]" if (unit := MOTION_ROWS[name].unit) else label for name, label in labels.items()}


def format_range(percentiles: Sequence[float] | None) -> str:
    """Format a median with its 5th and 95th percentiles."""
    if percentiles is None:
        return ""
    low, _, median, _, high = percentiles
    return f"{median:.2f} ({low:.2f} to {high:.2f})"


def describe_details(metrics: Iterable[Metric]) -> Mapping[str, str]:
    """Return the note of each metric without percentiles."""
    details = {}
    for metric in metrics:
        match = DELAYS.fullmatch(metric.why)
        if match:
            low, high, count = match.groups()
            details[metric.name] = (
                f"{describe_delay(low)} to {describe_delay(high)} (5th to 95th percentile of {count})"
            )
        elif "(n " not in metric.why and not metric.name.startswith(DEFINED_PREFIXES):
            details[metric.name] = metric.why
    return details


def describe_delay(seconds: str) -> str:
    """Format a stroke delay [s] as before or after its word."""
    value = float(seconds)
    return "0 s" if value == 0.0 else f"{abs(value):.2f} s {'before' if value < 0.0 else 'after'} the word"


def category_table(metrics: Mapping[str, Metric]) -> list[str]:
    """Tabulate medians of hand motion by category of gestures."""
    labels, part = read_definitions("hand-rows"), f"{METRIC_PREFIX}.category."
    categories = sorted({name.removeprefix(part).split(".")[0] for name in metrics if name.startswith(part)})
    rows = [
        (category, *(f"{metrics[f'{part}{category}.{row}'].value:.2f}" for row in EFFORT_ROWS))
        for category in categories
    ]
    return format_table("category", *(labels[row] for row in EFFORT_ROWS), rows=rows)


def turn_table(metrics: Mapping[str, Metric]) -> list[str]:
    """Tabulate the largest body rotations beside those of people."""
    part = f"{METRIC_PREFIX}.body."
    groups = dict.fromkeys(name.removeprefix(part).split(".")[0] for name in metrics if name.startswith(part))
    rows = []
    for group in groups:
        found = [metrics[f"{part}{group}.{name}"] for name in BODY_PARTS]
        rows.append((group, *(f"{each.value:.1f}" + (f" ({each.why})" if each.why else "") for each in found)))
    return format_table("category or gesture", *(f"{name} [°]" for name in BODY_PARTS), rows=rows)


if __name__ == "__main__":
    styles = names_of("style")
    gestures = measured(styles)
    hands = {style: [each.hand for each in group if each.hand] for style, group in group_by_style(gestures).items()}
    metrics = [*style_metrics(gestures, Robot.load().arm_length), *document_metrics(), *varied_metrics()]
    details, by_name = describe_details(metrics), {metric.name: metric for metric in metrics}
    replace_tables(
        BENCHMARKS / "naturalness.md",
        {
            "hands": hand_table(hands),
            "styles": style_table(hands),
            "hand-motion": metric_table(metrics, "hand-motion", details),
            "legibility": compared_table(metrics, "legibility", LEGIBILITY_COLUMNS, details),
            "synchrony": metric_table(metrics, "synchrony", details),
            "categories": category_table(by_name),
            "turns": turn_table(by_name),
            "story": compared_table(metrics, "story", STORY_COLUMNS, {}),
        },
    )
    draw(styles, BENCHMARKS.parent / "pictures")
