"""Write the output of `kinesic bench expressivity --json --plots docs/pictures --force` into its page."""

import json
import sys
from collections.abc import Mapping
from pathlib import Path

from metric_tables import (
    BENCHMARKS,
    MISSED_NOTES,
    compared_table,
    format_table,
    format_value,
    metric_table,
    replace_tables,
)

from kinesic.bench.metric import Metric
from kinesic.studies.sweep.series import MEASURE_OF

LEXICON_COLUMNS = {"neutral style": "expressivity.lexicon.", "all styles": "expressivity.styles."}


def parameter_table(metrics: Mapping[str, Metric]) -> list[str]:
    """Tabulate monotone gestures and the largest stroke error by parameter."""
    rows = []
    for parameter in MEASURE_OF:
        monotone, stroke = (metrics[f"expressivity.{parameter}_{name}"] for name in ("monotone", "stroke"))
        cells = [format_value(metric, MISSED_NOTES[metric.ok]) for metric in (monotone, stroke)]
        rows.append((parameter, *cells, monotone.why.removeprefix("not: "), stroke.why))
    header = (
        "parameter",
        "`_monotone`: fraction of monotone gestures (goal 1)",
        "`_stroke`: largest stroke error (goal 10 ms)",
        "gestures that are not monotone",
        "gestures with a late stroke",
    )
    return format_table(*header, rows=rows)


if __name__ == "__main__":
    printed = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    metrics = [Metric(**{name: value for name, value in row.items() if name != "ok"}) for row in printed]
    details = {metric.name: metric.why for metric in metrics}
    replace_tables(
        BENCHMARKS / "expressivity.md",
        {
            "parameters": parameter_table({metric.name: metric for metric in metrics}),
            "effects": metric_table(metrics, "expressivity-effects", details),
            "lexicon": compared_table(metrics, "expressivity-lexicon", LEXICON_COLUMNS, {}),
            "counts": metric_table(metrics, "expressivity-counts", details),
        },
    )
