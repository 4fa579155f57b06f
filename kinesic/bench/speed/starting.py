"""Benchmark of starting a performer, and of a planning process' memory."""

import json
import subprocess
import sys

from kinesic.bench.metric import Metric

RUN_REPETITIONS = 5  # number of timed process starts
MAX_READY_TIME = 0.6  # [s] CPU time goal for making a performer, imports included
MAX_PLANNER_MEMORY = 150.0  # [MB] memory goal of a planning process
PERFORMER_CODE = "import kinesic; kinesic.Performer('upper22', voice='durations')"
PLANNER_CODE = "from kinesic.session.plan import plan; from kinesic.session.setup import set_up; plan(TEXT, set_up())"
PROGRAM_TEMPLATE = """
import json, time
TEXT = '''<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0"><gesture id="g" lexeme="beat" stroke="1"/></bml>'''
{work}
seconds = time.process_time()
from kinesic.bench.plan.plan_process import peak_memory
print(json.dumps([seconds, peak_memory()]))
"""


def bench() -> list[Metric]:
    """Measure CPU time and memory of program start and first plan."""
    ready, planned = _measure(PERFORMER_CODE), _measure(PLANNER_CODE)
    return [
        Metric("speed.ready", ready[0], "s", MAX_READY_TIME, "lower", "CPU, from the start of Python"),
        Metric("speed.ready_memory", ready[1], "MB", None, "lower"),
        Metric("speed.beat", planned[0], "s", None, "lower", "CPU, from the start of Python until one beat is planned"),
        Metric("speed.planner_memory", planned[1], "MB", MAX_PLANNER_MEMORY, "lower"),
    ]


def _measure(work: str) -> tuple[float, float]:
    """Return the smallest CPU time [s] and memory [MB] of repeated starts."""
    program = PROGRAM_TEMPLATE.format(work=work)
    runs = [
        json.loads(subprocess.run([sys.executable, "-c", program], stdout=subprocess.PIPE, check=True).stdout)
        for _ in range(RUN_REPETITIONS)
    ]
    seconds, megabytes = (min(values) for values in zip(*runs, strict=True))
    return float(seconds), float(megabytes)
