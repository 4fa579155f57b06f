"""Measures how soon a performer is there, and how much memory a planner takes, each in a process of its own."""

import json
import subprocess
import sys

from kinesic.bench.figure import Figure

REPETITIONS = 5
READY = 0.6  # [s] goal: imports included
MEMORY = 150.0  # [MB] goal
PERFORMER = "import kinesic; kinesic.Performer('upper22')"
PLANNER = "from kinesic.controller.perform import plan, set_up; plan(TEXT, set_up())"
PROGRAM = """
import json, time
TEXT = '''<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0"><gesture id="g" lexeme="beat" stroke="1"/></bml>'''
{work}
seconds = time.process_time()
from kinesic.bench.plan.plan_process import peak_memory
print(json.dumps([seconds, peak_memory()]))
"""


def bench() -> list[Figure]:
    """Measures CPU and memory until a performer is there, and until a process has planned a beat."""
    ready, planned = _measure(PERFORMER), _measure(PLANNER)
    return [
        Figure("speed.ready", ready[0], "s", READY, "lower", "CPU, from the start of Python"),
        Figure("speed.ready_memory", ready[1], "MB", None, "lower"),
        Figure("speed.beat", planned[0], "s", None, "lower", "CPU, from the start of Python until one beat is planned"),
        Figure("speed.planner_memory", planned[1], "MB", MEMORY, "lower"),
    ]


def _measure(work: str) -> tuple[float, float]:
    """[s] of CPU and [MB] that a program takes, the least of some runs."""
    program = PROGRAM.format(work=work)
    runs = [
        json.loads(subprocess.run([sys.executable, "-c", program], stdout=subprocess.PIPE, check=True).stdout)
        for _ in range(REPETITIONS)
    ]
    seconds, megabytes = (min(values) for values in zip(*runs, strict=True))
    return float(seconds), float(megabytes)
