"""Write the output of `kinesic bench expressivity --json --plots docs/pictures --force` into its page."""

import json
import sys
from pathlib import Path

PAGE = Path(__file__).parents[1] / "benchmarks/expressivity.md"
BEGIN, END = "<!-- figures -->", "<!-- end of figures -->"
MARKS = {True: "met", False: "missed", None: ""}

figures = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
rows = ["| figure | value | goal | | |", "|---|---|---|---|---|"]
for figure in figures:
    value = "-" if figure["value"] is None else f"{figure['value']:.3g} {figure['unit']}".strip()
    sign = ">=" if figure["better"] == "higher" else "<="
    goal = "" if figure["goal"] is None else f"{sign} {figure['goal']:g}"
    rows.append(f"| `{figure['name']}` | {value} | {goal} | {MARKS[figure['ok']]} | {figure['why']} |")
before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
after = rest.split(END)[1]
PAGE.write_text("\n".join([before + BEGIN, "", *rows, "", END + after]), encoding="utf-8")
