"""Write the results of `kinesic bench face --json FILE` into docs/benchmarks/face.md."""

import json
import sys
from pathlib import Path

PAGE = Path(__file__).parents[1] / "benchmarks/face.md"
BEGIN, END = "<!-- figures -->", "<!-- end of figures -->"
MARKS = {True: "met", False: "missed", None: ""}
ESTIMATORS = {
    "depth": "plain depth",
    "crytek": "Crytek",
    "obscurance": "vol. obscurance",
    "horizon": "horizon",
    "angular": "angular",
}
STAGE = "face.stage."
TABLE = (*(f"face.occlusion.{estimator}_" for estimator in ESTIMATORS), STAGE)

figures = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
values = {figure["name"]: figure["value"] for figure in figures}
notes = {figure["name"]: figure["why"].removeprefix("thesis, GTX 480: ") for figure in figures}


def number(value: float) -> str:
    """Format with three significant digits, or as an integer from 1000 on."""
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def format_value(name: str) -> str:
    """Return a value with three digits, and the thesis's measurement in brackets."""
    if values[name] is None:
        return "-"
    return number(values[name]) + (f" ({notes[name].removeprefix('thesis: ')})" if notes[name] else "")


rows = [
    "Table 3.1 at 1024 x 768, 41 000 triangles: milliseconds, and in brackets the thesis's on a GTX 480.",
    "",
    "| size | | " + " | ".join(ESTIMATORS.values()) + " |",
    "|---|---|" + "---|" * len(ESTIMATORS),
]
for size in (5, 11, 21):
    for kind, head in (
        ("exact", f"{size} x {size}, exact"),
        ("separable", f"{size} x 2, separable"),
        ("ratio", "times faster"),
        ("rmse", "error, RMS"),
        ("rmse_occluded", "where occluded"),
    ):
        cells = [format_value(f"face.occlusion.{estimator}_{size}_{kind}") for estimator in ESTIMATORS]
        rows.append(f"| {size} | {head} | " + " | ".join(cells) + " |")
timed = [each.removeprefix(STAGE).rsplit("_", 1) for each in values if each.startswith(STAGE)]
drawn, stages = (list(dict.fromkeys(part)) for part in zip(*timed, strict=True))
stages = sorted(stages, key=[stage for stem, stage in timed if stem == drawn[-1]].index)  # the last preset has all
heads = [stem.replace("_", ", ").replace("x", " x ") for stem in drawn]
rows += ["", "Stages of a picture, and the whole picture without read-back: milliseconds on this machine.", ""]
rows += ["| | " + " | ".join(heads) + " |", "|---|" + "---|" * len(heads)]
for stage in stages:
    cells = [format_value(f"{STAGE}{stem}_{stage}") if f"{STAGE}{stem}_{stage}" in values else "" for stem in drawn]
    rows.append(f"| {stage} | " + " | ".join(cells) + " |")
rows += ["", "| figure | value | goal | |", "|---|---|---|---|"]
for figure in figures:
    if figure["goal"] is None and figure["name"].startswith(TABLE):
        continue
    value = "-" if figure["value"] is None else f"{number(figure['value'])} {figure['unit']}".strip()
    sign = ">=" if figure["better"] == "higher" else "<="
    goal = "" if figure["goal"] is None else f"{sign} {figure['goal']:g}"
    rows.append(f"| `{figure['name']}` | {value} | {goal} | {MARKS[figure['ok']]} |")
before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
after = rest.split(END)[1]
PAGE.write_text("\n".join([before + BEGIN, "", *rows, "", END + after]), encoding="utf-8")
