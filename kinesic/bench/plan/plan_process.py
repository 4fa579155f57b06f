"""Process that measures the cost of planning one hostile document.

Run `python -m kinesic.bench.plan.plan_process NAME`; it prints JSON.
"""

import json
import sys
from collections import Counter
from dataclasses import asdict
from math import nan
from pathlib import Path
from time import process_time

from kinesic.bench.plan.hostile import CPU_LIMIT, HOSTILE_DOCUMENTS, PlanningCost
from kinesic.bml.block import BmlError
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BYTES_PER_KIB = 1024
STATUS_FILE = Path("/proc/self/status")


def measure_planning_cost(name: str) -> PlanningCost:
    """Return the CPU time and memory to plan a document."""
    setup = set_up()
    text = HOSTILE_DOCUMENTS[name]([form.id for form in setup.lexicon.forms])
    began = process_time()
    try:
        planned = plan(text, setup)
        kinds = Counter(outcome.kind for outcome in planned.keyframes.outcomes.values())
        ending = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    except BmlError as error:
        ending = f"refused: {error}"[:200]
    return PlanningCost(process_time() - began, peak_memory(), ending)


def peak_memory() -> float:
    """Return the peak memory of this process [MB].

    The usage reported for a child process would include its parent's at the start. The result is NaN on Windows.
    """
    if STATUS_FILE.exists():
        status = dict(line.split(":", 1) for line in STATUS_FILE.read_text(encoding="utf-8").splitlines())
        return float(status["VmHWM"].split()[0]) / BYTES_PER_KIB
    peak = nan
    if sys.platform != "win32":
        import resource  # noqa: PLC0415 - Windows has none

        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / BYTES_PER_KIB**2
    return peak


def _bound_time() -> None:
    if sys.platform != "win32":
        import resource  # noqa: PLC0415 - Windows has none

        resource.setrlimit(resource.RLIMIT_CPU, (CPU_LIMIT, CPU_LIMIT))


if __name__ == "__main__":
    _bound_time()
    sys.stdout.write(json.dumps(asdict(measure_planning_cost(sys.argv[1]))))
