"""Plan each gesture in every style with the human model, and print a table.

`human_sweep.py FILE` appends one line per plan to a file. A stopped run continues from it.
"""

import json
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

from kinesic.bench.expressivity.lexicon import list_tasks
from kinesic.bench.plan import count_violations
from kinesic.body.config import names_of
from kinesic.expressivity.style.style import Style
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import plan_gesture

Row = dict[str, str | float | bool]


def plan_row(gesture: str, style: str, known: Setup) -> Row:
    """Plan one gesture in one style and return its results."""
    styled = replace(known, style=Style.load(style))
    form = next(form for form in styled.lexicon.forms if form.id == gesture)
    planned = plan_gesture(form, styled)
    strokes = [sync for sync in planned.syncs if sync.sync == "stroke"]
    distances = planned.clearance.distances
    return {
        "gesture": gesture,
        "style": style,
        "dropped": any(outcome.kind == "dropped" for outcome in planned.keyframes.outcomes.values()),
        "violations": count_violations(planned),
        "penetrations": int((distances < 0.0).sum()),
        "clearance_mm": 1000 * float(distances.min()),
        "late": any(abs(sync.planned - sync.requested) > SHIFT_TO_WARN for sync in strokes),
    }


def print_totals(rows: list[Row]) -> None:
    """Print the totals of all plans."""
    dropped = [row for row in rows if row["dropped"]]
    lines = [
        f"{len(rows)} plans, {len({row['gesture'] for row in rows})} gestures",
        f"limits exceeded: {sum(int(row['violations']) for row in rows)}",
        f"samples in penetration: {sum(int(row['penetrations']) for row in rows)}",
        f"smallest clearance: {min(float(row['clearance_mm']) for row in rows):.1f} mm",
        f"dropped: {len(dropped)}, {100 * len(dropped) / len(rows):.1f} %",
        f"strokes moved: {sum(bool(row['late']) for row in rows)}",
    ]
    for what in ("style", "gesture"):
        counted = Counter(str(row[what]) for row in dropped).most_common(40)
        lines.append(f"dropped by {what}: {', '.join(f'{name} {count}' for name, count in counted)}")
    sys.stdout.write("\n".join([*lines, ""]))


kept = Path(sys.argv[1])
done: list[Row] = [json.loads(line) for line in kept.read_text().splitlines()] if kept.exists() else []
behind = {(row["gesture"], row["style"]) for row in done}
tasks = [task for task in list_tasks(names_of("style")) if task not in behind]
order = np.random.default_rng(0).permutation(len(tasks))  # random, so that an unfinished run is a fair sample
human = set_up("human")
with kept.open("a") as file:
    for place in order:
        done.append(plan_row(*tasks[place], human))
        file.write(json.dumps(done[-1]) + "\n")
        file.flush()
print_totals(done)
