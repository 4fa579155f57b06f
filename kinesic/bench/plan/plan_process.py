"""Plans one hostile document and prints what that took: `python -m kinesic.bench.plan.plan_process NAME`."""

import json
import resource
import sys
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from time import process_time

from kinesic.bench.plan.hostile import DOCUMENTS, PATIENCE, Cost
from kinesic.bml.block import BmlError
from kinesic.controller.perform import plan, set_up

KIB = 1024
STATUS = Path("/proc/self/status")


def measure(name: str) -> Cost:
    """Plans a document in this process."""
    known = set_up()
    text = DOCUMENTS[name]([form.id for form in known.lexicon.forms])
    began = process_time()
    try:
        found = plan(text, known)
        kinds = Counter(outcome.kind for outcome in found.keyframes.outcomes.values())
        ending = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    except BmlError as error:
        ending = f"refused: {error}"[:200]
    return Cost(process_time() - began, peak_memory(), ending)


def peak_memory() -> float:
    """Looks up the largest memory of this process [MB]; usage as told of a child includes its parent's at the start."""
    if STATUS.exists():
        told = dict(line.split(":", 1) for line in STATUS.read_text(encoding="utf-8").splitlines())
        return float(told["VmHWM"].split()[0]) / KIB
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / KIB**2


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE, PATIENCE))
    sys.stdout.write(json.dumps(asdict(measure(sys.argv[1]))))
