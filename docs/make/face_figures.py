"""Write the results of `kinesic bench face --json FILE` into docs/benchmarks/face.md."""

import json
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

from metric_tables import (
    BENCHMARKS,
    compared_table,
    format_number,
    format_table,
    format_value,
    metric_table,
    replace_tables,
)

from kinesic.bench.face import OCCLUSION_SIZES, PICTURE_SIZES, STAGE_PREFIX
from kinesic.bench.face.lips import SPEECH_RATES
from kinesic.bench.metric import Metric
from kinesic.face.render.presets import QUALITY_PRESETS

ESTIMATORS = {
    "depth": "plain depth test",
    "crytek": "Crytek",
    "obscurance": "volumetric obscurance",
    "horizon": "horizon",
    "angular": "angular",
}
OCCLUSION_ROWS = {
    "exact": "time, {size} x {size} samples [ms]",
    "separable": "time, {size} x 2 samples [ms]",
    "ratio": "exact / separable time",
    "rmse": "RMS error of the separable pass",
    "rmse_occluded": "RMS error where occluded",
}
LIP_COLUMNS = {f"{name} voice ({rate:g})": f"face.lips.{name}_" for name, rate in SPEECH_RATES.items()}
DEFINED_TABLES = ("frames", "body", "boxes", "scattering", "wrinkles", "prosody")

Metrics = Mapping[str, Metric]


def occlusion_table(metrics: Metrics) -> list[str]:
    """Tabulate each estimator's time and error beside the thesis' times."""
    rows = []
    for size in OCCLUSION_SIZES:
        for kind, label in OCCLUSION_ROWS.items():
            found = [metrics.get(f"face.occlusion.{estimator}_{size}_{kind}") for estimator in ESTIMATORS]
            rows.append((label.format(size=size), *(_with_thesis(metric) for metric in found)))
    return format_table("measure", *ESTIMATORS.values(), rows=rows)


def _with_thesis(metric: Metric | None) -> str:
    """Format a measurement, followed by the thesis' value in brackets."""
    if metric is None or metric.value is None:
        return ""
    thesis = metric.why.rpartition(": ")[2].removesuffix(" ms")
    return format_number(metric.value) + (f" ({thesis})" if thesis else "")


def frame_table(metrics: Metrics) -> list[str]:
    """Tabulate the frame rate of each preset and size."""
    rows = []
    for preset in QUALITY_PRESETS:
        for width, height in PICTURE_SIZES:
            stem = f"face.fps.{preset}_{width}x{height}"
            values = [format_value(metrics[name]) for name in (stem, f"{stem}_cpu")]
            rows.append((preset, f"{width} x {height}", *values))
    return format_table("preset", "size", "frame rate", "CPU time of a frame", rows=rows)


def stage_table(metrics: Metrics) -> list[str]:
    """Tabulate the time of each stage of a picture in milliseconds."""
    stems = [f"{preset}_{width}x{height}" for preset in QUALITY_PRESETS for width, height in PICTURE_SIZES]
    stages = _find_stages(metrics, stems[-1])  # the last preset has all
    rows = [
        (stage, *(_with_thesis(metrics.get(f"{STAGE_PREFIX}{stem}_{stage}")) for stem in stems)) for stage in stages
    ]
    return format_table("stage [ms]", *(stem.replace("_", ", ").replace("x", " x ") for stem in stems), rows=rows)


def _find_stages(metrics: Iterable[str], stem: str) -> list[str]:
    """Return the stages of one preset and size, in the order of drawing."""
    prefix = f"{STAGE_PREFIX}{stem}_"
    return [name.removeprefix(prefix) for name in metrics if name.startswith(prefix)]


if __name__ == "__main__":
    printed = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    measured = [Metric(**{name: value for name, value in row.items() if name != "ok"}) for row in printed]
    by_name = {metric.name: metric for metric in measured}
    replace_tables(
        BENCHMARKS / "face.md",
        {
            "rates": frame_table(by_name),
            "stages": stage_table(by_name),
            "occlusion": occlusion_table(by_name),
            "lips": compared_table(measured, "face-lips", LIP_COLUMNS, {}),
            **{name: metric_table(measured, f"face-{name}", {}) for name in DEFINED_TABLES},
        },
    )
